import assert from "node:assert/strict";
import { test } from "node:test";
import type { SourceLiteral } from "../src/generated/messages";
import { rangeOf, rounded } from "../src/studio/dial";

const literal = (given: Partial<SourceLiteral>) =>
  ({ low: null, high: null, step: 0.1, ...given }) as SourceLiteral;

test("a slider's ends are the literal's limits, or lie on both sides of the value", () => {
  assert.deepEqual(rangeOf(literal({ low: 0, high: 1 }), 0.5), [0, 1]);
  assert.deepEqual(rangeOf(literal({}), 0), [-10, 10]);
  assert.deepEqual(rangeOf(literal({}), 100), [-100, 300]);
  assert.deepEqual(rangeOf(literal({ low: 0 }), 0.5), [0, 10.5]);
  for (const value of [-1e6, -3, 0, 1e-9, 7, 1e6]) {
    for (const limits of [{}, { low: value }, { high: value }, { low: value - 1 }]) {
      const [low, high] = rangeOf(literal(limits), value);
      assert.ok(low <= value && value <= high && low < high, `${low} ${value} ${high}`);
    }
  }
});

test("values are multiples of the step, without dust", () => {
  assert.equal(rounded(0.30000000000000004, 0.1), 0.3);
  assert.equal(rounded(0.449, 0.05), 0.45);
  assert.equal(rounded(1234.4, 1), 1234);
  assert.equal(rounded(1234, 100), 1200);
  assert.equal(rounded(-0.07, 0.01), -0.07);
  assert.equal(rounded(1.0000001e-7, 1e-8), 1e-7);
});
