import assert from "node:assert/strict";
import { test } from "node:test";
import type { Parameter } from "../src/payload";
import { shown } from "../src/numbers";
import { checked, positionCount, positionOf, valueAt } from "../src/values";

function slider(changes: Partial<Parameter>): Parameter {
  return {
    ...{ name: "a", label: "A", kind: "slider", default: 0, low: 0, high: 1, step: null, log: false },
    ...{ group: "", help: "", options: [] },
    ...changes,
  };
}

const SLIDERS: Record<string, Parameter> = {
  linear: slider({ low: -0.7, high: 1.3 }),
  tiny: slider({ low: 1e-7, high: 3e-7 }),
  wide: slider({ low: -1e6, high: 1e6 }),
  log: slider({ low: 0.001, high: 7, log: true }),
  "log in steps": slider({ low: 0.1, high: 10, step: 0.1, log: true }),
  stepped: slider({ low: 0.1, high: 0.9, step: 0.2 }),
  "a step that does not divide": slider({ low: 0, high: 1, step: 0.3 }),
  integer: slider({ kind: "integer", low: 1, high: 9, step: 1 }),
};

for (const [name, parameter] of Object.entries(SLIDERS)) {
  test(`${name}: the ends are exact, positions rise, values stay within`, () => {
    const count = positionCount(parameter);
    assert.equal(valueAt(parameter, 0), parameter.low);
    assert.equal(valueAt(parameter, count), parameter.high);
    assert.equal(positionOf(parameter, parameter.low!), 0);
    assert.equal(positionOf(parameter, parameter.high!), count);
    let last = -Infinity;
    for (let position = 0; position <= count; position++) {
      const value = valueAt(parameter, position);
      assert.ok(value >= last && value >= parameter.low! && value <= parameter.high!);
      last = value;
      if (!(parameter.log && parameter.step)) {
        const back = positionOf(parameter, value);
        assert.ok(Math.abs(back - position) < 0.51, `${position} came back as ${back}`);
      }
    }
  });
}

test("steps are the author's numbers, not sums of rounding errors", () => {
  const stepped = SLIDERS["stepped"]!;
  const values = [0, 1, 2, 3, 4].map((position) => valueAt(stepped, position));
  assert.deepEqual(values, [0.1, 0.3, 0.5, 0.7, 0.9]);
  const odd = SLIDERS["a step that does not divide"]!;
  assert.deepEqual([0, 1, 2, 3, 4].map((p) => valueAt(odd, p)), [0, 0.3, 0.6, 0.9, 1]);
});

test("a logarithmic slider stands in the middle for the geometric mean", () => {
  assert.equal(valueAt(slider({ low: 0.01, high: 100, log: true }), 100), 1);
});

test("values of another kind are refused, numbers are brought into range", () => {
  const integer = SLIDERS["integer"]!;
  assert.equal(checked(integer, 3.6), 4);
  assert.equal(checked(integer, 77), 9);
  for (const bad of [NaN, Infinity, "3", true, null, [1]]) assert.equal(checked(integer, bad), null);
  const toggle = slider({ kind: "toggle", default: true });
  assert.equal(checked(toggle, false), false);
  assert.equal(checked(toggle, 0), null);
  const color = slider({ kind: "color", default: [0, 0, 0] });
  assert.deepEqual(checked(color, [0.5, 2, -1]), [0.5, 1, 0]);
  assert.equal(checked(color, [0.5, 1]), null);
  const point = slider({ kind: "point", default: [0, 0] });
  assert.deepEqual(checked(point, [5, -7]), [5, -7]);
  assert.equal(checked(point, [1, NaN]), null);
  const choice = slider({ kind: "choice", default: 0, options: ["a", "b"] });
  assert.equal(checked(choice, 5), 1);
});

test("numbers are shown without the dust of binary fractions", () => {
  assert.equal(shown(0.1 + 0.2), "0.3");
  assert.equal(shown(1e-7), "1e-7");
  assert.equal(shown(-12345.678), "-12345.7");
});
