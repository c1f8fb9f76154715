/**
 * The playground's scenes: which one is open, and when its texts are written.
 *
 * Input: texts that change, records. Output: the scene in the editor, its record in the store, its name over
 * everything. Texts that are nobody's scene yet become one at the first edit. What is
 * asked for comes one after the other; the page's own state changes at once, after what was there is written.
 */

import type { EditorState } from "@codemirror/state";
import type { Payload } from "../../payload";
import type { Keeping } from "../keeping";
import type { Studio } from "../studio";
import { Heading } from "./heading";
import { askToPersist, forget, leave, left } from "./last";
import type { Release } from "./locks";
import * as r from "./records";
import { Shelf } from "./shelf";
import type { Store } from "./store";
import { thumbOf } from "./thumbs";
import { Turns } from "./turns";
import { earlierText, failureText, quoted } from "./wording";

/** After the first change that is not written, so long until it is. */
const KEEP_MS = 250;
/** A text that stays so long becomes a version. */
const REST_MS = 1000;
/** After a good picture, so long until it becomes the scene's small one. */
const THUMB_MS = 1500;
/** After the page has begun, so long until old records are looked for. */
const TIDY_MS = 5000;

/** What is open. */
export interface Current {
  record: r.SceneRecord;
  /** Whether it is in the store: the first edit puts it there. */
  isKept: boolean;
  /** Lets it go; null where another tab edits it. */
  release: Release | null;
  /** The texts that were written last, or opened. */
  written: r.Texts;
}

