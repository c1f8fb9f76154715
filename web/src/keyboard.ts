/** Keys to actions, and when a key belongs to somebody else. */

import { KEYS, OPPOSITES, type Action } from "./generated/bindings";

/** What keys do, with or without shift; false for a key that has no meaning and is left to the page. */
export type Actions = Record<Action, (shift: boolean) => boolean>;

/** Acts on a key unless the element that has the focus needs it. */
export function press(event: KeyboardEvent, actions: Actions): void {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  // What a digit's key types with shift depends on the keyboard; which key it is does not.
  const digit = event.shiftKey && /^(?:Digit|Numpad)(\d)$/.exec(event.code ?? "")?.[1];
  const key = digit || event.key;
  if (isNeeded(event.composedPath()[0], key)) return;
  const action =
    (digit && OPPOSITES[digit]) || (KEYS[key] ?? (key.length === 1 && KEYS[key.toLowerCase()]));
  if (action && actions[action](event.shiftKey)) event.preventDefault();
}

/** Whether the element that has the focus needs a key. */
export function isNeeded(target: EventTarget | undefined, key: string): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) {
    // A slider takes arrows and its ends, a switch the space bar; where one writes, every key is text.
    if (target.type === "range") return key.startsWith("Arrow") || key === "Home";
    return target.type === "checkbox" ? key === " " : true;
  }
  if (target.closest("textarea, select, dialog[open], [contenteditable]")) return true;
  return key === " " && !!target.closest("button, summary, a");
}
