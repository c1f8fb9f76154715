/**
 * The code: an editor with a state for each file, mistakes at their lines, marks of literals.
 *
 * Input: texts, mistakes, literals, edits. Output: what a person types. It knows no messages but the
 * records in them.
 */

import { defaultKeymap, history, historyKeymap, indentWithTab, isolateHistory } from "@codemirror/commands";
import { pythonLanguage } from "@codemirror/lang-python";
import {
  HighlightStyle,
  bracketMatching,
  foldKeymap,
  indentOnInput,
  indentUnit,
  syntaxHighlighting,
} from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics, type Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState, StateEffect, StateField, type Extension } from "@codemirror/state";
import {
  Decoration,
  EditorView,
  drawSelection,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
  type DecorationSet,
  type KeyBinding,
} from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Edit, Mistake, MistakeLabel, SourceLiteral } from "../generated/messages";
import { completion } from "./completion";
import { costs, showFigures, type Figure } from "./costs";
import { smallest } from "./edits";
import { literals, setLiterals, type Turning } from "./literals";
import { names } from "./names";
import { pairs } from "./pairs";

export interface EditorEvents extends Turning {
  /** A person changed a file's text. */
  typed(name: string, text: string): void;
  /** The caret is on another line, from 1. */
  moved(name: string, line: number): void;
  /** The mouse is over a line, or over none; or the caret went to one without a change of the text. */
  pointed(name: string, line: number | null, isMouse: boolean): void;
}

export const HIGHLIGHT = HighlightStyle.define([
  { tag: [tags.keyword, tags.operatorKeyword, tags.modifier], color: "var(--word)" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--text)" },
  { tag: [tags.comment, tags.docString], color: "var(--quiet)", fontStyle: "italic" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--number)" },
  { tag: [tags.definition(tags.variableName), tags.function(tags.definition(tags.variableName))], color: "var(--name)" },
  { tag: [tags.className, tags.meta], color: "var(--name)" },
]);

const setLinked = StateEffect.define<readonly number[]>();

/** Lines that another place points to. */
const linked = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(now, transaction) {
    let set = now.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setLinked)) continue;
      const { doc } = transaction.state;
      const lines = effect.value.filter((line) => line >= 1 && line <= doc.lines);
      const mark = Decoration.line({ class: "linked" });
      set = Decoration.set(lines.map((line) => mark.range(doc.line(line).from)), true);
    }
    return set;
  },
  provide: (field) => EditorView.decorations.from(field),
});

export class Editor {
  readonly view: EditorView;
  /** Whether nothing changes the texts: another tab edits them. */
  isReadOnly = false;
  #states = new Map<string, EditorState>();
  #name = "";
  #extensions: Extension;

