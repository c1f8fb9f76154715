/**
 * Where scenes and their versions are stored: the browser's database; what it refuses, the page's memory.
 *
 * Input: changes, each a function of the record that is there. Output: records. Nothing is overwritten: who
 * writes sees in the same transaction what is there. A write that the database refuses stays in memory until one succeeds.
 */

import { openDB, type DBSchema, type IDBPDatabase } from "idb";
import { DELETED_MS, renewed, thinned, type Change, type SceneRecord, type Version } from "./records";

interface Schema extends DBSchema {
  scenes: { key: string; value: SceneRecord };
  versions: { key: [string, number]; value: Version };
}

type Database = IDBPDatabase<Schema>;

/** Makes of the record that is there what is written; null for nothing. */
export type Making = (old: SceneRecord | undefined, last: Version | undefined) => Change | null;

const NAME = "distal";
const VERSION = 1;
/** A browser that does not open its database within so long has none. */
const OPEN_MS = 4000;
/** Letters of all versions together. */
const MOST_LETTERS = 50_000_000;

export class Store {
  /** Called where a write is refused, and with null once one succeeds again. */
  onFailure: (error: Error | null) => void = () => {};
  #memory = new Memory();
  #database: Promise<Database> | null = null;

  /** Whether there is a database; why not, where there is none. */
  async open(): Promise<Error | null> {
    return this.#opened().then(
      () => null,
      (error: Error) => error,
    );
  }

  /** Whether some scene is in this page's memory only. */
  get isMissing(): boolean {
    return this.#memory.scenes.size > 0;
  }

  /** The scenes that are in this page's memory only. */
  get missing(): SceneRecord[] {
    return [...this.#memory.scenes.values()];
  }

  async all(): Promise<SceneRecord[]> {
    const stored = await this.#try((database) => database.getAll("scenes"), []);
    const own = this.#memory.scenes;
    return [...stored.filter(({ id }) => !own.has(id)), ...own.values()];
  }

  async scene(id: string): Promise<SceneRecord | undefined> {
    return this.#memory.scenes.get(id) ?? (await this.#try((database) => database.get("scenes", id), undefined));
  }

  /** A scene's versions, the newest first. */
  async versions(id: string): Promise<Version[]> {
    const stored = await this.#try((database) => database.getAll("versions", rangeOf(id)), []);
    const own = this.#memory.versions.filter(({ scene }) => scene === id);
    return [...stored, ...own].sort((a, b) => b.at - a.at);
  }

  /** Writes a scene; what the database refuses stays in memory. Returns what was written. */
  async write(id: string, making: Making): Promise<SceneRecord | null> {
    const refused = this.#memory.refused(id);
    const whole: Making = (old, last) => {
      if (!refused) return making(old, last);
      const base = renewed(old, refused);
      const { versions = [] } = base;
      const change = making(base.scene, versions.at(-1) ?? last);
      return { scene: change?.scene ?? base.scene, versions: [...versions, ...(change?.versions ?? [])] };
    };
    try {
      const scene = await written(await this.#opened(), id, whole);
      if (refused) this.#memory.forget(refused);
      await this.#writeOthers();
      if (!this.isMissing) this.onFailure(null);
      return scene;
    } catch (error) {
      const scene = this.#memory.write(id, making);
      this.onFailure(error as Error);
      return scene;
    }
  }

  /** The database takes writes again: also of the scenes that it refused before. */
  async #writeOthers(): Promise<void> {
    for (const id of [...this.#memory.scenes.keys()]) {
      const refused = this.#memory.refused(id);
      if (!refused) continue;
      await this.#try(async (database) => {
        await written(database, id, (old) => renewed(old, refused));
        this.#memory.forget(refused);
      }, undefined);
    }
  }

  /** Removes what was deleted long ago, and the oldest versions where all are too many. */
  async tidy(now = Date.now()): Promise<void> {
    await this.#try(async (database) => {
      const transaction = database.transaction(["scenes", "versions"], "readwrite");
      const work = async () => {
        const scenes = transaction.objectStore("scenes");
        const versions = transaction.objectStore("versions");
        for (const { id, deleted } of await scenes.getAll()) {
          if (deleted === null || now - deleted < DELETED_MS) continue;
          await scenes.delete(id);
          await versions.delete(rangeOf(id));
        }
        const sizes: [number, [string, number], number][] = [];
        for (let at = await versions.openCursor(); at; at = await at.continue()) {
          const letters = Object.values(at.value.files).reduce((sum, text) => sum + text.length, 0);
          sizes.push([at.value.at, at.primaryKey, letters]);
        }
        let letters = 0;
        for (const [, key, size] of sizes.sort(([a], [b]) => b - a)) {
          letters += size;
          if (letters > MOST_LETTERS) await versions.delete(key);
        }
      };
      await Promise.all([work(), transaction.done]);
    }, undefined);
  }

  async #try<T>(act: (database: Database) => Promise<T>, fallback: T): Promise<T> {
    try {
      return await act(await this.#opened());
    } catch {
      return fallback;
    }
  }

  /** The database, opened again where the browser has closed it. */
  #opened(): Promise<Database> {
    this.#database ??= this.#begun();
    return this.#database;
  }

  #begun(): Promise<Database> {
    const ended = () => (this.#database = null);
    const opening = opened(ended);
    // One that opens late is used from then on; one that fails is tried again.
    opening.then(() => (this.#database = opening), ended);
    const late = new Promise<never>((_, reject) => {
      setTimeout(() => reject(new Error("the browser's database does not open")), OPEN_MS);
    });
    return Promise.race([opening, late]);
  }
}

async function opened(ended: () => void): Promise<Database> {
  return openDB<Schema>(NAME, VERSION, {
    upgrade(database) {
      database.createObjectStore("scenes", { keyPath: "id" });
      database.createObjectStore("versions", { keyPath: ["scene", "at"] });
    },
    blocking(_, __, event) {
      (event.target as IDBDatabase).close();
      ended();
    },
    terminated: ended,
  });
}

/** One write, in one transaction with what it depends on. */
async function written(database: Database, id: string, making: Making): Promise<SceneRecord | null> {
  const transaction = database.transaction(["scenes", "versions"], "readwrite");
  const work = async () => {
    const scenes = transaction.objectStore("scenes");
    const versions = transaction.objectStore("versions");
    const last = (await versions.openCursor(rangeOf(id), "prev"))?.value;
    const change = making(await scenes.get(id), last);
    if (!change) return null;
    await scenes.put(change.scene);
    let free = 0;
    for (const version of change.versions ?? []) {
      let at = Math.max(version.at, free);
      while (await versions.getKey([id, at])) at += 1;
      await versions.put({ ...version, at });
      free = at + 1;
    }
    if (change.versions?.length) {
      const keys = await versions.getAllKeys(rangeOf(id));
      const gone = thinned(keys.map(([, at]) => at), Date.now());
      for (const at of gone) await versions.delete([id, at]);
    }
    return change.scene;
  };
  const [scene] = await Promise.all([work(), transaction.done]);
  return scene;
}

function rangeOf(id: string): IDBKeyRange {
  return IDBKeyRange.bound([id, 0], [id, Infinity]);
}

/** What no database takes. */
class Memory {
  readonly scenes = new Map<string, SceneRecord>();
  versions: Version[] = [];

  write(id: string, making: Making): SceneRecord | null {
    const own = this.versions.filter(({ scene }) => scene === id);
    const change = making(this.scenes.get(id), own.at(-1));
    if (!change) return null;
    this.scenes.set(id, change.scene);
    for (const version of change.versions ?? []) {
      const at = Math.max(version.at, (own.at(-1)?.at ?? 0) + 1);
      own.push({ ...version, at });
    }
    const gone = new Set(thinned(own.map(({ at }) => at), Date.now()));
    this.versions = [...this.versions.filter(({ scene }) => scene !== id), ...own.filter(({ at }) => !gone.has(at))];
    return change.scene;
  }

  /** What was refused of a scene. */
  refused(id: string): Change | null {
    const scene = this.scenes.get(id);
    return scene ? { scene, versions: this.versions.filter((one) => one.scene === id) } : null;
  }

  /** Forgets what the database has taken since; what it refused meanwhile stays. */
  forget({ scene, versions = [] }: Change): void {
    if (this.scenes.get(scene.id) === scene) this.scenes.delete(scene.id);
    this.versions = this.versions.filter((one) => !versions.includes(one));
  }
}
