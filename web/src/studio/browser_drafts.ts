/**
 * Drafts of the playground in the browser's storage: one for each name of a file.
 *
 * Input: unsaved texts. Output: the same after a reload.
 */

import type { Keeping } from "./keeping";
import type { Studio } from "./studio";

interface Draft {
  text: string;
  digest: string;
}

export class BrowserDrafts implements Keeping {
  /** The files whose drafts are this tab's: those of others stay. */
  #own = new Set<string>();

  constructor(
    readonly studio: Studio,
    readonly key: string,
  ) {}

  changed(): void {}

  keep(): void {
    const { texts } = this.studio;
    for (const name of texts.names) {
      const { text, base } = texts.state(name);
      try {
        if (!texts.isChanged(name)) {
          if (this.#own.delete(name)) localStorage.removeItem(this.#keyOf(name));
          continue;
        }
        this.#own.add(name);
        localStorage.setItem(this.#keyOf(name), JSON.stringify({ text, digest: base.digest } satisfies Draft));
      } catch {
        // No storage, or a full one: the text is still in the editor.
      }
    }
  }

  /** The unsaved texts of an earlier visit. */
  found(names: readonly string[]): Record<string, Draft> {
    const drafts: Record<string, Draft> = {};
    for (const name of names) {
      try {
        const draft = JSON.parse(localStorage.getItem(this.#keyOf(name)) ?? "null") as Draft | null;
        if (draft?.digest === this.studio.texts.state(name).base.digest) drafts[name] = draft;
      } catch {
        // As above.
      }
    }
    return drafts;
  }

  #keyOf(name: string): string {
    return `distal:${this.key}/${name}`;
  }
}
