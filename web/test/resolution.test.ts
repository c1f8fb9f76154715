import assert from "node:assert/strict";
import { test } from "node:test";
import { BAND_MS, Resolution } from "../src/resolution";

const FULL = 1280 * 720;

/** A GPU that takes so many milliseconds for a full picture; the scale after some frames on it. */
function settled(full_ms: number, frames = 60): number {
  const resolution = new Resolution();
  let scale = 1;
  for (let frame = 0; frame < frames; frame++) {
    scale = resolution.moving(FULL);
    const pixels = FULL * scale * scale;
    resolution.measure((full_ms * pixels) / FULL + 1.5, pixels);
  }
  return scale;
}

test("a fast GPU draws all pixels, a slow one fewer, the slowest still some", () => {
  assert.equal(settled(5), 1);
  assert.equal(settled(24), 0.75);
  assert.equal(settled(100), 0.35);
  assert.equal(settled(1e6), 0.125);
});

test("two scales do not take turns", () => {
  const resolution = new Resolution();
  const seen = new Set<number>();
  for (let frame = 0; frame < 200; frame++) {
    const scale = resolution.moving(FULL);
    const pixels = FULL * scale * scale;
    // Costs at a stair's very edge, with noise.
    resolution.measure((15 * pixels) / FULL + 1.5 + (frame % 2 ? 0.6 : -0.6), pixels);
    if (frame > 20) seen.add(scale);
  }
  assert.equal(seen.size, 1);
});

test("bands fit a submission, and are an even number of rows", () => {
  const resolution = new Resolution();
  resolution.measure(101.5, 1000); // 0.1 ms a pixel
  assert.equal(resolution.columns(100), BAND_MS / 10);
  assert.equal(resolution.columns(150), 2); // 2.7
  assert.equal(resolution.columns(1e6), 2);
});
