/**
 * The mouse as scene code reads it (Shadertoy's meaning), in parts of the picture from the lower
 * left: where it was last dragged to, and where that drag began.
 *
 * Pure. The third number is positive while the button is down, the fourth in the first frame.
 */

import { clamp } from "./values";

export class Mouse {
  #at = [0, 0];
  #from = [0, 0];
  #down = false;
  #fresh = false;

  press(x: number, y: number): void {
    this.#at = this.#from = [clamp(x, 0, 1), clamp(y, 0, 1)];
    this.#down = this.#fresh = true;
  }

  move(x: number, y: number): void {
    if (this.#down) this.#at = [clamp(x, 0, 1), clamp(y, 0, 1)];
  }

  release(): void {
    this.#down = false;
  }

  /** For the keyboard: a press and release beside where it was. */
  nudge(right: number, up: number): void {
    const [x, y] = this.#at as [number, number];
    this.press(x + right, y + up);
    this.release();
  }

  reset(): void {
    this.#at = this.#from = [0, 0];
    this.#down = this.#fresh = false;
  }

  /** The uniform for a picture of so many pixels, counted from the corner of the author's frame. */
  pixels(width: number, height: number, [left, low]: [number, number] = [0, 0]): number[] {
    const [x, y] = this.#at as [number, number];
    const [fromX, fromY] = this.#from as [number, number];
    const signX = this.#down ? 1 : -1;
    const signY = this.#fresh ? 1 : -1;
    // Where nothing was pressed yet, the author's code reads 0.
    if (![x, y, fromX, fromY].some(Boolean)) return [0, 0, 0, 0];
    const at = [x * width - left, y * height - low];
    const from = [Math.max(fromX * width - left, 0), Math.max(fromY * height - low, 0)];
    return [...at, signX * from[0]!, signY * from[1]!];
  }

  /** A frame was drawn: the press is no news any more. Returns whether that changes the uniform. */
  settle(): boolean {
    const was = this.#fresh;
    this.#fresh = false;
    return was;
  }
}
