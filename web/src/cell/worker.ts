/**
 * Python with distal in a worker of the cell.
 *
 * Input: the files, then requests as JSON texts. Output: messages as JSON texts. What Python fetches comes
 * from the files; the policy of the cell forbids everything else.
 */

import { MOST_MESSAGES } from "./limits";

interface Python {
  globals: { set(name: string, value: unknown): void; get(name: string): unknown };
  unpackArchive(data: ArrayBuffer, format: string, options: { extractDir: string }): void;
  runPython(code: string): unknown;
}

interface Loader {
  loadPyodide(options: Record<string, unknown>): Promise<Python>;
}

const ADDRESS = "https://cell.invalid/";
const FOLDER = "/lib/distal";

const START = `
import sys
sys.path.insert(0, "${FOLDER}")
sys.dont_write_bytecode = True
import gc
# Collections take a fifth of the start, and of each compilation.
gc.disable()
import os
from pathlib import Path

from distal.editor.messages import AppRequest, MessageError, encoded, parsed
from distal.editor.worker import StudioWorker

os.makedirs("/scene", exist_ok=True)
os.chdir("/scene")
_worker = StudioWorker(Path("/scene"), lambda message: post(encoded(message)))
post(encoded(_worker.ready()))

def answer(text):
    request = parsed(text)
    if isinstance(request, AppRequest):
        for message in _worker.answers(request):
            post(encoded(message))

def tidy():
    gc.collect()
`;

function address(data: ArrayBuffer): string {
  return URL.createObjectURL(new Blob([data], { type: "text/javascript" }));
}

async function start(files: Record<string, ArrayBuffer>): Promise<(text: string) => void> {
  self.fetch = (async (asked: RequestInfo | URL) => {
    const name = String(asked instanceof Request ? asked.url : asked).replace(ADDRESS, "");
    const type = name.endsWith(".wasm") ? "application/wasm" : "application/octet-stream";
    const data = files[name];
    if (!data) return new Response(null, { status: 404 });
    return new Response(data, { headers: { "Content-Type": type } });
  }) as typeof fetch;
  const { loadPyodide } = (await import(address(files["pyodide.mjs"]!))) as Loader;
  const { default: createPyodideModule } = await import(address(files["pyodide.asm.mjs"]!));
  const python = await loadPyodide({
    indexURL: ADDRESS,
    createPyodideModule,
    lockFileContents: new TextDecoder().decode(files["pyodide-lock.json"]),
    packageBaseUrl: ADDRESS,
    jsglobals: Object.create(null),
    enableRunUntilComplete: false,
    stdout: () => {},
    stderr: () => {},
  });
  python.unpackArchive(files["distal.zip"]!, "zip", { extractDir: FOLDER });
  python.globals.set("post", tell);
  python.runPython(START);
  return python.globals.get("answer") as (text: string) => void;
}

/** Messages since the last request. */
let count = 0;

/** Passes a message on; a flood is stopped here, because it would bury the order to end the worker. */
function tell(text: string): void {
  count += 1;
  if (count < MOST_MESSAGES) postMessage(text);
  else if (count === MOST_MESSAGES) postMessage({ failed: "the scene's code sent too many messages" });
}

let ready: Promise<(text: string) => void> | null = null;

onmessage = async ({ data }: MessageEvent) => {
  count = 0;
  try {
    if (ready) (await ready)(data as string);
    else await (ready = start((data as { files: Record<string, ArrayBuffer> }).files));
  } catch (error) {
    postMessage({ failed: String(error) });
  }
};
