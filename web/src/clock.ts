/**
 * The scene's time: plays, pauses, jumps, loops.
 *
 * Pure: the host says how many seconds went by. Does not depend on frames or sliders.
 */

import * as rules from "./generated/interaction";

/** A tab that was away, or one slow frame, must not make the scene leap. */
const LONGEST_STEP_S = 0.25;

export class Clock {
  time: number;
  playing = false;
  speed = 1;

  constructor(
    public start: number,
    public duration: number | null,
  ) {
    this.time = start;
  }

  /** What the scene reads as its frame number. */
  get index(): number {
    return rules.indexAt(this.time);
  }

  /** Goes on by what passed on the wall, in seconds. */
  advance(seconds: number): void {
    const step = Math.min(Math.max(seconds, 0), LONGEST_STEP_S) * this.speed;
    this.time = rules.advanced(this.time, step, this.start, this.duration);
  }

  /** Jumps. */
  set(time: number): void {
    if (Number.isFinite(time)) this.time = time;
  }

  /** Jumps as far as a hand may. */
  jump(time: number): void {
    this.set(rules.jumped(time, this.start, this.duration));
  }

  /** Faster or slower by so many of the offered speeds. */
  changeSpeed(steps: number): void {
    this.speed = rules.speedAfter(this.speed, steps);
  }

  /** The ends of the slider: the loop, or the seconds from the start that hold the time. */
  range(): [number, number] {
    const { start, duration } = this;
    return [rules.firstTime(start, duration), rules.lastTime(this.time, start, duration)];
  }
}
