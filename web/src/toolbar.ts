/**
 * The bar below the picture: play, the time, what a frame costs, and what is done with the picture.
 *
 * Input: the player. Output: an element that follows the player's events. An embedded page has only the
 * smallest of it.
 */

import { ICONS, icon, iconButton, make, rename } from "./dom";
import type { Player } from "./player";

const STEPS = 1000;
/** Numbers that change with every frame cannot be read: so often is enough. */
const STATISTICS_MS = 250;

export function toolbarOf(player: Player): HTMLElement {
  const { embed, time, name } = player.payload;
  const bar = make("div", { className: "bar", role: "group", "aria-label": `Controls of ${name}` });
  if (time.animated) bar.append(playButton(player), ...(embed ? [] : timeline(player)));
  if (!embed) {
    bar.append(
      statistics(player),
      iconButton("Save a picture (S)", ICONS.camera, () => void player.saveScreenshot()),
    );
  } else if (player.payload.steering) {
    bar.append(iconButton("Reset the camera (R)", ICONS.reset, () => player.resetCamera()));
  }
  if (document.fullscreenEnabled) {
    bar.append(iconButton("Full screen (shift F)", ICONS.full, () => player.toggleFullScreen()));
  }
  if (!embed) {
    const panel = iconButton("Settings (P)", ICONS.panel, () => player.togglePanel());
    player.on("panel", ({ isOpen }) => panel.setAttribute("aria-expanded", String(isOpen)));
    bar.append(iconButton("Keys (H)", ICONS.help, () => player.showHelp()), panel);
  }
  return bar;
}

function playButton(player: Player): HTMLElement {
  const button = iconButton("", ICONS.play, () => player.toggle());
  let was: boolean | null = null;
  const show = () => {
    if (was === player.playing) return;
    was = player.playing;
    button.replaceChildren(icon(was ? ICONS.pause : ICONS.play));
    rename(button, was ? "Pause (space)" : "Play (space)");
  };
  player.on("time", show);
  show();
  return button;
}

function timeline(player: Player): HTMLElement[] {
  const slider = make("input", { type: "range", className: "time", min: 0, max: STEPS, step: 1 });
  slider.setAttribute("aria-label", "Time");
  const text = make("span", { className: "seconds" });
  let isHeld = false;
  let range = player.timeRange;
  const show = () => {
    // Under the hand the ends stay: its right end would else be the next window's left, and so on.
    if (!isHeld) range = player.timeRange;
    const [low, high] = range;
    const part = (player.time - low) / (high - low);
    slider.valueAsNumber = part * STEPS;
    slider.style.setProperty("--part", `${100 * Math.min(Math.max(part, 0), 1)}%`);
    const seconds = `${player.time.toFixed(2)} s`;
    text.textContent = seconds;
    slider.setAttribute("aria-valuetext", seconds);
  };
  slider.oninput = () => {
    const [low, high] = range;
    player.setTime(low + (high - low) * (slider.valueAsNumber / STEPS));
  };
  // While a hand holds the slider, the clock waits.
  const hold = (held: boolean) => player.hold((isHeld = held));
  slider.onpointerdown = () => hold(true);
  slider.onpointerup = slider.onpointercancel = slider.onblur = () => hold(false);
  player.on("time", show);
  show();
  return [slider, text];
}

function statistics(player: Player): HTMLElement {
  const text = make("span", { className: "statistics", "aria-hidden": true });
  let last = -Infinity;
  player.on("frame", ({ ms, width, height, fps }) => {
    const now = performance.now();
    if (fps && now - last < STATISTICS_MS) return;
    last = now;
    const pace = fps ? `${fps.toFixed(0)} fps · ` : "";
    text.textContent = `${pace}${ms.toFixed(ms < 10 ? 1 : 0)} ms · ${width}×${height}`;
  });
  return text;
}
