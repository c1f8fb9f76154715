/**
 * How many pixels a moving picture can afford, and how a big still is cut.
 *
 * Pure. In: what the GPU took for how many pixels. Out: a scale of the canvas's sides, columns of
 * a band. One number is learned: milliseconds per pixel.
 */

/** Scales, and what a moving frame may take at each: a coarse picture is worse than a slow one. */
const STAIRS: readonly (readonly [scale: number, budget_ms: number])[] = [
  [1, 15],
  [0.75, 15],
  [0.5, 20],
  [0.35, 30],
  [0.25, 50],
  [0.18, 70],
  [0.125, Infinity],
];

/** One submission should end well before a driver's watchdog (2 s) and let the page breathe. */
export const BAND_MS = 40;
/** The first draw of a program: nobody knows yet what a pixel costs. */
export const PROBE_PIXELS = 3072;

export class Resolution {
  /** Milliseconds per pixel; null until something was measured. */
  cost: number | null = null;
  /** Milliseconds that asking and answering take, whatever is drawn. */
  floor = 1.5;
  #scale = 1;

  /** Learns from a draw. */
  measure(ms: number, pixels: number): void {
    // Without the way to the GPU and back small draws would look dear.
    const now = Math.max(ms - this.floor, 0.05) / pixels;
    const known = this.cost;
    this.cost = known === null ? now : known + (now - known) * (now > known ? 0.5 : 0.25);
  }

  forget(): void {
    this.cost = null;
    this.#scale = 1;
  }

  /** The scale for a moving picture on a canvas of so many pixels. */
  moving(pixels: number): number {
    const cost = this.cost ?? 0;
    const fits = ([scale, budget]: readonly [number, number]) => {
      // Up only with a margin, else two scales alternate.
      const room = scale > this.#scale ? 0.7 : 1;
      return cost * pixels * scale * scale <= budget * room;
    };
    this.#scale = STAIRS.find(fits)![0];
    return this.#scale;
  }

  /**
   * Columns of so many pixels that fit one submission; `Infinity` where all do. An even number: GPUs
   * shade squares of 2 x 2 pixels, so a band of one column takes as long as one of two. Columns, not
   * rows: SwiftShader shares out pairs of rows among the cores.
   */
  columns(height: number): number {
    return 2 * Math.max(1, Math.floor(BAND_MS / (2 * (this.cost ?? 0) * height)));
  }
}
