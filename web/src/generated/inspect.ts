// Made by tools/gen_player.py from src/distal/render/ruler.py and scene/viewing/measuring.py: change that, and run it.

import { rounded } from "./interaction";

export const SIZE = "Ruler_size";
export const POINTER = "Ruler_pointer";
export const START = "Ruler_start";
export const END = "Ruler_end";
export const NORMAL = "Section_normal";
export const OFFSET = "Section_offset";
export const HATCH = "Section_hatch";
export const POINTS = 17;
export const UNSEEN = 1e+30;

export const KINDS = ["nothing", "surface", "edge", "corner"] as const;
export const PLACE_NUMBERS = ["x", "y", "z", "kind", "pixel"] as const;
export const RULER_NUMBERS = ["distance", "x", "y", "z"] as const;
export const CUT_AXES = ["x", "y", "z", "view"] as const;
export const CUT_NUMBERS = ["xNormalX", "xNormalY", "xNormalZ", "xLow", "xHigh", "yNormalX", "yNormalY", "yNormalZ", "yLow", "yHigh", "zNormalX", "zNormalY", "zNormalZ", "zLow", "zHigh", "viewNormalX", "viewNormalY", "viewNormalZ", "viewLow", "viewHigh", "diagonal"] as const;

/** Keys of pages to inspect, and the lines of their help. */
export const INSPECT_KEYS = {"x": "section", "X": "sectionSide", "d": "ruler"} as const;
export const INSPECT_HELP = [["X, shift X", "Cut open along x, y, z; the other side", "section"], ["D, then clicks", "Measure a distance (D, Esc: remove)", "ruler"]] as const;

export const CUT_STEP = 0.025;
export const CUT_LINES = 0.02;

/** Return the place of a plane at a share of the way along a box. */
export function cutPlace(low: number, high: number, share: number): number {
  return (low + (share * (high - low)));
}

/** Return the distance of the lines on cut faces, for the diagonal of a scene's box. */
export function cutLines(diagonal: number): number {
  return (CUT_LINES * diagonal);
}

/** Return a length rounded to about a hundredth of a pixel, as nobody points more exactly. */
export function measured(value: number, pixel: number): number {
  return rounded(value, (10 * pixel));
}
