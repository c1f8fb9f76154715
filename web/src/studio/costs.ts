/**
 * The editor's column of costs: a figure and a bar for each line.
 *
 * Input: figures of the file that is shown. Output: a gutter of the editor. What a figure means, and
 * where it comes from, is in `counts.ts` and `times.ts`.
 */

import { EditorView, GutterMarker, gutter } from "@codemirror/view";
import { RangeSet, StateEffect, StateField, type Extension } from "@codemirror/state";
import { make } from "../dom";

/** What a line costs, as it is shown. */
export interface Figure {
  line: number;
  text: string;
  /** A sentence that explains the text. */
  hint: string;
  /** The length of the bar, from 0 to 1. */
  share: number;
}

/** The figures of all files by name. */
export type Figures = Map<string, Figure[]>;

/** So many of the longest bars are printed bold. */
const HOTTEST = 3;

const setFigures = StateEffect.define<readonly Figure[]>();

class CostMarker extends GutterMarker {
  constructor(
    readonly figure: Figure,
    readonly isHot: boolean,
  ) {
    super();
  }

  override eq(other: CostMarker): boolean {
    return other.isHot === this.isHot && JSON.stringify(other.figure) === JSON.stringify(this.figure);
  }

  override toDOM(): Node {
    const { text, hint, share } = this.figure;
    const element = make("span", { className: this.isHot ? "runs hot" : "runs", title: hint }, text);
    element.style.setProperty("--share", `${Math.round(100 * share)}%`);
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

const marks = StateField.define<RangeSet<CostMarker>>({
  create: () => RangeSet.empty,
  update(now, transaction) {
    let set = now.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setFigures)) continue;
      const { doc } = transaction.state;
      const all = effect.value.filter(({ line }) => line <= doc.lines);
      const shares = all.map(({ share }) => share).sort((a, b) => b - a);
      const least = Math.max(shares[HOTTEST - 1] ?? 0, 0.05);
      const made = all.map((figure) => {
        return new CostMarker(figure, figure.share >= least).range(doc.line(figure.line).from);
      });
      set = RangeSet.of(made, true);
    }
    return set;
  },
});

/** The editor's column of costs, which is there while costs are wanted. */
export function costs(): Extension {
  return [marks, gutter({ class: "costs", markers: (view) => view.state.field(marks) })];
}

/** Shows the figures of the file in an editor; null takes the column away. */
export function showFigures(view: EditorView, figures: readonly Figure[] | null): void {
  view.dom.parentElement!.classList.toggle("counted", figures !== null);
  view.dispatch({ effects: setFigures.of(figures ?? []) });
}
