/**
 * What is stored of scenes: records, their names, which versions stay, which of two texts is the newer.
 *
 * Input: texts, names, times. Output: records and decisions about them. Nothing here stores or shows anything.
 */

import type { Values } from "../../payload";
import { fileName } from "../../taking";
import type { Shared } from "../links";

export type Texts = Record<string, string>;

/** What a scene began as: an example by its name, a link or texts by their digest. */
export interface Origin {
  kind: "example" | "link" | "new" | "file" | "draft" | "scene";
  ref: string;
  digest: string;
}

/** How the picture stands: what a person has moved. */
export interface Pose {
  values?: Values;
  camera?: Shared["camera"];
  time?: number;
}

export interface SceneRecord extends Pose {
  id: string;
  name: string;
  main: string;
  files: Texts;
  /** A small picture, as the address of its data. */
  thumb: string;
  from: Origin;
  created: number;
  /** When the texts were written last; grows with each write. */
  changed: number;
  /** When it was deleted; null for one that is there. */
  deleted: number | null;
}

export type Reason = "opened" | "typed" | "run" | "before replace" | "named";

export interface Version {
  scene: string;
  at: number;
  main: string;
  files: Texts;
  why: Reason;
}

/** What one write does. */
export interface Change {
  scene: SceneRecord;
  versions?: readonly Version[];
}

/** What the page had when it ended, and `changed` of the record that it began with. */
export interface LastTexts {
  scene: SceneRecord;
  base: number;
  at: number;
}

const MINUTE = 60_000;
const HOUR = 60 * MINUTE;
const DAY = 24 * HOUR;
/** A scene that was deleted is removed after so long. */
export const DELETED_MS = 30 * DAY;
export const MOST_VERSIONS = 50;
/** The newest versions all stay; of older ones, up to an age, one of each span. */
const NEWEST = 10;
const SPANS: readonly (readonly [age: number, span: number])[] = [
  [HOUR, 10 * MINUTE],
  [DAY, HOUR],
  [Infinity, DAY],
];
const LONGEST_NAME = 60;

/** What a record has of the picture. */
export function poseOf({ values, camera, time }: Pose): Pose {
  return { ...(values && { values }), ...(camera && { camera }), ...(time !== undefined && { time }) };
}

export function sameTexts(a: Texts, b: Texts): boolean {
  const names = Object.keys(a);
  return names.length === Object.keys(b).length && names.every((name) => a[name] === b[name]);
}

/** The times of the versions that go, of all times of a scene's versions. */
export function thinned(times: readonly number[], now: number): number[] {
  const newest = [...times].sort((a, b) => b - a);
  const spans = new Set<string>();
  const stays = newest.filter((at, i) => {
    if (i < NEWEST) return true;
    const [age, span] = SPANS.find(([limit]) => now - at < limit)!;
    const key = `${age}/${Math.floor(at / span)}`;
    return !spans.has(key) && spans.add(key);
  });
  const kept = new Set(stays.slice(0, MOST_VERSIONS));
  return times.filter((at) => !kept.has(at));
}

/** What to write of a text that the page left when it ended; null where nothing is to be written. */
export function merged(old: SceneRecord | undefined, last: LastTexts): Change | null {
  const { scene, base, at } = last;
  if (!old) return { scene };
  if (sameTexts(old.files, scene.files)) return null;
  const { files, main } = scene;
  const isNewer = old.changed === base || old.changed < at;
  if (!isNewer || (old.deleted ?? 0) > at) {
    return { scene: old, versions: [versionOf({ ...old, files, main }, "typed", at)] };
  }
  const versions = old.changed === base ? [] : [versionOf(old, "before replace", old.changed)];
  return { scene: { ...scene, name: old.name, thumb: old.thumb, changed: Math.max(at, old.changed + 1) }, versions };
}

/** What to write of a scene that the database refused before: the newer text, and the other as a version. */
export function renewed(old: SceneRecord | undefined, { scene, versions = [] }: Change): Change {
  if (!old) return { scene, versions };
  const isSame = sameTexts(old.files, scene.files);
  if (old.changed <= scene.changed) {
    return { scene, versions: isSame ? versions : [versionOf(old, "before replace", old.changed), ...versions] };
  }
  return { scene: old, versions: isSame ? versions : [...versions, versionOf(scene, "typed", scene.changed)] };
}

export function versionOf({ id, main, files }: SceneRecord, why: Reason, at: number): Version {
  return { scene: id, at, main, files, why };
}

// Names

/** The first name of a scene: its example's, or the first line of its description, or its file's. */
export function nameOf({ kind, ref }: Origin, main: string, text: string): string {
  if (kind === "example") return ref.replaceAll("_", " ");
  if (kind === "new") return "scene";
  if (kind === "draft") return `old draft ${main.replace(/\.py$/, "")}`;
  const stem = cleanName(main.replace(/\.py$/, "").replaceAll("_", " "));
  // A file's name was given by a person, unless it is everybody's.
  const isGiven = kind === "file" && stem !== "scene";
  return (!isGiven && cleanName(docstring(text))) || stem || "scene";
}

/** The first sentence of a module's docstring. */
function docstring(text: string): string {
  const found = /^\uFEFF?(?:[ \t]*(?:#.*)?\r?\n)*[rRuU]?("""|'''|"|')([\s\S]*?)\1/.exec(text);
  const [line = ""] = (found?.[2] ?? "").trim().split("\n");
  return line.replace(/(?<=[^.\d])[.:;](\s.*)?$/, "");
}

/** A name on one line, as long as a list can show. */
export function cleanName(name: string): string {
  const line = name.replace(/[\p{Cc}\p{Zl}\p{Zp}\s]+/gu, " ").trim();
  if ([...line].length <= LONGEST_NAME) return line;
  return [...line].slice(0, LONGEST_NAME).join("").replace(/\s+\S*$/, "");
}

/** A name that none of the others is. */
export function uniqueName(name: string, others: Iterable<string>): string {
  const taken = new Set([...others].map((other) => other.toLowerCase()));
  if (!taken.has(name.toLowerCase())) return name;
  const stem = name.replace(/ \d+$/, "");
  for (let number = 2; ; number++) {
    if (!taken.has(`${stem} ${number}`.toLowerCase())) return `${stem} ${number}`;
  }
}

/** The name of a scene's file, without an ending. */
export function fileNameOf(name: string): string {
  return fileName(name);
}

export async function digestOf(main: string, files: Texts): Promise<string> {
  const sorted = Object.entries(files).sort(([a], [b]) => (a < b ? -1 : 1));
  const bytes = new TextEncoder().encode(JSON.stringify([main, sorted]));
  // An address without encryption has no digests: nothing is recognized there.
  const hash = await crypto.subtle?.digest("SHA-256", bytes);
  return hash ? Array.from(new Uint8Array(hash), (byte) => byte.toString(16).padStart(2, "0")).join("") : "";
}

/** A scene that begins now, with no picture yet. */
export function fresh(from: Origin, main: string, files: Texts, pose: Pose = {}): SceneRecord {
  const now = Date.now();
  const name = nameOf(from, main, files[main]!);
  return { id: newId(), name, main, files, thumb: "", from, ...pose, created: now, changed: now, deleted: null };
}

export function newId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6]! & 0x0f) | 0x40;
  bytes[8] = (bytes[8]! & 0x3f) | 0x80;
  const hex = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})/, "$1-$2-$3-$4-");
}
