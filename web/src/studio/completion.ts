/**
 * The list of names that opens while one types, and its keys.
 *
 * Input: the text before the caret, the names that `tools/gen_names.py` found. Output: an extension of the
 * editor. What is typed stays as it is typed: Enter takes an entry only after an arrow has chosen one in
 * the list as it is shown, and no other letter takes one.
 */

import {
  CompletionContext,
  acceptCompletion,
  autocompletion,
  closeCompletion,
  completionStatus,
  currentCompletions,
  insertCompletionText,
  moveCompletionSelection,
  pickedCompletion,
  selectedCompletion,
  type Completion,
  type CompletionResult,
} from "@codemirror/autocomplete";
import { localCompletionSource } from "@codemirror/lang-python";
import { syntaxTree } from "@codemirror/language";
import { Prec, type EditorState, type Extension } from "@codemirror/state";
import { keymap, type EditorView } from "@codemirror/view";
import { DISTAL, LANGUAGE, METHODS, type Names } from "../generated/names";

/** The list opens by itself at so many letters. */
const LETTERS = 2;

/** Of Python itself, what scenes use: the many names of its exceptions would hide those of distal. */
const PYTHON =
  "and break def elif else enumerate False float for from if import in int len list None not " +
  "or print range return round sorted sum True tuple while zip";

const OF_DISTAL = completions(DISTAL);
const OF_LANGUAGE = completions(LANGUAGE);
const OF_METHODS = completions(METHODS, "method");
const OF_PYTHON: Completion[] = PYTHON.split(" ").map((label) => ({ label, type: "keyword" }));
const OF_MODULES: Record<string, Completion[]> = { distal: OF_DISTAL, "distal.lang": OF_LANGUAGE };

function completions(names: Names, kind?: string): Completion[] {
  return Object.entries(names).map(([label, [detail, info]]) => {
    const type = kind ?? (/^[A-Z]/.test(label) ? "class" : detail ? "function" : "variable");
    return { label, type, detail, info };
  });
}

// Where the caret is

const WORD = /[\p{L}\p{M}\p{N}_]*$/u;
const TOKEN =
  /#.*|"""[^]*?(?:"""|$)|'''[^]*?(?:'''|$)|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?|[\p{L}\p{M}\p{N}_]+|\*\*|:=|\S/gu;
