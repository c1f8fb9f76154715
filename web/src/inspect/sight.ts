/** Where the author's frame lies on a player's canvas. */

import { NOTHING_COVERED, frameOn } from "../framing";
import type { Player } from "../player";
import type { Point } from "./inspection";

export class Sight {
  #root: ShadowRoot;

  constructor(readonly player: Player) {
    this.#root = player.host.shadowRoot!;
  }

  get canvas(): HTMLCanvasElement {
    return this.#root.querySelector("canvas")!; // Another one after a lost context.
  }

  /** Pixels of the canvas for each of the page's. */
  get ratio(): number {
    const { width, clientWidth } = this.canvas;
    return width / (clientWidth || 1);
  }

  /** The frame's size and lower left corner, in pixels of the canvas. */
  frame(): { size: Point; offset: Point } {
    const { style } = this.#root.querySelector<HTMLElement>(".player")!;
    const offset = ["--left", "--bottom"].map((name) => {
      return Math.round(parseFloat(style.getPropertyValue(name) || "0") * this.ratio);
    });
    return { size: this.player.frameSize, offset: offset as Point };
  }

  /** The same of a saved picture, which nothing covers. */
  whole(): { size: Point; offset: Point } {
    const { width, height } = this.canvas;
    const [wide, high] = this.player.payload.size;
    return frameOn(width, height, NOTHING_COVERED, wide / high);
  }
}
