/** Experiments and phrases: buttons that set values; an experiment keeps the old state beside. */

import type { Values } from "../payload";
import type { Player } from "../player";
import { valuesOf, type Changes } from "./changes";
import { show } from "./stills";

export function followTries(player: Player, changes: Changes): void {
  for (const card of document.querySelectorAll<HTMLElement>(".try")) experiment(card, player, changes);
  for (const button of document.querySelectorAll<HTMLButtonElement>("button.phrase")) {
    button.onclick = () => void changes.move(valuesOf(button));
  }
}

interface Kept {
  values: Values;
  view: string;
}

function experiment(card: HTMLElement, player: Player, changes: Changes): void {
  const act = card.querySelector<HTMLButtonElement>(".act")!;
  const outcome = card.querySelector<HTMLElement>(".outcome")!;
  const image = outcome.querySelector("img")!;
  const back = outcome.querySelector<HTMLButtonElement>(".back")!;
  let kept: Kept | null = null;
  act.setAttribute("aria-expanded", "false");
  act.onclick = async () => {
    const values = valuesOf(act);
    if (!kept) {
      // The first press keeps the old state; pressed again, the experiment runs from there.
      const all = player.parameters();
      kept = {
        values: Object.fromEntries(Object.keys(values).map((name) => [name, all[name]!])),
        view: player.view,
      };
      const picture = await player.screenshot(1);
      if (picture) show(image, picture);
      image.hidden = !picture;
    }
    outcome.hidden = false;
    act.setAttribute("aria-expanded", "true");
    if (act.dataset["view"]) player.setView(act.dataset["view"]);
    await changes.move(values);
  };
  back.onclick = async () => {
    if (!kept) return;
    const { values, view } = kept;
    kept = null;
    outcome.hidden = true;
    act.setAttribute("aria-expanded", "false");
    act.focus();
    player.setView(view);
    await changes.move(values);
  };
}
