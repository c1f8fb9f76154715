/**
 * The poster of a page, as triangles: it stands before the player's script.
 *
 * Input: canvases with `data-triangles`, base64 of a file of `src/distal/triangles/`. Output: their
 * pictures, at the size at which they are seen. Where WebGL 2 is missing they stay empty.
 */

import { bytesOf } from "../payload";
import { draw } from "./drawing";
import { read } from "./reading";

/** A picture's pixel has at most so many of the screen's along a side. */
const MOST_SCALE = 4;

for (const canvas of document.querySelectorAll<HTMLCanvasElement>("canvas[data-triangles]")) {
  try {
    const found = read(bytesOf(canvas.dataset["triangles"]!));
    const seen = Math.min(canvas.clientWidth / found.width, canvas.clientHeight / found.height);
    const scale = Math.min(MOST_SCALE, Math.max(1, seen * (devicePixelRatio || 1)));
    draw(canvas, found, scale);
    canvas.removeAttribute("data-triangles");
  } catch (error) {
    console.warn(`The still picture cannot be drawn: ${(error as Error).message}`);
  }
}
