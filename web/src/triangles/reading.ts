/**
 * The file of a picture as triangles: the reader of pages.
 *
 * Input: the bytes that `src/distal/triangles/stream.py` writes. Output: one row of numbers for each
 * triangle, as `drawing.ts` has it. The order of decisions is explained there.
 */

import {
  AREA_PX,
  CHROMA,
  CHROMA_SIGN,
  CHROMA_STEP,
  CHOICE,
  COARSEST,
  CORNER,
  CUT,
  FARTHER,
  FARTHER_SIGN,
  FINEST,
  GAP,
  HALVES,
  HEAD,
  LEAST_CUT_PX,
  LUMA,
  LUMA_SIGN,
  MOST_CUT_PX,
  MOST_SIDE,
  PLACE,
  PLACES,
  SAME,
  SIGNATURE,
  TILE,
  TILE_SIGN,
  USED,
} from "../generated/triangles";
import { NUMBER_CONTEXTS, RangeDecoder } from "./coder";

/** Corners (x, y of three), their codes (three of three), the cut's two places. */
export const ROW = 17;

export interface Triangles {
  width: number;
  height: number;
  /** `ROW` numbers for each triangle. */
  rows: Float32Array<ArrayBuffer>;
}

/** What one point needs: where it is, the ends of the side that it halves, the points that it needs. */
type Visit = (at: number, kind: number, ends: [number, number], parents: [number, number], near: number, level: number) => void;