  constructor(
    parent: HTMLElement,
    readonly events: EditorEvents,
    keys: readonly KeyBinding[],
    nonce: string,
  ) {
    this.#extensions = [
      EditorView.cspNonce.of(nonce),
      lineNumbers(),
      highlightActiveLineGutter(),
      lintGutter(),
      history(),
      drawSelection(),
      indentOnInput(),
      indentUnit.of("    "),
      syntaxHighlighting(HIGHLIGHT),
      bracketMatching(),
      pairs(),
      completion(),
      highlightActiveLine(),
      highlightSelectionMatches(),
      linked,
      costs(),
      pythonLanguage,
      literals(events),
      names(),
      keymap.of([
        ...keys,
        ...defaultKeymap,
        ...searchKeymap,
        ...historyKeymap,
        ...foldKeymap,
        ...lintKeymap,
        indentWithTab,
      ]),
      EditorState.changeFilter.of(() => !this.isReadOnly),
      EditorView.contentAttributes.of(() => ({
        "aria-label": "Code",
        "aria-readonly": String(this.isReadOnly),
        tabindex: "0",
      })),
      EditorView.updateListener.of((update) => {
        const { state } = update;
        if (update.docChanged) events.typed(this.#name, state.doc.toString());
        if (!update.selectionSet && !update.docChanged) return;
        const { number } = state.doc.lineAt(state.selection.main.head);
        if (!update.docChanged) events.pointed(this.#name, number, false);
        events.moved(this.#name, number);
      }),
      EditorView.domEventHandlers({
        mousemove: ({ clientX: x, clientY: y }, view) => {
          const at = view.posAtCoords({ x, y });
          events.pointed(this.#name, at === null ? null : view.state.doc.lineAt(at).number, true);
        },
        mouseleave: () => events.pointed(this.#name, null, true),
      }),
    ];
    this.view = new EditorView({ parent, state: this.#fresh("") });
  }

  get name(): string {
    return this.#name;
  }

  #fresh(text: string): EditorState {
    return EditorState.create({ doc: text, extensions: this.#extensions });
  }

  /** Shows a file; each has its own history and place. */
  show(name: string, text: string): void {
    if (name === this.#name) return this.replace(name, text);
    if (this.#name) this.#states.set(this.#name, this.view.state);
    this.#name = name;
    this.view.setState(this.#states.get(name) ?? this.#fresh(text));
    this.replace(name, text);
  }

  /** Takes the states of other files for those that are there; returns these. */
  exchange(states?: Map<string, EditorState>): Map<string, EditorState> {
    if (this.#name) this.#states.set(this.#name, this.view.state);
    const old = this.#states;
    this.#states = states ?? new Map();
    this.#name = "";
    return old;
  }

  /** Gives a file another text, as one step that can be undone. */
  replace(name: string, text: string): void {
    const state = name === this.#name ? this.view.state : this.#states.get(name);
    if (!state || state.doc.toString() === text) return;
    const changes = smallest(state.doc.toString(), text);
    if (name === this.#name) this.view.dispatch({ changes, annotations: isolateHistory.of("full") });
    else this.#states.set(name, state.update({ changes }).state);
  }

  /** Makes edits in the file that is shown, as one step that can be undone. */
  apply(edits: readonly Edit[]): void {
    const own = edits.filter(({ file }) => file === this.#name);
    if (!own.length) return;
    const changes = own.map(({ start, end, text }) => ({ from: start, to: end, insert: text }));
    this.view.dispatch({ changes, userEvent: "input.dial", annotations: isolateHistory.of("full") });
  }

  setLiterals(found: readonly SourceLiteral[]): void {
    this.view.dispatch({ effects: setLiterals.of(found.filter(({ file }) => file === this.#name)) });
  }

  setMistakes(mistakes: readonly Mistake[]): void {
    const { state } = this.view;
    const own = mistakes.filter(({ file, line }) => file === this.#name && line !== null);
    const found = own.map((mistake): Diagnostic => {
      const { message, hint, severity, line, labels } = mistake;
      const { from, to } = state.doc.line(Math.min(Math.max(line!, 1), state.doc.lines));
      const start = offsetIn(mistake, mistake.column);
      const end = Math.max(offsetIn(mistake, mistake.end_column), start + 1);
      return {
        from: Math.min(from + start, to),
        to: Math.min(from + end, to),
        severity: severity === "note" ? "info" : severity,
        message: [message, ...labels.map(labelText), ...(hint ? [`Hint: ${hint}`] : [])].join("\n"),
      };
    });
    this.view.dispatch(setDiagnostics(state, found));
  }

  /** Shows what lines of the file that is shown cost; null takes the column away. */
  setFigures(figures: readonly Figure[] | null): void {
    showFigures(this.view, figures);
  }

  /** Marks lines of the file that is shown. */
  link(lines: readonly number[]): void {
    this.view.dispatch({ effects: setLinked.of(lines) });
  }

  /** Puts the caret on a line, which comes into view. */
  goTo(line: number, column = 0, isFocused = true): void {
    const { doc } = this.view.state;
    const { from, to } = doc.line(Math.min(Math.max(line, 1), doc.lines));
    const anchor = Math.min(from + column, to);
    this.view.dispatch({
      selection: { anchor },
      effects: EditorView.scrollIntoView(anchor, { y: "center" }),
    });
    if (isFocused) this.view.focus();
  }
}

/** How far a column of a mistake, in characters from 1, is from the start of its line. */
export function offsetIn({ excerpt }: Mistake, column: number | null): number {
  return [...(excerpt ?? "")].slice(0, (column ?? 1) - 1).join("").length;
}

/** What a label says, and where. */
export function labelText({ file, line, text }: MistakeLabel): string {
  return `${file} line ${line}: ${text}`;
}
