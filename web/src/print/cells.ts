/**
 * The topology of a mesh on a lattice: which points, edges, segments and triangles belong together.
 *
 * Input: the signs of the field at lattice points, the tables that `distal.mesh.tables` makes. Output:
 * integers and lattice points. It computes no place and knows nothing of WebGL.
 */

import { fail } from "./slices";

export const NO_NUMBER = "A value is no number.";

/** The tables in the order of `distal.mesh.printable.packed_tables`. */
export type Tables = readonly Int16Array[];

export const enum At {
  /** (256, 64): the case of a mask and the faces that are joined. */
  case,
  /** (256, 3): whether the upper face along each axis is ambiguous, by mask. */
  ambiguous,
  /** (cases): whether the regions of the case's components are separable. */
  separable,
  /** (cases, 12): the component of each edge. */
  component,
  /** (cases): how many components there are. */
  components,
  /** (cases, 3, 2, 2): the two edges of each segment on the upper face along each axis. */
  segments,
  /** (cases, 4): the corners at the ends of each component's edges. */
  regions,
  /** (256, 8, 4): planes around a region. */
  planes,
  /** (12, 2): the axis and the first corner of each edge. */
  edges,
  /** (4, 2): whether each cell around an edge is below it in u, and in v. */
  below,
  /** (3, 4): which of its edges the edge is for each of these cells. */
  inCell,
  /** (3, 12): which side of an edge a face is, by its normal. */
  sides,
  /** (3, 12): the edge that an edge of the upper face is in the next cell. */
  inNext,
}

export function tablesOf(lengths: readonly number[], numbers: Int16Array): Tables {
  let from = 0;
  return lengths.map((length) => numbers.subarray(from, (from += length)));
}

/** The cells with a change of sign: their masks and places, and where they are by lattice point. */
export interface Cells {
  /** From one lattice point to the next along each axis. */
  steps: readonly number[];
  /** From the lowest corner of a cell to each corner. */
  corners: readonly number[];
  /** The lattice point at the lowest corner of each cell. */
  place: number[];
  mask: number[];
  /** The number of the cell at each lattice point. */
  at: Int32Array;
  /** Lattice points close to the surface by their value that are corners of none of these cells. */
  near: number[];
}

/**
 * Finds the cells; throws where a value is no number, or where the surface leaves the lattice. `limit` is
 * how small a value is at a lattice point beside the surface.
 */
export function* cellsOf(
  values: Float32Array,
  counts: readonly number[],
  limit: number,
): Generator<unknown, Cells> {
  const [wide, high, deep] = counts as [number, number, number];
  const steps = [1, wide, wide * high];
  const total = wide * high * deep;
  const corners = Array.from({ length: 8 }, (_, i) => (i & 1) + ((i >> 1) & 1) * wide + (i >> 2) * steps[2]!);
  const at = new Int32Array(total).fill(-1);
  const place: number[] = [];
  const mask: number[] = [];
  for (let z = 0, i = 0; z < deep; z++) {
    for (let y = 0; y < high; y++) {
      for (let x = 0; x < wide; x++, i++) {
        const value = values[i]!;
        if (!(Math.abs(value) < Infinity)) fail(NO_NUMBER);
        const isLast = x === wide - 1 || y === high - 1 || z === deep - 1;
        if (value < 0 && (isLast || !(x && y && z))) fail("The surface leaves its box.");
        if (isLast) continue;
        let bits = 0;
        for (let corner = 0; corner < 8; corner++) {
          if (values[i + corners[corner]!]! < 0) bits |= 1 << corner;
        }
        if (bits === 0 || bits === 255) continue;
        at[i] = place.length;
        place.push(i);
        mask.push(bits);
      }
      yield;
    }
  }
  const near: number[] = [];
  for (let i = 0; i < total; i++) {
    if (!(i % wide)) yield;
    if (Math.abs(values[i]!) < limit && corners.every((corner) => !(at[i - corner]! >= 0))) near.push(i);
  }
  return { steps, corners, place, mask, at, near };
}

