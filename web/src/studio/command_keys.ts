/**
 * Keys and buttons of commands.
 *
 * Input: the list of commands. Output: listeners, bindings of the editor, buttons that say whether their
 * command is on or possible.
 */

import type { KeyBinding } from "@codemirror/view";
import { icon, make } from "../dom";
import { commandsOf, type Command } from "./commands";
import type { Studio } from "./studio";

const IS_MAC = /Mac|iP/.test(navigator.platform);

/** Keys as people read them: "Ctrl S". */
export function shownKeys(keys: string): string {
  const named = keys.replace("Mod-", IS_MAC ? "⌘-" : "Ctrl-");
  return named.replace("-", " ").replace(/ (\w)$/, (_, letter: string) => ` ${letter.toUpperCase()}`);
}

export class Commands {
  readonly all: readonly Command[];
  #buttons = new Map<string, HTMLButtonElement>();

  constructor(studio: Studio) {
    this.all = commandsOf(studio);
    // Before the editor, which has other meanings for some.
    document.addEventListener("keydown", (event) => this.#pressed(event), { capture: true });
  }

  /** The bindings of keys that are the code's. */
  get ofCode(): KeyBinding[] {
    const own = this.all.filter(({ keys, isOfCode }) => keys && isOfCode);
    return own.map(({ keys, act }) => ({ key: keys!, run: () => (act!(), true) }));
  }

  /** The button of a command. */
  button(id: string): HTMLButtonElement {
    const command = this.all.find((one) => one.id === id)!;
    const { act, button: text, hint, icon: path, keys } = command;
    const title = `${hint ?? command.text}${keys ? ` (${shownKeys(keys)})` : ""}`;
    const made = make("button", { type: "button", title, onclick: act }, path && icon(path), make("span", {}, text));
    made.dataset["command"] = id;
    this.#buttons.set(id, made);
    this.#show(command);
    return made;
  }

  /** Shows again what is on and what is possible. */
  refresh(): void {
    for (const command of this.all) this.#show(command);
  }

  #show({ id, isOn, isPossible }: Command): void {
    const button = this.#buttons.get(id);
    if (!button) return;
    if (isOn) button.setAttribute("aria-pressed", String(isOn()));
    if (isPossible) button.disabled = !isPossible();
  }

  #pressed(event: KeyboardEvent): void {
    if (event.defaultPrevented || event.isComposing) return;
    if (document.querySelector("dialog[open]")) {
      // A save that is pressed twice is not the browser's "Save page as".
      if (isPressed("Mod-s", event)) event.preventDefault();
      return;
    }
    const found = this.all.find(({ keys, isOfCode }) => keys && !isOfCode && isPressed(keys, event));
    if (!found?.act) return;
    event.preventDefault();
    event.stopPropagation();
    if (found.isPossible?.() ?? true) found.act();
  }
}

function isPressed(keys: string, event: KeyboardEvent): boolean {
  const { altKey, code, ctrlKey, metaKey, shiftKey, key } = event;
  const isMod = IS_MAC ? metaKey && !ctrlKey : ctrlKey && !metaKey;
  const hasMod = keys.startsWith("Mod-");
  if (altKey || shiftKey || (hasMod ? !isMod : ctrlKey || metaKey)) return false;
  // On a keyboard of other letters, the key at the place of the Latin letter.
  const pressed = key.length === 1 && key > "~" ? code.replace("Key", "") : key;
  return pressed.toLowerCase() === keys.replace("Mod-", "").toLowerCase();
}
