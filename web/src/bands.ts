/**
 * A picture drawn in bands of columns, so that no draw holds up the page or a driver's watchdog.
 *
 * Input: a program, inputs, what a pixel costs so far. Output: the picture in the program's target.
 */

import type { Painter } from "./painter";
import type { Linked } from "./program";
import type { Resolution } from "./resolution";
import type { Inputs } from "./uniforms";
import { gpuDone } from "./waiting";

/** The first bands measure what a pixel costs. */
const FIRST_COLUMNS = 2;
/** Programs that were drawn before. */
const DRAWN = new WeakSet<Linked>();

/** Whether the picture is whole; it is not where the context was lost, or nobody wants it. */
export async function drawBands(
  painter: Painter,
  program: Linked,
  inputs: Inputs,
  size: [number, number],
  samples: number,
  resolution: Resolution,
  isStale: () => boolean,
): Promise<boolean> {
  const [width, height] = size;
  for (let column = 0; column < width; ) {
    const isKnown = resolution.cost !== null;
    const fit = isKnown ? resolution.columns(height * samples) : FIRST_COLUMNS;
    const columns = Math.min(fit, width - column);
    painter.draw(program, inputs, size, column, columns);
    const ms = await gpuDone(painter.gl);
    if (ms === null || isStale()) return false;
    // What drivers put off until the first draw is not the cost of its pixels.
    if (DRAWN.has(program)) resolution.measure(ms, columns * height * samples);
    DRAWN.add(program);
    column += columns;
  }
  return true;
}
