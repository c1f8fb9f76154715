/**
 * The palette: a list of all commands that is searched by typing.
 *
 * Input: commands. Output: a dialog; Enter or a press runs one. The field is a combobox, the list its
 * listbox: the focus stays in the field, and `aria-activedescendant` names the option.
 */

import { make } from "../dom";
import { shownKeys } from "./command_keys";
import type { Command } from "./commands";
import { bareSheet } from "./sheets";

const STEPS: Record<string, number> = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 };

export function openPalette(commands: readonly Command[]): void {
  const able = commands.filter(({ act, isPossible }) => act && (isPossible?.() ?? true));
  const list = make("ul", { id: "palette-list", role: "listbox", "aria-label": "Commands" });
  const none = make("p", { className: "quiet", role: "status" });
  const field = make("input", {
    type: "text",
    placeholder: "Find a command",
    autocomplete: "off",
    spellcheck: false,
    role: "combobox",
    "aria-label": "Find a command",
    "aria-expanded": "true",
    "aria-controls": "palette-list",
    "aria-autocomplete": "list",
  });
  let found: readonly Command[] = [];
  let at = 0;
  const choose = (index: number) => {
    at = index;
    [...list.children].forEach((item, i) => item.setAttribute("aria-selected", String(i === at)));
    const option = list.children[at];
    if (option) field.setAttribute("aria-activedescendant", option.id);
    else field.removeAttribute("aria-activedescendant");
    option?.scrollIntoView({ block: "nearest" });
  };
  const run = (command: Command | undefined) => {
    if (!command) return;
    dialog.close();
    command.act!();
  };
  const show = () => {
    found = matching(able, field.value);
    list.replaceChildren(...found.map((command, i) => optionOf(command, i, () => run(command))));
    none.textContent = found.length ? "" : "No command of that name.";
    field.setAttribute("aria-expanded", String(found.length > 0));
    choose(0);
  };
  field.oninput = show;
  field.onkeydown = (event) => {
    const { key } = event;
    const last = found.length - 1;
    if (key in STEPS) {
      const next = at + STEPS[key]!;
      // One step goes around the ends; a page stops there.
      const isAround = Math.abs(STEPS[key]!) === 1 && (next < 0 || next > last);
      choose(isAround ? (next < 0 ? last : 0) : Math.min(Math.max(next, 0), Math.max(last, 0)));
    } else if (key === "Enter" && !event.isComposing) run(found[at]);
    else if (key.toLowerCase() === "k" && (event.ctrlKey || event.metaKey)) dialog.close();
    else return;
    event.preventDefault();
  };
  const dialog = bareSheet("Commands", field, list, none);
  dialog.classList.add("palette");
  show();
}

function optionOf({ text, keys, isOn }: Command, index: number, run: () => void): HTMLElement {
  const key = keys && make("kbd", {}, shownKeys(keys));
  const isNow = isOn?.() && make("span", { className: "quiet" }, "on");
  const item = make("li", { id: `palette-${index}`, role: "option" }, make("span", {}, text), isNow, key);
  item.onclick = run;
  // The focus stays in the field.
  item.onpointerdown = (event) => event.preventDefault();
  return item;
}

/** The commands that have all words: first those that begin with them, then by name, then by other words. */
function matching(commands: readonly Command[], typed: string): readonly Command[] {
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  const rank = ({ text, words: others = "" }: Command) => {
    const name = text.toLowerCase();
    const all = `${name} ${others.toLowerCase()}`;
    if (!words.every((word) => all.includes(word))) return -1;
    if (name.startsWith(words.join(" "))) return 0;
    if (words.every((word) => ` ${name}`.includes(` ${word}`))) return 1;
    return words.every((word) => name.includes(word)) ? 2 : 3;
  };
  const ranked = commands.map((command) => [rank(command), command] as const).filter(([found]) => found >= 0);
  return ranked.sort(([a], [b]) => a - b).map(([, command]) => command);
}
