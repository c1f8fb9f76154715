/**
 * Whose turn it is: which tab edits the open scene, and what happens when another one takes it.
 *
 * Input: what other tabs tell, a person's choice. Output: the editor is read only or not, the scene's newest
 * texts, a bar that says why. A tab that loses a scene has its text in the record, or as a version.
 */

import { Locks, type News, type Release } from "./locks";
import * as r from "./records";
import type { Current, Scenes } from "./scenes";
import { quoted } from "./wording";

/** Another tab's texts are shown so often at most. */
const FOLLOW_MS = 500;
/** After another tab has asked for the scene, so long until this one waits for it again. */
const POLITE_MS = 3000;

export class Turns {
  readonly locks = new Locks();
  #following = 0;
  /** Ends the waiting for a scene that another tab edits. */
  #waiting: (() => void) | null = null;

  constructor(readonly scenes: Scenes) {
    this.locks.onNews = (news) => void this.#heard(news);
  }

  /** Takes a scene for this tab; null where another tab has it. */
  take(id: string): Promise<Release | null> {
    return this.locks.take(id, () => this.#stolen(id));
  }

  /** The scene is edited in this tab from now on; the other one keeps its text first. */
  takeOver(): Promise<void> {
    const { scenes } = this;
    return scenes.afterwards(async () => {
      const { now } = scenes;
      if (!now || now.release) return;
      const { id } = now.record;
      this.#endWaiting();
      await this.#own(await this.locks.takeOver(id, () => this.#stolen(id)));
    });
  }

  /** A scene that is read here, in a tab that is seen, is edited here once the other tab ends. */
  wait(): void {
    const { scenes } = this;
    const { now } = scenes;
    this.#endWaiting();
    if (scenes.isFrame || !now || now.release || document.hidden) return;
    const { id } = now.record;
    const granted = (release: Release) =>
      scenes.afterwards(async () => (scenes.now === now && !now.release ? this.#own(release) : release()));
    this.#waiting = this.locks.wait(id, () => this.#stolen(id), (release) => void granted(release));
  }

  /** Says that another tab edits the scene, and what can be done. */
  tell(wasTaken = false): void {
    const { scenes } = this;
    const name = quoted(scenes.name);
    scenes.showName();
    scenes.studio.page.bar(
      "reader",
      wasTaken
        ? `Another tab edits ${name} now. What you typed here is kept.`
        : `${name} is open in another tab: here you can read it.`,
      ["Read on", () => scenes.studio.page.bar("reader", null)],
      ["Edit a copy", () => void scenes.fork()],
      [wasTaken ? "Take it back" : "Edit it here", () => void this.takeOver()],
    );
  }

  async #own(release: Release | null): Promise<void> {
    const { now, store, studio } = this.scenes;
    if (!release || !now) return;
    const record = (await store.scene(now.record.id)) ?? now.record;
    await this.scenes.swap({ record, isKept: true, release, written: record.files });
    studio.page.announcer.textContent = "You can edit this scene now";
  }

  async #heard({ kind, id }: News): Promise<void> {
    const { scenes } = this;
    if (kind === "written") scenes.onChange();
    const { now } = scenes;
    if (!now || id !== now.record.id) return;
    if (kind === "yield") return now.release ? this.#yield(now) : this.#letAnother();
    if (now.release) return this.#learn(now);
    this.#following ||= window.setTimeout(() => void scenes.afterwards(() => this.#follow()), FOLLOW_MS);
  }

  /** Another tab asks for the scene: first its text is kept, then it is let go. */
  #yield(now: Current): Promise<void> {
    const { scenes } = this;
    scenes.studio.editor.isReadOnly = true;
    return scenes.afterwards(async () => {
      if (scenes.now !== now) return;
      await scenes.writeNow("typed");
      now.release?.();
      this.#lost(now);
    });
  }

  /** Another tab asks for a scene that this one waits for: it goes first. */
  #letAnother(): void {
    this.#endWaiting();
    setTimeout(() => this.wait(), POLITE_MS);
  }

  /** Another tab has the scene by force: a text that it does not have becomes a version. */
  #stolen(id: string): void {
    const { now, store } = this.scenes;
    if (!now?.release || id !== now.record.id) return;
    const mine = this.scenes.textsNow(now);
    this.#lost(now);
    void store.write(id, (old) => {
      if (!old) return { scene: mine };
      const isKnown = r.sameTexts(old.files, mine.files);
      return isKnown ? null : { scene: old, versions: [r.versionOf(mine, "before replace", Date.now())] };
    });
  }

  #lost(now: Current): void {
    now.release = null;
    this.scenes.studio.editor.isReadOnly = true;
    this.tell(true);
    this.#letAnother();
  }

  /** Another tab wrote something of the scene that is edited here: its name, or that it is deleted. */
  async #learn(now: Current): Promise<void> {
    const { shelf, store, studio } = this.scenes;
    const { id } = now.record;
    const { name, deleted } = (await store.scene(id)) ?? now.record;
    now.record.name = name;
    this.scenes.showName();
    if (deleted === null) return studio.page.bar("deleted", null);
    const text = `${quoted(name)} was deleted in another tab. Your next change brings it back.`;
    const restore = () => {
      studio.page.bar("deleted", null);
      void shelf.change(id, { deleted: null });
    };
    studio.page.bar("deleted", text, ["Bring it back", restore]);
  }

  /** Shows what the tab that edits the scene has written. */
  async #follow(): Promise<void> {
    this.#following = 0;
    const { now, store, studio } = this.scenes;
    if (!now || now.release) return;
    const record = await store.scene(now.record.id);
    if (!record || r.sameTexts(record.files, studio.texts.files)) return;
    await this.scenes.swap({ record, isKept: true, release: null, written: record.files });
  }

  #endWaiting(): void {
    this.#waiting?.();
    this.#waiting = null;
  }
}
