/**
 * Files: what the disk tells, drafts that come back, saving, and conflicts.
 *
 * Input: texts of the disk and of the editor. Output: both the same, or a question to the person; nothing
 * is overwritten without one.
 */

import { make } from "../dom";
import type { Changed } from "../generated/messages";
import { sheet } from "./sheets";
import type { Studio } from "./studio";

export class Files {
  constructor(readonly studio: Studio) {}

  changed({ files, digests }: Changed): void {
    const { editor, looking, page, settings, tabs, texts } = this.studio;
    const kept: string[] = [];
    for (const [name, text] of Object.entries(files)) {
      const isNew = !(name in texts.files);
      const mine = texts.take(name, text, digests[name] ?? "");
      if (mine !== null) kept.push(name);
      else if (isNew) {
        this.#offerDraft(name, text);
        if (editor.name === name) editor.replace(name, texts.files[name]!);
      } else editor.replace(name, text);
    }
    if (!editor.name) tabs.show(settings.main);
    for (const name of kept) {
      page.tell(
        `${name} was changed by another program; your changes are still here.`,
        ["Keep mine", () => {}],
        ["Take the other", () => this.replace(name, files[name]!)],
      );
    }
    tabs.fill();
    looking.look();
  }

  /** Unsaved changes of an earlier visit: here again, or offered where the file has changed since. */
  #offerDraft(name: string, text: string): void {
    const { page, texts } = this.studio;
    const draft = texts.draft(name);
    if (!draft) return;
    if (draft.isCurrent) {
      texts.set(name, draft.text);
      const discard = () => this.replace(name, text);
      return page.tell(
        `Unsaved changes of ${name} are here again.`,
        ["Keep them", () => {}],
        ["Discard them", discard],
      );
    }
    page.tell(
      `${name} was changed since you left unsaved changes of it.`,
      ["Show my changes", () => this.replace(name, draft.text)],
      ["Discard them", () => texts.forgetDraft(name)],
    );
  }

  replace(name: string, text: string): void {
    const { editor, keeping, looking, scenes, texts } = this.studio;
    texts.set(name, text);
    editor.replace(name, text);
    keeping.changed();
    if (!scenes) texts.keepDraft(name);
    looking.look();
  }

  typed(name: string, text: string): void {
    const { costs, keeping, looking, picture, tabs, texts } = this.studio;
    if (!name || texts.files[name] === text) return;
    texts.set(name, text);
    keeping.changed();
    costs.changed();
    picture.outline.show(null, null);
    tabs.fill();
    looking.lookSoon();
  }

  async save(): Promise<void> {
    const { client, page, scenes, tabs, texts } = this.studio;
    if (scenes) return scenes.save();
    for (const name of texts.names.filter((one) => texts.isChanged(one))) {
      const text = texts.files[name]!;
      const { revision } = texts;
      const digest = texts.digest(name) || null;
      const answer = await client.ask({ kind: "save", revision, file: name, text, digest });
      if (!answer) return page.tell("The file is not saved: nobody answers.", ["Close", () => {}]);
      if (answer.kind === "mistakes") return page.tell(answer.mistakes[0]!.message, ["Close", () => {}]);
      if (answer.kind !== "answer" || answer.request !== "save") return;
      const { conflict, digest: now } = answer.result;
      if (conflict !== null) return this.#conflict(name, conflict, now);
      texts.saved(name, text, now);
      page.announcer.textContent = `${name} is saved`;
    }
    tabs.fill();
  }

  #conflict(name: string, theirs: string, digest: string): void {
    const { tabs, texts } = this.studio;
    const overwrite = make("button", { type: "button" }, "Overwrite the file");
    const take = make("button", { type: "button" }, "Take the file's text");
    const dialog = sheet(
      `${name} is another text on the disk`,
      make("p", {}, "Nothing was overwritten. Undo brings either text back."),
      make("pre", { className: "theirs", tabIndex: 0 }, theirs),
      make("div", { className: "choices" }, overwrite, take),
    );
    overwrite.onclick = () => {
      dialog.close();
      texts.saved(name, theirs, digest);
      void this.save();
    };
    take.onclick = () => {
      dialog.close();
      texts.saved(name, theirs, digest);
      this.replace(name, theirs);
      tabs.fill();
    };
  }
}
