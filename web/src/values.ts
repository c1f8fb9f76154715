/**
 * Parameters as numbers: where a slider stands for a value and back, ranges, texts.
 *
 * Pure. A continuous slider has `POSITIONS` positions: about as many as a hand can tell apart.
 */

import type { Parameter, Value } from "./payload";

export const POSITIONS = 200;

export function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** The positions of a slider: it runs from 0 to this number. */
export function positionCount({ low, high, step }: Parameter): number {
  // A step that does not divide the range leaves a last, shorter one, so that `high` is reached.
  return step ? Math.ceil((high! - low!) / step - 1e-6) : POSITIONS;
}

/** Where a slider stands for a value. */
export function positionOf(parameter: Parameter, value: number): number {
  const { step, log } = parameter;
  const low = parameter.low!;
  const high = parameter.high!;
  const count = positionCount(parameter);
  const inside = clamp(value, low, high);
  if (log) return (Math.log(inside / low) / Math.log(high / low)) * count;
  return inside === high ? count : (inside - low) / (step ?? (high - low) / count);
}

/** The value for which a slider stands; the ends are `low` and `high` to the last bit. */
export function valueAt(parameter: Parameter, position: number): number {
  const { step, log } = parameter;
  const low = parameter.low!;
  const high = parameter.high!;
  const count = positionCount(parameter);
  if (position <= 0) return low;
  if (position >= count) return high;
  if (log) {
    const exact = low * (high / low) ** (position / count);
    const value = step ? low + Math.round((exact - low) / step) * step : +exact.toPrecision(3);
    return clamp(rounded(value, step ?? value / 100), low, high);
  }
  const unit = step ?? (high - low) / count;
  return clamp(rounded(low + Math.round(position) * unit, unit), low, high);
}

/** A number without the digits far below `unit`: 0.1 + 0.2 is 0.3. */
function rounded(value: number, unit: number): number {
  const digits = clamp(3 - Math.floor(Math.log10(unit)), 0, 20);
  return +value.toFixed(digits);
}

/** A value that the parameter may have, or null where it cannot be made one. */
export function checked(parameter: Parameter, value: unknown): Value | null {
  const { kind, default: fallback, options } = parameter;
  if (kind === "toggle") return typeof value === "boolean" ? value : null;
  if (kind === "color" || kind === "point") {
    const size = (fallback as number[]).length;
    if (!Array.isArray(value) || value.length !== size || !value.every(Number.isFinite)) return null;
    return kind === "color" ? value.map((v: number) => clamp(v, 0, 1)) : value.slice();
  }
  if (typeof value !== "number" || !Number.isFinite(value)) return null;
  if (kind === "choice") return clamp(Math.round(value), 0, options.length - 1);
  const inside = clamp(value, parameter.low!, parameter.high!);
  return kind === "integer" ? Math.round(inside) : inside;
}

export function same(a: Value | undefined, b: Value | undefined): boolean {
  return String(a) === String(b);
}

/** A number as a person reads it: six digits at most. */
export function shown(value: number): string {
  return String(+value.toPrecision(6));
}
