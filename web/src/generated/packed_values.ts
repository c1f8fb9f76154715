// Made by tools/gen_player.py from src/distal/scene/packed_values.py: change that, and run it.

export const PROBE_WIDTH = 64;
export const PROBE_HEIGHT = 48;
export const FEWEST_VALUES = 8;
export const LOW_SHARE = 0.02;
export const HIGH_SHARE = 0.98;

/** Return the value that `render.ranges.packed` shows as a color of three bytes. */
export function unpacked(red: number, green: number, blue: number): number {
  let part = (((((65536 * red) + (256 * green)) + blue) - 8388608) / 8388607);
  let size = ((((2 ** (48 * Math.max(part, (-part))))) - 1) / 65536);
  return ((part > 0) ? size : (-size));
}

/** Return the index of a percentile in sorted values. */
export function rank(count: number, share: number): number {
  return Math.floor(((share * (count - 1)) + 0.5));
}

/** Return how much the range of sorted values must grow at both ends so that it is not empty. */
export function widening(values: readonly number[]): number {
  let low = values[rank(values.length, LOW_SHARE)]!;
  let high = values[rank(values.length, HIGH_SHARE)]!;
  return Math.max(0, ((0.0005 + (0.005 * Math.max(high, (-low)))) - (high - low)));
}

/** Return the low end of the range of sorted values. */
export function lowest(values: readonly number[]): number {
  return (values[rank(values.length, LOW_SHARE)]! - widening(values));
}

/** Return the high end of the range of sorted values. */
export function highest(values: readonly number[]): number {
  return (values[rank(values.length, HIGH_SHARE)]! + widening(values));
}

/** Return the value for the middle of the scale: the median of sorted values. */
export function median(values: readonly number[]): number {
  let low = lowest(values);
  let high = highest(values);
  let middle = values[rank(values.length, 0.5)]!;
  let half = (0.5 * (low + high));
  if (((low <= 0) || (high < (8 * low)) || (middle < half))) {
    return middle;
  }
  let count = 0;
  for (let i = 0; i < values.length; i++) {
    if ((values[i]! < half)) {
      count = (count + 1);
    }
  }
  return ((count >= FEWEST_VALUES) ? values[rank(count, 0.5)]! : middle);
}
