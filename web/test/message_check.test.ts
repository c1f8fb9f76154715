import assert from "node:assert/strict";
import { test } from "node:test";
import { faultOf } from "../src/studio/message_check";

const reply = { id: 1, revision: 2 };
const place = { file: "a.py", line: 1, start: 0, end: 1 };
const uniform = { name: "r", uniform: "u0", type: "float", origin: "number", default: 1 };
const program = {
  ...{ vertex: "v", fragment: "f", uniforms: [uniform], textures: [], buffers: [], trust: {} },
  ...{ lines: [[1, 2, 0, 3]], vertex_lines: [] },
};
const parameter = {
  ...{ name: "size", label: "Size", kind: "slider", default: 0.5, low: 0, high: 1, step: null },
  ...{ log: false, group: "", help: "", options: [] },
};
const mistake = {
  ...{ severity: "error", code: "", message: "m", hint: null, file: null, line: null, column: null },
  ...{ end_line: null, end_column: null, excerpt: null, labels: [] },
};
const literal = {
  ...{ ...place, text: "1", type: "number", value: 1, parts: [[0, 1]], call: "", slot: "", low: null, high: 2 },
  ...{ step: 0.1, whole: false, options: [], way: "numbers" },
};
const shape = { ...place, name: "a", label: true, material: "" };
const texture = { type: "Texture2D", size: [2, 1], components: 3, format: "rgba8", data: "AAAAAAAA" };
const payload = {
  ...{ format: 1, name: "a", description: "", size: [4, 3], embed: true, panel: false, view: "color" },
  steering: { elevation: 0, guide: -1, camera: { name: "Camera", mirror: false, extent: "height" } },
  time: { start: 0, duration: null, animated: false },
  parameters: [parameter],
  values: { size: 0.25 },
  views: [{ name: "color", label: "Color", program: 0 }],
  poster: null,
  files: ["a.py"],
  programs: { encoding: "plain", data: [program] },
  resources: { t: texture },
};
const found = { ...reply, key: "k", literals: [literal], shapes: [shape], edits: [], ms: { all: 1 } };
const edit = { file: "a.py", start: 0, end: 1, text: "" };
const answer = (request: string, result: object) => ({ kind: "answer", ...reply, request, result });

const GOOD: Record<string, unknown>[] = [
  { kind: "ready", abilities: ["look"], versions: { distal: "1" }, targets: [], formats: [] },
  { kind: "scene", ...found, payload, objects: ["a"], held: null },
  { kind: "numbers", ...found, numbers: { r: 1, m: [[1, 0], [0, 1]] }, parameters: [parameter] },
  { kind: "mistakes", ...reply, mistakes: [mistake], literals: null, edits: [edit] },
  { kind: "dropped", ...reply },
  { kind: "printed", ...reply, text: "", hangs: "" },
  { kind: "progress", ...reply, done: 0.5, label: "", text: "", remaining_s: null },
  answer("write", { edits: [edit] }),
  answer("count", { program, which: "w", most: 1, files: [], places: [[0, 1]] }),
  answer("map", { program, files: ["a.py"], parts: [[[0, 1]]] }),
  answer("text", { target: "wgsl", language: "wgsl", text: "", files: [], places: [[1, 2, 0, 3]] }),
  answer("check", { mistakes: [] }),
];

/** Each place of a value, as the value with another one there; `undefined` leaves it out. */
function* changed(value: unknown, other: unknown): Generator<[string, unknown]> {
  if (typeof value !== "object" || value === null) return;
  for (const [key, inner] of Object.entries(value)) {
    const copy = (with_: unknown) => {
      const made = Array.isArray(value) ? [...value] : { ...value };
      if (with_ === undefined && !Array.isArray(made)) delete (made as Record<string, unknown>)[key];
      else (made as Record<string, unknown>)[key] = with_;
      return made;
    };
    yield [key, copy(other)];
    for (const [path, made] of changed(inner, other)) yield [`${key}.${path}`, copy(made)];
  }
}

test("what a worker sends has no fault", () => {
  for (const message of GOOD) assert.equal(faultOf(message), null, JSON.stringify(message).slice(0, 200));
});

test("a missing field, a function's place, a nested value and an infinite number are faults", () => {
  // These may be left out, or hold anything, as they are declared.
  const free = /(^|\.)(guide|camera|versions\.distal|ms\.all|values\.size|numbers\.\w+|resources\.t)$/;
  let count = 0;
  for (const message of GOOD) {
    for (const other of [undefined, Infinity, { a: { b: [] } }, [[[[]]]], NaN]) {
      for (const [path, made] of changed(message, other)) {
        if (other === undefined && free.test(path)) continue;
        // An empty object is a record of anything.
        if (/(trust|resources|values|ms|versions|numbers)$/.test(path) && other !== undefined) continue;
        count += 1;
        assert.notEqual(faultOf(made), null, `${(message as { kind: string }).kind} ${path} = ${String(other)}`);
      }
    }
  }
  assert.ok(count > 1000, String(count));
});

test("names of prototypes are no kinds, requests or keys", () => {
  for (const kind of ["__proto__", "constructor", "toString", ["scene"], null, "changed", "restarted"]) {
    assert.equal(faultOf({ ...GOOD[1], kind }), "kind");
  }
  for (const request of ["__proto__", "constructor", "render "]) {
    assert.equal(faultOf(answer(request, {})), "answer.request");
  }
  const own = JSON.parse('{"__proto__": {"a": 1}}') as object;
  assert.equal(faultOf({ ...GOOD[1], ms: own }), "scene.ms");
});

test("what has the form but cannot be shown is named", () => {
  const scene = (change: object) => faultOf({ ...GOOD[1], payload: { ...payload, ...change } });
  const one = (change: object) => scene({ parameters: [{ ...parameter, ...change }] });
  assert.equal(scene({ size: [-1, 3] }), "scene.payload.size");
  assert.equal(scene({ size: [1e9, 3] }), "scene.payload.size");
  assert.equal(scene({ view: "depth" }), "scene.payload.views");
  assert.equal(scene({ views: [{ name: "color", label: "", program: 1 }] }), "scene.payload.views");
  assert.equal(scene({ parameters: [parameter, parameter] }), "parameters");
  for (const change of [{ low: null }, { low: 2 }, { step: -1 }, { log: true }, { default: [1] }, { kind: "color" }]) {
    assert.equal(one(change), "parameters[0]", JSON.stringify(change));
  }
  assert.equal(one({ kind: "choice", default: 0 }), "parameters[0]");
  for (const change of [{ size: [3, 1] }, { components: 9 }, { size: [] }, { data: "" }, { size: [1e9, 1e9] }]) {
    assert.equal(scene({ resources: { t: { ...texture, ...change } } }), "scene.payload.resources.t");
  }
  const typed = { ...program, uniforms: [{ ...uniform, type: "__proto__" }] };
  assert.equal(scene({ programs: { encoding: "plain", data: [typed] } }), "scene.payload.programs[0].uniforms[0]");
  assert.equal(faultOf({ ...GOOD[3], mistakes: [] }), "mistakes.mistakes");
});
