/**
 * The playground's scenes: which one is open, when its texts are written, and which tab may write them.
 *
 * Input: texts that change, records, what other tabs tell. Output: the scene in the editor, its record in the
 * store, its name over everything. Texts that are nobody's scene yet become one at the first edit. What is
 * asked for comes one after the other; the page's own state changes at once, after what was there is written.
 */

import type { EditorState } from "@codemirror/state";
import type { Payload } from "../../payload";
import type { Keeping } from "../keeping";
import type { Studio } from "../studio";
import { Bars } from "./bars";
import { Heading } from "./heading";
import { askToPersist, forget, leave, left, markRead, oldDrafts } from "./last";
import { Locks, type News, type Release } from "./locks";
import * as r from "./records";
import { Store } from "./store";
import { thumbOf } from "./thumbs";
import { earlierText, failureText, quoted } from "./wording";

/** After the first change that is not written, so long until it is. */
const KEEP_MS = 250;
/** A text that stays so long becomes a version. */
const REST_MS = 1000;
/** After a good picture, so long until it becomes the scene's small one. */
const THUMB_MS = 1500;
/** After the page has begun, so long until old records are looked for. */
const TIDY_MS = 5000;
/** Another tab's texts are shown so often at most. */
const FOLLOW_MS = 500;
/** After another tab has asked for the scene, so long until this one waits for it again. */
const POLITE_MS = 3000;

interface Current {
  record: r.SceneRecord;
  /** Whether it is in the store: the first edit puts it there. */
  isKept: boolean;
  /** Lets it go; null where another tab edits it. */
  release: Release | null;
  /** The texts that were written last, or opened. */
  written: r.Texts;
}

