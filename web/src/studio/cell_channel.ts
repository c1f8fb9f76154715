/**
 * The channel of the playground: Python in a sealed frame of the page.
 *
 * Input: requests. Output: responses. It fetches the files of Python once somebody needs it, and ends a
 * worker that does not answer, as the local studio's server does.
 */

import { MOST_MESSAGES } from "../cell/limits";
import { make } from "../dom";
import type { Request, Response } from "../generated/messages";
import type { Channel } from "./channel";
import { faultOf } from "./message_check";

const FILES = ["pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json", "distal.zip"];
/** Milliseconds that the author's code has, and that the work after it has. */
const CODE_MS = 5_000;
const WORK_MS = 120_000;
const ANSWERS = ["scene", "numbers", "answer", "mistakes", "dropped"];
/** What comes out of the cell is a stranger's: longer messages are not read. */
const LONGEST = 64_000_000;

export class CellChannel implements Channel {
  onMessage: Channel["onMessage"] = () => {};
  onState: Channel["onState"] = () => {};
  /** Called with what is loaded, from 0 to 1. */
  onProgress: (part: number) => void = () => {};
  #port: MessagePort | null = null;
  #isStarted = false;
  #waiting = new Map<number, number>();
  #timer = 0;
  /** Messages since the last answer. */
  #count = 0;
  /** The author's code has ended, for the first request that waits. */
  #hasRun = false;
  /** A worker begins, or was told to end: until the next one is ready, what is still said is not read. */
  #isBeginning = true;

  /** `folder`: where the files of Python are. */
  constructor(readonly folder: string) {}

  /** Loads Python; later calls do nothing. */
  async start(): Promise<void> {
    if (this.#isStarted) return;
    this.#isStarted = true;
    try {
      const [files, frame] = await Promise.all([this.#files(), this.#frame()]);
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = ({ data }) => this.#received(data);
      this.#port = port1;
      frame.contentWindow!.postMessage({ files }, "*", [port2, ...Object.values(files)]);
    } catch (error) {
      this.#isStarted = false;
      this.#fail(String((error as Error).message));
    }
  }

  post(request: Request): void {
    if (!this.#port) return;
    this.#waiting.set(request.id, request.revision);
    if (this.#waiting.size === 1) this.#wait(CODE_MS);
    this.#port.postMessage(JSON.stringify(request));
  }

  async #files(): Promise<Record<string, ArrayBuffer>> {
    let done = 0;
    const load = async (name: string) => {
      const response = await fetch(`${this.folder}${name}`);
      if (!response.ok) throw new Error(`${name} is not there (${response.status})`);
      const data = await response.arrayBuffer();
      this.onProgress((done += 1) / FILES.length);
      return [name, data] as const;
    };
    return Object.fromEntries(await Promise.all(FILES.map(load)));
  }

  /** The cell's page comes as a text: no service worker answers a frame without origin. */
  async #frame(): Promise<HTMLIFrameElement> {
    const response = await fetch(`${this.folder}cell.html`);
    if (!response.ok) throw new Error(`cell.html is not there (${response.status})`);
    const frame = make("iframe", { srcdoc: await response.text(), title: "Python", hidden: true });
    frame.setAttribute("sandbox", "allow-scripts");
    return new Promise((resolve) => {
      frame.onload = () => resolve(frame);
      document.body.append(frame);
    });
  }

  #received(data: unknown): void {
    if (typeof data !== "string") {
      return this.#fail(String((data as { failed?: unknown } | null)?.failed).slice(0, 400));
    }
    const message = messageOf(data);
    if (this.#isBeginning) {
      if (typeof message === "string" || message.kind !== "ready") return;
      this.#begin();
      return this.onMessage(message);
    }
    if (++this.#count > MOST_MESSAGES) return this.#restart("the scene's code sent too many messages");
    if (typeof message === "string") return this.refuse(message);
    // There is a new worker only after the last one was ended.
    if (message.kind === "ready") return this.refuse("ready");
    const isAnswer = ANSWERS.includes(message.kind);
    // Only answers to what was asked count: code that makes up others would never be ended.
    if (isAnswer && !this.#waiting.delete((message as { id: number }).id)) return;
    if (isAnswer) {
      clearTimeout(this.#timer);
      this.#begin();
      if (this.#waiting.size) this.#wait(CODE_MS);
    } else if (message.kind === "progress" && !this.#hasRun) {
      this.#hasRun = true;
      this.#wait(WORK_MS);
    }
    this.onMessage(message);
  }

  refuse(place: string): void {
    this.#restart(`the scene's code sent a broken answer (${place.slice(0, 100)})`);
  }

  /** The next request is the worker's. */
  #begin(): void {
    this.#isBeginning = this.#hasRun = false;
    this.#count = 0;
  }

  #wait(ms: number): void {
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => {
      this.#restart(`the scene's code gave no answer within ${ms / 1000} s`);
    }, ms);
  }

  #restart(reason: string): void {
    clearTimeout(this.#timer);
    this.#isBeginning = true;
    const [first, ...others] = this.#waiting;
    this.#waiting.clear();
    this.onMessage({ kind: "restarted", id: first?.[0] ?? null, reason });
    for (const [id, revision] of others) this.onMessage({ kind: "dropped", id, revision });
    this.#port?.postMessage("restart");
  }

  #fail(reason: string): void {
    if (this.#port && this.#waiting.size) return this.#restart(reason);
    this.onState(false);
    this.onMessage({ kind: "restarted", id: null, reason: `Python could not be loaded: ${reason}` });
  }
}

/** The message in a text of the cell; for a text that is none, where it is wrong. */
function messageOf(text: string): Response | string {
  if (text.length > LONGEST) return "its length";
  try {
    const found = JSON.parse(text) as Response;
    return faultOf(found) ?? found;
  } catch {
    return "no JSON";
  }
}
