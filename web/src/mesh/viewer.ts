/**
 * A mesh that turns slowly until somebody takes hold of it.
 *
 * Input: unpacked triangles and an element. Output: its canvas. Draws only what is on the screen, and
 * gives its WebGL context back where it is not: a page has 16, a notebook may have more meshes.
 */

import { Camera, type Steering } from "../camera";
import { KEYS } from "../generated/bindings";
import { listen } from "../gestures";
import { Hands } from "../hands";
import { Mouse } from "../mouse";
import { Drawing, type Texts } from "./drawing";
import type { Corners } from "./unpacking";

export interface Shown {
  size: [number, number, number];
  elevation: number;
  /** What the canvas shows, in words. */
  description: string;
  texts: Texts;
}

/** A whole turn takes 20 s: a drag over the picture's height is half of one. */
const HEIGHTS_PER_S = 0.1;

export class Viewer {
  readonly canvas = document.createElement("canvas");
  /** How many pictures were drawn. */
  frames = 0;
  /** Whether it turns by itself. */
  turning: boolean;
  #camera: Camera;
  #gl: WebGL2RenderingContext;
  #drawing: Drawing | null = null;
  #lending: WEBGL_lose_context | null;
  #seen = false;
  #request = 0;
  #last: number | null = null;

  /** Throws where the browser gives no WebGL 2, or refuses the program. */
  constructor(
    host: HTMLElement,
    readonly corners: Corners,
    readonly shown: Shown,
  ) {
    const { canvas } = this;
    const gl = canvas.getContext("webgl2", { antialias: true });
    if (!gl) throw new Error("This mesh turns in a browser with WebGL 2.");
    this.#gl = gl;
    this.#lending = gl.getExtension("WEBGL_lose_context");
    this.#drawing = this.#made();
    this.#camera = new Camera(shown.elevation);
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", shown.description);
    this.#takeHold();
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.#drawing = null;
      // Seen again before the loss was told.
      if (this.#seen) setTimeout(() => this.#restore());
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.#drawing = this.#made();
      this.#wake();
    });
    const calm = matchMedia("(prefers-reduced-motion: reduce)");
    this.turning = !calm.matches;
    calm.addEventListener("change", () => (this.turning &&= !calm.matches));
    host.prepend(canvas);
    new ResizeObserver(() => this.#wake()).observe(canvas);
    new IntersectionObserver(([entry]) => this.#sight(!!entry?.isIntersecting)).observe(canvas);
    document.addEventListener("visibilitychange", () => this.#wake());
  }

  get steering(): Steering {
    return this.#camera.steering;
  }

  #made(): Drawing {
    return new Drawing(this.#gl, this.corners, this.shown.texts, this.shown.size);
  }

  /** Gestures and keys, as in the player. */
  #takeHold(): void {
    const { canvas } = this;
    const hands = new Hands(this.#camera, new Mouse(), () => false, () => this.#wake());
    canvas.addEventListener("pointerdown", () => (this.turning = false));
    // The wheel scrolls the notebook, unless the canvas was picked up first.
    listen(canvas, hands, (event) => {
      const takes = event.ctrlKey || document.activeElement === canvas;
      if (takes) this.turning = false;
      return takes;
    });
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.#act(hands, event)) return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  /** Acts on a key; false for a key without a meaning here. The space bar starts and stops the turn. */
  #act(hands: Hands, { key, shiftKey }: KeyboardEvent): boolean {
    const action = KEYS[key] ?? (key.length === 1 ? KEYS[key.toLowerCase()] : undefined);
    const turning = action === "pause" && !this.turning;
    const acts: Partial<Record<string, () => unknown>> = {
      left: () => hands.arrow(-1, 0, shiftKey),
      right: () => hands.arrow(1, 0, shiftKey),
      up: () => hands.arrow(0, 1, shiftKey),
      down: () => hands.arrow(0, -1, shiftKey),
      nearer: () => hands.wheel(-1),
      farther: () => hands.wheel(1),
      resetCamera: () => hands.reset(),
      pause: () => this.#wake(),
    };
    const act = action && acts[action];
    if (!act) return false;
    this.turning = turning;
    act();
    return true;
  }

  #sight(isSeen: boolean): void {
    if (isSeen === this.#seen) return;
    this.#seen = isSeen;
    if (!isSeen) this.#lending?.loseContext();
    else if (this.#gl.isContextLost()) this.#restore();
    this.#wake();
  }

  #restore(): void {
    if (this.#seen && this.#gl.isContextLost()) this.#lending?.restoreContext();
  }

  /** Draws at the next frame of the browser, if anybody sees it. */
  #wake(): void {
    if (this.#request || !this.#seen || document.hidden) return;
    this.#request = requestAnimationFrame((now) => this.#frame(now));
  }

  #frame(now: number): void {
    this.#request = 0;
    if (!this.#seen || document.hidden) return void (this.#last = null);
    const { canvas } = this;
    const width = Math.max(Math.round(canvas.clientWidth * devicePixelRatio), 1);
    const height = Math.max(Math.round(canvas.clientHeight * devicePixelRatio), 1);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    // After a pause it goes on where it was.
    const passed = this.#last === null ? 0 : Math.min((now - this.#last) / 1000, 0.1);
    this.#last = this.turning ? now : null;
    if (this.turning) this.#camera.orbit(HEIGHTS_PER_S * passed, 0);
    if (this.#drawing && !this.#gl.isContextLost()) {
      this.#drawing.draw(this.steering);
      this.frames++;
    }
    if (this.turning) this.#wake();
  }
}
