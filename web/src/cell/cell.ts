/**
 * The sealed cell of the playground: a frame without origin, storage and network.
 *
 * Input: a port from the page, then the files of Python and of distal, then requests. Output: what the
 * worker in it answers, through the port. It starts a worker, ends it when it is told to, and passes
 * messages on; it reads none of them.
 */

declare const WORKER: string;

export {};

let port: MessagePort;
let files: Record<string, ArrayBuffer>;
let worker: Worker | null = null;

function start(): void {
  worker?.terminate();
  const source = new Blob([WORKER], { type: "text/javascript" });
  worker = new Worker(URL.createObjectURL(source));
  worker.onmessage = ({ data }) => port.postMessage(data);
  worker.onerror = (event) => port.postMessage({ failed: event.message || "the worker failed" });
  worker.postMessage({ files });
}

addEventListener("message", (event: MessageEvent) => {
  if (event.source !== parent || !event.ports[0]) return;
  [port] = event.ports as [MessagePort];
  ({ files } = event.data as { files: typeof files });
  port.onmessage = ({ data }) => {
    if (data === "restart") start();
    else worker?.postMessage(data);
  };
  start();
});
