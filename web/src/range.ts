/**
 * The range of a view's values, measured by a small picture of packed values.
 *
 * Pure. In: the bytes of the picture. Out: the numbers of the range. `distal/scene/view_ranges.py` does
 * the same for stills.
 */

import {
  FEWEST_VALUES,
  PROBE_HEIGHT,
  PROBE_WIDTH,
  highest,
  lowest,
  median,
  unpacked,
} from "./generated/packed_values";
import type { Program } from "./payload";
import type { Given } from "./uniforms";

export const PROBE: [number, number] = [PROBE_WIDTH, PROBE_HEIGHT];
/** What asks a program for packed values. */
export const PACKED: Given = { View_low: 1, View_middle: 0, View_high: -1 };

export function hasRange({ uniforms }: Program): boolean {
  return uniforms.some(({ name, origin }) => origin === "number" && name === "View_low");
}

/** The numbers of the range; none where there are too few values. */
export function rangeOf(bytes: Uint8Array): Given {
  const values: number[] = [];
  for (let i = 0; i < bytes.length; i += 4) {
    const [red, green, blue] = bytes.subarray(i, i + 3) as unknown as [number, number, number];
    if (red || green || blue) values.push(unpacked(red, green, blue));
  }
  if (values.length < FEWEST_VALUES) return {};
  values.sort((a, b) => a - b);
  return { View_low: lowest(values), View_middle: median(values), View_high: highest(values) };
}
