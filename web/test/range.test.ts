import assert from "node:assert/strict";
import { test } from "node:test";

import { rangeOf } from "../src/range";

/** As `render.ranges.packed` packs a value. */
function packed(value: number): number[] {
  const part = (Math.sign(value) * Math.log2(1 + Math.abs(value) * 65536)) / 48;
  const code = Math.floor(8388608 + part * 8388607 + 0.5);
  return [code >> 16, (code >> 8) & 255, code & 255, 255];
}

function near(a: unknown, b: number): void {
  assert.ok(Math.abs((a as number) - b) <= 1e-4 * Math.max(1, Math.abs(b)), `${String(a)} ${b}`);
}

test("the ends are the 2nd and 98th percentile, the middle is the median", () => {
  const values = Array.from({ length: 101 }, (_, i) => i - 20);
  values.sort(() => 0.5 - Math.random());
  const found = rangeOf(new Uint8Array(values.flatMap(packed)));
  near(found["View_low"], -18);
  near(found["View_middle"], 30);
  near(found["View_high"], 78);
});

test("pixels without a value do not count, and too few values give no range", () => {
  const none = [0, 0, 0, 255];
  const few = [1, 2, 3, 4, 5, 6, 7].flatMap(packed);
  assert.deepEqual(rangeOf(new Uint8Array([...none, ...few])), {});
  const found = rangeOf(new Uint8Array([...none, ...few, ...packed(8)]));
  near(found["View_low"], 1);
  near(found["View_high"], 8);
});

test("equal values have a range that is not empty", () => {
  const found = rangeOf(new Uint8Array(Array(20).fill(packed(3)).flat() as number[]));
  assert.ok((found["View_low"] as number) < 3);
  assert.ok((found["View_high"] as number) > 3);
});