export class Scenes implements Keeping {
  readonly store = new Store();
  readonly locks = new Locks();
  readonly bars = new Bars();
  readonly heading = new Heading((name) => void this.rename(this.id, name), () => this.#tellReader());
  /** In another page it is small: nothing is read from the store, or written. */
  readonly isFrame = new URLSearchParams(location.search).has("embed");
  /** Called when records have changed. */
  onChange: () => void = () => {};
  #now: Current | null = null;
  /** Each scene's texts with their history, while the page is open. */
  #states = new Map<string, Map<string, EditorState>>();
  #queue: Promise<unknown> = Promise.resolve();
  #keeping = 0;
  #resting = 0;
  #picturing = 0;
  #following = 0;
  /** Ends the waiting for a scene that another tab edits. */
  #waiting: (() => void) | null = null;
  /** Another scene takes the place: the address is its own already. */
  #isLeaving = false;

  constructor(readonly studio: Studio) {
    this.store.onFailure = (error) => this.#failed(error);
    this.locks.onNews = (news) => void this.#heard(news);
  }

  get id(): string {
    return this.#now?.record.id ?? "";
  }

  /** The open scene as it was written last. */
  get record(): r.SceneRecord | null {
    return this.#now?.record ?? null;
  }

  get name(): string {
    return this.#now?.record.name ?? "";
  }

  get isKept(): boolean {
    return !!this.#now?.isKept;
  }

  /** Whether another tab edits it. */
  get isReader(): boolean {
    return !!this.#now && !this.#now.release;
  }

  // The page begins and ends

  /** Takes what earlier pages left into the store. */
  async start(): Promise<void> {
    this.studio.page.notice.after(this.bars.element);
    this.studio.page.name.replaceWith(this.heading.element);
    if (this.isFrame) return;
    const isThere = !(await this.store.open());
    if (isThere) {
      for (const last of left()) {
        await this.store.write(last.scene.id, (old) => r.merged(old, last));
        if (!this.store.isMissing) forget(last.scene.id);
      }
      await this.#takeDrafts();
      setTimeout(() => void this.store.tidy(), TIDY_MS);
    }
    addEventListener("pagehide", () => this.#leave());
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.#leave();
      this.#await();
    });
    // A page that the browser has held back lost its locks and connections.
    addEventListener("pageshow", ({ persisted }) => persisted && location.reload());
    addEventListener("beforeunload", (event) => {
      if (this.store.isMissing || (!isThere && this.#isChanged)) event.preventDefault();
    });
  }

  async #takeDrafts(): Promise<void> {
    const drafts = oldDrafts();
    for (const { key, file, text } of drafts) {
      const files = { [file]: text };
      const origin = { kind: "draft", ref: key, digest: await r.digestOf(file, files) } as const;
      await this.#add(this.#fresh(origin, file, files));
    }
    if (!this.store.isMissing) markRead(drafts);
  }

  /** The page ends, or may: what is not written is left where no promise is needed. */
  #leave(): void {
    const now = this.#now;
    if (!now?.release || !this.#isChanged) return void this.write();
    leave({ scene: this.#recordNow(now), base: now.record.changed, at: Date.now() });
    void this.write();
  }

  // Writing

  changed(): void {
    if (this.isFrame || !this.#now?.release) return;
    this.#keeping ||= window.setTimeout(() => void this.write(), KEEP_MS);
    clearTimeout(this.#resting);
    this.#resting = window.setTimeout(() => void this.write("typed"), REST_MS);
  }

  keep(): void {
    void this.write();
  }

  /** A person wants to keep it as it is now. */
  async save(): Promise<void> {
    if (this.isReader) return this.#tellReader();
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
    return this.#afterwards(() => this.#write(why, isWanted));
  }

  async #write(why?: r.Reason, isWanted = false): Promise<void> {
    const now = this.#now;
    if (this.isFrame || !now?.release) return;
    if (!now.isKept && !this.#isChanged && !isWanted) return;
    const { record, isKept, written } = now;
    const mine = this.#recordNow(now);
    const isSame = JSON.stringify([mine.files, r.poseOf(mine)]) === JSON.stringify([record.files, r.poseOf(record)]);
    if (isKept && isSame && !why && !this.store.isMissing) return;
    if (!isKept) mine.name = r.uniqueName(record.name, await this.#names());
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
    this.bars.hide("deleted");
    this.#tell(scene.id);
  }

  /** The texts are a scene from now on. */
  #becameScene({ id }: r.SceneRecord): void {
    if (!this.#isLeaving) history.replaceState(null, "", `#scene=${id}`);
    this.bars.hide("earlier");
    this.#showName();
    this.pictured();
    askToPersist();
  }

  get #isChanged(): boolean {
    return !!this.#now && !r.sameTexts(this.studio.texts.files, this.#now.written);
  }

  #recordNow({ record }: Current): r.SceneRecord {
    const { values: _, camera: __, time: ___, ...rest } = record;
    return { ...rest, ...this.studio.opening.pose, files: this.studio.texts.files };
  }

  #fresh(from: r.Origin, main: string, files: r.Texts, pose: r.Pose = {}): r.SceneRecord {
    const now = Date.now();
    const name = r.nameOf(from, main, files[main]!);
    return { ...{ id: r.newId(), name, main, files, thumb: "", from }, ...pose, created: now, changed: now, deleted: null };
  }

  async #names(id = ""): Promise<string[]> {
    const all = await this.store.all();
    return all.filter((one) => one.id !== id && one.deleted === null).map(({ name }) => name);
  }

  // Opening

  /** Scenes that are there, the newest first. */
  async all(): Promise<r.SceneRecord[]> {
    return (await this.store.all()).sort((a, b) => b.changed - a.changed);
  }

  /** The scene that was changed last and that no tab edits. */
  async last(): Promise<r.SceneRecord | undefined> {
    if (this.isFrame) return undefined;
    const taken = await this.locks.taken();
    return (await this.all()).find(({ id, deleted }) => deleted === null && !taken.has(id));
  }

  /** Opens a scene of this browser; false where it is not there. */
  open(id: string): Promise<boolean> {
    return this.#afterwards(async () => {
      if (this.isFrame) return false;
      if (id === this.id) return true;
      const found = await this.store.scene(id);
      if (!found || found.deleted !== null) return false;
      const release = await this.locks.take(id, () => this.#stolen(id));
      await this.#swap({ record: (await this.store.scene(id)) ?? found, isKept: true, release, written: found.files });
      if (!release) this.#tellReader();
      return true;
    });
  }

  /** Opens texts that become a scene at the first edit. */
  openUnsaved(from: r.Origin, main: string, files: r.Texts, pose: r.Pose, payload?: Payload): Promise<void> {
    return this.#afterwards(async () => {
      const record = this.#fresh(from, main, files, pose);
      const release = this.isFrame ? () => {} : await this.locks.take(record.id, () => this.#stolen(record.id));
      await this.#swap({ record, isKept: false, release, written: files }, payload);
      if (!this.isFrame && from.kind !== "new") await this.#tellEarlier(from);
    });
  }

