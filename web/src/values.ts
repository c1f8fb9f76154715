/**
 * Parameters as numbers: the position of a slider for a value and back, ranges. Pure.
 */

import * as rules from "./generated/interaction";
import type { Parameter, Value } from "./payload";

export function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** The positions of a slider: it runs from 0 to this number. */
export function positionCount({ low, high, step }: Parameter): number {
  return rules.positionCount(low!, high!, step);
}

/** The position of a slider for a value. */
export function positionOf({ low, high, step, log }: Parameter, value: number): number {
  return rules.positionOf(value, low!, high!, step, log);
}

/** The value for a position of a slider. */
export function valueAt(parameter: Parameter, position: number): number {
  const { low, high, step, log, default: fallback } = parameter;
  return rules.valueAt(position, low!, high!, step, log, fallback as number);
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
