import assert from "node:assert/strict";
import { test } from "node:test";

import { cellsOf } from "../src/print/cells";
import { placed } from "../src/print/files";
import { sliced } from "../src/print/slices";

const COUNTS = [4, 3, 3];
const INSIDE = 1 + COUNTS[0]! * (1 + COUNTS[1]!);

function found(change: Record<number, number>) {
  const values = new Float32Array(36).fill(1);
  for (const [at, value] of Object.entries(change)) values[+at] = value;
  return sliced(cellsOf(values, COUNTS, 0.5), new AbortController().signal);
}

test("one point inside is a corner of eight cells", async () => {
  const { place, mask, at } = await found({ [INSIDE]: -1 });
  // The point is the highest corner of the first cell and the lowest of the last.
  assert.deepEqual(mask, [128, 64, 32, 16, 8, 4, 2, 1]);
  assert.deepEqual(place, [0, 1, 4, 5, 12, 13, 16, 17]);
  assert.equal(at[INSIDE], 7);
  assert.deepEqual((await found({ [INSIDE]: -0 })).mask, []);
});

test("a value that is no number and a surface beyond the lattice are refused", async () => {
  for (const value of [NaN, Infinity, -Infinity]) {
    await assert.rejects(found({ [INSIDE]: value }), { message: "A value is no number." });
  }
  for (const at of [0, 3, INSIDE - 1, INSIDE + 2, INSIDE - 4, INSIDE + 4, INSIDE - 12, INSIDE + 12]) {
    await assert.rejects(found({ [at]: -1 }), { message: "The surface leaves its box." });
  }
});

test("a part stands on the bed, z up, its middle at the origin", () => {
  const { points, sides } = placed([1, 2, 3, 0, 2, 4, 7, 0], 10);
  assert.deepEqual([...points], [-5, 20, 0, 5, -20, 20]);
  assert.deepEqual(sides, [10, 40, 20]);
});

test("work that is stopped throws the reason of its signal", async () => {
  const stop = new AbortController();
  function* endless(): Generator<unknown, never> {
    for (;;) yield;
  }
  const work = sliced(endless(), stop.signal);
  stop.abort(new Error("stopped"));
  await assert.rejects(work, { message: "stopped" });
});
