/** The list of keys and gestures, as a dialog. */

import { make } from "./dom";
import { HELP, type Needs } from "./generated/bindings";

export function helpOf(has: (needs: Needs) => boolean): HTMLDialogElement {
  const rows = HELP.filter(([, , needs]) => has(needs));
  const list = make("dl");
  for (const [keys, meaning] of rows) list.append(make("dt", {}, keys), make("dd", {}, meaning));
  const close = make("button", { type: "submit", className: "text" }, "Close");
  const title = make("h2", {}, "Mouse and keys");
  const form = make("form", { method: "dialog" }, title, list, close);
  const dialog = make("dialog", { "aria-label": "Mouse and keys" }, form);
  // A click beside the sheet closes it.
  dialog.onclick = (event) => event.target === dialog && dialog.close();
  return dialog;
}
