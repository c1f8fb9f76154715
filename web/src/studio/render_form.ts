/**
 * The part of the export sheet that renders pictures and films.
 *
 * Input: what the server can render, the scene as it is seen. Output: a form, the command that does the same,
 * requests. Formats, limits and defaults are those that Python declares.
 */

import { make } from "../dom";
import type { RenderChoices, RenderFormat, RenderRequest } from "../generated/messages";
import type { Player } from "../player";
import type { Client } from "./client";
import { commandOf, type Jobs } from "./jobs";

type Wanted = Omit<RenderRequest, "id" | "kind">;
export type Source = Pick<Wanted, "revision" | "files" | "main" | "object" | "view" | "values" | "size">;

export interface Scene {
  source(): Source;
  player(): Player | null;
  isUnsaved(): boolean;
}

/** After the last change of a field, so long until its command is asked for. */
const ASKING_MS = 150;
const AS_IT_IS = "Scene's own";

export class RenderForm {
  readonly element = make("section", { className: "render", "aria-label": "Pictures and films" });
  #format: HTMLSelectElement;
  #width: HTMLInputElement;
  #height: HTMLInputElement;
  #time = number("", 0);
  #length = number("", 2, { min: "0" });
  #fps = make("input", { type: "text", value: "30", inputMode: "decimal" });
  #mode: HTMLSelectElement;
  #samples: HTMLInputElement;
  #limit = number("", null, { min: "0", placeholder: "no limit" });
  #bits = make("select");
  #quality: HTMLSelectElement;
  #transparent = make("input", { type: "checkbox" });
  #loop = make("input", { type: "checkbox", checked: true });
  #command = make("div");
  #note = make("p", { className: "result", role: "status" });
  #go = make("button", { type: "button", className: "go" });
  #fields = new Map<string, HTMLElement>();
  #timer = 0;
  #asked = 0;

