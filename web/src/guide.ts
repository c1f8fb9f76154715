/**
 * Asks the scene's guide where a camera may go: a small program of the GPU, and its answer as numbers.
 *
 * Input: the camera's numbers, those that a gesture asks for, what the scene reads. Output: the numbers
 * that the camera gets, and where it then is. The rules are scene code; here are only their bytes.
 */

import type { Steering } from "./camera";
import { ACTION, ACTIONS, GOAL_PREFIX, NUMBERS, PREFIX, SIZE } from "./generated/guide";
import type { Given } from "./uniforms";

export type GuideAction = (typeof ACTIONS)[number];
type Name = (typeof NUMBERS)[number];

/** What the guide gives. */
export type Guided = Record<Name, number>;

/** Pixels of the guide's picture: a number each. */
export const GUIDE_PIXELS = NUMBERS.length;

/** The numbers that a program of a steered camera reads. */
export function numbersOf(steering: Steering, prefix = PREFIX): Record<string, number | number[]> {
  const { yaw, pitch, zoom, pan } = steering;
  return {
    [`${prefix}yaw`]: yaw,
    [`${prefix}pitch`]: pitch,
    [`${prefix}zoom`]: zoom,
    [`${prefix}pan`]: pan,
  };
}

/** What the guide reads besides frame and parameters. */
export function question(
  action: GuideAction,
  now: Steering,
  goal: Steering,
  size: [number, number],
): Given {
  return {
    ...numbersOf(now),
    ...numbersOf(goal, GOAL_PREFIX),
    [ACTION]: ACTIONS.indexOf(action),
    [SIZE]: size,
  };
}

/** The numbers in the guide's pixels; null if a driver gave something else. */
export function answer(bytes: Uint8Array): Guided | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const numbers = NUMBERS.map((_, i) => view.getFloat32(4 * i, true));
  if (!numbers.every(Number.isFinite)) return null;
  const found = Object.fromEntries(NUMBERS.map((name, i) => [name, numbers[i]])) as Guided;
  return found.zoom > 0 ? found : null;
}

/** The camera's five numbers in an answer. */
export function steeringOf({ yaw, pitch, zoom, panX, panY }: Guided): Steering {
  return { yaw, pitch, zoom, pan: [panX, panY] };
}
