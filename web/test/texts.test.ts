import assert from "node:assert/strict";
import { test } from "node:test";
import { cameraOf, pythonOf } from "../src/code";
import type { Guided } from "../src/guide";
import { complaints } from "../src/lines";
import type { Parameter } from "../src/payload";
import { fileName } from "../src/taking";

function parameter(name: string, kind: Parameter["kind"], fallback: Parameter["default"]): Parameter {
  const rest = { low: 0, high: 9, step: null, log: false, group: "", help: "" };
  return { name, label: name, kind, default: fallback, options: ["matt", 'so "shiny"'], ...rest };
}

const PARAMETERS = [
  parameter("softness", "slider", 0.3),
  parameter("count", "integer", 3),
  parameter("soft", "toggle", false),
  parameter("finish", "choice", 0),
  parameter("tint", "color", [1, 1, 1]),
  parameter("sun", "point", [1, 2, 3]),
];

test("what differs from the defaults is said, as Python", () => {
  const values = {
    ...{ softness: 0.3, count: 5, soft: true, finish: 1 },
    ...{ tint: [1, 0, 0], sun: [0.5, -1, 2] },
  };
  const code = pythonOf(PARAMETERS, values, 0, "color", null);
  assert.equal(
    code,
    'params={"count": 5, "soft": True, "finish": "so \\"shiny\\"", "tint": "#ff0000", ' +
      '"sun": (0.5, -1, 2)}',
  );
});

test("an untouched scene says no more than that", () => {
  const values = Object.fromEntries(PARAMETERS.map((p) => [p.name, p.default]));
  assert.equal(pythonOf(PARAMETERS, values, 0, "color", null), "params={}");
});

test("a color that no hexadecimal says stays linear; time, view and camera are said where they are not the first", () => {
  const [tint] = [PARAMETERS[4]!];
  const steering = { yaw: 0.123456, pitch: 0, zoom: 0.5, pan: [0, -1] as [number, number] };
  assert.equal(
    pythonOf([tint], { tint: [0.1, 0.2, 0.3] }, 1.23456, "normal", steering),
    'params={"tint": (0.1, 0.2, 0.3)}, time=1.235, view="normal", ' +
      "steering=distal.Steering(yaw=0.1235, zoom=0.5, pan=(0, -1))",
  );
});

test("drivers' complaints are told in the author's lines", () => {
  const lines: [number, number, number, number][] = [
    [10, 12, 0, 42],
    [14, 14, 1, 7],
  ];
  const files = ["scene.py", "shapes.py"];
  const places = (log: string) => complaints(log, lines, files).map(({ place }) => place);
  assert.deepEqual(places("ERROR: 0:11: 'foo' : undeclared identifier\n"), ["scene.py:42"]);
  assert.deepEqual(places("0:14(5): error: no such function"), ["shapes.py:7"]);
  assert.deepEqual(places("0(12) : error C1008: undefined"), ["scene.py:42"]);
  assert.deepEqual(places("ERROR: 0:13: 'foo'\nERROR: too many uniforms\n\0"), ["", ""]);
  const [row] = complaints("  ERROR: 0:10: x \0", lines, files);
  assert.deepEqual(row, { place: "scene.py:42", text: "ERROR: 0:10: x" });
});

test("names of files are such on every disk", () => {
  assert.equal(fileName("a/b\\c: <d>?"), "a-b-c-d");
  assert.equal(fileName("Größe 3 normal"), "Größe-3-normal");
  assert.equal(fileName("../.."), "picture");
});

test("a camera has the arguments of its class, rounded to what can be seen", () => {
  const eye = { eyeX: 3.00001, eyeY: -0, eyeZ: 4, targetX: 0, targetY: 0, targetZ: 0 };
  const place = { ...eye, upX: 0, upY: 1, upZ: 0, opening: 40.04, height: 0.25 } as Guided;
  const points = "(3, 0, 4), (0, 0, 0)";
  const form = { name: "Camera", mirror: false, extent: "fov_deg" } as const;
  assert.equal(cameraOf(place, form), `Camera(${points}, fov_deg=40.04)`);
  assert.equal(cameraOf(place, { ...form, extent: "", mirror: true }), `Camera(${points}, mirrored=True)`);
  const flat = cameraOf({ ...place, upY: 0, upZ: 1 }, { ...form, extent: "height" });
  assert.equal(flat, `Camera(${points}, up=(0, 0, 1), height=0.25)`);
});
