/**
 * How a person moved the camera: five numbers, and how drags, keys and wheels change them.
 *
 * Pure. What the numbers do to the picture is scene code; here are only the hand's habits: a drag
 * of the picture's height is half a turn, the scene follows the hand.
 */

import { clamp } from "./values";

export interface Steering {
  yaw: number;
  pitch: number;
  zoom: number;
  pan: [number, number];
}

/** The camera never stands straight above its target, where "up" has no meaning. */
const HIGHEST = Math.PI / 2 - 0.02;
const NEAREST = 0.02;
const FARTHEST = 50;

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

  /** Takes the numbers given, leaves the others. */
  set(change: Partial<Steering>): void {
    const { yaw, pitch, zoom, pan } = { ...this.#state, ...change };
    if (![yaw, pitch, zoom, ...pan].every(Number.isFinite)) return;
    this.#state = {
      yaw,
      pitch: this.#level(pitch),
      zoom: clamp(zoom, NEAREST, FARTHEST),
      pan: [pan[0], pan[1]],
    };
  }

  reset(): void {
    this.#state = identity();
  }

  /** A drag of so many parts of the picture's height, right and down: the eye goes against it. */
  orbit(right: number, down: number): void {
    const { yaw, pitch } = this.#state;
    this.set({ yaw: yaw - Math.PI * right, pitch: pitch + Math.PI * down });
  }

  /** The same drag moves the scene; pan counts half heights, up. */
  pan(right: number, down: number): void {
    const [x, y] = this.#state.pan;
    this.set({ pan: [x + 2 * right, y - 2 * down] });
  }

  /** Above 1: away. */
  zoom(factor: number): void {
    this.set({ zoom: this.#state.zoom * factor });
  }

  #level(pitch: number): number {
    // An author's camera may itself stand beyond the bound: it may stay, and only come back.
    const low = Math.min(-HIGHEST - this.elevation, 0);
    const high = Math.max(HIGHEST - this.elevation, 0);
    return clamp(pitch, low, high);
  }
}

function identity(): Steering {
  return { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0] };
}
