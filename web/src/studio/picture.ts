/**
 * The picture beside the code: a player, its views and time, what the camera and the parameters keep.
 *
 * Input: payloads and numbers. Output: elements, and what a person did: a click, a view, a Keep.
 */

import { rowOf, type Row } from "../controls";
import { ICONS, icon, iconButton, make, rename } from "../dom";
import type { NumbersFound, ShapeMap } from "../generated/messages";
import type { Parameter, Payload, Program, Value } from "../payload";
import { Player } from "../player";
import { same } from "../values";
import { Layers } from "./layers";
import { Outline } from "./outline";

export interface PictureEvents {
  /** Another view is wanted, which may not be compiled yet. */
  view(): void;
  /** A click, in pixels of the author's frame from its top left. */
  clicked(x: number, y: number): void;
  keepParameter(name: string, value: Value): void;
  keepCamera(text: string): void;
  /** What was asked for does not come, and why. */
  refused(reason: string): void;
  /** Asks for the program that knows where the camera is; resolves when it is there, or none can be. */
  guide(): Promise<void>;
  drawn(text: string): void;
  /** The name of what is saved, where that is not the file's. */
  named(): string;
  /** The program of a view, for its still. */
  program(view: string): Promise<Program | null>;
  /** Which shape each pixel shows. */
  map(): Promise<ShapeMap | null>;
  /** The button of a command. */
  button(id: string): HTMLElement;
  /** What commands do may have changed. */
  changed(): void;
}

/** A press that moves farther is a drag. */
const CLICK_PX = 4;
const STEPS = 1000;
/** So often, with a pause between, it is asked where the camera is before that is given up. */
const KEEP_TRIES = 20;
const KEEP_PAUSE_MS = 250;
const NO_SLIDERS =
  "This scene has no sliders. Drag an underlined number of the code to change it; click the picture to find a shape's line.";

export class Picture {
  readonly element = make("div", { className: "picture" });
  readonly strip = make("div", { className: "strip", role: "toolbar", "aria-label": "Picture" });
  readonly knobs = make("div", { className: "knobs" });
  readonly layers: Layers;
  readonly outline: Outline;
  player: Player | null = null;
  #host = make("div", { className: "host" });
  #rows = new Map<string, { row: Row; keep: HTMLElement }>();
  #declared = "";
  #ends: (() => void)[] = [];

  constructor(readonly events: PictureEvents) {
    this.outline = new Outline(() => events.map());
    this.element.append(this.#host, this.outline.element);
    this.layers = new Layers({
      program: (view) => events.program(view),
      chosen: (view) => this.player?.setView(view),
    });
    this.#listenToClicks();
  }

  /** Shows a payload, in the player that is there if it can; throws where it fails, with the last one shown. */
  async show(payload: Payload): Promise<void> {
    const last = this.#last();
    try {
      await this.#show(payload);
    } catch (error) {
      this.#restore(last);
      throw error;
    }
  }

  /** What is shown, with the values that a person has chosen. */
  #last(): Payload | null {
    const { player } = this;
    return player && { ...player.payload, values: player.parameters() };
  }

