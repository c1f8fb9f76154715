/**
 * Creases that leave their cells: points and faces that reach into empty cells, as `distal.mesh.reach`.
 *
 * Input: topology and points, each in its own cell. Output: points; faces say how far they may be left.
 * A direction is 1, 2 or 3 for x, y or z, negative towards low ends; 0 is none.
 */

import type { Cells, Topology } from "./cells";
import type { Numbers, Run } from "./passes";

/** In place of the number of a cell that is given to a point beside it. */
const GIVEN = -2;
/** What a direction has less in the row of a cell, and three times more in that of a face. */
const IN_CELL = 4;
const IN_FACE = 5;

/** Some rows of numbers. */
function taken(numbers: Float32Array | Int32Array | number[], rows: number[], size: number): number[] {
  return rows.flatMap((row) => [...numbers.slice(size * row, size * row + size)]);
}

/**
 * Moves points, and marks the faces that they share.
 *
 * `on` are the roots. The fourth number of a point is more than 0 at a crease, and more than 1 at one
 * that leaves the cell.
 */
export async function reached(
  run: Run,
  found: Cells,
  { cells, uses, faces, ends }: Topology,
  points: Float32Array,
  on: Record<string, Numbers>,
): Promise<Float32Array> {
  const reach = new Int8Array(cells.length / 2);
  const leaving: number[] = [];
  const beside: number[] = [];
  const isAlone = (point: number, least = 0) => points[4 * point + 3]! > least && !cells[2 * point + 1];
  reach.forEach((_, point) => isAlone(point, 1) && leaving.push(point));
  for (let row = 0; 4 * row < ends.length; row++) {
    if (faces[2 * row + 1]! < 3 && isAlone(ends[4 * row]!) && isAlone(ends[4 * row + 1]!)) beside.push(row);
  }
  const inCells = async (rows: number[]) => {
    for (const row of rows) cells[2 * row + 1] = reach[row]! - IN_CELL;
    const given = { cells: taken(cells, rows, 2), uses: taken(uses, rows, 12), points: taken(points, rows, 4) };
    return (await run("points", rows.length, { ...on, ...given }))[0]!;
  };
  const wishes = await inCells(leaving);
  give(found, cells, reach, leaving.map((point, i) => [wishes[4 * i + 3]!, point]));
  const mark = (row: number, way: number) => (faces[2 * row + 1]! += 3 * (way + IN_FACE));
  for (const row of beside) mark(row, 0);
  const given = { points, faces: taken(faces, beside, 2), ends: taken(ends, beside, 4) };
  const [ways] = (await run("faces", beside.length, { ...on, ...given })) as [Float32Array];
  give(found, cells, reach, beside.map((row, i) => [ways[4 * i + 3]!, ends[4 * row]!, ends[4 * row + 1]!]));
  for (const row of beside) {
    faces[2 * row + 1]! %= 3;
    const way = reach[ends[4 * row]!]!;
    const isBeside = Math.abs(way) - 1 !== faces[2 * row + 1];
    if (way && way === reach[ends[4 * row + 1]!] && isBeside) mark(row, way);
  }
  const rows = leaving.concat(beside.flatMap((row) => [ends[4 * row]!, ends[4 * row + 1]!]));
  const moving = [...new Set(rows)].filter((point) => reach[point]);
  const moved = await inCells(moving);
  const last = points.slice();
  moving.forEach((point, i) => last.set(moved.subarray(4 * i, 4 * i + 4), 4 * point));
  return last;
}

/**
 * Gives cells without a change of sign to points beside them, each to one point at most: a way, and the
 * points that want it, all or none. The order of ways decides; within one, no two want the same cell.
 */
function give({ at, steps }: Cells, cells: number[], reach: Int8Array, wishes: number[][]): void {
  for (const [way, ...points] of wishes.sort((a, b) => a[0]! - b[0]!) as [number, ...number[]][]) {
    const target = (point: number) => cells[2 * point]! + Math.sign(way) * steps[Math.abs(way) - 1]!;
    const mayReach = (point: number) => reach[point] === way || (!reach[point] && at[target(point)] === -1);
    if (!way || !points.every(mayReach)) continue;
    for (const point of points) {
      reach[point] = way;
      at[target(point)] = GIVEN;
    }
  }
}
