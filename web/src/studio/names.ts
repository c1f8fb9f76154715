/**
 * What the editor knows of the language: what a name is, the arguments of a call.
 *
 * Input: the names that `tools/gen_names.py` found. Output: an extension of the editor. It reads the text's
 * syntax only and asks nobody.
 */

import { syntaxTree } from "@codemirror/language";
import { StateField, type EditorState, type Extension } from "@codemirror/state";
import { hoverTooltip, showTooltip, type Tooltip } from "@codemirror/view";
import { make } from "../dom";
import { DISTAL, LANGUAGE, METHODS, type Names } from "../generated/names";

type SyntaxNode = ReturnType<typeof syntaxTree>["topNode"];

const GLOBALS: Names = { ...LANGUAGE, ...DISTAL };

function shown(name: string, [args, about]: [string, string]): HTMLElement {
  const head = make("div", { className: "name-head" }, `${name}${args}`);
  return make("div", { className: "name" }, head, about && make("div", {}, about));
}

/** What a node names: a method after a point, else one of the public names. */
function known(state: EditorState, node: SyntaxNode): [name: string, entry: [string, string]] | null {
  const name = state.sliceDoc(node.from, node.to);
  const table = node.name === "PropertyName" ? METHODS : node.name === "VariableName" ? GLOBALS : {};
  const entry = Object.hasOwn(table, name) ? table[name] : undefined;
  return entry ? [name, entry] : null;
}

const hover = hoverTooltip((view, at, side) => {
  const node = syntaxTree(view.state).resolveInner(at, side);
  const found = known(view.state, node);
  if (!found) return null;
  return { pos: node.from, end: node.to, above: true, create: () => ({ dom: shown(...found) }) };
});

/** The call whose arguments the caret is in. */
function callAt(state: EditorState): SyntaxNode | null {
  const { main } = state.selection;
  if (!main.empty) return null;
  for (let node: SyntaxNode | null = syntaxTree(state).resolveInner(main.head, -1); node; node = node.parent) {
    if (node.name !== "ArgList" || main.head <= node.from) continue;
    if (main.head >= node.to && state.sliceDoc(node.to - 1, node.to) === ")") continue;
    const callee = node.parent?.firstChild;
    return callee ? (callee.name === "MemberExpression" ? callee.lastChild : callee) : null;
  }
  return null;
}

interface Called {
  name: string;
  tooltip: Tooltip;
}

/** The arguments of a call, from the moment that one types in it. */
const called = StateField.define<Called | null>({
  create: () => null,
  update(now, transaction) {
    const isTyped = transaction.isUserEvent("input.type");
    if (!isTyped && !(now && (transaction.docChanged || transaction.selection))) {
      return transaction.docChanged ? null : now;
    }
    const callee = callAt(transaction.state);
    const found = callee && known(transaction.state, callee);
    if (!callee || !found || !found[1][0]) return null;
    if (now?.name === found[0] && now.tooltip.pos === callee.from) return now;
    const create = () => ({ dom: shown(...found) });
    return { name: found[0], tooltip: { pos: callee.from, above: true, create } };
  },
  provide: (field) => showTooltip.from(field, (found) => found?.tooltip ?? null),
});

export function names(): Extension {
  return [hover, called];
}
