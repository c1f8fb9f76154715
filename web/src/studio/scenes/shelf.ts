/**
 * The scenes of this browser: which there are, and what can be done with one that need not be open.
 *
 * Input: ids, names, texts. Output: records in the store; names are unique. Who listens is told of each change.
 */

import { markRead, oldDrafts } from "./last";
import * as r from "./records";
import { Store } from "./store";

export class Shelf {
  readonly store = new Store();

  /** `told`: called with the id of each record that was written. */
  constructor(readonly told: (id: string) => void) {}

  /** All scenes, the newest first; deleted ones too. */
  async all(): Promise<r.SceneRecord[]> {
    return (await this.store.all()).sort((a, b) => b.changed - a.changed);
  }

  /** The names that are taken, by others than one scene. */
  async names(id = ""): Promise<string[]> {
    const all = await this.store.all();
    return all.filter((one) => one.id !== id && one.deleted === null).map(({ name }) => name);
  }

  /** The newest scene that began as the same example, or with the same texts. */
  async begunAs({ kind, ref, digest }: r.Origin): Promise<r.SceneRecord | undefined> {
    const isSame = ({ deleted, from }: r.SceneRecord) =>
      deleted === null && from.kind === kind && (kind === "example" ? from.ref === ref : !!digest && from.digest === digest);
    return (await this.all()).find(isSame);
  }

  /** Puts a new scene into the store, under a name of its own. */
  async add(record: r.SceneRecord): Promise<r.SceneRecord> {
    const scene = { ...record, name: r.uniqueName(record.name, await this.names()) };
    await this.store.write(scene.id, () => ({ scene }));
    this.told(scene.id);
    return scene;
  }

  /** A copy of a scene, with its picture, as one of its own. */
  async copy(scene: r.SceneRecord): Promise<r.SceneRecord> {
    const { id, main, files, name, thumb } = scene;
    const from = { kind: "scene", ref: id, digest: await r.digestOf(main, files) } as const;
    return this.add({ ...r.fresh(from, main, files, r.poseOf(scene)), name, thumb });
  }

  /** Adds texts that a person opened; false where a scene has them already. */
  async take(loaded: Partial<r.SceneRecord> & Pick<r.SceneRecord, "main" | "files">): Promise<boolean> {
    const { main, files, name } = loaded;
    const isSame = (one: r.SceneRecord) => r.sameTexts(one.files, files) && (name ?? one.name) === one.name;
    if ((await this.all()).some((one) => one.deleted === null && isSame(one))) return false;
    const from = { kind: "file", ref: main, digest: await r.digestOf(main, files) } as const;
    await this.add({ ...r.fresh(from, main, files), ...loaded });
    return true;
  }

  /** Makes a scene of each draft of earlier versions of the playground. */
  async takeDrafts(): Promise<void> {
    const drafts = oldDrafts();
    for (const { key, file, text } of drafts) {
      const files = { [file]: text };
      const from = { kind: "draft", ref: key, digest: await r.digestOf(file, files) } as const;
      await this.add(r.fresh(from, file, files));
    }
    if (!this.store.isMissing) markRead(drafts);
  }

  /** Writes something else of a scene than its texts. */
  async change(id: string, change: Partial<r.SceneRecord>): Promise<void> {
    const known = await this.store.scene(id);
    await this.store.write(id, (old) => {
      const base = old ?? known;
      return base ? { scene: { ...base, ...change } } : null;
    });
    this.told(id);
  }
}
