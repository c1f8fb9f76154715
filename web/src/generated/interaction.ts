// Made by tools/gen_player.py from src/distal/scene/viewing/interaction.py: change that, and run it.

import { fixed, precise } from "../numbers";

export const TURN_PER_HEIGHT = Math.PI;
export const HIGHEST = ((Math.PI / 2) - 0.02);
export const PAN_PER_HEIGHT = 2;
export const FARTHEST_PAN = 1000;
export const NEAREST = 0.015625;
export const FARTHEST = 64;
export const ZOOM_PER_NOTCH = 1.15;
export const MOST_NOTCHES = 10;
export const NOTCHES_PER_UNIT = [0.01, (1 / 3), 4];
export const NOTCHES_PER_PINCH = 7;
export const ARROW = (1 / 24);
export const LATEST_S = 1048576;
export const FIRST_SPAN_S = 10;
export const STEP_S = 0.25;
export const FRAMES_PER_S = 60;
export const SPEEDS = [0.0625, 0.125, 0.25, 0.5, 1, 2, 4, 8, 16];
export const POSITIONS = 200;
export const POINT_STEP = 0.05;

/** Return the nearest number within a range. */
export function clamped(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** Return the nearest whole number; halves are rounded up. */
export function whole(value: number): number {
  return Math.floor((value + 0.5));
}

/** Return the yaw after a drag to the right: the eye moves in the opposite direction. */
export function turned(yaw: number, right: number): number {
  let moved = (yaw - (TURN_PER_HEIGHT * right));
  let full = (2 * Math.PI);
  return (moved - (full * whole((moved / full))));
}

/** Return the pitch after a drag downwards. */
export function raised(pitch: number, down: number, elevation: number): number {
  let low = Math.min(((-HIGHEST) - elevation), 0);
  let high = Math.max((HIGHEST - elevation), 0);
  return clamped((pitch + (TURN_PER_HEIGHT * down)), low, high);
}

/** Return one component of pan after a drag along its axis. */
export function dragged(pan: number, way: number): number {
  return clamped((pan + (PAN_PER_HEIGHT * way)), (-FARTHEST_PAN), FARTHEST_PAN);
}

/** Return the zoom multiplied by a factor. */
export function zoomed(zoom: number, factor: number): number {
  return clamped((zoom * factor), NEAREST, FARTHEST);
}

/** Return the zoom after a number of wheel notches; a positive number moves the camera away. */
export function notched(zoom: number, notches: number): number {
  return zoomed(zoom, (ZOOM_PER_NOTCH ** clamped(notches, (-MOST_NOTCHES), MOST_NOTCHES)));
}

/** Return the notches of a wheel event whose unit is pixels (0), lines (1) or pages (2). */
export function notchesOf(delta: number, unit: number, isPinch: boolean): number {
  return ((delta * NOTCHES_PER_UNIT[unit]!) * (isPinch ? NOTCHES_PER_PINCH : 1));
}

/** Return the time after `passed` seconds. */
export function advanced(time: number, passed: number, start: number, duration: number | null): number {
  if ((duration === null)) {
    return Math.min((time + passed), Math.max(time, LATEST_S));
  }
  let past = ((time + passed) - start);
  return (start + (past - (duration * Math.floor((past / duration)))));
}

/** Return the earliest time that a person can choose: the smaller of 0 and `start`. */
export function firstTime(start: number, duration: number | null): number {
  return ((duration === null) ? Math.min(start, 0) : start);
}

/** Return the right end of the timeline: ten seconds, doubled until the time is within it. */
export function lastTime(time: number, start: number, duration: number | null): number {
  if ((duration !== null)) {
    return (start + duration);
  }
  let low = firstTime(start, duration);
  let span = FIRST_SPAN_S;
  while (((low + span) < time)) {
    span = (2 * span);
  }
  return (low + span);
}

/** Return the nearest time that a person can choose. */
export function jumped(time: number, start: number, duration: number | null): number {
  let high = ((duration === null) ? LATEST_S : (start + duration));
  return clamped(time, firstTime(start, duration), high);
}

/** Return the frame number of a time, so that a paused frame can be reproduced. */
export function indexAt(time: number): number {
  return whole((time * FRAMES_PER_S));
}

/** Return the speed some steps up or down in the list of speeds. */
export function speedAfter(speed: number, steps: number): number {
  let at = 0;
  for (let i = 0; i < SPEEDS.length; i++) {
    if ((SPEEDS[i]! <= speed)) {
      at = i;
    }
  }
  return SPEEDS[(clamped((at + steps), 0, (SPEEDS.length - 1)))]!;
}

/** Return the number of the last position of a slider, which starts at 0. */
export function positionCount(low: number, high: number, step: number | null): number {
  return ((step === null) ? POSITIONS : (Math.ceil((((high - low) / step) - 1e-06))));
}

/** Return the position of a slider for a value. */
export function positionOf(value: number, low: number, high: number, step: number | null, log: boolean): number {
  let count = positionCount(low, high, step);
  let inside = clamped(value, low, high);
  if ((inside === high)) {
    return count;
  }
  if (log) {
    return ((Math.log((inside / low)) / Math.log((high / low))) * count);
  }
  return ((inside - low) / ((step === null) ? ((high - low) / count) : step));
}

/** Return the value at a position of a slider; the ends are exactly those of the range. */
export function valueAt(position: number, low: number, high: number, step: number | null, log: boolean, usual: number): number {
  let count = positionCount(low, high, step);
  if ((position <= 0)) {
    return low;
  }
  if ((position >= count)) {
    return high;
  }
  if (((step === null) && (whole(position) === whole(positionOf(usual, low, high, step, log))))) {
    return usual;
  }
  if (log) {
    let exact = (low * ((high / low) ** (position / count)));
    if ((step === null)) {
      return clamped(precise(exact, 3), low, high);
    }
    return clamped(rounded((low + (whole(((exact - low) / step)) * step)), step), low, high);
  }
  let unit = ((step === null) ? ((high - low) / count) : step);
  return clamped(rounded((low + (whole(position) * unit)), unit), low, high);
}

/** Round away the digits far below `unit`: 0.1 + 0.2 becomes 0.3. */
export function rounded(value: number, unit: number): number {
  return fixed(value, (clamped((3 - Math.floor(Math.log10(unit))), 0, 20)));
}
