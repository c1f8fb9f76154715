/**
 * What the page leaves in `localStorage`: the last text of a tab that ends, because the database may not
 * come to the end of a write then; and the drafts that earlier versions of the playground kept there.
 *
 * Input: texts of a scene. Output: texts that earlier pages left. A browser that refuses this has the database.
 */

import type { LastTexts } from "./records";

const LEFT = "distal:last:";
const READ_DRAFTS = "distal:old-drafts";
const ASKED = "distal:asked-to-persist";
const OLD_DRAFT = /^distal:.*\/([^/]+\.py)$/s;

export function leave(last: LastTexts): void {
  // The picture is in the database, if there is one.
  attempt(() => localStorage.setItem(LEFT + last.scene.id, JSON.stringify({ ...last, scene: { ...last.scene, thumb: "" } })));
}

export function forget(id: string): void {
  attempt(() => localStorage.removeItem(LEFT + id));
}

/** What earlier pages, or other tabs that are not seen now, left. */
export function left(): LastTexts[] {
  return keys(LEFT).flatMap((key) => {
    const found = attempt(() => JSON.parse(localStorage.getItem(key)!) as LastTexts | null);
    const isWhole = found?.scene?.id === key.slice(LEFT.length) && isTexts(found.scene.files, found.scene.main);
    return isWhole ? [found!] : [];
  });
}

export interface OldDraft {
  key: string;
  file: string;
  text: string;
}

/** Drafts of earlier versions that no scene was made of yet. */
export function oldDrafts(): OldDraft[] {
  const read = new Set(attempt(() => JSON.parse(localStorage.getItem(READ_DRAFTS) ?? "[]") as string[]) ?? []);
  return keys("distal:").flatMap((key) => {
    const file = OLD_DRAFT.exec(key)?.[1];
    if (!file || read.has(key)) return [];
    const text = attempt(() => (JSON.parse(localStorage.getItem(key)!) as { text?: unknown } | null)?.text);
    return typeof text === "string" && text.trim() ? [{ key, file, text }] : [];
  });
}

/** Each draft becomes a scene once; it stays where earlier versions look for it. */
export function markRead(drafts: readonly OldDraft[]): void {
  if (!drafts.length) return;
  attempt(() => {
    const read = JSON.parse(localStorage.getItem(READ_DRAFTS) ?? "[]") as string[];
    localStorage.setItem(READ_DRAFTS, JSON.stringify([...read, ...drafts.map(({ key }) => key)]));
  });
}

/** Asks once that the browser does not clear what is stored when room is short. */
export function askToPersist(): void {
  attempt(() => {
    if (localStorage.getItem(ASKED)) return;
    localStorage.setItem(ASKED, "1");
    void navigator.storage?.persist?.().catch(() => {});
  });
}

function keys(prefix: string): string[] {
  return attempt(() => Object.keys(localStorage).filter((key) => key.startsWith(prefix))) ?? [];
}

/** Whether what was stored has the form of texts. */
function isTexts(files: unknown, main: unknown): boolean {
  if (typeof main !== "string" || typeof files !== "object" || !files || !Object.hasOwn(files, main)) return false;
  return Object.values(files).every((text) => typeof text === "string");
}

/** What storage gives; undefined where it gives nothing. */
function attempt<T>(act: () => T): T | undefined {
  try {
    return act();
  } catch {
    return undefined;
  }
}
