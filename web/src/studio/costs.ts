/**
 * How often each line runs: a program that counts is drawn once for each line, small.
 *
 * Input: the worker's counting program, a player. Output: runs of a line a pixel, on average and at
 * most. They are exact at the pixels that are drawn, for this view, time and values.
 */

import { EditorView, GutterMarker, gutter } from "@codemirror/view";
import { RangeSet, StateEffect, StateField, type Extension } from "@codemirror/state";
import type { Counting } from "../generated/messages";
import { make } from "../dom";
import type { Player } from "../player";

/** The longer side of the drawing. */
const PIXELS = 64;

/** Runs of a line in a pixel. */
export interface Runs {
  line: number;
  mean: number;
  most: number;
}

/** The runs of all lines by file; null where the picture went away, or `isWanted` says so. */
export async function runsOf(
  counting: Counting,
  player: Player,
  isWanted: () => boolean,
): Promise<Map<string, Runs[]> | null> {
  const [wide, high] = player.payload.size;
  const scale = PIXELS / Math.max(wide, high);
  const size: [number, number] = [Math.round(wide * scale) || 1, Math.round(high * scale) || 1];
  const found = new Map<string, Runs[]>(counting.files.map((file) => [file, []]));
  for (const [number, [file, line]] of counting.places.entries()) {
    const bytes = await player.drawn(counting.program, { [counting.which]: number }, size);
    if (!bytes || !isWanted()) return null;
    let sum = 0;
    let most = 0;
    for (let i = 0; i < bytes.length; i += 4) {
      const runs = bytes[i]! + 256 * bytes[i + 1]! + 65536 * bytes[i + 2]!;
      sum += runs;
      most = Math.max(most, runs);
    }
    found.get(counting.files[file]!)!.push({ line, mean: (4 * sum) / bytes.length, most });
  }
  return found;
}

const setRuns = StateEffect.define<readonly Runs[]>();

class RunsMarker extends GutterMarker {
  constructor(
    readonly runs: Runs,
    readonly share: number,
  ) {
    super();
  }

  override eq(other: RunsMarker): boolean {
    return other.runs.mean === this.runs.mean && other.runs.most === this.runs.most && other.share === this.share;
  }

  override toDOM(): Node {
    const { mean, most } = this.runs;
    const title = `Runs ${short(mean)} times a pixel on average, ${most.toLocaleString("en")} at most`;
    const element = make("span", { className: "runs", title }, short(mean));
    element.style.setProperty("--share", `${Math.round(100 * this.share)}%`);
    return element;
  }
}

/** A number with three digits at most, where that is enough. */
export function short(value: number): string {
  if (value >= 1e6) return `${(value / 1e6).toPrecision(3)}M`;
  if (value >= 1e4) return `${(value / 1e3).toPrecision(3)}k`;
  if (value >= 100) return value.toFixed(0);
  return value === 0 ? "0" : String(+value.toPrecision(value < 1 ? 2 : 3));
}

const marks = StateField.define<RangeSet<RunsMarker>>({
  create: () => RangeSet.empty,
  update(now, transaction) {
    let set = now.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setRuns)) continue;
      const { doc } = transaction.state;
      const all = effect.value.filter(({ line }) => line <= doc.lines);
      const most = Math.max(...all.map(({ mean }) => mean), 1);
      const made = all.map((runs) => {
        const share = Math.log1p(runs.mean) / Math.log1p(most);
        return new RunsMarker(runs, share).range(doc.line(runs.line).from);
      });
      set = RangeSet.of(made, true);
    }
    return set;
  },
});

/** The editor's column of runs, which is there while it has something to show. */
export function costs(): Extension {
  return [marks, gutter({ class: "costs", markers: (view) => view.state.field(marks) })];
}

/** Shows the runs of the file in an editor; none takes the column away. */
export function showRuns(view: EditorView, runs: readonly Runs[]): void {
  view.dom.parentElement!.classList.toggle("counted", runs.length > 0);
  view.dispatch({ effects: setRuns.of(runs) });
}
