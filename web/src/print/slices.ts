/** Work in slices, so that the page goes on meanwhile; streams; failures. Knows nothing of meshes. */

/** So long the page may wait. */
const SLICE_MS = 6;

/** What a signal that was aborted throws out of the work. */
export async function sliced<T>(work: Generator<unknown, T>, signal: AbortSignal): Promise<T> {
  for (let begin = performance.now(); ; ) {
    const { done, value } = work.next();
    if (done) return value as T;
    if (performance.now() - begin < SLICE_MS) continue;
    await new Promise((resolve) => setTimeout(resolve));
    signal.throwIfAborted();
    begin = performance.now();
  }
}

/** The bytes that a stream makes of others. */
export function through(bytes: Blob, stream: CompressionStream): Promise<ArrayBuffer> {
  return new Response(bytes.stream().pipeThrough(stream)).arrayBuffer();
}

export function fail(text: string): never {
  throw new Error(text);
}