  /** Begins again with what was shown: a payload that failed has changed a part of everything. */
  #restore(last: Payload | null): void {
    this.#declared = "";
    delete this.strip.dataset["key"];
    if (last) {
      this.#begin(last);
      this.#fill(last);
    } else {
      this.player?.dispose();
      this.player = null;
    }
  }

  async #show(payload: Payload): Promise<void> {
    const name = this.events.named() || payload.name;
    const shown = { ...payload, name, embed: true, panel: false };
    if (!(await this.player?.load(shown))) this.#begin(shown);
    this.#fill(payload);
  }

  /** The elements around a picture. */
  #fill({ parameters, ...payload }: Payload): void {
    this.#declare(parameters);
    this.#fillStrip(payload);
    this.layers.list(payload.views, payload.size);
    this.layers.mark(this.player!.view);
  }

  /** Shows what was drawn earlier, until a first picture is there. */
  preview(address: string): void {
    if (!this.player) this.#host.replaceChildren(make("img", { className: "preview", src: address, alt: "" }));
  }

  /** Draws with other numbers; the program stays. Throws where they do not belong to it. */
  setNumbers(found: Pick<NumbersFound, "numbers" | "parameters">): void {
    const last = this.#last();
    try {
      if (this.player) this.#setNumbers(this.player, found);
    } catch (error) {
      this.#restore(last);
      throw error;
    }
  }

  #setNumbers(player: Player, { numbers, parameters }: Pick<NumbersFound, "numbers" | "parameters">): void {
    const old = player.payload.parameters;
    const now = player.parameters();
    player.payload = { ...player.payload, parameters };
    for (const parameter of parameters) {
      const before = old.find(({ name }) => name === parameter.name);
      // What a person has not moved follows the code.
      const isFree = before && same(now[parameter.name]!, before.default);
      if (isFree) player.setParameter(parameter.name, parameter.default);
    }
    player.setNumbers(numbers);
    this.#declare(parameters);
  }

  /** One number of the program, while a literal is turned. */
  setNumber(name: string, value: number): void {
    this.player?.setNumbers({ [name]: value });
  }

  set isOld(isOld: boolean) {
    this.element.classList.toggle("old", isOld);
  }

  #begin(payload: Payload): void {
    const steering = this.player?.steering();
    for (const end of this.#ends.splice(0)) end();
    this.player?.dispose();
    const host = make("div", { className: "host", "data-distal": "" });
    this.#host.replaceWith(host);
    this.#host = host;
    const player = new Player(host, payload, { embed: true });
    (host as unknown as { distal: Player }).distal = player;
    this.player = player;
    if (steering) player.setSteering(steering);
    this.#ends.push(
      player.on("view", ({ name }) => {
        this.layers.mark(name);
        this.events.view();
      }),
      player.on("parameter", ({ name, value }) => {
        this.#moved(name, value);
        this.layers.drawSoon(player);
      }),
      player.on("steering", () => {
        this.layers.drawSoon(player);
        this.events.changed();
      }),
      player.on("frame", ({ ms, fps, width, height, samples, rate }) => {
        this.outline.follow(player);
        const speed = fps ? `${fps.toFixed(0)} fps` : `${ms.toFixed(0)} ms`;
        const paths = rate === undefined ? "" : ` · ${samples} samples`;
        this.events.drawn(`${width} × ${height} · ${speed}${paths}`);
      }),
    );
  }

  // Parameters

  #declare(parameters: readonly Parameter[]): void {
    const declared = JSON.stringify(parameters);
    if (declared === this.#declared) return;
    this.#declared = declared;
    this.#rows.clear();
    const player = this.player!;
    const values = player.parameters();
    const groups = new Map<string, HTMLElement[]>();
    for (const parameter of parameters) {
      const { name, label, group } = parameter;
      const row = rowOf(parameter, (value) => player.change(name, value));
      const keep = make("button", { type: "button", className: "keep" }, "Keep");
      keep.title = `Write this value of ${label} into the code`;
      keep.onclick = () => this.events.keepParameter(name, player.parameters()[name]!);
      row.element.append(keep);
      this.#rows.set(name, { row, keep });
      groups.set(group, [...(groups.get(group) ?? []), row.element]);
      row.show(values[name]!);
      keep.hidden = same(values[name]!, parameter.default);
    }
    const made = [...groups].map(([title, rows]) => {
      const heading = title && make("h3", {}, title);
      return make("div", { role: "group", "aria-label": title || "Parameters" }, heading, ...rows);
    });
    this.knobs.replaceChildren(...(made.length ? made : [make("p", { className: "quiet" }, NO_SLIDERS)]));
  }

  #moved(name: string, value: Value): void {
    const found = this.#rows.get(name);
    const parameter = this.player!.payload.parameters.find((one) => one.name === name);
    if (!found || !parameter) return;
    found.row.show(value);
    found.keep.hidden = same(value, parameter.default);
  }

  // The strip under the picture

  #fillStrip(payload: Pick<Payload, "views" | "time" | "steering">): void {
    const key = JSON.stringify([payload.views.map(({ name }) => name), payload.time.animated, !!payload.steering]);
    if (this.strip.dataset["key"] === key) return;
    this.strip.dataset["key"] = key;
    const player = this.player!;
    const parts: HTMLElement[] = [];
    if (payload.time.animated) parts.push(...this.#time(player));
    if (payload.views.length > 1) parts.push(this.#views(player, payload), this.events.button("layers"));
    if (payload.steering) parts.push(this.events.button("keepCamera"));
    parts.push(iconButton("Save a picture", ICONS.camera, () => void player.saveScreenshot()));
    this.strip.replaceChildren(...parts);
  }

  toggleLayers(): void {
    this.layers.isOpen = !this.layers.isOpen;
    this.events.changed();
    if (this.player) void this.layers.draw(this.player);
  }

  /** Writes into the code where the camera is. */
  async keepCamera(): Promise<void> {
    for (let tries = 0; tries < KEEP_TRIES; tries++) {
      const text = await this.player?.cameraText();
      if (text) return this.events.keepCamera(text);
      // In the first moment after a change nothing knows yet where the camera is; where the player itself
      // has just begun, not even after the answer.
      if ((this.player?.payload.steering?.guide ?? -1) < 0) await this.events.guide();
      if (tries) await new Promise((resolve) => setTimeout(resolve, KEEP_PAUSE_MS));
    }
    this.events.refused("The camera is not kept: the graphics driver does not say where it is.");
  }

  #views(player: Player, { views }: Pick<Payload, "views">): HTMLElement {
    const items = views.map(({ name, label }) => make("option", { value: name }, label));
    const menu = make("select", { "aria-label": "View", title: "View" }, ...items);
    menu.value = player.view;
    menu.onchange = () => player.setView(menu.value);
    this.#ends.push(player.on("view", ({ name }) => (menu.value = name)));
    return menu;
  }

  #time(player: Player): HTMLElement[] {
    const button = iconButton("", ICONS.play, () => player.toggle());
    const slider = make("input", { type: "range", min: "0", max: String(STEPS), step: "1" });
    slider.className = "time";
    slider.setAttribute("aria-label", "Time");
    const text = make("span", { className: "seconds" });
    let isHeld = false;
    let was: boolean | null = null;
    const show = () => {
      const [low, high] = player.timeRange;
      if (!isHeld) slider.valueAsNumber = ((player.time - low) / (high - low)) * STEPS;
      text.textContent = `${player.time.toFixed(2)} s`;
      if (was === player.playing) return;
      was = player.playing;
      button.replaceChildren(icon(was ? ICONS.pause : ICONS.play));
      rename(button, was ? "Pause" : "Play");
    };
    slider.oninput = () => {
      const [low, high] = player.timeRange;
      player.setTime(low + ((high - low) * slider.valueAsNumber) / STEPS);
    };
    const hold = (held: boolean) => player.hold((isHeld = held));
    slider.onpointerdown = () => hold(true);
    slider.onpointerup = slider.onpointercancel = slider.onblur = () => hold(false);
    this.#ends.push(player.on("time", show));
    show();
    return [button, slider, text];
  }

  // Clicks

  #listenToClicks(): void {
    let from: [number, number] | null = null;
    this.element.addEventListener("pointerdown", ({ clientX, clientY, button }) => {
      from = button === 0 ? [clientX, clientY] : null;
    });
    this.element.addEventListener("pointerup", (event) => {
      const { clientX: x, clientY: y } = event;
      if (!from || Math.hypot(x - from[0], y - from[1]) > CLICK_PX || !this.player) return;
      const canvas = event.composedPath()[0];
      if (!(canvas instanceof HTMLCanvasElement)) return;
      const box = canvas.getBoundingClientRect();
      // The author's frame lies whole in the middle of the canvas.
      const [wide, high] = this.player.payload.size;
      const scale = Math.min(box.width / wide, box.height / high);
      const left = (box.width - wide * scale) / 2;
      const top = (box.height - high * scale) / 2;
      this.events.clicked((x - box.left - left) / scale, (y - box.top - top) / scale);
    });
  }
}
