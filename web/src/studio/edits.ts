/**
 * Changes of texts: the smallest one between two, and edits of an earlier text in the one that is there now.
 *
 * Input: texts, edits with their places. Output: edits. Nothing here changes a text.
 */

import type { Edit } from "../generated/messages";

/** The smallest change that makes one text of another. */
export function smallest(old: string, text: string): { from: number; to: number; insert: string } {
  let from = 0;
  while (from < old.length && from < text.length && old[from] === text[from]) from++;
  let last = 0;
  const most = Math.min(old.length, text.length) - from;
  while (last < most && old[old.length - 1 - last] === text[text.length - 1 - last]) last++;
  return { from, to: old.length - last, insert: text.slice(from, text.length - last) };
}

/** Edits of a file's earlier text as those of its text now; null where both change the same place. */
export function moved(edits: readonly Edit[], old: string, now: string): Edit[] | null {
  if (old === now) return [...edits];
  const { from, to, insert } = smallest(old, now);
  const shift = insert.length - (to - from);
  if (edits.some(({ start, end }) => end >= from && start <= to)) return null;
  return edits.map((edit) => (edit.end < from ? edit : { ...edit, start: edit.start + shift, end: edit.end + shift }));
}
