/** The list of keys and gestures, as a dialog. */

import { make } from "./dom";
import { KEYS, type Actions } from "./keyboard";

/** What a hand on the picture moves. */
const GESTURES = {
  camera: [
    ["Drag", "Turn around the scene"],
    ["Right drag, two fingers", "Move the scene"],
    ["Wheel, pinch", "Nearer, farther"],
    ["Double click", "Reset the camera"],
  ],
  mouse: [
    ["Drag, ← → ↑ ↓", "The mouse that the picture reads"],
    ["R, double click", "Reset the mouse"],
  ],
} as const;

export function helpOf(
  has: (action: keyof Actions) => boolean,
  moved: keyof typeof GESTURES | false,
): HTMLDialogElement {
  const rows: (readonly [string, string])[] = moved ? [...GESTURES[moved]] : [];
  for (const [keys, meaning, needs] of KEYS) if (has(needs)) rows.push([keys, meaning]);
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
