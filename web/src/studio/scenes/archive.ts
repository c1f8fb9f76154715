/**
 * Scenes as files: all of them in one archive, and back from archives and files.
 *
 * Input: records; the names and bytes of files. Output: an archive; scenes. A file that another one imports is
 * a module of it, not a scene. An archive is a stranger's: what it may unpack to is bounded.
 */

import { strFromU8, strToU8, unzipSync, zipSync } from "fflate";
import { cleanName, fileNameOf, poseOf, uniqueName, type Pose, type SceneRecord, type Texts } from "./records";

export interface Loaded extends Pose {
  name?: string;
  main: string;
  files: Texts;
}

const ABOUT = "scene.json";
const MOST_FILES = 5000;
const MOST_BYTES = 50_000_000;

export function packed(scenes: readonly SceneRecord[]): Uint8Array<ArrayBuffer> {
  const folders: string[] = [];
  const files: Record<string, Uint8Array> = {};
  for (const scene of scenes) {
    const folder = uniqueName(fileNameOf(scene.name), folders);
    folders.push(folder);
    const { name, main, created, changed } = scene;
    const about = { name, main, ...poseOf(scene), created, changed };
    files[`${folder}/${ABOUT}`] = strToU8(JSON.stringify(about, null, 1));
    for (const [file, text] of Object.entries(scene.files)) files[`${folder}/${file}`] = strToU8(text);
  }
  return zipSync(files) as Uint8Array<ArrayBuffer>;
}

/**
 * The scenes in files, of which some are archives.
 *
 * Raises an error with one sentence: a file is damaged, or too large.
 */
export function unpacked(files: readonly [name: string, bytes: Uint8Array][]): Loaded[] {
  const plain = files.filter(([name]) => name.endsWith(".py"));
  const archives = files.filter(([name]) => name.toLowerCase().endsWith(".zip"));
  return [...scenesOf(Object.fromEntries(plain)), ...archives.flatMap(([name, bytes]) => scenesIn(name, bytes))];
}

function scenesIn(archive: string, bytes: Uint8Array): Loaded[] {
  let count = 0;
  let size = 0;
  let entries: Record<string, Uint8Array>;
  try {
    entries = unzipSync(bytes, {
      filter({ name, originalSize }) {
        if (!/(^|\/)([^/\\]+\.py|scene\.json)$/.test(name) || /(^|\/)(__MACOSX|\.)/.test(name)) return false;
        size += originalSize;
        if (++count > MOST_FILES || size > MOST_BYTES) throw new RangeError();
        return true;
      },
    });
  } catch (error) {
    const why = error instanceof RangeError ? `has more than ${MOST_FILES} files or ${MOST_BYTES / 1e6} MB` : "is damaged";
    throw new Error(`${archive} ${why}.`);
  }
  const folders = new Map<string, Record<string, Uint8Array>>();
  for (const [path, data] of Object.entries(entries)) {
    const end = path.lastIndexOf("/") + 1;
    const folder = path.slice(0, end);
    folders.set(folder, { ...folders.get(folder), [path.slice(end)]: data });
  }
  return [...folders.values()].flatMap(scenesOf);
}

/** The scenes of one folder. */
function scenesOf(folder: Record<string, Uint8Array>): Loaded[] {
  const texts: Texts = {};
  for (const [name, bytes] of Object.entries(folder)) {
    if (name !== ABOUT) texts[name] = strFromU8(bytes).replace(/^\uFEFF/, "").replace(/\r\n?/g, "\n");
  }
  const about = aboutOf(folder[ABOUT]);
  if (about && Object.hasOwn(texts, about.main)) return [{ ...about, files: texts }];
  const imports = new Map(Object.entries(texts).map(([name, text]) => [name, importsOf(text, texts)]));
  const modules = new Set([...imports].flatMap(([name, others]) => [...others].filter((other) => other !== name)));
  const mains = Object.keys(texts).filter((name) => !modules.has(name));
  // Modules that import each other around have no first: each is one.
  return (mains.length ? mains : Object.keys(texts)).map((main) => {
    const names = new Set([main]);
    for (const name of names) for (const other of imports.get(name)!) names.add(other);
    return { main, files: Object.fromEntries([...names].map((name) => [name, texts[name]!])) };
  });
}

/** The files of a folder that a text imports. */
function importsOf(text: string, folder: Texts): Set<string> {
  const names = [...text.matchAll(/^[ \t]*(?:from[ \t]+\.?(\w+)|import[ \t]+([\w, \t]+))/gm)];
  const modules = names.flatMap(([, from = "", list = ""]) => [from, ...list.split(",")]);
  return new Set(modules.map((name) => `${name.trim().split(/\s/)[0]}.py`).filter((file) => Object.hasOwn(folder, file)));
}

/** What an archive of ours says of a scene; null where that is none of ours. */
function aboutOf(bytes: Uint8Array | undefined): Omit<Loaded, "files"> | null {
  if (!bytes) return null;
  try {
    const found = JSON.parse(strFromU8(bytes)) as Partial<Loaded> | null;
    if (typeof found?.main !== "string" || typeof found.name !== "string") return null;
    const { main, name } = found;
    return { main, ...(cleanName(name) && { name: cleanName(name) }), ...poseOf(found) };
  } catch {
    return null;
  }
}
