/**
 * The strip of stills: a press shows the layer large; the stills follow the sliders.
 *
 * The first view has no still of its own in the page: at the beginning it is the poster.
 */

import type { Player } from "../player";
import { later, show, type Stills } from "./stills";

export function followLayers(player: Player, stills: Stills, poster: string): void {
  const buttons = [...document.querySelectorAll<HTMLButtonElement>(".layer")];
  const caption = document.querySelector<HTMLElement>(".caption");
  if (buttons.length === 0) return;
  const name = () => {
    for (const button of buttons) {
      const isShown = button.dataset["view"] === player.view;
      button.setAttribute("aria-pressed", String(isShown));
      if (isShown && caption) caption.textContent = button.dataset["caption"] ?? "";
    }
  };
  for (const button of buttons) {
    button.onclick = () => player.setView(button.dataset["view"]!);
    const image = button.querySelector("img")!;
    if (!image.getAttribute("src")) image.src = poster;
  }
  player.on("view", name);
  name();
  const redraw = later(async () => {
    const values = player.parameters();
    for (const button of buttons) {
      const picture = await stills.take(button.dataset["view"]!, values, player.time);
      if (picture) show(button.querySelector("img")!, picture);
    }
  });
  player.on("parameter", redraw);
}
