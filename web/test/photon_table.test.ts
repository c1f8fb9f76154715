import assert from "node:assert/strict";
import { test } from "node:test";
import { photonTable } from "../src/photon_table";

test("photons are sorted by slot, and those of the first slot come again at the end", () => {
  // Four photons: of slots 2 and 0, one that met nothing, and another one of slot 2.
  const places = new Float32Array([1, 2, 3, 2, 4, 5, 6, 0, 0, 0, 0, -1, 7, 8, 9, 2]);
  const arrivals = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0]);
  const powers = new Float32Array([4, 2, 1, 0, 0.5, 0.25, 0, 0, 9, 9, 9, 0, 0, 0, 2, 0]);
  const table = photonTable([places, arrivals, powers], 4);
  assert.deepEqual([...table.starts], [0, 1, 1, 3, 3, 4]);
  assert.deepEqual([...table.places], [4, 5, 6, 0.5, 1, 2, 3, 4, 7, 8, 9, 2, 4, 5, 6, 0.5]);
  assert.deepEqual([...table.arrivals.subarray(8, 16)], [1, 0, 0, 0, 1, 0.5, 0.25, 0]);
  assert.deepEqual(table.arrivals.subarray(24, 32), table.arrivals.subarray(0, 8));
});

test("photons without power, and powers that are no numbers, are left out", () => {
  const places = new Float32Array(12);
  const powers = new Float32Array([0, 0, 0, 0, NaN, NaN, NaN, 0, Infinity, 1, 1, 0]);
  const table = photonTable([places, places, powers], 2);
  assert.deepEqual([...table.starts], [0, 0, 0, 0]);
  assert.equal(table.places.length, 4);
});
