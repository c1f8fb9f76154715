/**
 * The triangles of a cell, unpacked.
 *
 * Input: what `src/distal/mesh/preview.py` packs: columns of whole numbers as differences, byte by byte.
 * Output: columns of numbers. Pure.
 */

import { inflated } from "../payload";

export interface Packed {
  /** The size of the mesh's box; its largest side is 1. */
  size: [number, number, number];
  /** How far above the mesh the camera is at first, in radians. */
  elevation: number;
  points: number;
  triangles: number;
  /** base64 of deflate. */
  data: string;
}

export interface Corners {
  places: Uint16Array[];
  normals: Int8Array[];
  /** Colors, by sRGB's curve. */
  codes: Uint8Array[];
  triangles: Uint32Array;
}

export async function unpacked({ points, triangles, data }: Packed): Promise<Corners> {
  const bytes = new Uint8Array(await inflated(data).arrayBuffer());
  let at = 0;
  const read = <T extends Uint8Array | Int8Array | Uint16Array | Uint32Array>(column: T): T => {
    const count = column.length;
    const width = column.BYTES_PER_ELEMENT;
    let sum = 0;
    for (let row = 0; row < count; row++) {
      for (let byte = 0; byte < width; byte++) sum += bytes[at + byte * count + row]! << (8 * byte);
      column[row] = sum; // What is beyond the range falls off.
      sum = column[row]!;
    }
    at += width * count;
    return column;
  };
  const three = <T>(make: () => T): T[] => [make(), make(), make()];
  return {
    places: three(() => read(new Uint16Array(points))),
    normals: three(() => read(new Int8Array(points))),
    codes: three(() => read(new Uint8Array(points))),
    triangles: read(new Uint32Array(3 * triangles)),
  };
}
