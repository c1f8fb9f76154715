/**
 * The layers: small stills of all views, beside the one picture; a press shows one large.
 *
 * Input: views, their programs, a player. Output: stills as the player would draw them now.
 */

import { make } from "../dom";
import type { Program, View } from "../payload";
import type { Player } from "../player";

const WIDTH_PX = 104;
/** More views are in the menu alone. */
const MOST = 16;
/** After the last change of a parameter or the camera, so long until stills follow. */
const REST_MS = 350;

export interface LayerEvents {
  /** The program of a view; null where it has mistakes or the text has changed. */
  program(view: string): Promise<Program | null>;
  chosen(view: string): void;
}

export class Layers {
  readonly element = make("div", { className: "layers", role: "group", "aria-label": "Layers", hidden: true });
  #stills = new Map<string, { button: HTMLButtonElement; still: HTMLCanvasElement }>();
  #key = "";
  #turn = 0;
  #timer = 0;

  constructor(readonly events: LayerEvents) {}

  get isOpen(): boolean {
    return !this.element.hidden;
  }

  set isOpen(isOpen: boolean) {
    this.element.hidden = !isOpen;
    this.#turn += 1;
  }

  /** Has a still for each view. */
  list(views: readonly View[], size: readonly [number, number]): void {
    const key = JSON.stringify([views.map(({ name }) => name), size]);
    if (key === this.#key) return;
    this.#key = key;
    const height = Math.max(Math.round((WIDTH_PX * size[1]) / size[0]), 1);
    this.#stills.clear();
    for (const { name, label } of views.slice(0, MOST)) {
      const still = make("canvas", { width: WIDTH_PX, height });
      const button = make("button", { type: "button", className: "layer" }, still, make("span", {}, label));
      button.onclick = () => this.events.chosen(name);
      this.#stills.set(name, { button, still });
    }
    this.element.replaceChildren(...[...this.#stills.values()].map(({ button }) => button));
  }

  /** Marks the view that is large. */
  mark(view: string): void {
    for (const [name, { button }] of this.#stills) button.setAttribute("aria-pressed", String(name === view));
  }

  /** Draws the stills again, once nothing has changed for a moment. */
  drawSoon(player: Player): void {
    clearTimeout(this.#timer);
    if (this.isOpen) this.#timer = window.setTimeout(() => void this.draw(player), REST_MS);
  }

  /** Draws the stills, one after the other; a newer call takes over. */
  async draw(player: Player): Promise<void> {
    const turn = ++this.#turn;
    for (const [name, { still }] of this.#stills) {
      if (!this.isOpen || turn !== this.#turn) return;
      const program = await this.events.program(name);
      if (!program || turn !== this.#turn) continue;
      const { width, height } = still;
      const bytes = await player.drawn(program, {}, [width, height]).catch(() => null);
      if (bytes && turn === this.#turn) paint(still, bytes);
    }
  }
}

/** Puts pixels on a canvas; their first row is the lowest. */
export function paint(still: HTMLCanvasElement, bytes: Uint8Array): void {
  const { width, height } = still;
  const context = still.getContext("2d")!;
  const image = context.createImageData(width, height);
  for (let y = 0; y < height; y++) {
    const row = bytes.subarray(4 * width * (height - 1 - y), 4 * width * (height - y));
    image.data.set(row, 4 * width * y);
  }
  for (let i = 3; i < image.data.length; i += 4) image.data[i] = 255;
  context.putImageData(image, 0, 0);
}
