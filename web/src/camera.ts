/**
 * How a person moved the camera: five numbers.
 *
 * Pure. What the numbers do to the picture, and where solids stop them, is scene code; how drags, keys
 * and wheels change them is generated from the definition that windows use too.
 */

import { dragged, notched, raised, turned, zoomed } from "./generated/interaction";
import { steeringOf, type GuideAction, type Guided } from "./guide";

export interface Steering {
  yaw: number;
  pitch: number;
  zoom: number;
  pan: [number, number];
}

/** Where a camera gets that wants to go somewhere; null if nothing is known: then it moves freely. */
export type Ask = (action: GuideAction, now: Steering, goal: Steering) => Promise<Guided | null>;

export class Camera {
  /** Keeps the camera out of solids; without it, the camera moves freely. */
  ask: Ask | null = null;
  /** Called after an answer has moved the camera. */
  onMoved: () => void = () => {};
  #state: Steering = identity();
  /** Where gestures have asked the camera to go; null once it has got as far as it can. */
  #goal: Steering | null = null;
  #asking: Promise<void> | null = null;

  constructor(public elevation: number) {}

  get steering(): Steering {
    return copied(this.#state);
  }

  get moved(): boolean {
    return JSON.stringify(this.#state) !== JSON.stringify(identity());
  }

  /** Takes the numbers given, leaves the others. Only a hand has bounds; zoom is above 0. */
  set(change: Partial<Steering>): void {
    const { yaw, pitch, zoom, pan } = { ...this.#state, ...change };
    if (![yaw, pitch, zoom, ...pan].every(Number.isFinite) || zoom <= 0) return;
    this.#goal = null;
    this.#state = { yaw, pitch, zoom, pan: [pan[0], pan[1]] };
  }

  reset(): void {
    this.set(identity());
  }

  /** A drag of so many parts of the picture's height, right and down. */
  orbit(right: number, down: number): void {
    const { yaw, pitch } = this.#aim;
    this.#go({ yaw: turned(yaw, right), pitch: raised(pitch, down, this.elevation) });
  }

  /** The same drag moves the scene; pan counts half heights, up. */
  pan(right: number, down: number): void {
    const [x, y] = this.#aim.pan;
    this.#go({ pan: [dragged(x, right), dragged(y, -down)] });
  }

  /** Notches of a wheel: farther where positive. */
  wheel(notches: number): void {
    this.#go({ zoom: notched(this.#aim.zoom, notches) });
  }

  /** Above 1: away. */
  zoom(factor: number): void {
    this.#go({ zoom: zoomed(this.#aim.zoom, factor) });
  }

  /** Shows the whole scene, from where the camera is or from an axis; without a guide, nothing. */
  async show(action: GuideAction): Promise<void> {
    await this.rest();
    const now = this.#state;
    const found = await this.ask?.(action, now, now).catch(() => null);
    if (!found || this.#state !== now) return;
    this.set(steeringOf(found));
    this.onMoved();
  }

  /** Where the camera is; null where that is not known. */
  async place(): Promise<Guided | null> {
    await this.rest();
    return this.here();
  }

  /** The same at once, even on the way to a goal. */
  async here(): Promise<Guided | null> {
    const found = await this.ask?.("go", this.#state, this.#state).catch(() => null);
    return found ?? null;
  }

  /** Resolves when the camera has got where gestures asked it to go. */
  async rest(): Promise<void> {
    while (this.#asking) await this.#asking;
  }

  get #aim(): Steering {
    return this.#goal ?? this.#state;
  }

  #go(change: Partial<Steering>): void {
    const goal = copied({ ...this.#aim, ...change });
    if (!this.ask) return this.set(goal);
    this.#goal = goal;
    this.#asking ??= this.#follow().finally(() => (this.#asking = null));
  }

  /** Goes to the newest goal, until there is none. */
  async #follow(): Promise<void> {
    while (this.#goal) {
      const goal = this.#goal;
      const now = this.#state;
      const found = await this.ask!("go", now, goal).catch(() => null);
      // Meanwhile a program or a key may have put the camera elsewhere.
      if (this.#state !== now) continue;
      this.#state = found && !found.arrived ? steeringOf(found) : goal;
      // What was in the way is not asked for again; what a hand did since then is.
      if (this.#goal === goal) this.#goal = null;
      this.onMoved();
    }
  }
}

function identity(): Steering {
  return { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0] };
}

function copied({ yaw, pitch, zoom, pan }: Steering): Steering {
  return { yaw, pitch, zoom, pan: [...pan] };
}
