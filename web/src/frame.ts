/**
 * The elements over a picture: poster, title, bar, panel, notices, all in a shadow root.
 *
 * Input: a player. Output: elements; the size and visibility of the canvas as they change, and how much
 * of it they cover. It decides what is over what, and nothing about pictures.
 */

import { make } from "./dom";
import type { Needs } from "./generated/bindings";
import { NOTHING_COVERED, frameOn, type Covered } from "./framing";
import { listen } from "./gestures";
import { helpOf } from "./help";
import { isNeeded, press } from "./keyboard";
import { Notices } from "./notices";
import { panelOf } from "./panel";
import type { Payload } from "./payload";
import type { Player } from "./player";
import type { State } from "./renderer";
import style from "./style.css";
import { toolbarOf } from "./toolbar";

export type Theme = "auto" | "light" | "dark";

/** Below this width the panel is a sheet under the picture. */
export const NARROW_PX = 640;
/** More pixels than this for one of the page's are not seen. */
const FINEST = 2;

export class Frame {
  static #pages = 0;
  readonly root: ShadowRoot;
  readonly notices = new Notices();
  canvas: HTMLCanvasElement;
  #player: Player;
  #box: HTMLElement;
  #stage: HTMLElement;
  #panel: HTMLElement | null = null;
  #bar: HTMLElement;
  #covered = NOTHING_COVERED;
  #isOpen: boolean | null = null;
  #end = new AbortController();
  #onPanel: (isOpen: boolean) => void = () => {};
  #onCovered: () => void = () => {};
  #onSize: (entry: ResizeObserverEntry) => void = () => {};
  #sizes = new ResizeObserver((entries) => entries.forEach((entry) => this.#onSize(entry)));