export function read(bytes: Uint8Array): Triangles {
  const text = String.fromCharCode(...bytes.subarray(0, SIGNATURE.length));
  if (text !== SIGNATURE) throw new Error("This is no picture as triangles of this version.");
  const view = new DataView(bytes.buffer, bytes.byteOffset + SIGNATURE.length);
  const width = view.getUint16(0, true);
  const height = view.getUint16(2, true);
  const base = view.getUint8(4) / 4;
  if (!width || !height || width > MOST_SIDE || height > MOST_SIDE) throw new Error("The picture's size is wrong.");
  const coder = new RangeDecoder(bytes, HEAD);
  let side = 2;
  while (side < Math.min(width, height)) side *= 2;
  const rows = Math.ceil(height / side) * side;
  const columns = Math.ceil(width / side) * side;
  const stride = columns + 1;
  const used = new Uint8Array(stride * (rows + 1));
  for (let y = 0; y <= rows; y += side) for (let x = 0; x <= columns; x += side) used[y * stride + x] = 1;

  /** Visits all points that may be used, in the order of the file. */
  const each = (visit: Visit) => {
    let level = 0;
    for (let s = side; s > 1; s /= 2) {
      const h = s / 2;
      const one = (y: number, x: number, kind: number, end: number, first: number, second: number) => {
        const at = y * stride + x;
        if (!used[at + first] || !used[at + second]) return;
        let near = x >= s ? used[at - s]! : 0;
        if (y >= s) {
          near += used[at - s * stride]!;
          if (x + s < stride) near += used[at - s * stride + s]!;
        }
        visit(at, kind, [at - end, at + end], [at + first, at + second], near, level + kind);
      };
      const [down, right] = [h * stride, h];
      for (let y = h; y <= rows; y += s) {
        for (let x = h; x <= columns; x += s) {
          const way = (((y / s) | 0) + ((x / s) | 0)) % 2 ? -right : right;
          one(y, x, 0, down + way, way - down, down - way);
        }
      }
      for (let y = 0; y <= rows; y += s) {
        for (let x = h; x <= columns; x += s) one(y, x, 1, right, y ? -down : down, y < rows ? down : -down);
      }
      for (let y = h; y <= rows; y += s) {
        for (let x = 0; x <= columns; x += s) one(y, x, 1, down, x ? -right : right, x < columns ? right : -right);
      }
      level += 2;
    }
  };
  each((at, _kind, _ends, _parents, near, level) => {
    used[at] = coder.bit(USED + 4 * level + near);
  });

  // Triangles, depth first, and their cuts.
  const areas = new Float64Array(used.length);
  const found: number[][] = []; // corners in the cut's order, and its places
  const edges = new Map<number, number>();
  const edge = (a: number, b: number) => Math.min(a, b) * used.length + Math.max(a, b);
  const place = (known: number | undefined, number: number): number => {
    if (known !== undefined && known >= 0) {
      if (coder.bit(SAME)) return known;
      const far = coder.number(FARTHER) + 1;
      return known + (coder.bit(FARTHER_SIGN + known) ? far : -far);
    }
    let node = 1;
    while (node < PLACES) node = 2 * node + coder.bit(PLACE + PLACES * number + node);
    return node - PLACES;
  };
  const cut = (corners: [number, number, number], level: number): number[] => {
    const sides = corners.map((corner, k) => edge(corner, corners[(k + 1) % 3]!));
    const known = sides.map((key) => edges.get(key));
    let context = CUT + 16 * level;
    let pattern = CORNER;
    known.forEach((at, k) => {
      const state = at === undefined ? 0 : at < 0 ? 2 : 1;
      context += [0, 4, 1][state]!;
      pattern += 2 * 3 ** k * state;
      edges.set(sides[k]!, -1);
    });
    if (!coder.bit(context)) return [...corners, -1, -1];
    const first = coder.bit(pattern) ? 0 : coder.bit(pattern + 1) ? 1 : 2;
    const turned = [0, 1, 2].map((k) => corners[(first + k) % 3]!);
    const [corner] = turned as [number, number, number];
    const places = [0, 1].map((number) => {
      const other = turned[1 + number]!;
      const key = edge(corner, other);
      const at = place(known[sides.indexOf(key)], number);
      edges.set(key, at);
      return corner > other ? PLACES - 1 - at : at;
    });
    return [...turned, ...places];
  };
  const visit = (a: number, b: number, c: number, level: number): void => {
    if (Math.min(a, b, c) >= height * stride) return;
    if (Math.min(a % stride, b % stride, c % stride) >= width) return;
    const s = side / 2 ** (level >> 1);
    const middle = (a + b) / 2;
    if (s > 1 && used[middle]) {
      visit(c, a, middle, level + 1);
      return visit(b, c, middle, level + 1);
    }
    const area = (s * s) / (level % 2 ? 4 : 2);
    for (const corner of [a, b, c]) areas[corner]! += area;
    const pixels = Math.floor(area);
    const able = pixels >= LEAST_CUT_PX && pixels <= MOST_CUT_PX;
    found.push(able ? cut([a, b, c], level) : [a, b, c, -1, -1]);
  };
  for (let y = 0; y < rows; y += side) {
    for (let x = 0; x < columns; x += side) {
      for (const form of HALVES[((y + x) / side) % 2]!) {
        const [a, b, c] = form.map(([down, right]) => (y + down! * side) * stride + x + right! * side);
        visit(a!, b!, c!, 0);
      }
    }
  }

  // The codes of points.
  const codes = new Float64Array(3 * used.length);
  const size = (at: number, k: number) => {
    const step = base * Math.sqrt(AREA_PX / Math.max(areas[at]!, 0.25));
    return Math.min(COARSEST, Math.max(FINEST, step)) * (k ? CHROMA_STEP : 1);
  };
  for (let y = 0; y <= rows; y += side) {
    for (let x = 0; x <= columns; x += side) {
      const at = y * stride + x;
      const from = x ? at - side : at - side * stride;
      for (let k = 0; k < 3; k++) {
        const level = coder.signed(TILE + NUMBER_CONTEXTS * k, TILE_SIGN + k);
        codes[3 * at + k] = (at ? codes[3 * from + k]! : 0) + level * size(at, k);
      }
    }
  }
  const busy = new Uint8Array(used.length);
  each((at, kind, [a, b], [p, q]) => {
    if (!used[at]) return;
    const differs = (k: number) => Math.abs(codes[3 * a + k]! - codes[3 * b + k]!) / size(at, k);
    let [one, other] = [a, b];
    if (differs(0) + differs(1) + differs(2) > GAP) {
      const isMean = coder.bit(CHOICE + 2 * kind);
      if (!isMean && coder.bit(CHOICE + 2 * kind + 1)) other = a;
      else if (!isMean) one = b;
    }
    const near = Math.min(4, 31 - Math.clz32(busy[p]! + busy[q]! + 1));
    const luma = coder.signed(LUMA + (2 * near + kind) * NUMBER_CONTEXTS, LUMA_SIGN);
    const context = CHROMA + (Math.min(2, Math.abs(luma)) * 5 + near) * 3 * NUMBER_CONTEXTS;
    const way = 3 * (Math.sign(luma) + 1);
    const first = coder.signed(context, CHROMA_SIGN + way + 1);
    const further = context + (45 + Math.min(2, Math.abs(first))) * NUMBER_CONTEXTS;
    const second = coder.signed(further, CHROMA_SIGN + 9 + way + Math.sign(first) + 1);
    [luma, first, second].forEach((level, k) => {
      codes[3 * at + k] = (codes[3 * one + k]! + codes[3 * other + k]!) / 2 + level * size(at, k);
    });
    const most = Math.max(Math.abs(first), Math.abs(second));
    busy[at] = 1 + Math.min(15, Math.abs(luma)) + Math.min(15, most);
  });

  const table = new Float32Array(ROW * found.length);
  found.forEach((entry, number) => {
    const at = ROW * number;
    for (let k = 0; k < 3; k++) {
      const corner = entry[k]!;
      table[at + 2 * k] = corner % stride;
      table[at + 2 * k + 1] = Math.floor(corner / stride);
      table.set(codes.subarray(3 * corner, 3 * corner + 3), at + 6 + 3 * k);
    }
    table[at + 15] = entry[3]!;
    table[at + 16] = entry[4]!;
  });
  return { width, height, rows: table };
}
