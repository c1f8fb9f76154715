/** Promises of time: a frame, a pause, the GPU being done. Knows nothing of scenes. */

export function nextFrame(): Promise<number> {
  return new Promise((resolve) => requestAnimationFrame(resolve));
}

/** The next frame, or soon after: browsers delay frames of pages that nobody seems to look at. */
export function soonFrame(): Promise<number> {
  return Promise.race([nextFrame(), pause(30).then(() => performance.now())]);
}

export function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** Milliseconds until the GPU has finished all submitted work; null where it was lost. */
export async function gpuDone(gl: WebGL2RenderingContext): Promise<number | null> {
  const begin = performance.now();
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  if (!fence) return null;
  // A blocking wait would freeze the page: poll, at growing intervals.
  for (let round = 0; ; round++) {
    await pause(round < 8 ? 0 : 4);
    if (gl.isContextLost()) return null;
    const status = gl.clientWaitSync(fence, 0, 0);
    if (status === gl.TIMEOUT_EXPIRED) continue;
    gl.deleteSync(fence);
    return status === gl.WAIT_FAILED ? null : performance.now() - begin;
  }
}
