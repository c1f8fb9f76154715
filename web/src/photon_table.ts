/**
 * Photons in the order of the slots of their cells, as `distal.runtime.photons` sorts them. Pure.
 *
 * Input: the texels of the pictures of `render.photons.DepositImage`. Output: the buffers that
 * `render.photons.gathered` reads, of one map.
 */

export interface PhotonTable {
  /** Place and brightness of each photon. */
  places: Float32Array;
  /** Of each, the direction to where it came from, and its color. */
  arrivals: Float32Array;
  /** The first photon of each slot, of one slot more that repeats the first one, and the end. */
  starts: Int32Array;
}

export function photonTable(
  [places, arrivals, powers]: readonly [Float32Array, Float32Array, Float32Array],
  slots: number,
): PhotonTable {
  const count = places.length / 4;
  const bright = new Float32Array(count);
  const starts = new Int32Array(slots + 2);
  for (let i = 0; i < count; i++) {
    const [red, green, blue] = [0, 1, 2].map((c) => Math.abs(powers[4 * i + c]!));
    const most = Math.max(red!, green!, blue!);
    const slot = places[4 * i + 3]!;
    // Of a photon that met nothing the slot is -1; NaN is not above 0.
    if (!(slot >= 0 && most > 0 && most < Infinity)) continue;
    bright[i] = most;
    starts[slot + 1]! += 1;
  }
  const again = starts[1]!;
  for (let slot = 0; slot < slots; slot++) starts[slot + 1]! += starts[slot]!;
  const kept = starts[slots]!;
  const total = kept + again;
  starts[slots + 1] = total;
  // One photon stands in tables without any, if of no slot: textures are never empty.
  const table = {
    places: new Float32Array(4 * Math.max(total, 1)),
    arrivals: new Float32Array(8 * Math.max(total, 1)),
    starts,
  };
  const next = starts.slice(0, slots);
  for (let i = 0; i < count; i++) {
    const most = bright[i]!;
    if (!most) continue;
    const at = next[places[4 * i + 3]!]!++;
    for (let c = 0; c < 3; c++) {
      table.places[4 * at + c] = places[4 * i + c]!;
      table.arrivals[8 * at + c] = arrivals[4 * i + c]!;
      table.arrivals[8 * at + 4 + c] = powers[4 * i + c]! / most;
    }
    table.places[4 * at + 3] = most;
  }
  table.places.copyWithin(4 * kept, 0, 4 * again);
  table.arrivals.copyWithin(8 * kept, 0, 8 * again);
  return table;
}
