/** Numbers in decimal digits, as `distal/lang/number_text.py` has them. Pure. */

/** The number with so many digits after the point. */
export function fixed(value: number, digits: number): number {
  return +value.toFixed(digits);
}

/** The number with so many digits in all. */
export function precise(value: number, digits: number): number {
  return +value.toPrecision(digits);
}

/** A number as a person reads it: six digits at most. */
export function shown(value: number): string {
  return String(precise(value, 6));
}
