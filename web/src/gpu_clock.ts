/**
 * The time of drawings on the GPU: by the GPU's own clock where the browser shows it, else by waiting
 * for a pixel. Draws aside: neither the picture that is shown nor the one under way is touched.
 */

import type { Painter } from "./painter";
import type { Linked } from "./program";
import type { Inputs } from "./uniforms";
import { pause } from "./waiting";

const NS_IN_MS = 1e6;

interface GpuTimer {
  TIME_ELAPSED_EXT: number;
  GPU_DISJOINT_EXT: number;
}

/** The milliseconds of some drawings of a program; null where the GPU went away. */
export async function gpuMs(
  painter: Painter,
  program: Linked,
  inputs: Inputs,
  size: [number, number],
  draws: number,
): Promise<number | null> {
  const { gl } = painter;
  const timer = gl.getExtension("EXT_disjoint_timer_query_webgl2") as GpuTimer | null;
  const drawAll = () => {
    for (let i = 0; i < draws; i++) painter.aside(program, inputs, size);
  };
  return timer ? byQuery(gl, timer, drawAll) : byPixel(gl, drawAll);
}

/** The GPU's clock; once more where something else disturbed it. */
async function byQuery(gl: WebGL2RenderingContext, timer: GpuTimer, draw: () => void): Promise<number | null> {
  for (;;) {
    gl.getParameter(timer.GPU_DISJOINT_EXT);
    const query = gl.createQuery()!;
    gl.beginQuery(timer.TIME_ELAPSED_EXT, query);
    draw();
    gl.endQuery(timer.TIME_ELAPSED_EXT);
    gl.flush();
    do {
      await pause(0);
      if (gl.isContextLost()) return null;
    } while (!gl.getQueryParameter(query, gl.QUERY_RESULT_AVAILABLE));
    const ns = gl.getQueryParameter(query, gl.QUERY_RESULT) as number;
    gl.deleteQuery(query);
    if (!gl.getParameter(timer.GPU_DISJOINT_EXT)) return ns / NS_IN_MS;
  }
}

/** To read a pixel waits for all drawings, and no timer of the page is as fine. */
function byPixel(gl: WebGL2RenderingContext, draw: () => void): number | null {
  const pixel = new Uint8Array(4);
  const begin = performance.now();
  draw();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  return gl.isContextLost() ? null : performance.now() - begin;
}
