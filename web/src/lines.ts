/**
 * A driver's message about a shader, with the author's line numbers.
 *
 * Pure. In: the info log and the program's line table. Out: rows of text, each with the place in
 * the Python file where it is known. Drivers write "ERROR: 0:12: ..." (ANGLE), "0:12(5): error"
 * (Mesa) or "0(12) : error" (others).
 */

import type { LineRange } from "./payload";

export interface Complaint {
  /** "scene.py:42", or "" where the text comes from no line of the author's. */
  place: string;
  text: string;
}

const NUMBERED = /^\s*(?:[a-z]+:\s*)?\d+(?::(\d+)|\((\d+)\))/i;

export function complaints(
  log: string,
  lines: readonly LineRange[],
  files: readonly string[],
): Complaint[] {
  const rows = log.split(/[\n\0]/).filter((row) => row.trim());
  return rows.map((row) => {
    const [, colon, bracket] = NUMBERED.exec(row) ?? [];
    const at = +(colon ?? bracket ?? 0);
    const range = lines.find(([first, last]) => first <= at && at <= last);
    const file = range && files[range[2]];
    return { place: file ? `${file}:${range[3]}` : "", text: row.trim() };
  });
}
