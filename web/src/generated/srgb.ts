// Made by tools/gen_player.py from src/distal/lang/srgb.py: change that, and run it.

/** Linear light to sRGB's curve; nothing is darker than 0. */
export function encodeSrgb(c: number): number {
  let x = Math.max(c, 0);
  return ((x <= 0.0031308) ? (12.92 * x) : ((1.055 * (x ** (1 / 2.4))) - 0.055));
}

/** From sRGB's curve to linear light; the straight part goes on below 0. */
export function decodeSrgb(c: number): number {
  let curved = (((Math.max(c, 0) + 0.055) / 1.055) ** 2.4);
  return ((c > 0.04045) ? curved : (c / 12.92));
}
