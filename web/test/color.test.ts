import assert from "node:assert/strict";
import { test } from "node:test";
import { hexOf, linearOf } from "../src/color";

test("every byte goes to linear light and back", () => {
  for (let byte = 0; byte < 256; byte++) {
    const hex = `#${byte.toString(16).padStart(2, "0").repeat(3)}`;
    assert.equal(hexOf(linearOf(hex)!), hex);
  }
});

test("the standard's values: middle grey, the knee, the ends", () => {
  const [grey] = linearOf("#808080")!;
  assert.ok(Math.abs(grey! - 0.2158605) < 1e-6);
  assert.ok(Math.abs(linearOf("#0a0a0a")![0]! - 10 / 255 / 12.92) < 1e-9);
  assert.deepEqual(linearOf("#fff"), [1, 1, 1]);
  assert.equal(hexOf([-1, 0.5, 2]), "#00bcff");
});

test("only colors are colors", () => {
  assert.deepEqual(linearOf(" f00 "), [1, 0, 0]);
  for (const text of ["", "#12", "#12345", "red", "#gggggg", "#1234567"]) {
    assert.equal(linearOf(text), null);
  }
});