/** The ambiguous faces: for each the lattice point of the cell below it, and its axis. */
export function ambiguousFaces({ mask, place }: Cells, tables: Tables): number[] {
  const faces: number[] = [];
  mask.forEach((bits, cell) => {
    for (let axis = 0; axis < 3; axis++) {
      if (tables[At.ambiguous]![3 * bits + axis]) faces.push(place[cell]!, axis);
    }
  });
  return faces;
}

/** The case of each cell; `values` has four numbers for each ambiguous face, the first is that of its middle. */
export function casesOf(cells: Cells, tables: Tables, faces: number[], values: Float32Array): number[] {
  const { mask, at, steps } = cells;
  let inside = Array.from({ length: faces.length / 2 }, (_, i) => values[4 * i]! < 0);
  for (;;) {
    const joined = new Uint8Array(mask.length);
    const below = (i: number) => at[faces[2 * i]!]!;
    const above = (i: number) => at[faces[2 * i]! + steps[faces[2 * i + 1]!]!]!;
    inside.forEach((isInside, i) => {
      if (!isInside) return;
      joined[below(i)]! |= 2 << (2 * faces[2 * i + 1]!);
      joined[above(i)]! |= 1 << (2 * faces[2 * i + 1]!);
    });
    const cases = mask.map((bits, cell) => tables[At.case]![64 * bits + joined[cell]!]!);
    const isWrong = (cell: number) => !tables[At.separable]![cases[cell]!];
    if (!cases.some((_, cell) => isWrong(cell))) return cases;
    // A cell whose components would not be separable has no joined face.
    inside = inside.map((isInside, i) => isInside && !isWrong(below(i)) && !isWrong(above(i)));
  }
}

export interface Topology {
  /** Of each edge: its lower end and its axis. */
  edges: number[];
  /** The values at its ends. */
  values: number[];
  /** The points of the four cells around it, and the segments on its four sides. */
  around: Int32Array;
  sides: Int32Array;
  /** Of each point: the lowest corner of its cell, and its region if the cell has several points. */
  cells: number[];
  /** Its edges; -1 for none. */
  uses: Int32Array;
  /** Of each segment: the lowest corner of its face and its axis, plus 3 if several points share it. */
  faces: number[];
  /** The points below and above the face, the edges at which it ends. */
  ends: number[];
}

