import assert from "node:assert/strict";
import { test } from "node:test";
import { strToU8, zipSync } from "fflate";
import { packed, unpacked } from "../src/studio/scenes/archive";
import {
  MOST_VERSIONS,
  cleanName,
  fileNameOf,
  merged,
  nameOf,
  newId,
  renewed,
  thinned,
  uniqueName,
  type Origin,
  type SceneRecord,
} from "../src/studio/scenes/records";
import { earlierText, failureText, momentOf } from "../src/studio/scenes/wording";

const MINUTE = 60_000;
const HOUR = 60 * MINUTE;
const DAY = 24 * HOUR;
const NOW = Date.UTC(2026, 10, 28, 12);

const origin = (kind: Origin["kind"], ref = ""): Origin => ({ kind, ref, digest: "" });

function record(given: Partial<SceneRecord> = {}): SceneRecord {
  const files = { "a.py": "old" };
  const rest = { thumb: "t", from: origin("new"), created: 1, changed: 100, deleted: null };
  return { id: "x", name: "mine", main: "a.py", files, ...rest, ...given };
}

test("a scene is called after its example, its description or its file", () => {
  assert.equal(nameOf(origin("example", "sdfray_row"), "a.py", '"""No."""'), "sdfray row");
  assert.equal(nameOf(origin("link"), "a.py", '# note\n\n"""A planet cut open, with a ring. More.\n"""'), "A planet cut open, with a ring");
  assert.equal(nameOf(origin("link"), "a.py", "r'''\n  A 0.5 mm wall\n'''"), "A 0.5 mm wall");
  assert.equal(nameOf(origin("link"), "red_ball.py", "x = 1\n'''no'''"), "red ball");
  assert.equal(nameOf(origin("link"), "scene.py", '""""""'), "scene");
  assert.equal(nameOf(origin("file"), "my_part.py", '"""Other."""'), "my part");
  assert.equal(nameOf(origin("file"), "scene.py", '"""A lamp"""'), "A lamp");
  assert.equal(nameOf(origin("draft"), "planet.py", ""), "old draft planet");
});

