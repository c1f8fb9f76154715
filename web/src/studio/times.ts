/**
 * How long the GPU takes for each line: what the line computes is done once and several times.
 *
 * Input: the worker's program that repeats a line, a player. Output: milliseconds of a line with their
 * error, and their figures. The time of a line is the median of seven slopes, less that of the loop
 * alone; the error is half the distance of the second and the sixth.
 */

import type { LineTiming } from "../generated/messages";
import type { Program } from "../payload";
import type { Player } from "../player";
import { pause } from "../waiting";
import { short, type Figure, type Figures } from "./costs";
import { sizeOf } from "./counts";

const ROUNDS = 7;
const MOST_REPEATS = 256;
/** A measured drawing takes at least this long, or it is drawn several times. */
const CLEAR_MS = 4;
const MOST_DRAWS = 64;

/** The time of a line in a picture; null for what could not be measured at all. */
export interface LineTime {
  line: number;
  ms: number;
  error: number;
}

export interface Times {
  /** The whole picture, in milliseconds. */
  frame: number;
  size: [number, number];
  lines: Map<string, LineTime[]>;
}

export interface TimesEvents {
  isWanted(): boolean;
  /** What part of the lines is done. */
  progress(part: number): void;
}

/** Seconds of drawings of one program; null where the GPU went away. */
type Clock = (repeats: number) => Promise<number | null>;

/** The times of all lines by file; null where the picture went away, or nobody wants them any more. */
export async function timesOf(timing: LineTiming, player: Player, events: TimesEvents): Promise<Times | null> {
  const { places, files, repeats, evaluations } = timing;
  const whole = await scaleOf(timing, player);
  if (!whole) return null;
  const { size, draws, frame } = whole;
  const inputs = player.inputs(size);
  const lines = new Map<string, LineTime[]>(files.map((file) => [file, []]));
  const clock = (program: Program): Clock => {
    return async (count) => {
      if (!events.isWanted()) return null;
      const ms = await player.timed(program, { ...inputs, number: { ...inputs.number, [repeats]: count } }, size, draws);
      return ms === null ? null : ms / draws;
    };
  };
  for (const [number, [file, line]] of places.entries()) {
    const full = chosen(timing, number);
    const bare = chosen(timing, -2 - number);
    const found = await slopeOf(clock(full), clock(bare));
    player.forget(full);
    player.forget(bare);
    if (!found || !events.isWanted()) return null;
    const [ms, error] = [found.ms, found.error].map((value) => value / evaluations[number]!) as [number, number];
    lines.get(files[file]!)!.push({ line, ms, error });
    events.progress((number + 1) / places.length);
    await pause(0); // The page stays alive.
  }
  return { frame, size, lines };
}

/** The program that measures a place. */
function chosen({ program, choice }: LineTiming, number: number): Program {
  const fragment = program.fragment.replace(choice, choice.replace(/-1$/, String(number)));
  return { ...program, fragment };
}

/** The smallest picture that takes long enough, its draws, and milliseconds. */
async function scaleOf(timing: LineTiming, player: Player): Promise<{ size: [number, number]; draws: number; frame: number } | null> {
  const { program } = timing;
  const source = { ...program };
  const longest = Math.max(...player.payload.size);
  let size = sizeOf(player, Math.min(64, longest));
  const frameOf = async (draws: number) => {
    const found: number[] = [];
    for (let round = 0; round <= ROUNDS; round++) {
      const ms = await player.timed(source, player.inputs(size), size, draws);
      if (ms === null) return null;
      if (round) found.push(ms / draws); // The first compiles.
    }
    return median(found);
  };
  let frame = await frameOf(1);
  while (frame !== null && frame < CLEAR_MS && Math.max(...size) < longest) {
    size = sizeOf(player, Math.min(2 * Math.max(...size), longest));
    frame = await frameOf(1);
  }
  if (frame === null) return null;
  const draws = Math.min(Math.ceil(CLEAR_MS / Math.max(frame, 1e-3)), MOST_DRAWS);
  if (draws > 1) frame = await frameOf(draws);
  player.forget(source);
  return frame === null ? null : { size, draws, frame };
}

/** The milliseconds of one repetition, and their error. */
async function slopeOf(full: Clock, bare: Clock): Promise<{ ms: number; error: number } | null> {
  let many = 4;
  await full(1); // The first drawing compiles.
  await bare(1);
  for (;;) {
    const [once, several] = [await full(1), await full(many)];
    if (once === null || several === null) return null;
    if (several >= 2 * once || many >= MOST_REPEATS) break;
    many *= 4;
  }
  const slopes: number[] = [];
  for (let round = 0; round < ROUNDS; round++) {
    const all = [await full(many), await full(1), await bare(many), await bare(1)];
    if (all.some((ms) => ms === null)) return null;
    const [fullMany, fullOnce, bareMany, bareOnce] = all as number[];
    slopes.push((fullMany! - fullOnce! - bareMany! + bareOnce!) / (many - 1));
  }
  slopes.sort((a, b) => a - b);
  return { ms: median(slopes), error: (slopes.at(-2)! - slopes[1]!) / 2 };
}

function median(values: number[]): number {
  return values.sort((a, b) => a - b)[values.length >> 1]!;
}

/** The figures of times: parts of the picture's time. */
export function timeFigures({ frame, size, lines }: Times): Figures {
  const picture = `${size[0]} × ${size[1]} pixels`;
  const figure = ({ line, ms, error }: LineTime): Figure => {
    const spread = `${short(Math.max(ms, 0))} ms ± ${short(error)} ms`;
    if (ms <= error || ms <= 0) {
      const hint = `Not measurable: ${spread}, the error is not smaller than the time`;
      return { line, text: "–", hint, share: 0 };
    }
    const part = ms / frame;
    const hint = `${spread} of ${short(frame)} ms for ${picture}, with what it calls: ${percent(part)} ± ${percent(error / frame)}`;
    return { line, text: percent(part), hint, share: Math.min(part, 1) };
  };
  return new Map([...lines].map(([file, all]) => [file, all.map(figure)]));
}

function percent(part: number): string {
  return `${short(100 * part)} %`;
}
