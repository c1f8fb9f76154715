/**
 * Files: what the disk tells, unsaved texts that come back, saving.
 *
 * Input: texts of the disk and of the editor. Output: both the same, or a conflict (`conflicts.ts`); nothing is
 * overwritten that a person has not seen.
 */

import type { Changed } from "../generated/messages";
import type { Studio } from "./studio";

/** A save is tried so often while the file becomes what the page has. */
const MOST_TRIES = 3;

export class Files {
  /** What the disk has told before the server knew the tab. */
  #waiting: Partial<Changed>[] | null = [];
  #saving: Promise<void> = Promise.resolve();

  constructor(readonly studio: Studio) {}

  /** How files are on the disk. */
  changed(message: Pick<Changed, "files" | "digests"> & Partial<Changed>): void {
    if (this.#waiting) return void this.#waiting.push(message);
    this.#take(message);
    this.#refresh();
  }

  /** The connection opened or closed. */
  connected(isOpen: boolean): void {
    this.#waiting = [];
    if (isOpen) this.studio.texts.reconnected();
  }

  /** The server knows the tab: these are its unsaved texts. */
  greeted(drafts: Record<string, { text: string; digest: string }>): void {
    const messages = this.#waiting ?? [];
    this.#waiting = null;
    for (const message of messages) this.#take(message);
    this.#restore(drafts);
    if (this.studio.texts.names.length) this.#refresh();
  }

  #take({ files = {}, digests = {}, problems = {}, order = 0 }: Partial<Changed>): void {
    const { editor, texts } = this.studio;
    for (const [name, text] of Object.entries(files)) {
      const digest = digests[name] ?? "";
      const problem = problems[name];
      if (!(name in texts.files)) texts.take(name, text, digest, order);
      if (problem) texts.seen(name, { digest: problem.digest, text: null, problem: problem.text, order });
      else texts.seen(name, { digest, text: digest ? text : null, problem: "", order });
      editor.replace(name, texts.files[name]!);
    }
  }

  #refresh(): void {
    const { conflicts, editor, looking, settings, tabs } = this.studio;
    if (!editor.name) tabs.show(settings.main);
    tabs.fill();
    conflicts.show();
    looking.look();
  }

  /** Unsaved changes of an earlier page: here again, as a conflict where the file has changed since. */
  #restore(drafts: Record<string, { text: string; digest: string }>): void {
    const { editor, page, texts } = this.studio;
    for (const [name, { text, digest }] of Object.entries(drafts)) {
      if (!(name in texts.files)) texts.take(name, "", "");
      const before = texts.files[name]!;
      texts.restore(name, text, digest);
      editor.replace(name, texts.files[name]!);
      if (texts.isOpen(name) || text === before) continue;
      page.tell(
        `Unsaved changes of ${name} are here again.`,
        ["Keep them", () => {}],
        ["Discard them", () => this.replace(name, before)],
      );
    }
  }

  /** Gives a file another text; undo brings the one before back. */
  replace(name: string, text: string): void {
    const { conflicts, editor, keeping, looking, tabs, texts } = this.studio;
    keeping.keep();
    texts.set(name, text);
    editor.replace(name, text);
    keeping.keep();
    tabs.fill();
    conflicts.show();
    looking.look();
  }

  typed(name: string, text: string): void {
    const { conflicts, costs, keeping, looking, picture, tabs, texts } = this.studio;
    if (!name || texts.files[name] === text) return;
    texts.set(name, text);
    keeping.changed();
    costs.changed();
    picture.outline.show(null, null);
    tabs.fill();
    conflicts.show();
    looking.lookSoon();
  }

  /** Saves the files that are not as on the disk, one save after the other. */
  save(): Promise<void> {
    const { scenes } = this.studio;
    if (scenes) return scenes.save();
    const next = () => this.#saveAll();
    this.#saving = this.#saving.then(next, next);
    return this.#saving;
  }

  async #saveAll(): Promise<void> {
    const { conflicts, editor, keeping, tabs, texts } = this.studio;
    keeping.keep();
    // What was deleted is asked about where one sees it, and not at each save of another file.
    const isMeant = (name: string) => texts.hasOwn(name) || (texts.isChanged(name) && name === editor.name);
    for (const name of texts.names.filter(isMeant)) {
      const isSaved = await this.#saveOne(name);
      tabs.fill();
      conflicts.show();
      if (!isSaved) return;
    }
    keeping.keep();
  }

  /** Saves a file; returns whether that is done. */
  async #saveOne(name: string, inPlace = false, tries = MOST_TRIES): Promise<boolean> {
    const { client, conflicts, page, tabs, texts } = this.studio;
    if (texts.isOpen(name)) return conflicts.ask(name), false;
    const { text, base } = texts.state(name);
    const { revision } = texts;
    const asked = { kind: "save", revision, file: name, text, digest: base.digest || null, in_place: inPlace } as const;
    const answer = await client.ask(asked);
    const close = ["Close", () => {}] as [string, () => void];
    if (!answer) return page.tell("The file is not saved: nobody answers.", close), false;
    if (answer.kind === "mistakes") return page.tell(answer.mistakes[0]!.message, close), false;
    if (answer.kind !== "answer" || answer.request !== "save") return false;
    const { conflict, digest, is_saved: isSaved, order, other, problem, refusal, unkept } = answer.result;
    if (refusal) {
      const again = () => void this.#saveOne(name, true).then(() => this.save());
      return page.tell(`${refusal}.`, ["Write in place", again], close), false;
    }
    if (isSaved) {
      texts.saved(name, text, digest, order);
      tabs.fill();
      page.announcer.textContent = `${name} is saved`;
      if (other !== null) this.#tellOther(name, other);
      if (unkept) page.tell(`${name} is saved; its versions are not kept: ${unkept}.`, close);
      return true;
    }
    texts.seen(name, { digest, text: conflict, problem, order });
    this.studio.editor.replace(name, texts.files[name]!);
    conflicts.show();
    if (!texts.isChanged(name)) return true; // the disk has this very text
    if (tries > 1 || texts.isOpen(name)) return this.#saveOne(name, inPlace, tries - 1);
    return page.tell(`${name} is not saved: it changes again and again.`, close), false;
  }

  /** Another program saved in the same moment, and its text is not on the disk any more. */
  #tellOther(name: string, other: string): void {
    const { page, versions } = this.studio;
    const key = `other:${name}`;
    const closing = (act: () => void) => () => (page.bar(key, null), act());
    page.bar(
      key,
      `Another program saved ${name} in the same moment. Your text is on the disk, the other one among the versions.`,
      ["Keep mine", closing(() => {})],
      ["Take the other", closing(() => this.replace(name, other))],
      ["Show versions", closing(() => void versions.open(name))],
    );
  }
}