test("names are one line, unique, and names of files", () => {
  assert.equal(cleanName("  a\n\u0000 b\u2028c "), "a b c");
  assert.ok(cleanName("word ".repeat(40)).length <= 60);
  assert.equal(uniqueName("a", ["b"]), "a");
  assert.equal(uniqueName("a", ["A", "a 2"]), "a 3");
  assert.equal(uniqueName("a 2", ["a 2"]), "a 3");
  assert.equal(fileNameOf("Größe: a/b 2"), "Größe-a-b-2");
  assert.match(newId(), /^[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$/);
});

test("the last ten versions stay, then one of ten minutes, of an hour, of a day; never more than fifty", () => {
  const each = (count: number, step: number) => Array.from({ length: count }, (_, i) => NOW - 1 - i * step);
  const kept = (times: number[]) => {
    const gone = new Set(thinned(times, NOW));
    return times.filter((at) => !gone.has(at));
  };
  assert.deepEqual(kept(each(10, 1)), each(10, 1));
  // Ten of the last seconds, and one older of the same ten minutes.
  assert.equal(kept(each(60, 1000)).length, 11);
  const hour = kept(each(59, MINUTE));
  assert.deepEqual(hour.slice(0, 10), each(10, MINUTE));
  assert.ok(hour.length > 13 && hour.length < 17, String(hour.length));
  const day = kept(each(24 * 6, 10 * MINUTE));
  assert.ok(day.length > 30 && day.length < 40, String(day.length));
  for (let h = 3; h < 23; h++) assert.ok(day.some((at) => Math.abs(NOW - at - h * HOUR) <= HOUR), `hour ${h}`);
  assert.equal(kept(each(500, DAY)).length, MOST_VERSIONS);
  // Whatever goes is older than what stays of its span: nothing new is lost for something old.
  assert.equal(kept(each(1000, 7 * MINUTE))[0], NOW - 1);
  assert.ok(kept(each(1000, 7 * MINUTE)).length <= MOST_VERSIONS);
  // A clock that was put back.
  assert.equal(kept([NOW + DAY, NOW]).length, 2);
});

test("the text that a page left is merged, and no text is lost", () => {
  const mine = record({ files: { "a.py": "mine" }, thumb: "" });
  const last = { scene: mine, base: 100, at: 200 };
  assert.deepEqual(merged(undefined, last), { scene: mine });
  assert.equal(merged(record({ files: { "a.py": "mine" }, changed: 150 }), last), null);
  // Nobody wrote since: it goes on, under the name that it has now.
  const next = merged(record({ name: "renamed" }), last)!;
  assert.deepEqual([next.scene.files, next.scene.name, next.scene.thumb, next.versions], [mine.files, "renamed", "t", []]);
  // Another tab wrote before: its text is a version.
  const between = merged(record({ changed: 150 }), last)!;
  assert.equal(between.scene.files["a.py"], "mine");
  assert.deepEqual(between.versions!.map(({ files, why }) => [files["a.py"], why]), [["old", "before replace"]]);
  // Another tab wrote later: ours is one.
  const later = record({ changed: 300 });
  const after = merged(later, last)!;
  assert.equal(after.scene, later);
  assert.deepEqual(after.versions!.map(({ files }) => files["a.py"]), ["mine"]);
  // It was deleted later: it stays deleted, with the text.
  const deleted = merged(record({ deleted: 250 }), last)!;
  assert.deepEqual([deleted.scene.deleted, deleted.versions!.length], [250, 1]);
});

test("all scenes go into an archive and come back", () => {
  const one = record({ name: "A/b", files: { "a.py": "import part", "part.py": "x = 'é'" }, values: { size: 2 }, time: 1.5 });
  const two = record({ name: "a-b", main: "b.py", files: { "b.py": "" } });
  const back = unpacked([["all.zip", packed([one, two])]]);
  assert.deepEqual(back, [
    { main: "a.py", name: "A/b", files: one.files, values: { size: 2 }, time: 1.5 },
    { main: "b.py", name: "a-b", files: two.files },
  ]);
});

test("files that others import are modules, and archives of strangers are bounded", () => {
  const bytes = (files: Record<string, string>) =>
    Object.entries(files).map(([name, text]) => [name, strToU8(text)] as [string, Uint8Array]);
  const files = { "a.py": "from part import x", "b.py": "import math, part as p\r\n", "part.py": "\uFEFFimport deep", "deep.py": "", "alone.py": "" };
  const found = unpacked(bytes(files)).map(({ main, files: own }) => [main, Object.keys(own).sort()]);
  assert.deepEqual(found, [
    ["a.py", ["a.py", "deep.py", "part.py"]],
    ["b.py", ["b.py", "deep.py", "part.py"]],
    ["alone.py", ["alone.py"]],
  ]);
  assert.deepEqual(unpacked(bytes({ "x.py": "import y", "y.py": "import x" })).length, 2);
  assert.equal(unpacked(bytes({ "b.py": "a\r\nb" }))[0]!.files["b.py"], "a\nb");
  assert.deepEqual(unpacked(bytes({ "picture.png": "x" })), []);
  assert.throws(() => unpacked([["x.zip", strToU8("no archive")]]), /x.zip is damaged/);
  const bomb = zipSync({ "a.py": new Uint8Array(60_000_000) }, { level: 9 });
  assert.throws(() => unpacked([["bomb.zip", bomb]]), /bomb.zip has more than/);
  const odd = zipSync({ "s/a.py": strToU8("1"), "../c.py": strToU8("2"), "s/scene.json": strToU8("{"), "__MACOSX/s/b.py": strToU8("") });
  assert.deepEqual(unpacked([["odd.zip", odd]]), [{ main: "a.py", files: { "a.py": "1" } }]);
});

test("times and refusals are said in a sentence", () => {
  const now = new Date(2026, 10, 28, 15, 4, 5);
  assert.equal(momentOf(now.getTime(), false, now), "today, 15:04");
  assert.equal(momentOf(now.getTime(), true, now), "today, 15:04:05");
  assert.equal(momentOf(new Date(2026, 1, 3, 9, 0).getTime(), false, now), "3 February, 09:00");
  assert.equal(momentOf(new Date(2025, 1, 3, 9, 0).getTime(), false, now), "3 February 2025, 09:00");
  const earlier = record({ changed: new Date(2026, 1, 3).getTime() });
  assert.equal(earlierText(earlier, now), "You changed this on 3 February: it is your scene “mine”.");
  const refused = (name: string) => failureText(Object.assign(new Error("no"), { name }));
  assert.match(refused("QuotaExceededError"), /^The browser's storage is full\. .*this tab only/);
  assert.match(refused("VersionError"), /newer version/);
  assert.match(refused("SecurityError"), /private window, or storage is blocked/);
});

test("what the database refused is the newer text there later, with its versions, whatever is written then", () => {
  const version = { scene: "x", at: 250, main: "a.py", files: { "a.py": "typed" }, why: "typed" } as const;
  const refused = { scene: record({ name: "new", files: { "a.py": "mine" }, changed: 300 }), versions: [version] };
  assert.deepEqual(renewed(undefined, refused), refused);
  const same = renewed(record({ files: { "a.py": "mine" } }), refused);
  assert.deepEqual([same.scene.name, same.versions], ["new", [version]]);
  const older = renewed(record(), refused);
  assert.deepEqual(older.scene, refused.scene);
  assert.deepEqual(older.versions?.map(({ files }) => files["a.py"]), ["old", "typed"]);
  const newer = renewed(record({ changed: 400 }), refused);
  assert.equal(newer.scene.files["a.py"], "old");
  assert.deepEqual(newer.versions?.map(({ files }) => files["a.py"]), ["typed", "mine"]);
});
