/**
 * How a person moved the camera: five numbers.
 *
 * Pure. What the numbers do to the picture is scene code; how drags, keys and wheels change them is
 * generated from the definition that windows use too.
 */

import { dragged, notched, raised, turned, zoomed } from "./generated/interaction";

export interface Steering {
  yaw: number;
  pitch: number;
  zoom: number;
  pan: [number, number];
}

export class Camera {
  #state: Steering = identity();

  constructor(readonly elevation: number) {}

  get steering(): Steering {
    const { yaw, pitch, zoom, pan } = this.#state;
    return { yaw, pitch, zoom, pan: [...pan] };
  }

  get moved(): boolean {
    return JSON.stringify(this.#state) !== JSON.stringify(identity());
  }

  /** Takes the numbers given, leaves the others. Only a hand has bounds; zoom is above 0. */
  set(change: Partial<Steering>): void {
    const { yaw, pitch, zoom, pan } = { ...this.#state, ...change };
    if (![yaw, pitch, zoom, ...pan].every(Number.isFinite) || zoom <= 0) return;
    this.#state = { yaw, pitch, zoom, pan: [pan[0], pan[1]] };
  }

  reset(): void {
    this.#state = identity();
  }

  /** A drag of so many parts of the picture's height, right and down. */
  orbit(right: number, down: number): void {
    const { yaw, pitch } = this.#state;
    this.set({ yaw: turned(yaw, right), pitch: raised(pitch, down, this.elevation) });
  }

  /** The same drag moves the scene; pan counts half heights, up. */
  pan(right: number, down: number): void {
    const [x, y] = this.#state.pan;
    this.set({ pan: [dragged(x, right), dragged(y, -down)] });
  }

  /** Notches of a wheel: farther where positive. */
  wheel(notches: number): void {
    this.set({ zoom: notched(this.#state.zoom, notches) });
  }

  /** Above 1: away. */
  zoom(factor: number): void {
    this.set({ zoom: zoomed(this.#state.zoom, factor) });
  }
}

function identity(): Steering {
  return { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0] };
}