export function* topologyOf(
  cells: Cells,
  tables: Tables,
  cases: number[],
  field: Float32Array,
): Generator<unknown, Topology> {
  const { mask, at, place, steps, corners } = cells;
  const count = (cell: number) => tables[At.components]![cases[cell]!]!;
  const component = (cell: number, edge: number) => tables[At.component]![12 * cases[cell]! + edge]!;
  const first = new Int32Array(mask.length);
  // An edge belongs to the cell at its lower end.
  const own = new Int32Array(3 * mask.length);
  let points = 0;
  const edges: number[] = [];
  const values: number[] = [];
  for (const [cell, bits] of mask.entries()) {
    first[cell] = points;
    points += count(cell);
    for (let axis = 0; axis < 3; axis++) {
      if ((bits & 1) === ((bits >> (1 << axis)) & 1)) continue;
      own[3 * cell + axis] = edges.length / 2;
      const from = place[cell]!;
      edges.push(from, axis);
      values.push(field[from]!, field[from + steps[axis]!]!);
    }
    yield;
  }
  const around = new Int32Array(2 * edges.length);
  const sides = new Int32Array(2 * edges.length).fill(-1);
  const uses = new Int32Array(12 * points).fill(-1);
  const used = new Uint8Array(points);
  for (let edge = 0; 2 * edge < edges.length; edge++, yield) {
    const from = edges[2 * edge]!;
    const axis = edges[2 * edge + 1]!;
    for (let number = 0; number < 4; number++) {
      const [u, v] = tables[At.below]!.subarray(2 * number);
      const cell = at[from - u! * steps[(axis + 1) % 3]! - v! * steps[(axis + 2) % 3]!]!;
      const point = first[cell]! + component(cell, tables[At.inCell]![4 * axis + number]!);
      around[4 * edge + number] = point;
      uses[12 * point + used[point]!++] = edge;
    }
  }
  const rows: number[] = [];
  const faces: number[] = [];
  const ends: number[] = [];
  for (const [cell, from] of place.entries()) {
    const number = cases[cell]!;
    const several = count(cell) > 1;
    for (let i = 0; i < count(cell); i++) {
      rows.push(from, several ? tables[At.regions]![4 * number + i]! : 0);
    }
    const edgeOf = (edge: number) => {
      const [axis, bits] = tables[At.edges]!.subarray(2 * edge);
      return own[3 * at[from + corners[bits!]!]! + axis!]!;
    };
    for (let axis = 0; axis < 3; axis++) {
      const pairs = tables[At.segments]!.subarray(12 * number + 4 * axis);
      for (let i = 0; i < 4 && pairs[i]! >= 0; i += 2) {
        const a = pairs[i]!;
        const b = pairs[i + 1]!;
        const face = from + steps[axis]!;
        const upper = at[face]!;
        const one = edgeOf(a);
        const other = edgeOf(b);
        sides[4 * one + tables[At.sides]![12 * axis + a]!] = faces.length / 2;
        sides[4 * other + tables[At.sides]![12 * axis + b]!] = faces.length / 2;
        const shared = several || count(upper) > 1 || pairs[2]! >= 0;
        faces.push(face, axis + (shared ? 3 : 0));
        const next = component(upper, tables[At.inNext]![12 * axis + a]!);
        ends.push(first[cell]! + component(cell, a), first[upper]! + next, one, other);
      }
    }
    yield;
  }
  return { edges, values, around, sides, cells: rows, uses, faces, ends };
}

export interface Mesh {
  /** Four numbers for each point; the last one is not used. */
  places: number[];
  /** Of each triangle three points, counter-clockwise seen from outside, and its edge. */
  triangles: number[];
}

/**
 * The triangles around all edges.
 *
 * `points`, `kept` and `onFaces` have four numbers for each point, edge and segment; the last one of a
 * segment says whether the mesh needs its point. `diagonals` has four for each edge, the first one is
 * which diagonal splits its four points: 0, 1, or 2 for neither.
 */
export function* meshOf(
  { around, sides, values }: Topology,
  points: Float32Array,
  kept: Float32Array,
  onFaces: Float32Array,
  diagonals: Float32Array,
): Generator<unknown, Mesh> {
  const places = [...points];
  const triangles: number[] = [];
  const add = (rows: Float32Array, row: number) => places.push(...rows.subarray(4 * row, 4 * row + 4)) / 4 - 1;
  const numbers = new Int32Array(onFaces.length / 4);
  numbers.forEach((_, i) => (numbers[i] = onFaces[4 * i + 3]! ? add(onFaces, i) : -1));
  for (let edge = 0; 4 * edge < around.length; edge++, yield) {
    const isInside = values[2 * edge]! < 0;
    const put = (a: number, b: number, c: number) =>
      isInside ? triangles.push(a, b, c, edge) : triangles.push(c, b, a, edge);
    const corner = (i: number) => around[4 * edge + (i % 4)]!;
    const which = diagonals[4 * edge]!;
    const ring: number[] = [];
    for (let side = 0; side < 4; side++) {
      const middle = numbers[sides[4 * edge + side]!]!;
      ring.push(corner(side), ...(middle < 0 ? [] : [middle]));
    }
    if (ring.length === 4 && which < 2) {
      put(corner(which), corner(which + 1), corner(which + 2));
      put(corner(which), corner(which + 2), corner(which + 3));
    } else {
      const root = add(kept, edge);
      ring.forEach((point, i) => put(point, ring[(i + 1) % ring.length]!, root));
    }
  }
  return { places, triangles };
}
