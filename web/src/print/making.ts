/**
 * Makes the mesh of a part: the passes in their order, and topology between them.
 *
 * Input: a player and what its payload has of a mesh. Output: a part, and how exact it is. Where points
 * are is computed by the programs of the page, which have the arithmetic of `distal.mesh`.
 */

import type { Player } from "../player";
import type { Given } from "../uniforms";
import { At, NO_NUMBER, ambiguousFaces, casesOf, cellsOf, meshOf, tablesOf, topologyOf } from "./cells";
import { placed, type Frame, type Part } from "./files";
import { runner, type Programs } from "./passes";
import { reached } from "./reach";
import { fail, sliced } from "./slices";

/** What a payload has of a mesh; `distal.export.printing` writes it. */
export interface Printing extends Programs {
  lengths: number[];
  /** The tables, 16-bit integers, deflated. */
  tables: string;
  /** The length of a scene unit in millimeters. */
  scale: number;
  frame: Frame;
  isSharp: boolean;
}

export interface Made extends Part {
  /** The largest distance that was measured, in millimeters. */
  error: number;
  /** How large it may be, in millimeters. */
  tolerance: number;
  /** Whether there are parts that are thinner than a cell, which the mesh lacks. */
  isThin: boolean;
}

/** By the numbers, from 1, of `distal.mesh.printable_lattice`. */
const PROBLEMS = [
  "The part has no end.",
  "The part is empty.",
  "Too many cells.",
  "Too far from the origin for so small cells.",
];

/** As many lattice points are followed to a surface that the mesh does not have. */
const MOST_FOLLOWED = 1 << 14;

export async function makes(
  player: Player,
  printing: Printing,
  detail: number,
  signal: AbortSignal,
  tell: (share: number) => void,
): Promise<Made> {
  const gl = floatContext()!;
  const { kit } = player.constructor as typeof Player;
  const numbers: Given = { Print_cells: detail };
  try {
    const run = await runner(gl, player, printing, numbers, signal, tell);
    const [begin, end, more] = (await run("plan", 1, {}, 3)) as [Float32Array, Float32Array, Float32Array];
    if (more[1]) fail(PROBLEMS[more[1] - 1]!);
    const step = begin[3]!;
    const counts = [...end.subarray(0, 3)];
    Object.assign(numbers, {
      Print_origin: [...begin.subarray(0, 3)],
      Print_step: step,
      Print_counts: counts,
      Print_margin: end[3],
      Print_tolerance: more[0],
    });
    const [field] = (await run("values", Math.ceil(more[2]! / 4))) as [Float32Array];
    const tables = tablesOf(printing.lengths, new Int16Array(await kit.inflated(printing.tables).arrayBuffer()));
    const found = await sliced(cellsOf(field, counts, more[3]!), signal);
    const { scale, isSharp } = printing;
    if (!found.mask.length) {
      fail(`Nothing is as thick as a cell, ${(step * scale).toPrecision(2)} mm.`);
    }
    // Some of them are enough: each looks at hundreds of values where it finds a surface.
    const every = Math.ceil(found.near.length / MOST_FOLLOWED);
    const followed = found.near.filter((_, i) => i % every === 0);
    const [lost] = (await run("lost", followed.length, { uses: followed })) as [Float32Array];
    const ambiguous = ambiguousFaces(found, tables);
    const [values] = (await run("middles", ambiguous.length / 2, { faces: ambiguous })) as [Float32Array];
    const cases = casesOf(found, tables, ambiguous, values);
    const topology = await sliced(topologyOf(found, tables, cases, field), signal);
    const { edges, around, cells, uses, faces, ends } = topology;
    const count = edges.length / 2;
    const given = { edges, values: topology.values };
    const [roots, kept, slopes] = (await run("roots", count, given, 3)) as [Float32Array, Float32Array, Float32Array];
    const on = { roots, kept, slopes };
    const regions = { cells, uses, planes: tables[At.planes]! };
    const [points] = (await run("points", cells.length / 2, { ...on, ...regions })) as [Float32Array];
    const last = await reached(run, found, topology, points, on);
    const [onFaces] = (await run("faces", faces.length / 2, { ...on, points: last, faces, ends })) as [Float32Array];
    const [diagonals] = (await run("diagonals", count, { roots, points: last, edges, around })) as [Float32Array];
    const mesh = await sliced(meshOf(topology, last, kept, onFaces, diagonals), signal);
    const rows = mesh.triangles.length / 4;
    const [misses] = (await run("misses", rows, { ...mesh, roots } as never)) as [Float32Array];
    const nearest = new Float32Array(count).fill(Infinity);
    let error = 0;
    for (let i = 0; i < misses.length; i += 4) {
      if (misses[i + 2]!) fail(NO_NUMBER);
      const edge = mesh.triangles[i + 3]!;
      error = Math.max(error, misses[i]!);
      nearest[edge] = Math.min(nearest[edge]!, misses[i + 3]!);
    }
    error = scale * nearest.reduce((most, miss) => Math.max(most, miss), error);
    const colored = isSharp ? rows : mesh.places.length / 4;
    const [codes] = "colors" in printing.programs ? await run("colors", colored, mesh as never) : [];
    return { ...mesh, ...placed(mesh.places, scale), codes, isSharp, error, isThin: lost.includes(1), tolerance: scale * more[0]! };
  } finally {
    drop(gl);
  }
}

/** A context that draws numbers of 32 bits, which a mesh is made of; undefined where there is none. */
export function floatContext(): WebGL2RenderingContext | undefined {
  const gl = self.OffscreenCanvas && new OffscreenCanvas(1, 1).getContext("webgl2");
  return gl?.getExtension("EXT_color_buffer_float") ? gl : undefined;
}

/** Gives the memory of a context back. */
export function drop(gl: WebGL2RenderingContext): void {
  gl.getExtension("WEBGL_lose_context")?.loseContext();
}
