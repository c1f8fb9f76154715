/**
 * Brackets and quotes, which are closed while one types.
 *
 * Input: the text around the caret. Output: an extension of the editor. Who types the closing ones as well
 * gets what was typed: they are typed over, also those of a string of three quotes. In comments nothing is
 * closed, in strings their own quote alone.
 */

import { closeBrackets, closeBracketsKeymap, type CloseBracketConfig } from "@codemirror/autocomplete";
import { pythonLanguage } from "@codemirror/lang-python";
import { syntaxTree } from "@codemirror/language";
import { EditorState, Prec, type Extension } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";

const ofPython = EditorState.create({ extensions: pythonLanguage });
const EVERYWHERE = ofPython.languageDataAt<CloseBracketConfig>("closeBrackets", 0)[0]!;

/** What is closed at a place. */
function pairsAt(state: EditorState, at: number): CloseBracketConfig {
  const { name, from } = syntaxTree(state).resolveInner(at, -1);
  if (name === "Comment") return { ...EVERYWHERE, brackets: [] };
  if (!/String/.test(name)) return EVERYWHERE;
  const [quote = '"'] = /["']/.exec(state.sliceDoc(from, at)) ?? [];
  return { ...EVERYWHERE, brackets: [quote, quote.repeat(3)] };
}

/** Whether a place is before the last, or within the last, of the three quotes that end a string. */
function isAtEnd(state: EditorState, at: number): boolean {
  const { name, from, to } = syntaxTree(state).resolveInner(at, -1);
  const text = state.sliceDoc(from, to);
  const isWhole = /^[a-z]*("""|''')[^]*\1$/i.test(text) && text.length >= 6;
  return /String/.test(name) && isWhole && at >= to - 3 && at < to;
}

/** One quote is typed over, where the extension of the library types over three. */
const threeQuotes = EditorView.inputHandler.of((view, from, to, typed) => {
  const { state } = view;
  const isNext = /^["']$/.test(typed) && state.sliceDoc(from, from + 1) === typed;
  if (from !== to || !isNext || state.selection.ranges.length > 1 || !isAtEnd(state, from)) return false;
  view.dispatch({ selection: { anchor: from + 1 }, scrollIntoView: true, userEvent: "input.type" });
  return true;
});

export function pairs(): Extension {
  const own = EditorState.languageData.of((state, at) => [{ closeBrackets: pairsAt(state, at) }]);
  return [Prec.high([own, threeQuotes]), closeBrackets(), keymap.of(closeBracketsKeymap)];
}
