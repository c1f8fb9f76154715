/**
 * How often each line runs, and its work: a program that counts is drawn once for each line, small.
 *
 * Input: the worker's counting program, a player. Output: counts of a line a pixel, on average and at
 * most, and their figures. They are those of the pixels that are drawn, for one view, camera, time and
 * values.
 */

import type { Counting } from "../generated/messages";
import type { Player } from "../player";
import { short, type Figure, type Figures } from "./costs";

/** The longer side of the drawing. */
const PIXELS = 64;

/** Counts of a line in a pixel. */
export interface Count {
  line: number;
  mean: number;
  most: number;
}

/** The size of a small picture as wide as the frame, for its height. */
export function sizeOf(player: Player, longer: number): [number, number] {
  const [wide, high] = player.payload.size;
  const scale = longer / Math.max(wide, high);
  return [Math.round(wide * scale) || 1, Math.round(high * scale) || 1];
}

/** The counts of all lines by file; null where the picture went away, or `isWanted` says so. */
export async function countsOf(
  counting: Counting,
  player: Player,
  isWanted: () => boolean,
): Promise<Map<string, Count[]> | null> {
  const size = sizeOf(player, PIXELS);
  const inputs = player.inputs(size);
  const found = new Map<string, Count[]>(counting.files.map((file) => [file, []]));
  for (const [number, [file, line]] of counting.places.entries()) {
    const bytes = await player.drawn(counting.program, { [counting.which]: number }, size, inputs);
    if (!bytes || !isWanted()) return null;
    let sum = 0;
    let most = 0;
    for (let i = 0; i < bytes.length; i += 4) {
      const count = bytes[i]! + 256 * bytes[i + 1]! + 65536 * bytes[i + 2]!;
      sum += count;
      most = Math.max(most, count);
    }
    found.get(counting.files[file]!)!.push({ line, mean: (4 * sum) / bytes.length, most });
  }
  return found;
}

/** The figures of runs; the bars are those of the logarithms. */
export function runFigures(counts: Map<string, Count[]>): Figures {
  const bar = (mean: number, most: number) => Math.log1p(mean) / Math.log1p(Math.max(most, 1));
  return figuresOf(counts, bar, ({ mean, most }) => {
    return `Runs ${short(mean)} times a pixel on average, ${most.toLocaleString("en")} at most`;
  });
}

/** The figures of work. */
export function workFigures(counts: Map<string, Count[]>, limit: number): Figures {
  const bar = (mean: number, most: number) => mean / Math.max(most, 1);
  return figuresOf(counts, bar, ({ mean, most }) => {
    const highest = `${most.toLocaleString("en")}${most < limit ? "" : " or more"}`;
    return mean === 0
      ? "Computes nothing for a pixel: what is the same for all pixels is computed once a frame"
      : `About ${short(mean)} operations a pixel with what it calls, ${highest} at most (an estimate)`;
  });
}

function figuresOf(
  counts: Map<string, Count[]>,
  bar: (mean: number, most: number) => number,
  hint: (count: Count) => string,
): Figures {
  const most = Math.max(0, ...[...counts.values()].flat().map(({ mean }) => mean));
  const figure = (count: Count): Figure => {
    return { line: count.line, text: short(count.mean), hint: hint(count), share: bar(count.mean, most) };
  };
  return new Map([...counts].map(([file, all]) => [file, all.map(figure)]));
}
