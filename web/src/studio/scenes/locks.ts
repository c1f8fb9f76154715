/**
 * Which tab edits a scene: a lock of the browser for each scene, and messages between tabs.
 *
 * Input: a scene's id. Output: the lock, or that another tab has it; what other tabs tell. A browser without
 * locks has none to take: the store then makes a version of a text that is in the way of another.
 */

/** How long a tab that has the lock is waited for: one that is frozen never answers. */
const YIELD_MS = 1500;
/** A page that is loaded again has the lock until its end, which may come after the new page's beginning. */
const TAKE_MS = 400;

export type News =
  /** Please keep your text and let the scene go. */
  | { kind: "yield"; id: string }
  /** A record was written. */
  | { kind: "written"; id: string };

/** Lets a scene go. */
export type Release = () => void;

export class Locks {
  /** Called with what other tabs tell. */
  onNews: (news: News) => void = () => {};
  #channel = typeof BroadcastChannel === "undefined" ? null : new BroadcastChannel("distal:scenes");

  constructor() {
    if (this.#channel) this.#channel.onmessage = ({ data }) => this.onNews(data as News);
  }

  tell(news: News): void {
    this.#channel?.postMessage(news);
  }

  /** Takes a scene for this tab; null where another tab has it. `stolen` is called if a tab takes it by force. */
  take(id: string, stolen: () => void): Promise<Release | null> {
    return this.#request(id, { signal: AbortSignal.timeout(TAKE_MS) }, stolen);
  }

  /** Takes a scene as soon as no tab has it. Returns what ends the waiting. */
  wait(id: string, stolen: () => void, granted: (release: Release) => void): () => void {
    const ending = new AbortController();
    void this.#request(id, { signal: ending.signal }, stolen).then((release) => release && granted(release));
    return () => ending.abort();
  }

  /** Takes a scene from the tab that has it: it keeps its text first, if it still answers. */
  async takeOver(id: string, stolen: () => void): Promise<Release | null> {
    this.tell({ kind: "yield", id });
    const polite = await this.#request(id, { signal: AbortSignal.timeout(YIELD_MS) }, stolen);
    return polite ?? this.#request(id, { steal: true }, stolen);
  }

  /** The scenes that tabs edit now. */
  async taken(): Promise<Set<string>> {
    const { held = [] } = (await navigator.locks?.query()) ?? {};
    return new Set(held.flatMap(({ name = "" }) => (name.startsWith(PREFIX) ? [name.slice(PREFIX.length)] : [])));
  }

  #request(id: string, options: LockOptions, stolen: () => void): Promise<Release | null> {
    if (!navigator.locks) return Promise.resolve(() => {});
    return new Promise((resolve) => {
      let isHeld = false;
      const holding = navigator.locks.request(PREFIX + id, options, () => {
        isHeld = true;
        return new Promise<void>((release) => resolve(release));
      });
      holding.catch(() => (isHeld ? stolen() : resolve(null)));
    });
  }
}

const PREFIX = "distal:scene:";
