/**
 * The emitted text beside the code: whole lines are linked both ways.
 *
 * Input: a text with the places of its lines. Output: an element; the lines that come from a line of the
 * code are marked, and a press on one goes to its line.
 */

import { EditorState, StateEffect, StateField } from "@codemirror/state";
import { Decoration, EditorView, lineNumbers, type DecorationSet } from "@codemirror/view";
import { make } from "../dom";
import type { EmittedText } from "../generated/messages";

const mark = StateEffect.define<readonly [number, number][]>();
const marked = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(now, { effects, state }) {
    const found = effects.find((effect) => effect.is(mark));
    if (!found) return now;
    const line = Decoration.line({ class: "linked" });
    const numbers = (found.value as readonly [number, number][]).flatMap(([first, last]) => {
      const end = Math.min(last, state.doc.lines);
      return Array.from({ length: Math.max(end - Math.max(first, 1) + 1, 0) }, (_, i) => Math.max(first, 1) + i);
    });
    const known = [...new Set(numbers)];
    return Decoration.set(known.map((number) => line.range(state.doc.line(number).from)), true);
  },
  provide: (field) => EditorView.decorations.from(field),
});

export class Emitted {
  readonly element = make("div", { className: "emitted" });
  readonly menu = make("select", { "aria-label": "Target" });
  #view: EditorView;
  #text: EmittedText | null = null;

  constructor(
    nonce: string,
    readonly goTo: (file: string, line: number) => void,
    choose: (target: string) => void,
  ) {
    this.menu.onchange = () => choose(this.menu.value);
    this.#view = new EditorView({
      parent: this.element,
      state: EditorState.create({
        extensions: [
          EditorView.cspNonce.of(nonce),
          lineNumbers(),
          marked,
          EditorState.readOnly.of(true),
          EditorView.contentAttributes.of({ "aria-label": "Emitted text", "aria-readonly": "true", tabindex: "0" }),
          EditorView.updateListener.of((update) => {
            const isByHand = update.transactions.some((one) => one.isUserEvent("select"));
            if (!update.selectionSet || !isByHand || !this.#text) return;
            const { number } = update.state.doc.lineAt(update.state.selection.main.head);
            const place = this.#text.places.find(([first, last]) => first <= number && number <= last);
            if (place) this.goTo(this.#text.files[place[2]]!, place[3]);
          }),
        ],
      }),
    });
  }

  set targets(targets: readonly string[]) {
    const was = this.menu.value || "glsl-es300";
    this.menu.replaceChildren(...targets.map((name) => make("option", { value: name }, name)));
    this.menu.value = targets.includes(was) ? was : (targets[0] ?? "");
  }

  get target(): string {
    return this.menu.value || "glsl-es300";
  }

  show(text: EmittedText): void {
    this.#text = text;
    this.#view.dispatch({ changes: { from: 0, to: this.#view.state.doc.length, insert: text.text } });
  }

  /** Marks what comes from a line of the code, and shows the first of it. */
  link(file: string, line: number): void {
    const places = (this.#text?.places ?? []).filter(
      ([, , number, from]) => this.#text!.files[number] === file && from === line,
    );
    const ranges = places.map(([first, last]) => [first, last] as [number, number]);
    const effects: StateEffect<unknown>[] = [mark.of(ranges)];
    const { doc } = this.#view.state;
    if (ranges[0] && ranges[0][0] >= 1 && ranges[0][0] <= doc.lines) {
      effects.push(EditorView.scrollIntoView(doc.line(ranges[0][0]).from, { y: "center" }));
    }
    this.#view.dispatch({ effects });
  }
}
