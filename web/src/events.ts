/** Who wants to know what happens to a player. */

import type { Steering } from "./camera";
import type { Value } from "./payload";
import type { FrameReport } from "./renderer";

export interface Events {
  /** A person changed a parameter. */
  change: { name: string; value: Value };
  /** A parameter has another value, set by the user or by the page. */
  parameter: { name: string; value: Value };
  time: { time: number; playing: boolean };
  speed: { speed: number };
  view: { name: string };
  steering: Steering;
  error: { message: string; log: string };
  /** Of a page with paths: whether direct light is shown instead. */
  mode: { isDirect: boolean };
  /** The panel opened or closed. */
  panel: { isOpen: boolean };
  frame: FrameReport & { time: number; view: string };
}

export class Emitter {
  #listeners = new Map<keyof Events, Set<(detail: never) => void>>();

  /** Calls `listener` at each event of the kind. Returns what ends that. */
  on<K extends keyof Events>(event: K, listener: (detail: Events[K]) => void): () => void {
    const listeners = this.#listeners.get(event) ?? new Set();
    this.#listeners.set(event, listeners.add(listener));
    return () => listeners.delete(listener);
  }

  emit<K extends keyof Events>(event: K, detail: Events[K]): void {
    for (const listener of [...(this.#listeners.get(event) ?? [])]) {
      (listener as (detail: Events[K]) => void)(detail);
    }
  }
}
