/**
 * The texts that are edited, each with the state of its file.
 *
 * Input: texts of the disk, texts of the editor, choices. Output: the texts, the revision, what is unsaved.
 */

import * as state from "./file_state";
import type { Disk, FileState } from "./file_state";

export class Texts {
  /** Grows with each change. */
  revision = 0;
  #now: Record<string, string> = {};
  #states = new Map<string, FileState>();

  get files(): Record<string, string> {
    return this.#now;
  }

  get names(): string[] {
    return Object.keys(this.#now);
  }

  /** The state of a file that is there. */
  state(name: string): FileState {
    return this.#states.get(name)!;
  }

  isChanged(name: string): boolean {
    return state.kindOf(this.state(name)) !== "same";
  }

  /** Whether the page has a text that was not on the disk. */
  hasOwn(name: string): boolean {
    return ["mine", "both"].includes(state.kindOf(this.state(name)));
  }

  /** Whether the disk has another text than the one that the page's began with. */
  isOpen(name: string): boolean {
    return state.isOpen(this.state(name));
  }

  /** A file that was not there yet, as the disk has it; without a digest it is not on the disk. */
  take(name: string, text: string, digest: string, order = 0): void {
    this.#become(name, state.begun(text, digest, order));
  }

  /** Other texts take the place of all. */
  begin(files: Record<string, string>): void {
    this.#states = new Map(Object.entries(files).map(([name, text]) => [name, state.begun(text, "begun")]));
    this.#now = { ...files };
    this.revision += 1;
  }

  seen(name: string, disk: Disk): void {
    this.#become(name, state.seen(this.state(name), disk));
  }

  set(name: string, text: string): void {
    this.#become(name, state.typed(this.state(name), text));
  }

  restore(name: string, text: string, digest: string): void {
    this.#become(name, state.restored(this.state(name), text, digest));
  }

  saved(name: string, text: string, digest: string, order: number): void {
    this.#become(name, state.saved(this.state(name), text, digest, order));
  }

  keepMine(name: string, digest: string): void {
    this.#become(name, state.keptMine(this.state(name), digest));
  }

  takeTheirs(name: string, digest: string): void {
    this.#become(name, state.tookTheirs(this.state(name), digest));
  }

  reconnected(): void {
    for (const [name, one] of this.#states) this.#states.set(name, state.reconnected(one));
  }

  #become(name: string, next: FileState): void {
    this.#states.set(name, next);
    if (this.#now[name] === next.text) return;
    this.#now = { ...this.#now, [name]: next.text };
    this.revision += 1;
  }
}