  /** Shows another scene, after what was there is written. */
  async #swap(next: Current, payload?: Payload): Promise<void> {
    this.#isLeaving = true;
    await this.#write("typed");
    // A key that was pressed meanwhile.
    if (this.#isChanged) await this.#write("typed");
    this.#isLeaving = false;
    const { editor, opening, settings, texts } = this.studio;
    const old = this.#now;
    const { record, release } = next;
    const isOther = old?.record.id !== record.id;
    for (const timer of [this.#keeping, this.#resting, this.#picturing, this.#following]) clearTimeout(timer);
    this.#keeping = 0;
    if (old && isOther) {
      old.release?.();
      this.#states.set(old.record.id, editor.exchange(this.#states.get(record.id)));
    }
    this.#now = next;
    settings.main = record.main;
    texts.begin(record.files);
    editor.isReadOnly = false;
    opening.show(record, isOther, payload);
    editor.isReadOnly = !release;
    this.#await();
    if (isOther || release) for (const bar of ["reader", "earlier", "deleted"]) this.bars.hide(bar);
    this.#showName();
  }

  /** The same example or link became a scene earlier. */
  async #tellEarlier({ kind, ref, digest }: r.Origin): Promise<void> {
    const isSame = ({ deleted, from }: r.SceneRecord) =>
      deleted === null && from.kind === kind && (kind === "example" ? from.ref === ref : !!digest && from.digest === digest);
    const earlier = (await this.all()).find(isSame);
    if (!earlier) return;
    this.bars.show(
      "earlier",
      earlierText(earlier),
      ["Open it", () => this.studio.opening.goTo(`#scene=${earlier.id}`)],
      ["Go on with the original", () => this.bars.hide("earlier")],
    );
  }

  #showName(): void {
    const now = this.#now;
    if (!now) return;
    this.heading.show(now.record.name, now.isKept || this.isFrame, !now.release);
    document.title = `${now.record.name} · distal`;
  }

  // What is done with scenes

  /** A copy as a scene of its own. Returns its id. */
  async duplicate(id: string): Promise<string> {
    if (id === this.id) await this.write();
    const found = id === this.id ? this.#recordNow(this.#now!) : (await this.store.scene(id))!;
    const { main, files, name, thumb } = found;
    const from = { kind: "scene", ref: id, digest: await r.digestOf(main, files) } as const;
    return this.#add({ ...this.#fresh(from, main, files, r.poseOf(found)), name, thumb });
  }

  /** What is open becomes a scene of its own, or another one. */
  async fork(): Promise<void> {
    if (!this.isKept) return this.save();
    this.studio.opening.goTo(`#scene=${await this.duplicate(this.id)}`);
    this.studio.page.announcer.textContent = "A copy is open";
  }

  /** Puts a new scene into the store. Returns its id. */
  async #add(record: r.SceneRecord): Promise<string> {
    const name = r.uniqueName(record.name, await this.#names());
    await this.store.write(record.id, () => ({ scene: { ...record, name } }));
    this.#tell(record.id);
    return record.id;
  }

  /** Adds texts that a person opened; false where a scene has them already. */
  async add(record: Partial<r.SceneRecord> & Pick<r.SceneRecord, "main" | "files">): Promise<boolean> {
    const { main, files, name } = record;
    const isSame = (one: r.SceneRecord) => r.sameTexts(one.files, files) && (name ?? one.name) === one.name;
    if ((await this.all()).some((one) => one.deleted === null && isSame(one))) return false;
    const from = { kind: "file", ref: main, digest: await r.digestOf(main, files) } as const;
    await this.#add({ ...this.#fresh(from, main, files), ...record });
    return true;
  }

