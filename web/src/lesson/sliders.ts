/** The sliders of a lesson: the player's own rows, outside of the picture. */

import { rowOf, type Row } from "../controls";
import { make } from "../dom";
import type { Player } from "../player";

export type Sliders = Map<string, Row>;

/** Fills the section; it goes where there is nothing to move. */
export function slidersOf(player: Player, section: HTMLElement): Sliders {
  const rows: Sliders = new Map();
  const { parameters } = player.payload;
  if (parameters.length === 0) {
    section.remove();
    return rows;
  }
  const values = player.parameters();
  for (const parameter of parameters) {
    const row = rowOf(parameter, (value) => player.change(parameter.name, value));
    row.show(values[parameter.name]!);
    rows.set(parameter.name, row);
    section.append(row.element);
  }
  if (parameters.length > 1) {
    const reset = make("button", { type: "button", className: "quiet" }, "Reset all");
    reset.onclick = () => player.resetAll();
    section.append(reset);
  }
  player.on("parameter", ({ name, value }) => rows.get(name)?.show(value));
  return rows;
}
