/**
 * Colors of a picker: sRGB "#rrggbb" (IEC 61966-2-1) to and from linear light.
 *
 * Pure. This is the picker's own encoding and no formula of the scene.
 */

/** Linear red, green, blue as the nearest "#rrggbb". */
export function hexOf(linear: readonly number[]): string {
  const bytes = linear.map((light) => {
    const l = Math.min(Math.max(light, 0), 1);
    const encoded = l <= 0.0031308 ? 12.92 * l : 1.055 * l ** (1 / 2.4) - 0.055;
    return Math.round(255 * encoded)
      .toString(16)
      .padStart(2, "0");
  });
  return `#${bytes.join("")}`;
}

/** "#rrggbb", "rrggbb" or "#rgb" as linear red, green, blue; null for any other text. */
export function linearOf(text: string): number[] | null {
  const short = text.trim().replace(/^#?/, "");
  const hex = short.length === 3 ? short.replace(/./g, "$&$&") : short;
  if (!/^[0-9a-f]{6}$/i.test(hex)) return null;
  return [0, 2, 4].map((at) => {
    const encoded = parseInt(hex.slice(at, at + 2), 16) / 255;
    return encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
  });
}