  async rename(id: string, typed: string): Promise<void> {
    const name = r.cleanName(typed);
    const now = this.#now;
    if (!name) return this.#showName();
    const free = r.uniqueName(name, await this.#names(id));
    if (now && now.record.id === id) {
      now.record.name = free;
      this.#showName();
      if (!now.isKept) return this.write(undefined, true);
    }
    await this.#change(id, { name: free });
  }

  async remove(id: string): Promise<void> {
    if (id === this.id) await this.write("typed");
    await this.#change(id, { deleted: Date.now() });
    if (id === this.id) this.studio.opening.goTo("#start");
  }

  async restore(id: string): Promise<void> {
    this.bars.hide("deleted");
    await this.#change(id, { deleted: null });
  }

  async #change(id: string, change: Partial<r.SceneRecord>): Promise<void> {
    const known = await this.store.scene(id);
    await this.store.write(id, (old) => {
      const base = old ?? known;
      return base ? { scene: { ...base, ...change } } : null;
    });
    this.#tell(id);
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
    const now = this.#now;
    const { player } = this.studio.picture;
    if (!now?.isKept || !now.release || !player || document.hidden || !this.studio.opening.isShown) return;
    const thumb = await thumbOf(player);
    if (!thumb || this.#now !== now || thumb === now.record.thumb) return;
    now.record.thumb = thumb;
    await this.#change(now.record.id, { thumb });
  }

  // Other tabs

  /** The scene is edited in this tab from now on; the other one keeps its text first. */
  takeOver(): Promise<void> {
    return this.#afterwards(async () => {
      const now = this.#now;
      if (!now || now.release) return;
      const { id } = now.record;
      this.#endWaiting();
      await this.#own(await this.locks.takeOver(id, () => this.#stolen(id)));
    });
  }

  async #own(release: Release | null): Promise<void> {
    if (!release || !this.#now) return;
    const record = (await this.store.scene(this.id)) ?? this.#now.record;
    await this.#swap({ record, isKept: true, release, written: record.files });
    this.studio.page.announcer.textContent = "You can edit this scene now";
  }

  async #heard({ kind, id }: News): Promise<void> {
    if (kind === "written") this.onChange();
    const now = this.#now;
    if (id !== this.id || !now) return;
    if (kind === "yield" && now.release) return this.#yield(now);
    if (kind === "yield") {
      this.#endWaiting();
      return void setTimeout(() => this.#await(), POLITE_MS);
    }
    if (!now.release) {
      this.#following ||= window.setTimeout(() => void this.#afterwards(() => this.#follow()), FOLLOW_MS);
      return;
    }
    const { name, deleted } = (await this.store.scene(id)) ?? now.record;
    now.record.name = name;
    this.#showName();
    if (deleted === null) return this.bars.hide("deleted");
    const text = `${quoted(name)} was deleted in another tab. Your next change brings it back.`;
    this.bars.show("deleted", text, ["Bring it back", () => void this.restore(id)]);
  }

  /** Another tab asks for the scene: first its text is kept, then it is let go. */
  #yield(now: Current): Promise<void> {
    this.studio.editor.isReadOnly = true;
    return this.#afterwards(async () => {
      await this.#write("typed");
      now.release?.();
      now.release = null;
      this.#tellReader(true);
      setTimeout(() => this.#await(), POLITE_MS);
    });
  }

  /** A scene that is read here, in a tab that is seen, is edited here once the other tab ends. */
  #await(): void {
    const now = this.#now;
    this.#endWaiting();
    if (this.isFrame || !now || now.release || document.hidden) return;
    const { id } = now.record;
    this.#waiting = this.locks.wait(
      id,
      () => this.#stolen(id),
      (release) => void this.#afterwards(async () => (this.#now === now && !now.release ? this.#own(release) : release())),
    );
  }

  /** Another tab has the scene by force: a text that it does not have becomes a version. */
  #stolen(id: string): void {
    const now = this.#now;
    if (id !== this.id || !now?.release) return;
    const mine = this.#recordNow(now);
    now.release = null;
    this.studio.editor.isReadOnly = true;
    this.#tellReader(true);
    setTimeout(() => this.#await(), POLITE_MS);
    void this.store.write(id, (old) => {
      if (!old) return { scene: mine };
      const isKnown = r.sameTexts(old.files, mine.files);
      return isKnown ? null : { scene: old, versions: [r.versionOf(mine, "before replace", Date.now())] };
    });
  }

  /** Shows what the tab that edits the scene has written. */
  async #follow(): Promise<void> {
    this.#following = 0;
    const now = this.#now;
    if (!now || now.release) return;
    const record = await this.store.scene(now.record.id);
    if (!record || r.sameTexts(record.files, this.studio.texts.files)) return;
    await this.#swap({ record, isKept: true, release: null, written: record.files });
  }

  #endWaiting(): void {
    this.#waiting?.();
    this.#waiting = null;
  }

  #tellReader(wasTaken = false): void {
    this.#showName();
    this.bars.show(
      "reader",
      wasTaken
        ? `Another tab edits ${quoted(this.name)} now. What you typed here is kept.`
        : `${quoted(this.name)} is open in another tab: here you can read it.`,
      ["Read on", () => this.bars.hide("reader")],
      ["Edit a copy", () => void this.fork()],
      [wasTaken ? "Take it back" : "Edit it here", () => void this.takeOver()],
    );
  }

  #tell(id: string): void {
    this.locks.tell({ kind: "written", id });
    this.onChange();
  }

  #failed(error: Error | null): void {
    if (!error) return this.bars.hide("storage");
    const { sharing } = this.studio;
    this.bars.show(
      "storage",
      failureText(error),
      ["Save a copy", () => sharing.saveSource()],
      ["Share a link", () => void sharing.share()],
      ["Try again", () => void this.write(undefined, true)],
    );
  }

  /** Does one thing after the other. */
  #afterwards<T>(act: () => Promise<T>): Promise<T> {
    const done = this.#queue.then(act);
    this.#queue = done.catch(() => {});
    return done;
  }
}
