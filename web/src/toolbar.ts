/**
 * The bar over the picture's lower edge: play, the time, the views, and what is done with the picture.
 *
 * Input: the player. Output: an element that follows the player's events. An embedded page has only the
 * smallest of it.
 */

import { ICONS, icon, iconButton, make, rename } from "./dom";
import type { Player } from "./player";

const STEPS = 1000;

export function toolbarOf(player: Player): HTMLElement {
  const { embed, time, name } = player.payload;
  const bar = make("div", { className: "bar", role: "group", "aria-label": `Controls of ${name}` });
  if (time.animated) {
    bar.append(playButton(player), ...(embed ? [] : [...timeline(player), make("span", { className: "break" })]));
  }
  if (!embed) {
    bar.append(
      views(player) || "",
      ...(PATHS ? [samples(player)] : []),
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
    const help = iconButton("Keys (H)", ICONS.help, () => player.showHelp());
    help.classList.add("keys");
    bar.append(help, panel);
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

/** How many samples the picture has; a press shows direct light instead, or paths again. */
function samples(player: Player): HTMLElement {
  const button = make("button", { type: "button", className: "text" });
  button.style.cssText = "font-size:12px;font-variant-numeric:tabular-nums;white-space:nowrap";
  button.onclick = () => player.actions.mode(false);
  const show = (text: string) => (button.textContent = text);
  const film = () => player.payload.views.find(({ name }) => name === player.view)?.film;
  const caustics = () => (film()?.photons ? " · caustics" : "");
  const wait = () => show(player.isDirect ? "Direct light" : "Paths …");
  const name = () => {
    rename(button, `${player.isDirect ? "Trace paths" : "Show direct light"} (M)`);
    button.setAttribute("aria-pressed", String(!player.isDirect));
    wait();
  };
  player.on("frame", ({ samples, rate }) => {
    if (rate === undefined) wait();
    else show(`${samples} samples · ${rate.toFixed(rate < 10 ? 1 : 0)}/s${caustics()}`);
  });
  player.on("mode", name);
  const seen = () => {
    button.hidden = !film();
  };
  player.on("view", seen);
  seen();
  name();
  return button;
}

/** The picture, and what helps to understand it: one menu. */
function views(player: Player): HTMLElement | null {
  const all = player.payload.views;
  if (all.length < 2) return null;
  const items = all.map(({ name, label }) => make("option", { value: name }, label));
  const menu = make("select", { "aria-label": "View", title: "View (V)" }, ...items);
  menu.value = player.view;
  menu.onchange = () => player.setView(menu.value);
  player.on("view", ({ name }) => (menu.value = name));
  return make("span", { className: "views" }, icon(ICONS.views), menu);
}
