/**
 * The scene's time: plays, pauses, jumps, loops.
 *
 * Pure: the host tells how many seconds went by. It knows neither a frame nor a slider.
 */

/** An endless clock is scrubbed within windows of this many seconds. */
export const WINDOW_S = 10;
/** A tab that was away, or one slow frame, must not make the scene leap. */
const LONGEST_STEP_S = 0.25;

export const SPEEDS = [0.25, 0.5, 1, 2, 4];

export class Clock {
  time: number;
  playing = false;
  speed = 1;
  /** Frames since it was set: what the scene reads as its frame number. */
  index = 0;

  constructor(
    readonly start: number,
    readonly duration: number | null,
  ) {
    this.time = start;
  }

  /** Goes on by what passed on the wall, in seconds. */
  advance(seconds: number): void {
    const step = Math.min(Math.max(seconds, 0), LONGEST_STEP_S) * this.speed;
    this.time = this.#looped(this.time + step);
    this.index += 1;
  }

  /** Jumps. */
  set(time: number): void {
    if (!Number.isFinite(time)) return;
    this.time = time;
    this.index = 0;
  }

  /** The ends of the slider: the loop, or the window around the time. */
  range(): [number, number] {
    if (this.duration) return [this.start, this.start + this.duration];
    const window = Math.floor((this.time - this.start) / WINDOW_S);
    const low = this.start + window * WINDOW_S;
    return [low, low + WINDOW_S];
  }

  #looped(time: number): number {
    const length = this.duration;
    if (!length) return time;
    const past = (time - this.start) % length;
    return this.start + (past < 0 ? past + length : past);
  }
}
