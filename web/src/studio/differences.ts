/**
 * Two texts as one, with what differs marked.
 *
 * Input: texts. Output: an element to read, not to edit.
 */

import { syntaxHighlighting } from "@codemirror/language";
import { pythonLanguage } from "@codemirror/lang-python";
import { unifiedMergeView } from "@codemirror/merge";
import { EditorState } from "@codemirror/state";
import { EditorView, lineNumbers } from "@codemirror/view";
import { make } from "../dom";
import { HIGHLIGHT } from "./editor";

/**
 * Shows a text, and between its lines those of an old one that it has not.
 *
 * Long parts without differences are folded.
 */
export function differences(text: string, old: string, label: string, nonce: string): HTMLElement {
  const parent = make("div", { className: "differences" });
  if (text === old) {
    parent.append(make("p", { className: "quiet" }, "It is the text in the page."));
    return parent;
  }
  new EditorView({
    parent,
    doc: text,
    extensions: [
      EditorView.cspNonce.of(nonce),
      lineNumbers(),
      syntaxHighlighting(HIGHLIGHT),
      pythonLanguage,
      EditorState.readOnly.of(true),
      EditorView.editable.of(false),
      EditorView.contentAttributes.of({ "aria-label": label, tabindex: "0" }),
      unifiedMergeView({
        original: old,
        mergeControls: false,
        gutter: true,
        collapseUnchanged: { margin: 2, minSize: 6 },
      }),
    ],
  });
  return parent;
}
