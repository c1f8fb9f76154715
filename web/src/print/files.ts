/**
 * Files of a mesh: 3MF with colors and binary STL; millimeters, z up, on the bed.
 *
 * Input: a mesh in scene units, y up. Output: a blob. What is the same in every file stands in the
 * payload, where `distal.mesh.files` puts it.
 */

import type { Player } from "../player";
import type { Mesh } from "./cells";
import { through } from "./slices";

/** What is the same in every file. */
export interface Frame {
  /** The archive of a 3MF file before and after its model. */
  head: string;
  tail: string;
  /** Where its check sum and its sizes stand in both. */
  local: number;
  central: number;
  /** The model before colors, attributes, points and triangles, and after them. */
  model: string[];
  /** PrusaSlicer's attribute for each number of a filament from 1. */
  paints: string[];
  /** The first letters of an STL file. */
  stl: string;
}

/** Letters of a text, at least, that are handed on at once. */
const PIECE = 1 << 16;

export interface Part extends Mesh {
  /** Three numbers for each point, in millimeters; the sides of their box. */
  points: Float64Array;
  sides: number[];
  /** sRGB codes as one number, and three of no use, for each triangle or each point; undefined for no colors. */
  codes: ArrayLike<number> | undefined;
  isSharp: boolean;
}

/** The points z up, standing on 0 and centered; and the sides of their box. */
export function placed(places: number[], scale: number): Pick<Part, "points" | "sides"> {
  const points = new Float64Array((places.length / 4) * 3);
  const low = [Infinity, Infinity, Infinity];
  const high = low.map((x) => -x);
  for (let i = 0; i < points.length; i++) {
    const axis = i % 3;
    const row = ((i / 3) | 0) * 4;
    // (x, y, z) becomes (x, -z, y).
    const value = scale * (axis === 1 ? -places[row + 2]! : places[row + axis / 2]!);
    points[i] = value;
    low[axis] = Math.min(low[axis]!, value);
    high[axis] = Math.max(high[axis]!, value);
  }
  const origin = low.map((x, axis) => (axis === 2 ? x : (x + high[axis]!) / 2));
  points.forEach((x, i) => (points[i] = x - origin[i % 3]!));
  return { points, sides: low.map((x, axis) => high[axis]! - x) };
}

export function* stlOf({ points, triangles }: Part, { stl }: Frame): Generator<unknown, Blob> {
  const count = triangles.length / 4;
  const view = new DataView(new ArrayBuffer(50 * count));
  for (let i = 0; i < count; i++, yield) {
    // Normals stay 0: readers compute them from the corners.
    for (let j = 0; j < 9; j++) {
      const corner = triangles[4 * i + ((j / 3) | 0)]!;
      view.setFloat32(50 * i + 12 + 4 * j, points[3 * corner + (j % 3)]!, true);
    }
  }
  return new Blob([stl, Uint32Array.of(count), view]);
}

/** The archive around the text of a model. */
export async function archived(
  text: Blob,
  { head, tail, local, central }: Frame,
  bytesOf: typeof Player.kit.bytesOf,
): Promise<Blob> {
  const made = await through(text, new CompressionStream("gzip"));
  // Behind the data gzip has the check sum of the text and its length, as zip has before them.
  const end = made.byteLength - 8;
  const [sum, length] = new Uint32Array(made.slice(end));
  const around = [head, tail].map(bytesOf) as [Uint8Array<ArrayBuffer>, Uint8Array<ArrayBuffer>];
  const [first, last] = around.map(({ buffer }) => new DataView(buffer)) as [DataView, DataView];
  for (const [view, at] of [[first, local], [last, central]] as const) {
    [sum!, end - 10, length!].forEach((value, i) => view.setUint32(at + 4 * i, value, true));
  }
  last.setUint32(last.byteLength - 6, first.byteLength + end - 10, true);
  return new Blob([around[0], made.slice(10, end), around[1]]);
}

/** The model of a 3MF file. */
export function* modelOf(part: Part, { model, paints }: Frame): Generator<unknown, Blob> {
  const { points, triangles, codes, isSharp } = part;
  const pieces: string[] = [];
  let text = model[0]!;
  const cut = () => {
    if (text.length < PIECE) return;
    pieces.push(text);
    text = "";
  };
  const count = triangles.length / 4;
  const shades = (i: number) => [0, 1, 2].map((j) => codes![4 * (isSharp ? i : triangles[4 * i + j]!)]!);
  const uses = new Map<number, number>();
  for (let i = 0; codes && i < count; i++, yield) {
    for (const color of shades(i)) uses.set(color, (uses.get(color) ?? 0) + 1);
  }
  // The most frequent first: the color of the whole part, and the order of filaments.
  const colors = [...uses.keys()].sort((a, b) => uses.get(b)! - uses.get(a)!);
  const numbers = new Map(colors.map((color, i) => [color, i]));
  if (codes) {
    text += '<m:colorgroup id="1">';
    for (const color of colors) {
      text += `<m:color color="#${color.toString(16).padStart(6, "0").toUpperCase()}FF"/>`;
    }
    text += "</m:colorgroup>\n";
  }
  text += model[1]!;
  if (codes) text += ' pid="1" pindex="0"';
  text += model[2]!;
  for (let i = 0; i < points.length; i += 3, yield cut()) {
    const [x, y, z] = [0, 1, 2].map((axis) => +points[i + axis]!.toPrecision(9));
    text += `<vertex x="${x}" y="${y}" z="${z}"/>\n`;
  }
  text += model[3]!;
  for (let i = 0; i < count; i++, yield cut()) {
    const [a, b, c] = triangles.slice(4 * i, 4 * i + 4);
    text += `<triangle v1="${a}" v2="${b}" v3="${c}"`;
    if (colors.length > 1) {
      const [p, q, r] = shades(i).map((color) => numbers.get(color)!);
      const isOne = p === q && p === r;
      text += ` pid="1" p1="${p}"` + (isOne ? "" : ` p2="${q}" p3="${r}"`);
      if (isOne && colors.length <= paints.length) text += paints[p!];
    }
    text += "/>\n";
  }
  pieces.push(text + model[4]!);
  return new Blob(pieces);
}
