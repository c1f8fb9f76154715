/**
 * The script of a lesson's page: the player, and what the lesson's buttons do with it.
 *
 * Input: the elements that `src/distal/lessons/page.py` writes. Output: sliders, stills, experiments, goals.
 */

import "../main";
import type { Payload } from "../payload";
import type { Player } from "../player";
import { Changes } from "./changes";
import { followGoals } from "./goal";
import { followLayers } from "./layers";
import { present } from "./presentation";
import { slidersOf } from "./sliders";
import { Stills } from "./stills";
import { followTries } from "./tries";

function start(): void {
  const host = document.querySelector<HTMLElement & { distal?: Player }>(".picture [data-distal]");
  const player = host?.distal;
  if (!host || !player) return;
  const controls = document.querySelector<HTMLElement>(".controls")!;
  const sliders = slidersOf(player, controls);
  const announcer = document.querySelector<HTMLElement>(".announcer")!;
  const changes = new Changes(player, sliders, (text) => (announcer.textContent = text));
  const stills = new Stills(player.payload as Payload);
  followLayers(player, stills, host.querySelector("img")!.src);
  followTries(player, changes);
  followGoals(player, stills, changes);
  present();
}

start();
