/**
 * Colors of a picker: "#rrggbb" to and from linear light.
 *
 * Pure. The curve is generated from its definition in Python.
 */

import { decodeSrgb, encodeSrgb } from "./generated/srgb";

/** Linear red, green, blue as the nearest "#rrggbb". */
export function hexOf(linear: readonly number[]): string {
  const bytes = linear.map((light) => {
    const code = Math.floor(Math.min(255 * encodeSrgb(light), 255) + 0.5);
    return code.toString(16).padStart(2, "0");
  });
  return `#${bytes.join("")}`;
}

/** "#rrggbb", "rrggbb" or "#rgb" as linear red, green, blue; null for any other text. */
export function linearOf(text: string): number[] | null {
  const short = text.trim().replace(/^#?/, "");
  const hex = short.length === 3 ? short.replace(/./g, "$&$&") : short;
  if (!/^[0-9a-f]{6}$/i.test(hex)) return null;
  return [0, 2, 4].map((at) => decodeSrgb(parseInt(hex.slice(at, at + 2), 16) / 255));
}
