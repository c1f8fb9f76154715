/**
 * What a hand does to the camera, or to the mouse that a picture reads: drags, wheels, arrow keys.
 *
 * Input: movements in picture heights, places in parts of the picture. Output: the camera's or the
 * mouse's new state; `changed` is called then. It knows neither events nor elements.
 */

import type { Camera } from "./camera";
import type { Clock } from "./clock";
import { ARROW, FRAMES_PER_S, STEP_S } from "./generated/interaction";
import type { Hand } from "./gestures";
import type { GuideAction } from "./guide";
import type { Actions } from "./keyboard";
import type { Mouse } from "./mouse";

export class Hands implements Hand {
  constructor(
    readonly camera: Camera | null,
    readonly mouse: Mouse,
    readonly readsMouse: () => boolean,
    readonly changed: () => void,
  ) {}

  drag(right: number, down: number, pan: boolean): void {
    if (!this.camera) return;
    if (pan) this.camera.pan(right, down);
    else this.camera.orbit(right, down);
    this.changed();
  }

  pinch(factor: number): void {
    this.camera?.zoom(factor);
    if (this.camera) this.changed();
  }

  wheel(notches: number): boolean {
    this.camera?.wheel(notches);
    if (this.camera) this.changed();
    return !!this.camera;
  }

  press(x: number, y: number): void {
    this.#point(() => this.mouse.press(x, y));
  }

  move(x: number, y: number): void {
    this.#point(() => this.mouse.move(x, y));
  }

  release(): void {
    this.#point(() => this.mouse.release());
  }

  /** An arrow key, right and up: where the eye goes, and the hand would drag the other way. */
  arrow(right: number, up: number, pan: boolean): boolean {
    if (this.camera) this.drag(-right * ARROW, up * ARROW, pan);
    else if (this.readsMouse()) this.#point(() => this.mouse.nudge(right * ARROW, up * ARROW));
    else return false;
    return true;
  }

  /** Two clicks on a picture that reads the mouse are two clicks. */
  doubleClick(): void {
    if (this.camera) this.reset();
  }

  /** Shows the whole scene; false where there is no camera to do it with. */
  show(action: GuideAction): boolean {
    void this.camera?.show(action);
    return !!this.camera;
  }

  reset(): boolean {
    this.camera?.reset();
    this.mouse.reset();
    this.changed();
    return !!this.camera || this.readsMouse();
  }

  #point(act: () => void): void {
    if (!this.readsMouse()) return;
    act();
    this.changed();
  }
}

type Moves = Omit<
  Actions,
  | ("pause" | "nextView" | "lastView" | "fullScreen" | "screenshot" | "parameters" | "help")
  | ("copyCamera" | "mode")
>;

/** What keys do to the camera and the time; `timed` and `sped` are called after the clock changed. */
export function movesOf(
  hands: Hands,
  clock: Clock,
  isAnimated: boolean,
  timed: () => void,
  sped: () => void,
): Moves {
  const step = (seconds: number) => () => {
    if (isAnimated) clock.jump(clock.time + seconds), timed();
    return isAnimated;
  };
  const pace = (steps: number) => () => {
    if (isAnimated) clock.changeSpeed(steps), sped();
    return isAnimated;
  };
  return {
    left: (shift) => hands.arrow(-1, 0, shift),
    right: (shift) => hands.arrow(1, 0, shift),
    up: (shift) => hands.arrow(0, 1, shift),
    down: (shift) => hands.arrow(0, -1, shift),
    nearer: () => hands.wheel(-1),
    farther: () => hands.wheel(1),
    resetCamera: () => hands.reset(),
    frame: () => hands.show("frame"),
    front: () => hands.show("front"),
    backSide: () => hands.show("back"),
    rightSide: () => hands.show("right"),
    leftSide: () => hands.show("left"),
    top: () => hands.show("top"),
    bottom: () => hands.show("bottom"),
    back: step(-STEP_S),
    forth: step(STEP_S),
    frameBack: step(-1 / FRAMES_PER_S),
    frameForth: step(1 / FRAMES_PER_S),
    begin: () => {
      if (isAnimated) clock.set(clock.start), timed();
      return isAnimated;
    },
    slower: pace(-1),
    faster: pace(1),
  };
}
