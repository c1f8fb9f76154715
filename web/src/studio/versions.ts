/**
 * Versions of a file: texts that were on the disk or in the page, listed, shown, restored.
 *
 * Input: what the server keeps. Output: a sheet; a restored text is an edit, which undo takes back.
 */

import { make } from "../dom";
import type { VersionEntry } from "../generated/messages";
import { differences } from "./differences";
import { sheet } from "./sheets";
import type { Studio } from "./studio";

const REASONS: Record<string, string> = {
  opened: "on the disk when the studio opened",
  saved: "saved here",
  other: "saved by another program",
  typed: "unsaved text in the page",
  left: "unsaved text of a tab that is gone",
};

export class Versions {
  constructor(readonly studio: Studio) {}

  async open(name: string): Promise<void> {
    const { client, keeping, page, texts } = this.studio;
    keeping.keep();
    const answer = await client.ask({ kind: "versions", revision: texts.revision, file: name });
    if (answer?.kind !== "answer" || answer.request !== "versions") {
      const reason = answer?.kind === "mistakes" ? answer.mistakes[0]!.message : "nobody answers";
      return page.tell(`The versions of ${name} cannot be shown: ${reason}.`, ["Close", () => {}]);
    }
    const { versions } = answer.result;
    const none = make("p", { className: "quiet" }, "No other text of this file is kept yet.");
    const shown = make("div", { className: "version" });
    const list = make("ul", { className: "version-list" });
    const dialog = sheet(`Versions of ${name}`, ...(versions.length ? [list, shown] : [none]));
    dialog.classList.add("wide", "versions");
    const buttons = versions.map((version) => {
      const button = entryOf(version);
      button.onclick = () => {
        for (const one of buttons) one.setAttribute("aria-pressed", String(one === button));
        void this.#show(name, version, shown, dialog);
      };
      list.append(make("li", {}, button));
      return button;
    });
    buttons[0]?.click();
  }

  async #show(name: string, version: VersionEntry, shown: HTMLElement, dialog: HTMLDialogElement): Promise<void> {
    const { client, files, settings, texts } = this.studio;
    const answer = await client.ask({ kind: "version", revision: texts.revision, file: name, version: version.name });
    if (answer?.kind !== "answer" || answer.request !== "version") {
      shown.replaceChildren(make("p", {}, "This version is not there any more."));
      return;
    }
    const { text } = answer.result;
    const restore = make("button", { type: "button" }, "Put it into the page");
    restore.onclick = () => {
      dialog.close();
      files.replace(name, text);
    };
    restore.disabled = text === texts.files[name];
    const legend = make(
      "p",
      { className: "legend" },
      make("span", { className: "theirs-sign" }, "in the version"),
      make("span", { className: "mine-sign" }, "in the page"),
    );
    const label = `The version of ${timeOf(version)}`;
    const view = differences(text, texts.files[name]!, label, settings.nonce);
    shown.replaceChildren(...(restore.disabled ? [] : [legend]), view, make("div", { className: "choices" }, restore));
  }
}

function entryOf(version: VersionEntry): HTMLButtonElement {
  const reason = make("span", { className: "quiet" }, REASONS[version.why] ?? version.why);
  return make("button", { type: "button" }, make("strong", {}, timeOf(version)), reason);
}

function timeOf({ at }: VersionEntry): string {
  return new Date(at).toLocaleString([], { dateStyle: "medium", timeStyle: "medium" });
}