  constructor(player: Player, theme: Theme) {
    const { host, payload } = player;
    this.#player = player;
    // First what an old browser lacks: a poster in a host without a root stays to be seen.
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(style);
    this.root = host.shadowRoot ?? host.attachShadow({ mode: "open" });
    this.root.adoptedStyleSheets = [sheet];
    host.style.setProperty("--distal-shape", `${payload.size[0]} / ${payload.size[1]}`);
    this.canvas = this.#newCanvas();
    const poster = payload.poster && make("img", { src: payload.poster, alt: payload.description });
    const still = make("slot", { className: "still" }, poster || "");
    this.#stage = make("div", { className: "stage" }, still, this.canvas, this.notices.element);
    const classes = `player ${theme} ${payload.embed ? "embed" : ""}`;
    this.#bar = toolbarOf(player);
    this.#box = make("div", { className: classes }, this.#stage, this.notices.status, this.#bar);
    this.root.replaceChildren(this.#box);
    if (!payload.embed) {
      this.#panel = panelOf(player);
      this.#stage.after(make("h2", { className: "title glass" }, payload.name));
      this.#box.append(this.#panel);
    }
  }

  /** Fits an editor's picture to another payload; an editor has embedded pictures, without panels. */
  refresh(old: Payload): void {
    if (!EDITED) return;
    const { host, payload } = this.#player;
    host.style.setProperty("--distal-shape", `${payload.size[0]} / ${payload.size[1]}`);
    this.canvas.ariaLabel = this.#newCanvas().ariaLabel;
    if (payload.time.animated === old.time.animated && payload.name === old.name) return;
    const bar = toolbarOf(this.#player);
    this.#bar.replaceWith(bar);
    this.#bar = bar;
  }

  /** How much of the picture bar and panel cover; the author's frame lies in the rest. */
  get covered(): Covered {
    return this.#covered;
  }

  set live(isLive: boolean) {
    this.#stage.classList.toggle("live", isLive);
  }

  set state(state: State) {
    this.#box.dataset["state"] = state;
  }

  showHelp(): void {
    const dialog = helpOf((needs) => this.#has(needs));
    this.#box.append(dialog);
    dialog.onclose = () => dialog.remove();
    dialog.showModal();
  }

  togglePanel(): void {
    this.#isOpen = !this.#box.classList.contains("open");
    this.#arrange();
  }

  /** Reports the canvas's size in pixels, whether it and the panel can be seen, what is covered. */
  follow(
    onSize: (width: number, height: number) => void,
    onSight: (isVisible: boolean) => void,
    onPanel: (isOpen: boolean) => void,
    onCovered: () => void,
  ): void {
    this.#onPanel = onPanel;
    this.#onCovered = onCovered;
    this.#onSize = (entry) => {
      if (entry.target === this.#player.host) this.#arrange();
      if (entry.target !== this.canvas) return this.#measure();
      const density = devicePixelRatio || 1;
      const exact = entry.devicePixelContentBoxSize?.[0];
      const width = exact?.inlineSize ?? entry.contentRect.width * density;
      const height = exact?.blockSize ?? entry.contentRect.height * density;
      const share = Math.min(1, FINEST / density);
      onSize(Math.max(1, Math.round(width * share)), Math.max(1, Math.round(height * share)));
    };
    for (const element of [this.#player.host, this.#bar, this.#panel]) {
      if (element) this.#sizes.observe(element);
    }
    this.#observeCanvas();
    let isNear = false;
    const tell = () => onSight(isNear && !document.hidden);
    const sight = new IntersectionObserver((entries) => {
      isNear = entries.at(-1)!.isIntersecting;
      tell();
    });
    sight.observe(this.#player.host);
    const { signal } = this.#end;
    document.addEventListener("visibilitychange", tell, { signal });
    signal.addEventListener("abort", () => sight.disconnect());
  }

  /** Gestures and keys begin to mean something. */
  listen(isMovable: boolean): void {
    const { canvas } = this;
    canvas.classList.toggle("movable", isMovable);
    if (isMovable) listen(canvas, this.#player.hands, (event) => this.#takesWheel(event));
    if (this.#end.signal.aborted || this.#isListening) return;
    this.#isListening = true;
    const { signal } = this.#end;
    const act = (event: KeyboardEvent) =>
      (FRAMES && takes(this.#player, event)) || press(event, this.#player.actions);
    this.#box.addEventListener("keydown", act);
    if (FRAMES) {
      this.#box.addEventListener("keyup", act);
      if (!EDITED) takeFiles(this.#box, this.#player, (text) => this.notices.brief(text));
      addEventListener("blur", () => this.#player.keys?.release(), { signal });
      for (const type of ["pointerdown", "pointerup", "pointercancel"] as const) {
        const tell = (event: PointerEvent) => this.#player.pressed(event.buttons);
        this.#box.addEventListener(type, tell);
      }
    }
    if (this.#player.payload.embed) return;
    // On a page of its own the keys need no focus.
    Frame.#pages += 1;
    signal.addEventListener("abort", () => (Frame.#pages -= 1));
    const actAlone = (event: KeyboardEvent) => {
      const isFree = event.target === document.body || event.target === document.documentElement;
      if (isFree && Frame.#pages === 1 && this.#fills()) act(event);
    };
    document.addEventListener("keydown", actAlone, { signal });
    if (FRAMES) document.addEventListener("keyup", actAlone, { signal });
  }

  #isListening = false;

  /** A canvas that failed once gives no context ever again: another one. */
  newCanvas(): HTMLCanvasElement {
    const fresh = this.#newCanvas();
    fresh.width = this.canvas.width;
    fresh.height = this.canvas.height;
    this.#sizes.unobserve(this.canvas);
    this.canvas.replaceWith(fresh);
    this.canvas = fresh;
    this.#observeCanvas();
    return fresh;
  }

  dispose(): void {
    this.#end.abort();
    this.#sizes.disconnect();
    this.notices.clear();
    this.root.replaceChildren(document.createElement("slot"));
  }

  #newCanvas(): HTMLCanvasElement {
    const { description, steering } = this.#player.payload;
    const keys = steering ? " Arrow keys turn around it, plus and minus go nearer and farther." : "";
    const canvas = make("canvas", { tabIndex: 0, role: "img" });
    canvas.setAttribute("aria-label", `${description}${keys}`);
    return canvas;
  }

  #observeCanvas(): void {
    try {
      this.#sizes.observe(this.canvas, { box: "device-pixel-content-box" });
    } catch {
      this.#sizes.observe(this.canvas); // Not every browser reports device pixels.
    }
  }

  #arrange(): void {
    const isNarrow = this.#player.host.clientWidth < NARROW_PX;
    // A sheet would hide half of a small screen: it opens on request.
    const isOpen = this.#isOpen ?? (!isNarrow && this.#player.payload.panel);
    this.#box.classList.toggle("narrow", isNarrow);
    this.#box.classList.toggle("open", isOpen);
    if (this.#panel) this.#panel.inert = !isOpen;
    this.#measure();
    this.#onPanel(isOpen);
  }

  /** What bar and panel cover. Those of an embedded picture appear only under the hand. */
  #measure(): void {
    const { payload, host } = this.#player;
    const { clientWidth: width, clientHeight: height } = host;
    // A sheet stands on the bar, whose rows are as many as fit.
    this.#box.style.setProperty("--bar", `${this.#bar.offsetHeight}px`);
    let covered = NOTHING_COVERED;
    if (!payload.embed && width && height) {
      const isNarrow = this.#box.classList.contains("narrow");
      const panel = this.#box.classList.contains("open") ? this.#panel : null;
      const lowest = isNarrow && panel ? panel : this.#bar;
      const side = !isNarrow && panel ? width - panel.offsetLeft : 0;
      const bottom = (height - lowest.offsetTop) / height;
      covered = { left: 0, right: side / width, top: 0, bottom };
    }
    const isNew = JSON.stringify(covered) !== JSON.stringify(this.#covered);
    this.#covered = covered;
    const [wide, high] = payload.size;
    const { size, offset } = frameOn(width, height, covered, wide / high);
    const place = { left: offset[0], width: size[0], bottom: offset[1], height: size[1] };
    for (const [name, value] of Object.entries(place)) {
      this.#box.style.setProperty(`--${name}`, `${value}px`);
    }
    if (isNew) this.#onCovered();
  }

  #has(needs: Needs): boolean {
    const { payload, camera, readsMouse } = this.#player;
    if (needs === "camera") return !!camera;
    if (PATHS && needs === "mode") return payload.views.some(({ film }) => film);
    if (needs === "mouse") return readsMouse;
    if (["pause", "back", "begin", "slower"].includes(needs)) return payload.time.animated;
    if (needs === "nextView") return payload.views.length > 1;
    if (needs === "fullScreen") return document.fullscreenEnabled;
    return needs !== "parameters" || !payload.embed;
  }

  /** Whether the page is there for this player alone, and not a text around it. */
  #fills(): boolean {
    const { height } = this.#player.host.getBoundingClientRect();
    return !this.#player.payload.embed && height > 0.9 * innerHeight;
  }

  /** The wheel scrolls a page, unless the canvas was picked up first. */
  #takesWheel(event: WheelEvent): boolean {
    if (!this.#player.camera) return false;
    return event.ctrlKey || this.root.activeElement === this.canvas || this.#fills();
  }
}

/** Whether the picture reads the key; a key that goes up has no other meaning. */
function takes(player: Player, event: KeyboardEvent): boolean {
  const isTaken = !isNeeded(event.composedPath()[0], event.key) && player.takesKey(event);
  if (isTaken) event.preventDefault();
  return isTaken || event.type === "keyup";
}

/** A file that is dropped on a picture takes the place of its images, one after the other. */
function takeFiles(box: HTMLElement, player: Player, say: (text: string) => void): void {
  let next = 0;
  box.addEventListener("dragover", (event) => event.preventDefault());
  box.addEventListener("drop", (event) => {
    const images = player.payload.frames?.images ?? [];
    const file = event.dataTransfer?.files[0];
    event.preventDefault();
    if (!file || !images.length) return;
    const { name } = images[next % images.length]!;
    const done = () => (next += 1);
    player.setImage(name, file).then(done, () => say(`${file.name} is no picture.`));
  });
}