  constructor(
    readonly client: Client,
    readonly scene: Scene,
    readonly jobs: Jobs,
    readonly choices: RenderChoices,
  ) {
    const { formats, modes, qualities, quality, largest_side, most_samples } = choices;
    const group = (label: string, isFilm: boolean) => {
      const options = formats.filter(({ film }) => film === isFilm);
      const made = options.map(({ name }) => make("option", { value: name }, name.toUpperCase()));
      return make("optgroup", { label }, ...made);
    };
    this.#format = make("select", {}, group("Picture", false), group("Film", true));
    const [wide, high] = scene.source().size ?? [0, 0];
    const side = { min: "1", max: String(largest_side), step: "1" };
    this.#width = number("Width", wide, side);
    this.#height = number("Height", high, side);
    this.#samples = number("", null, { min: "1", max: String(most_samples), step: "1" });
    this.#mode = menu(["", AS_IT_IS], ...modes.map((mode): [string, string] => [mode, mode]));
    this.#quality = menu(...qualities.map((one): [string, string] => [one, one]));
    this.#quality.value = quality;
    this.#time.valueAsNumber = +(scene.player()?.time ?? 0).toFixed(3);
    this.#fill();
    this.element.addEventListener("input", () => this.#changed());
    this.#go.onclick = () => this.#render();
    this.#changed();
  }

  get #chosen(): RenderFormat {
    return this.choices.formats.find(({ name }) => name === this.#format.value)!;
  }

  #fill(): void {
    const size = make("span", { className: "pair" }, this.#width, "×", this.#height);
    const rows: [string, string, HTMLElement][] = [
      ["format", "Format", this.#format],
      ["size", "Size", size],
      ["time", "Time", this.#time],
      ["length", "Length, s", this.#length],
      ["fps", "Frames a second", this.#fps],
      ["mode", "Light", this.#mode],
      ["samples", "Samples", this.#samples],
      ["limit", "Time limit, s", this.#limit],
      ["bits", "Bits of a channel", this.#bits],
      ["quality", "Quality", this.#quality],
      ["transparent", "Without the background", this.#transparent],
      ["loop", "Repeats", this.#loop],
    ];
    const fields = rows.map(([name, text, control]) => {
      const tag = name === "size" ? "div" : "label";
      const field = make(tag, { className: "field" }, make("span", {}, text), control);
      this.#fields.set(name, field);
      return field;
    });
    const seen = make(
      "p",
      { className: "quiet" },
      "The text, sliders, view and camera are those that you see, saved or not.",
    );
    this.element.append(
      make("h3", {}, "Pictures and films"),
      make("div", { className: "fields" }, ...fields),
      seen,
      this.#command,
      this.#note,
      this.#go,
      this.jobs.rows,
    );
  }

  /** Shows the fields that the format has, and asks for the command. */
  #changed(): void {
    const format = this.#chosen;
    const player = this.scene.player();
    const isColor = (player?.view ?? "color") === "color";
    const isLit = !!player?.payload.steering && isColor;
    const isPath = this.#mode.value === "path" || (!this.#mode.value && !!player?.payload.views.some(({ film }) => film));
    const shown: Record<string, boolean> = {
      time: !!player?.payload.time.animated,
      length: format.film,
      fps: format.film,
      mode: isLit,
      limit: isLit && isPath && !format.film,
      bits: format.bits.length > 1,
      quality: format.lossy,
      transparent: isLit && !format.film,
      loop: format.loops,
    };
    for (const [name, isShown] of Object.entries(shown)) this.#fields.get(name)!.hidden = !isShown;
    this.#fields.get("time")!.querySelector("span")!.textContent = format.film ? "From, s" : "Time, s";
    this.#samples.placeholder = isLit && isPath ? String(this.choices.path_samples) : "automatic";
    this.#limit.disabled = !shown["limit"];
    if (this.#bits.dataset["of"] !== format.name) {
      this.#bits.dataset["of"] = format.name;
      this.#bits.replaceChildren(...format.bits.map((bits) => make("option", { value: String(bits) }, String(bits))));
    }
    this.#go.textContent = `Render ${format.name.toUpperCase()}`;
    this.#go.disabled = !!format.missing;
    this.#note.textContent = format.missing ?? "";
    this.#command.setAttribute("aria-busy", "true");
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => void this.#ask(), ASKING_MS);
  }

  async #ask(): Promise<void> {
    const asked = ++this.#asked;
    const stop = () => this.#command.removeAttribute("aria-busy");
    if (this.#chosen.missing || this.#mistake()) {
      this.#note.textContent = this.#chosen.missing ?? this.#mistake();
      stop();
      return this.#command.replaceChildren();
    }
    const answer = await this.client.ask({ kind: "command", ...this.#wanted() });
    if (asked !== this.#asked) return;
    stop();
    const isThere = answer?.kind === "answer" && answer.request === "command";
    this.#command.replaceChildren(...(isThere ? [commandOf(answer.result.command)] : []));
    const isStill = this.#chosen.film && this.scene.player()?.payload.time.animated === false;
    const notes = [
      isStill && "Nothing moves in this picture: all frames are the same.",
      this.scene.isUnsaved() && "The command reads the saved file: save first for the same picture.",
    ];
    if (answer?.kind === "mistakes") this.#note.textContent = answer.mistakes[0]!.message;
    else this.#note.textContent = notes.filter(Boolean).join(" ");
  }

  /** What a field has that is not allowed. */
  #mistake(): string {
    for (const [name, field] of this.#fields) {
      const bad = field.hidden ? null : field.querySelector<HTMLInputElement>("input:invalid");
      if (bad) return `${field.querySelector("span")!.textContent || name}: ${bad.validationMessage}`;
    }
    const isEmpty = [this.#width, this.#height].some(({ value }) => !value);
    return isEmpty ? "A picture has a width and a height." : "";
  }

  #wanted(): Wanted {
    const format = this.#chosen;
    const player = this.scene.player();
    const has = (name: string) => !this.#fields.get(name)!.hidden;
    const value = (name: string, { valueAsNumber }: HTMLInputElement) =>
      has(name) && Number.isFinite(valueAsNumber) ? valueAsNumber : null;
    const bits = Number(this.#bits.value);
    return {
      ...this.scene.source(),
      format: format.name,
      size: [this.#width.valueAsNumber, this.#height.valueAsNumber],
      time: value("time", this.#time) ?? 0,
      steering: steeringOf(player),
      mode: has("mode") ? ((this.#mode.value || null) as NonNullable<Wanted["mode"]> | null) : null,
      samples: value("samples", this.#samples),
      time_limit: value("limit", this.#limit),
      bits: has("bits") && bits !== format.bits[0] ? bits : null,
      transparent: has("transparent") && this.#transparent.checked,
      duration: value("length", this.#length) ?? 0,
      fps: this.#fps.value,
      quality: has("quality") && this.#quality.value !== this.choices.quality ? this.#quality.value : null,
      loop: has("loop") && this.#loop.checked,
    };
  }

  #render(): void {
    const mistake = this.#mistake();
    if (mistake) {
      this.#note.textContent = mistake;
      return;
    }
    const wanted = this.#wanted();
    this.jobs.start({ kind: "render", ...wanted }, `${wanted.main.replace(/\.py$/, "")}.${wanted.format}`);
  }
}

/** The form, once the server has said what it can render; it is asked once. */
export function renderPart(client: Client, scene: Scene, jobs: Jobs): HTMLElement {
  const place = make("div");
  const fill = (choices: RenderChoices) => {
    jobs.choices = choices;
    place.replaceChildren(new RenderForm(client, scene, jobs, choices).element);
  };
  if (jobs.choices) fill(jobs.choices);
  else {
    place.append(make("p", { className: "quiet" }, "Looking what can be rendered here …"));
    void client.ask({ kind: "choices", revision: 0 }).then((answer) => {
      if (answer?.kind === "answer" && answer.request === "choices") fill(answer.result);
      else place.replaceChildren(make("p", { role: "alert" }, "Nothing can be rendered: nobody answers."));
    });
  }
  return place;
}

/** In the playground nothing is rendered beside the page: the drawn picture is there, and why not more. */
export function drawnPicture(player: () => Player | null): HTMLElement {
  const save = make("button", { type: "button" }, "PNG of the picture as it is drawn here");
  save.onclick = () => void player()?.saveScreenshot();
  return make(
    "section",
    { className: "render", "aria-label": "Pictures and films" },
    make("h3", {}, "Pictures and films"),
    save,
    make(
      "p",
      { className: "quiet" },
      "Other sizes, EXR, films and long renders need programs that a browser page may not run: ",
      make("code", {}, "pip install 'distal[studio]'"),
      " and ",
      make("code", {}, "distal studio"),
      " have them.",
    ),
  );
}

/** How the camera was moved, in numbers short enough for a command. */
function steeringOf(player: Player | null): Record<string, number> {
  if (!player?.camera?.moved) return {};
  const { yaw, pitch, zoom, pan } = player.steering()!;
  const moved = { yaw, pitch, zoom, pan_x: pan[0]!, pan_y: pan[1]! };
  return Object.fromEntries(Object.entries(moved).map(([name, value]) => [name, +value.toFixed(6)]));
}

function number(name: string, value: number | null, more: Record<string, string> = {}): HTMLInputElement {
  const made = make("input", { type: "number", step: "any", ...more });
  if (name) made.setAttribute("aria-label", name);
  if (value !== null) made.valueAsNumber = value;
  return made;
}

function menu(...options: [value: string, text: string][]): HTMLSelectElement {
  return make("select", {}, ...options.map(([value, text]) => make("option", { value }, text)));
}
