import assert from "node:assert/strict";
import { test } from "node:test";

import { NOTHING_COVERED, frameOn } from "../src/framing";

test("a canvas of the author's shape is the frame", () => {
  const found = frameOn(640, 480, NOTHING_COVERED, 4 / 3);
  assert.deepEqual(found, { size: [640, 480], offset: [0, 0] });
});

test("a wide canvas keeps the height and shows more at the sides", () => {
  const found = frameOn(1600, 480, NOTHING_COVERED, 4 / 3);
  assert.deepEqual(found, { size: [1600, 480], offset: [0, 0] });
});

test("a portrait canvas keeps the author's width, in the middle", () => {
  const found = frameOn(390, 844, NOTHING_COVERED, 4 / 3);
  assert.deepEqual(found, { size: [390, 293], offset: [0, 276] });
});

test("the frame lies in the middle of what nothing covers", () => {
  const covered = { left: 0, right: 0.25, top: 0, bottom: 0.1 };
  const found = frameOn(1280, 800, covered, 4 / 3);
  assert.deepEqual(found, { size: [960, 720], offset: [0, 80] });
  const narrow = frameOn(390, 844, { ...covered, right: 0, bottom: 0.5 }, 4 / 3);
  assert.equal(narrow.offset[1] + narrow.size[1] / 2, 422 + 211 + 0.5);
});

test("a quarter of each side stays, whatever covers it", () => {
  const covered = { left: 0, right: 2, top: 0, bottom: 0.9 };
  const found = frameOn(400, 400, covered, 1);
  assert.deepEqual(found.size, [100, 100]);
});
