/**
 * Conflicts: files of which the disk has another text than the one that the page's began with.
 *
 * Input: the states of files. Output: a bar for each, as long as it is so, and the dialog of a save. A choice is
 * for the text that was shown: when that changes meanwhile, the dialog asks again.
 */

import { make } from "../dom";
import { differences } from "./differences";
import { kindOf, NO_FILE, UNREADABLE, type FileState } from "./file_state";
import { sheet } from "./sheets";
import type { Studio } from "./studio";

/** So long the buttons of a dialog rest whose text has changed: a press may be for the earlier one. */
const RESTING_MS = 700;

type Action = [label: string, act: () => void];

export class Conflicts {
  /** What the bar of each file says. */
  #shown = new Map<string, string>();
  #asked: { name: string; digest: string; dialog: HTMLDialogElement } | null = null;

  constructor(readonly studio: Studio) {}

  /** Shows what is so now; after each change of a state. */
  show(): void {
    const { page, texts } = this.studio;
    for (const name of texts.names) {
      const state = texts.state(name);
      const isOpen = texts.isOpen(name);
      const signature = isOpen ? JSON.stringify([state.disk.digest, state.disk.problem, kindOf(state)]) : "";
      if (signature === (this.#shown.get(name) ?? "")) continue;
      this.#shown.set(name, signature);
      if (isOpen) page.bar(`conflict:${name}`, sentence(name, state), ...this.#actions(name, state));
      else page.bar(`conflict:${name}`, null);
    }
    this.#askAgain();
  }

  #actions(name: string, { disk }: FileState): Action[] {
    const { digest, text } = disk;
    if (digest === UNREADABLE) return [];
    const keep: Action = [text === null ? "Keep the text" : "Keep mine", () => this.#keep(name, digest)];
    if (text === null) return [keep];
    return [keep, ["Take the other", () => this.#take(name, digest)], ["Compare", () => this.ask(name)]];
  }

  #keep(name: string, digest: string): void {
    const { keeping, tabs, texts } = this.studio;
    texts.keepMine(name, digest);
    keeping.keep();
    tabs.fill();
    this.show();
  }

  /** Undo brings the page's text back, and it is kept as a version. */
  #take(name: string, digest: string): void {
    const { channel, editor, keeping, looking, page, tabs, texts } = this.studio;
    if (channel.isOpen === false) {
      const reason = `Nothing is changed: while the studio's server is away, your text of ${name} would be kept nowhere.`;
      return page.tell(reason, ["Close", () => {}]);
    }
    keeping.keep();
    texts.takeTheirs(name, digest);
    editor.replace(name, texts.files[name]!);
    keeping.keep();
    tabs.fill();
    this.show();
    looking.look();
  }

  /** Asks what becomes of a file that is saved. */
  ask(name: string, again = ""): void {
    const { page, settings, texts } = this.studio;
    const state = texts.state(name);
    const { digest, text } = state.disk;
    if (digest === UNREADABLE) {
      return page.tell(`${name} is not saved: what is there now ${whatIs(state)}.`, ["Close", () => {}]);
    }
    const buttons = this.#choices(name, digest, text);
    const about = text === null ? explained(digest) : "Nothing is overwritten yet. The text that you leave is kept among the versions.";
    const dialog = sheet(
      text === null ? `${name} ${whatIs(state)}` : `${name} is another text on the disk`,
      make("p", { role: "status" }, `${again}${about}`),
      ...(text === null ? [] : [this.#legend(), differences(text, state.text, "The file's text", settings.nonce)]),
      make("div", { className: "choices" }, ...buttons),
    );
    dialog.classList.add("conflict", ...(text === null ? [] : ["wide"]));
    this.#asked = { name, digest, dialog };
    dialog.addEventListener("close", () => {
      if (this.#asked?.dialog === dialog) this.#asked = null;
    });
    if (!again) return buttons[0]!.focus();
    for (const button of buttons) button.disabled = true;
    setTimeout(() => buttons.forEach((button) => (button.disabled = false)), RESTING_MS);
  }

  #choices(name: string, digest: string, text: string | null): HTMLButtonElement[] {
    const { files } = this.studio;
    const choice = (label: string, act: () => void) => {
      const button = make("button", { type: "button" }, label);
      button.onclick = () => {
        this.#close();
        act();
      };
      return button;
    };
    const overwrite = choice(digest === NO_FILE ? "Write it again" : "Overwrite the file", () => {
      this.#keep(name, digest);
      void files.save();
    });
    const take = choice("Take the file's text", () => this.#take(name, digest));
    const cancel = choice("Cancel", () => {});
    return text === null ? [cancel, overwrite] : [cancel, take, overwrite];
  }

  #legend(): HTMLElement {
    const sign = (className: string, text: string) => make("span", { className }, text);
    return make("p", { className: "legend" }, sign("theirs-sign", "in the file"), sign("mine-sign", "in the page"));
  }

  #close(): void {
    this.#asked?.dialog.close();
    this.#asked = null;
  }

  /** While the dialog is open, the disk may change again. */
  #askAgain(): void {
    if (!this.#asked) return;
    const { name, digest } = this.#asked;
    const { texts } = this.studio;
    if (texts.isOpen(name) && texts.state(name).disk.digest === digest) return;
    this.#close();
    if (texts.isOpen(name)) this.ask(name, "It has changed once more. ");
  }
}

/** What is wrong with what the disk has; nothing where it has a text. */
function whatIs({ disk }: FileState): string {
  return disk.problem || (disk.digest === NO_FILE ? "is not on the disk" : "");
}

function sentence(name: string, state: FileState): string {
  const problem = whatIs(state);
  if (state.disk.digest === UNREADABLE) {
    return `${name} ${problem}. Your text is here; it can be saved once that is repaired.`;
  }
  if (problem) return `${name} ${problem}. Its text is still here.`;
  return `${name} was changed by another program or tab; your text is still here.`;
}

function explained(digest: string): string {
  if (digest === NO_FILE) return "Its text is still here, and can be written again.";
  return "What is there stays among the versions if you overwrite it.";
}
