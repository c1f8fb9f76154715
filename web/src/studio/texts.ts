/**
 * The texts that are edited: what the disk has, what is unsaved, and a draft that outlives the tab.
 *
 * Input: texts of the disk, texts of the editor. Output: the revision, what is unsaved, drafts. A draft
 * is kept before each compilation, because a scene may stop the page.
 */

interface Draft {
  text: string;
  /** The digest of the text on the disk that it began with. */
  digest: string;
}

export class Texts {
  /** Grows with each change. */
  revision = 0;
  #now: Record<string, string> = {};
  #saved: Record<string, string> = {};
  #digests: Record<string, string> = {};
  /** The files whose drafts are this tab's: those of other tabs stay. */
  #drafts = new Set<string>();

  constructor(readonly key: string) {}

  get files(): Record<string, string> {
    return this.#now;
  }

  get names(): string[] {
    return Object.keys(this.#now);
  }

  digest(name: string): string {
    return this.#digests[name] ?? "";
  }

  isChanged(name: string): boolean {
    return this.#now[name] !== this.#saved[name] || !this.#digests[name];
  }

  /** A file as the disk has it. Returns the unsaved text that is in its way, if there is one. */
  take(name: string, text: string, digest: string): string | null {
    const now = this.#now[name];
    // After the server was away: nothing is new.
    if (now !== undefined && this.#digests[name] === digest && digest) return null;
    const isKept = now !== undefined && now !== this.#saved[name] && now !== text;
    this.#saved[name] = text;
    this.#digests[name] = digest;
    if (isKept) return now;
    this.set(name, text);
    return null;
  }

  /** Other texts take the place of all. */
  begin(files: Record<string, string>): void {
    this.#now = { ...files };
    this.#saved = { ...files };
    this.revision += 1;
  }

  set(name: string, text: string): void {
    if (this.#now[name] === text) return;
    this.#now = { ...this.#now, [name]: text };
    this.revision += 1;
  }

  saved(name: string, text: string, digest: string): void {
    this.#saved[name] = text;
    this.#digests[name] = digest;
    this.keepDraft(name);
  }

  /** Remembers an unsaved text, and forgets one that is saved. */
  keepDraft(name: string): void {
    const key = this.#keyOf(name);
    try {
      if (this.#now[name] === this.#saved[name]) {
        if (this.#drafts.delete(name)) localStorage.removeItem(key);
        return;
      }
      this.#drafts.add(name);
      const draft: Draft = { text: this.#now[name]!, digest: this.digest(name) };
      localStorage.setItem(key, JSON.stringify(draft));
    } catch {
      // No storage, or a full one: the text is still in the editor.
    }
  }

  /** An unsaved text of an earlier visit, and whether the disk still has what it began with. */
  draft(name: string): { text: string; isCurrent: boolean } | null {
    try {
      const found = JSON.parse(localStorage.getItem(this.#keyOf(name)) ?? "null") as Draft | null;
      if (!found || found.text === this.#now[name]) return null;
      return { text: found.text, isCurrent: found.digest === this.digest(name) };
    } catch {
      return null;
    }
  }

  forgetDraft(name: string): void {
    this.#drafts.add(name);
    this.keepDraft(name);
  }

  #keyOf(name: string): string {
    return `distal:${this.key}/${name}`;
  }
}