export class Scenes implements Keeping {
  readonly shelf = new Shelf((id) => this.#tell(id));
  readonly store: Store = this.shelf.store;
  readonly turns = new Turns(this);
  readonly heading = new Heading((name) => void this.rename(this.id, name), () => this.turns.tell());
  /** In another page it is small: nothing is read from the store, or written. */
  readonly isFrame = new URLSearchParams(location.search).has("embed");
  /** Called when records have changed. */
  onChange: () => void = () => {};
  /** Null until the first texts are there. */
  now: Current | null = null;
  /** Each scene's texts with their history, while the page is open. */
  #states = new Map<string, Map<string, EditorState>>();
  #queue: Promise<unknown> = Promise.resolve();
  #keeping = 0;
  #resting = 0;
  #picturing = 0;
  /** Another scene takes the place: the address is its own already. */
  #isLeaving = false;

  constructor(readonly studio: Studio) {
    this.store.onFailure = (error) => this.#failed(error);
  }

  get id(): string {
    return this.now?.record.id ?? "";
  }

  /** The open scene as it was written last. */
  get record(): r.SceneRecord | null {
    return this.now?.record ?? null;
  }

  get name(): string {
    return this.now?.record.name ?? "";
  }

  get isKept(): boolean {
    return !!this.now?.isKept;
  }

  /** Whether another tab edits it. */
  get isReader(): boolean {
    return !!this.now && !this.now.release;
  }

  // The page begins and ends

  /** Takes what earlier pages left into the store. */
  async start(): Promise<void> {
    this.studio.page.name.replaceWith(this.heading.element);
    if (this.isFrame) return;
    const isThere = !(await this.store.open());
    if (isThere) {
      for (const last of left()) {
        await this.store.write(last.scene.id, (old) => r.merged(old, last));
        if (!this.store.isMissing) forget(last.scene.id);
      }
      await this.shelf.takeDrafts();
      setTimeout(() => void this.store.tidy(), TIDY_MS);
    }
    addEventListener("pagehide", () => this.#leave());
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.#leave();
      this.turns.wait();
    });
    // A page that the browser has held back lost its locks and connections.
    addEventListener("pageshow", ({ persisted }) => persisted && location.reload());
    addEventListener("beforeunload", (event) => {
      if (this.store.isMissing || (!isThere && this.#isChanged)) event.preventDefault();
    });
  }

  /** The page ends, or may: what is not written is left where no promise is needed. */
  #leave(): void {
    const now = this.now;
    const isStored = !this.#isChanged && !this.store.isMissing;
    if (now?.release && !isStored) leave({ scene: this.textsNow(now), base: now.record.changed, at: Date.now() });
    const others = this.store.missing.filter(({ id }) => id !== this.id || !now?.release);
    for (const scene of others) leave({ scene, base: -1, at: scene.changed });
    void this.write();
  }

  // Writing

  changed(): void {
    if (this.isFrame || !this.now?.release) return;
    this.#keeping ||= window.setTimeout(() => void this.write(), KEEP_MS);
    clearTimeout(this.#resting);
    this.#resting = window.setTimeout(() => void this.write("typed"), REST_MS);
  }

  keep(): void {
    void this.write();
  }

  /** A person wants to keep it as it is now. */
  async save(): Promise<void> {
    if (this.isReader) return this.turns.tell();
    await this.write("named", true);
    const isStored = !this.isFrame && !this.store.isMissing;
    this.studio.page.announcer.textContent = isStored
      ? `Kept in this browser as ${quoted(this.name)}`
      : "It is not stored: save a copy, or share a link.";
  }

  /** Writes the texts as they are; a reason makes a version of them; `isWanted`: also without an edit. */
  write(why?: r.Reason, isWanted = false): Promise<void> {
    clearTimeout(this.#keeping);
    this.#keeping = 0;
    return this.afterwards(() => this.writeNow(why, isWanted));
  }

  /** As `write`, for what is done within the queue. */
  async writeNow(why?: r.Reason, isWanted = false): Promise<void> {
    const now = this.now;
    if (this.isFrame || !now?.release) return;
    if (!now.isKept && !this.#isChanged && !isWanted) return;
    const { record, isKept, written } = now;
    const mine = this.textsNow(now);
    const isSame = JSON.stringify([mine.files, r.poseOf(mine)]) === JSON.stringify([record.files, r.poseOf(record)]);
    if (isKept && isSame && !why && !this.store.isMissing) return;
    if (!isKept) mine.name = r.uniqueName(record.name, await this.shelf.names());
    const scene = await this.store.write(record.id, (old, last) => {
      const { name, thumb, changed, deleted } = old ?? mine;
      const at = Math.max(Date.now(), changed + 1);
      // Whoever goes on with a scene that another tab deleted wants it; a version alone changes nothing.
      const state = isKept && isSame && old ? { changed, deleted } : { changed: at, deleted: null };
      const next = { ...mine, name, thumb, ...state };
      const versions: r.Version[] = [];
      if (!isKept && !r.sameTexts(written, mine.files)) versions.push(r.versionOf(record, "opened", record.created));
      // Somebody else wrote meanwhile, where tabs have no locks.
      const isOther = old && old.changed !== record.changed && !r.sameTexts(old.files, written);
      if (isOther) versions.push(r.versionOf(old, "before replace", old.changed));
      if (why && !(last && r.sameTexts(last.files, mine.files))) versions.push(r.versionOf(next, why, at));
      return { scene: next, versions };
    });
    if (!scene) return;
    Object.assign(now, { record: scene, isKept: true, written: mine.files });
    if (!this.store.isMissing) forget(scene.id);
    if (!isKept) this.#becameScene(scene);
    if (scene.deleted === null) this.studio.page.bar("deleted", null);
    this.#tell(scene.id);
  }

  /** The texts are a scene from now on. */
  #becameScene({ id }: r.SceneRecord): void {
    if (!this.#isLeaving) history.replaceState(null, "", `#scene=${id}`);
    this.studio.page.bar("earlier", null);
    this.showName();
    this.pictured();
    askToPersist();
  }

  get #isChanged(): boolean {
    return !!this.now && !r.sameTexts(this.studio.texts.files, this.now.written);
  }

  /** The record of a scene with the texts and the picture as they are. */
  textsNow({ record }: Current): r.SceneRecord {
    const { values: _, camera: __, time: ___, ...rest } = record;
    return { ...rest, ...this.studio.opening.pose, files: this.studio.texts.files };
  }

  // Opening

  /** The scene that was changed last and that no tab edits. */
  async last(): Promise<r.SceneRecord | undefined> {
    if (this.isFrame) return undefined;
    const taken = await this.turns.locks.taken();
    return (await this.shelf.all()).find(({ id, deleted }) => deleted === null && !taken.has(id));
  }

  /** Opens a scene of this browser; false where it is not there. */
  open(id: string): Promise<boolean> {
    return this.afterwards(async () => {
      if (this.isFrame) return false;
      if (id === this.id) return true;
      const found = await this.store.scene(id);
      if (!found || found.deleted !== null) return false;
      const release = await this.turns.take(id);
      await this.swap({ record: (await this.store.scene(id)) ?? found, isKept: true, release, written: found.files });
      if (!release) this.turns.tell();
      return true;
    });
  }

  /** Opens texts that become a scene at the first edit. */
  openUnsaved(from: r.Origin, main: string, files: r.Texts, pose: r.Pose, payload?: Payload): Promise<void> {
    return this.afterwards(async () => {
      const record = r.fresh(from, main, files, pose);
      const release = this.isFrame ? () => {} : await this.turns.take(record.id);
      await this.swap({ record, isKept: false, release, written: files }, payload);
      if (!this.isFrame && from.kind !== "new") await this.#tellEarlier(from);
    });
  }

  /** Shows another scene, after what was there is written. */
  async swap(next: Current, payload?: Payload): Promise<void> {
    this.#isLeaving = true;
    await this.writeNow("typed");
    // A key that was pressed meanwhile.
    for (let tries = 0; tries < 3 && this.#isChanged; tries++) await this.writeNow("typed");
    this.#isLeaving = false;
    const { editor, opening, settings, texts } = this.studio;
    const old = this.now;
    const { record, release } = next;
    const isOther = old?.record.id !== record.id;
    for (const timer of [this.#keeping, this.#resting, this.#picturing]) clearTimeout(timer);
    this.#keeping = 0;
    if (old && isOther) {
      old.release?.();
      this.#states.set(old.record.id, editor.exchange(this.#states.get(record.id)));
    }
    this.now = next;
    settings.main = record.main;
    texts.begin(record.files);
    editor.isReadOnly = false;
    opening.show(record, isOther, payload);
    editor.isReadOnly = !release;
    this.turns.wait();
    if (isOther || release) for (const bar of ["reader", "earlier", "deleted"]) this.studio.page.bar(bar, null);
    this.showName();
  }

  /** The same example or link became a scene earlier. */
  async #tellEarlier(from: r.Origin): Promise<void> {
    const earlier = await this.shelf.begunAs(from);
    if (!earlier) return;
    this.studio.page.bar(
      "earlier",
      earlierText(earlier),
      ["Open it", () => this.studio.opening.goTo(`#scene=${earlier.id}`)],
      ["Go on with the original", () => this.studio.page.bar("earlier", null)],
    );
  }

  showName(): void {
    const now = this.now;
    if (!now) return;
    this.heading.show(now.record.name, now.isKept || this.isFrame, !now.release);
    document.title = `${now.record.name} · distal`;
    const { player } = this.studio.picture;
    const { name } = now.record;
    if (player && player.payload.name !== name) player.payload = { ...player.payload, name };
  }

  // What is done with scenes

  /** A copy as a scene of its own, of the texts as they are. */
  async duplicate(id: string): Promise<r.SceneRecord> {
    if (id === this.id) await this.write();
    const found = id === this.id ? this.textsNow(this.now!) : (await this.store.scene(id))!;
    return this.shelf.copy(found);
  }

  /** What is open becomes a scene of its own, or another one. */
  async fork(): Promise<void> {
    if (!this.isKept) return this.save();
    this.studio.opening.goTo(`#scene=${(await this.duplicate(this.id)).id}`);
    this.studio.page.announcer.textContent = "A copy is open";
  }

  async rename(id: string, typed: string): Promise<void> {
    const name = r.cleanName(typed);
    const now = this.now;
    if (!name) return this.showName();
    const free = r.uniqueName(name, await this.shelf.names(id));
    if (now && now.record.id === id) {
      now.record.name = free;
      this.showName();
      if (!now.isKept) return this.write(undefined, true);
    }
    await this.shelf.change(id, { name: free });
  }

  async remove(id: string): Promise<void> {
    if (id === this.id) await this.write("typed");
    await this.shelf.change(id, { deleted: Date.now() });
    if (id === this.id) this.studio.opening.goTo("#start");
  }

  restore(id: string): Promise<void> {
    return this.shelf.change(id, { deleted: null });
  }

  /** Takes the texts of a version: a step that can be undone, and what was there is a version itself. */
  async restoreVersion({ files, main }: r.Version): Promise<void> {
    await this.write("before replace", true);
    for (const [name, text] of Object.entries(files)) {
      this.studio.files.replace(name === main ? this.studio.settings.main : name, text);
    }
    await this.write("typed");
  }

  // Pictures

  /** The picture is that of the text: it becomes the scene's small one. */
  pictured(): void {
    clearTimeout(this.#picturing);
    if (!this.isFrame) this.#picturing = window.setTimeout(() => void this.#picture(), THUMB_MS);
  }

  async #picture(): Promise<void> {
    const now = this.now;
    const { player } = this.studio.picture;
    if (!now?.isKept || !now.release || !player || document.hidden || !this.studio.opening.isShown) return;
    const thumb = await thumbOf(player);
    if (!thumb || this.now !== now || thumb === now.record.thumb) return;
    now.record.thumb = thumb;
    await this.shelf.change(now.record.id, { thumb });
  }

  #tell(id: string): void {
    this.turns.locks.tell({ kind: "written", id });
    this.onChange();
  }

  #failed(error: Error | null): void {
    if (!error) return this.studio.page.bar("storage", null);
    const { sharing } = this.studio;
    this.studio.page.bar(
      "storage",
      failureText(error),
      ["Save a copy", () => sharing.saveSource()],
      ["Share a link", () => void sharing.share()],
      ["Try again", () => void this.write(undefined, true)],
    );
  }

  /** Does one thing after the other. */
  afterwards<T>(act: () => Promise<T>): Promise<T> {
    const done = this.#queue.then(act);
    this.#queue = done.catch(() => {});
    return done;
  }
}
