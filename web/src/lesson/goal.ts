/**
 * An exercise's goal: how far the reader's picture is from it, measured on small stills.
 *
 * The difference is the mean of the absolute differences of display values, as the lesson's tests have it.
 */

import type { Player } from "../player";
import { valuesOf, type Changes } from "./changes";
import { later, show, type Stills } from "./stills";

/** Pixels are compared at this width, below what antialiasing changes. */
const COMPARED_PX = 96;

export function followGoals(player: Player, stills: Stills, changes: Changes): void {
  for (const card of document.querySelectorAll<HTMLElement>(".goal")) goal(card, player, stills, changes);
}

function goal(card: HTMLElement, player: Player, stills: Stills, changes: Changes): void {
  const wanted = card.querySelector<HTMLImageElement>(".wanted")!;
  const yours = card.querySelector<HTMLImageElement>(".yours")!;
  const text = card.querySelector<HTMLElement>(".difference")!;
  const solve = card.querySelector<HTMLButtonElement>(".solve")!;
  const within = Number(card.dataset["within"]);
  const { start } = player.payload.time;
  const measure = async () => {
    const picture = await stills.take("color", player.parameters(), start);
    if (!picture) return;
    show(yours, picture);
    await Promise.all([yours.decode(), wanted.decode()]);
    const difference = meanDifference(pixelsOf(wanted), pixelsOf(yours));
    const isReached = difference <= within;
    card.classList.toggle("reached", isReached);
    card.dataset["difference"] = difference.toFixed(4);
    const measured = `Difference ${percent(difference)}`;
    text.textContent = isReached
      ? `${measured}: reached.`
      : `${measured}. The goal is reached at ${percent(within)}.`;
  };
  const soon = later(() => void measure());
  player.on("parameter", soon);
  solve.onclick = () => void changes.move(valuesOf(solve));
  // The second player starts when the exercise comes near, not with the page.
  const sight = new IntersectionObserver(
    (entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      sight.disconnect();
      // While time plays, the picture never comes to rest.
      if (player.playing) soon();
      else void player.settled().then(measure);
    },
    { rootMargin: "200px" },
  );
  sight.observe(card);
}

function percent(part: number): string {
  return `${(100 * part).toFixed(1)} %`;
}

function pixelsOf(image: HTMLImageElement): Uint8ClampedArray {
  const canvas = document.createElement("canvas");
  canvas.width = COMPARED_PX;
  canvas.height = Math.round((COMPARED_PX * image.naturalHeight) / image.naturalWidth);
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  context.imageSmoothingQuality = "high";
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  return context.getImageData(0, 0, canvas.width, canvas.height).data;
}

/** From 0 to 1; alpha is left out. */
export function meanDifference(a: Uint8ClampedArray, b: Uint8ClampedArray): number {
  let sum = 0;
  const count = Math.min(a.length, b.length);
  for (let i = 0; i < count; i++) if (i % 4 !== 3) sum += Math.abs(a[i]! - b[i]!);
  return sum / (0.75 * count * 255);
}
