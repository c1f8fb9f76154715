/**
 * Where the author's frame lies on a canvas that may be larger, have another shape, or be covered in
 * part.
 *
 * Pure. The picture fills the canvas; the frame is the part that the author's camera or image was
 * made for. It lies in the middle of what nothing covers. A canvas that is narrower than the author's
 * keeps the author's width and shows more above and below; a wider one keeps the height.
 */

/** How much of each side is covered, in parts of the canvas. */
export interface Covered {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

export const NOTHING_COVERED: Covered = { left: 0, right: 0, top: 0, bottom: 0 };

/** No panel may leave less of the canvas than this, in parts of a side. */
const LEAST = 0.25;

/** The frame's size and its lower left corner, in pixels, on a canvas of so many. */
export function frameOn(
  width: number,
  height: number,
  { left, right, top, bottom }: Covered,
  aspect: number,
): { size: [number, number]; offset: [number, number] } {
  // Whole pixels: the picture is then the same, pixel by pixel, as one of the frame's size.
  const wide = Math.max(Math.round(width * Math.max(1 - left - right, LEAST)), 1);
  const high = height * Math.max(1 - top - bottom, LEAST);
  const kept = Math.max(Math.round(Math.min(high, wide / aspect)), 1);
  const low = Math.round(height * bottom + (high - kept) / 2);
  return { size: [wide, kept], offset: [Math.round(width * left), low] };
}
