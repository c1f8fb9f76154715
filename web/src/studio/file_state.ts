/**
 * The state of a file: the text in the page, the text on the disk, and the one that both come from.
 *
 * Input: events (a key, a change on the disk, a save, a choice). Output: the next state. The base moves to what
 * is on the disk only when the page has no text of its own, or when a person has chosen; a save may replace
 * the base alone. Knows neither the page nor the server.
 */

/** The digests of a file that is not there, and of one whose bytes nobody can read. */
export const NO_FILE = "";
export const UNREADABLE = "?";

/** What the disk has. */
export interface Disk {
  digest: string;
  /** Null where it has no text: see `problem`. */
  text: string | null;
  /** What is wrong, for a sentence that begins with the file's name; else nothing. */
  problem: string;
  /** An older message has a smaller one. */
  order: number;
}

export interface FileState {
  /** In the page. */
  text: string;
  /** What the text began with; its text is null where only the digest is known. */
  base: { digest: string; text: string | null };
  disk: Disk;
}

/** Who has changed the file since its base: nobody, the page, the disk, both. */
export type Kind = "same" | "mine" | "theirs" | "both";

export function kindOf(state: FileState): Kind {
  const isTheirs = state.disk.digest !== state.base.digest;
  if (isMine(state)) return isTheirs ? "both" : "mine";
  return isTheirs ? "theirs" : "same";
}

/** A file that is not on the disk yet is all the page's. */
function isMine({ text, base }: FileState): boolean {
  return base.digest === NO_FILE || text !== base.text;
}

/** Whether a person has to choose before it is saved. */
export function isOpen(state: FileState): boolean {
  return state.disk.digest !== state.base.digest;
}

/** A file that the page did not have. */
export function begun(text: string, digest: string, order = 0): FileState {
  return { text, base: { digest, text }, disk: { digest, text: digest ? text : null, problem: "", order } };
}

function same(state: FileState): FileState {
  const { digest, text } = state.disk;
  return { ...state, text: text!, base: { digest, text } };
}

function hasText({ text, digest }: Disk): boolean {
  return text !== null && digest !== NO_FILE && digest !== UNREADABLE;
}

/** The disk has this. A text of the page stays; without one the page follows. */
export function seen(state: FileState, disk: Disk): FileState {
  if (disk.order < state.disk.order) return state;
  const next = { ...state, disk };
  return hasText(disk) && (!isMine(state) || disk.text === state.text) ? same(next) : next;
}

/** The page has this. */
export function typed(state: FileState, text: string): FileState {
  const next = { ...state, text };
  return hasText(state.disk) && state.disk.text === text ? same(next) : next;
}

/** An unsaved text of an earlier page, which began with the text of a digest. */
export function restored(state: FileState, text: string, digest: string): FileState {
  const base = digest === state.base.digest ? state.base : { digest, text: null };
  return typed({ ...state, base }, text);
}

/** A text was written; the disk may have another one since. */
export function saved(state: FileState, text: string, digest: string, order: number): FileState {
  const disk = order < state.disk.order ? state.disk : { digest, text, problem: "", order };
  return { ...state, base: { digest, text }, disk };
}

/** Whether a choice for what the disk had is one for what it has. */
function isFor(state: FileState, digest: string): boolean {
  return digest === state.disk.digest && digest !== UNREADABLE;
}

/** A person wants the page's text instead of what the disk has with this digest. */
export function keptMine(state: FileState, digest: string): FileState {
  if (!isFor(state, digest)) return state;
  return { ...state, base: { digest, text: state.disk.text } };
}

/** A person wants what the disk has with this digest instead of the page's text. */
export function tookTheirs(state: FileState, digest: string): FileState {
  return isFor(state, digest) && hasText(state.disk) ? same(state) : state;
}

/** The server was away: what it says next is newest. */
export function reconnected(state: FileState): FileState {
  return { ...state, disk: { ...state.disk, order: -1 } };
}