const CLOSED = /^(?:("""|''')[^]*\1|(?!"""|''')(["']).*\2)$/s;

/** Tokens since a bracket was opened, which is not closed yet; the first level is the statement. */
interface Level {
  opened: string;
  tokens: string[];
}

/** Whether a text ends in a comment, or in a string that is not closed. */
function isQuiet(text: string): boolean {
  const last = [...text.matchAll(TOKEN)].at(-1);
  if (!last || last.index + last[0].length < text.length) return false;
  return /^#/.test(last[0]) || (/^["']/.test(last[0]) && !CLOSED.test(last[0]));
}

/** The statement that the caret is in, up to a place; the innermost level is the last. */
function levelsOf(text: string): Level[] {
  const levels: Level[] = [{ opened: "", tokens: [] }];
  for (const [token] of text.matchAll(TOKEN)) {
    if (/^[([{]$/.test(token)) levels.push({ opened: token, tokens: [] });
    else if (!/^[)\]}]$/.test(token)) levels.at(-1)!.tokens.push(token);
    else {
      if (levels.length > 1) levels.pop();
      levels.at(-1)!.tokens.push(token);
    }
  }
  return levels;
}

/** Where the statement begins that a place is in. */
function statementStart(state: EditorState, at: number): number {
  let node = syntaxTree(state).resolveInner(at, -1);
  while (node.parent && !/^(Script|Body)$/.test(node.parent.name)) node = node.parent;
  const line = state.doc.lineAt(at).from;
  return node.parent ? Math.min(node.from, line) : line;
}

/** Whether a word there is the name of something that begins with it: no other name helps. */
function isNew(levels: readonly Level[]): boolean {
  const isTarget = ({ tokens }: Level) => tokens.lastIndexOf("for") > tokens.lastIndexOf("in");
  if (levels.some(isTarget)) return true;
  const { opened, tokens } = levels.at(-1)!;
  const last = tokens.at(-1);
  if (/^(def|class|as|global|nonlocal)$/.test(last ?? "")) return true;
  const [first, second] = levels[0]!.tokens;
  if (first === "case" && second !== "=" && !levels[0]!.tokens.includes(":")) return true;
  const isParameter = opened === "(" && levels.at(-2)!.tokens.at(-2) === "def";
  const isOfLambda = tokens.lastIndexOf("lambda") > tokens.lastIndexOf(":");
  return (isParameter || isOfLambda) && /^(lambda|,|\*\*?|)$/.test(last ?? "");
}

/** The names of a module that `from` or `import` begins to name; null in any other statement. */
function imported(levels: readonly Level[]): Completion[] | null {
  const { tokens } = levels[0]!;
  if (tokens[0] === "import") return [];
  if (tokens[0] !== "from") return null;
  const at = tokens.indexOf("import");
  const isNamed = levels.at(-1)!.tokens.at(-1) !== "as";
  const name = tokens.slice(1, at).join("");
  return at > 0 && isNamed && Object.hasOwn(OF_MODULES, name) ? OF_MODULES[name]! : [];
}

/** The names after a point: the methods of shapes, unless a number or a module is before it. */
function members(tokens: readonly string[], own: readonly Completion[]): Completion[] {
  let at = tokens.length - 2;
  if (/^\d/.test(tokens[at] ?? "")) return [];
  while (tokens[at - 1] === ".") at -= 2;
  const isModule = own.some(({ label, type }) => type === "namespace" && label === tokens[at]);
  return isModule ? [] : OF_METHODS;
}

/** The names that the file itself gives something. */
function locals(context: CompletionContext): readonly Completion[] {
  return (localCompletionSource(context) as CompletionResult | null)?.options ?? [];
}

/** The names that could stand at the caret. */
function candidates(context: CompletionContext, from: number): Completion[] {
  const { pos, state } = context;
  if (/String|Comment/.test(syntaxTree(state).resolveInner(pos, -1).name)) return [];
  const start = statementStart(state, pos);
  const text = state.sliceDoc(start, pos);
  if (isQuiet(text)) return [];
  const levels = levelsOf(text.slice(0, text.length - (pos - from)));
  const ofModule = imported(levels);
  if (ofModule || isNew(levels)) return ofModule ?? [];
  // The name of an argument, or of what an assignment begins.
  if (/^[\p{L}\p{M}\p{N}_]*\s*:?=(?!=)/u.test(state.sliceDoc(pos, state.doc.lineAt(pos).to))) return [];
  const { tokens } = levels.at(-1)!;
  if (tokens.at(-1) === ".") return members(tokens, locals(new CompletionContext(state, start, true)));
  return [...locals(context), ...OF_LANGUAGE, ...OF_DISTAL, ...OF_PYTHON];
}

/** Those that begin with a word, in any case; with its own case first. The word itself is none. */
function beginning(word: string, whole: string, names: readonly Completion[]): Completion[] {
  const folded = word.toLowerCase();
  const taken = new Set([word, whole]);
  const found = names.filter(({ label }) => {
    const isOne = label.toLowerCase().startsWith(folded) && !taken.has(label);
    if (isOne) taken.add(label);
    return isOne;
  });
  const rank = ({ label }: Completion) => +!label.startsWith(word);
  found.sort((a, b) => rank(a) - rank(b) || (a.label < b.label ? -1 : 1));
  // New objects: what an arrow had chosen is chosen no more once another letter is typed.
  return found.map((one) => ({ ...one }));
}

/** The list at a place; null where none belongs. */
export function complete(context: CompletionContext): CompletionResult | null {
  const found = listAt(context, context.explicit ? 0 : LETTERS);
  return found.options.length ? found : null;
}

function listAt(context: CompletionContext, fewest: number): CompletionResult {
  const { pos, state } = context;
  const { text, from: start } = state.doc.lineAt(pos);
  const [word] = WORD.exec(text.slice(0, pos - start))!;
  const [rest] = /^[\p{L}\p{M}\p{N}_]*/u.exec(text.slice(pos - start))!;
  const from = pos - word.length;
  const isOne = [...word].length >= fewest && !/^\p{N}/u.test(word) && !(rest && fewest);
  const options = isOne ? beginning(word, word + rest, candidates(context, from)) : [];
  // Each letter asks again, at once; an empty list is closed.
  const update: CompletionResult["update"] = (_, __, ___, now) => listAt(now, fewest);
  return { from, options, filter: false, getMatch: () => [0, word.length], update };
}

// Keys

/** Takes what an arrow has chosen, else the first entry for a word of two letters. */
function takeFirst(view: EditorView): boolean {
  const { state } = view;
  const [first] = currentCompletions(state);
  const { head } = state.selection.main;
  const [word] = WORD.exec(state.sliceDoc(state.doc.lineAt(head).from, head))!;
  const chosen = selectedCompletion(state) ?? ([...word].length >= LETTERS ? first : null);
  if (!first || !chosen || state.readOnly) return false;
  const inserted = insertCompletionText(state, chosen.label, head - word.length, head);
  view.dispatch({ ...inserted, annotations: pickedCompletion.of(chosen) });
  return true;
}

/** Closes the list; where none is shown yet, Escape is the editor's, which Tab then leaves. */
function close(view: EditorView): boolean {
  const isShown = completionStatus(view.state) === "active";
  return closeCompletion(view) && isShown;
}

export function completion(): Extension {
  const keys = [
    { key: "ArrowDown", run: moveCompletionSelection(true) },
    { key: "ArrowUp", run: moveCompletionSelection(false) },
    { key: "PageDown", run: moveCompletionSelection(true, "page") },
    { key: "PageUp", run: moveCompletionSelection(false, "page") },
    { key: "Enter", run: acceptCompletion },
    { key: "Tab", run: takeFirst },
    { key: "Escape", run: close },
  ];
  const list = autocompletion({ override: [complete], defaultKeymap: false, selectOnOpen: false });
  return [list, Prec.highest(keymap.of(keys))];
}
