/**
 * The panel at the side: the scene's name, its parameters in groups, the picture's quality and what
 * it costs, and what can be done with all of them at once.
 *
 * Input: the player. Output: an element that follows the player's events.
 */

import { pointsOf } from "./code";
import { rowOf, type Row } from "./controls";
import { ICONS, iconButton, make } from "./dom";
import { SPEEDS } from "./generated/interaction";
import type { Player } from "./player";

const SCALES = [
  ["auto", "Automatic"],
  ["0.25", "¼"],
  ["0.5", "½"],
  ["1", "Full"],
  ["2", "Double"],
] as const;

/** Numbers that change with every frame cannot be read: so often is enough. */
const STATISTICS_MS = 250;

export function panelOf(player: Player): HTMLElement {
  const { name, description } = player.payload;
  const panel = make("section", { className: "panel", "aria-label": "Settings" });
  const body = make("div", { className: "body" });
  const head = make("h2", {}, name);
  const about = description !== name && make("p", { className: "about" }, description);
  body.append(make("header", {}, head, about || ""));
  body.append(...parameterGroups(player), pictureGroup(player));
  panel.append(body, actions(player));
  return panel;
}

function group(title: string, ...children: Node[]): HTMLElement {
  const heading = title && make("h3", {}, title);
  return make("div", { className: "group", role: "group", "aria-label": title || "Parameters" },
    heading, ...children);
}

let count = 0;

/** A menu in a row of its own; `follow` is called with what sets its choice from outside. */
function menu(
  label: string,
  options: readonly (readonly [value: string, text: string])[],
  value: string,
  choose: (value: string) => void,
): [HTMLElement, HTMLSelectElement] {
  const id = `m${++count}`;
  const items = options.map(([key, text]) => make("option", { value: key }, text));
  const select = make("select", { id }, ...items);
  select.value = value;
  select.onchange = () => choose(select.value);
  const caption = make("label", { className: "label", for: id }, label);
  return [make("div", { className: "row choice" }, caption, select), select];
}

function parameterGroups(player: Player): HTMLElement[] {
  const rows = new Map<string, Row>();
  const groups = new Map<string, HTMLElement[]>();
  const values = player.parameters();
  for (const parameter of player.payload.parameters) {
    const row = rowOf(parameter, (value) => player.change(parameter.name, value));
    row.show(values[parameter.name]!);
    rows.set(parameter.name, row);
    groups.set(parameter.group, [...(groups.get(parameter.group) ?? []), row.element]);
  }
  player.on("parameter", ({ name, value }) => rows.get(name)?.show(value));
  return [...groups].map(([title, elements]) => group(title, ...elements));
}

function pictureGroup(player: Player): HTMLElement {
  const scales = SCALES.map(([value, text]) => [value, text] as const);
  const [resolution] = menu("Resolution", scales, "auto", (value) =>
    player.setResolution(value === "auto" ? value : +value),
  );
  const rows = [resolution];
  if (player.payload.time.animated) {
    const speeds = SPEEDS.map((speed) => [String(speed), `${speed}×`] as const);
    const [row, select] = menu("Speed", speeds, "1", (value) => player.setSpeed(+value));
    player.on("speed", ({ speed }) => (select.value = String(speed)));
    rows.push(row);
  }
  if ((player.payload.steering?.guide ?? -1) >= 0) rows.push(position(player));
  return group("Picture", ...rows, statistics(player));
}

/** Where the camera is, and a button that copies it. */
function position(player: Player): HTMLElement {
  const text = make("span", { className: "position" });
  const button = iconButton("Copy the camera as Python (C)", ICONS.copy, () => void player.copyCamera());
  button.classList.add("undo");
  const label = make("span", { className: "label" }, "Camera");
  const row = make("div", { className: "row camera" }, label, text, button);
  // What plays never rests.
  const played = new Promise<unknown>((resolve) => player.on("time", resolve));
  let isNew = false;
  let following: Promise<void> | undefined;
  let isFirst = true;
  const follow = async () => {
    while (isNew) {
      // After the first sharp picture, so that neither it nor the first gesture waits for the guide.
      if (!player.playing) await Promise.race([isFirst && player.settled(), played]);
      await new Promise((resolve) => setTimeout(resolve, STATISTICS_MS));
      isFirst = isNew = false;
      const place = await player.camera!.here();
      row.style.display = place ? "" : "none";
      if (place) text.textContent = pointsOf(place)[0];
    }
    following = undefined;
  };
  player.on("frame", () => {
    isNew = true;
    following ??= follow();
  });
  return row;
}

function actions(player: Player): HTMLElement {
  const button = (text: string, act: () => void) =>
    make("button", { type: "button", className: "text", onclick: act }, text);
  return make(
    "footer",
    {},
    player.payload.parameters.length > 0 && button("Reset all", () => player.resetAll()),
    player.payload.steering && button("Reset camera", () => player.resetCamera()),
    button("Copy as code", () => void player.copyCode()),
  );
}

function statistics(player: Player): HTMLElement {
  const text = make("p", { className: "hint", "aria-hidden": true }, "\u00a0");
  let last = -Infinity;
  player.on("frame", ({ ms, width, height, fps, samples }) => {
    const now = performance.now();
    if (fps && now - last < STATISTICS_MS) return;
    last = now;
    const pace = fps ? ` · ${fps.toFixed(0)} fps` : "";
    const more = samples > 1 ? ` · ${samples} samples` : "";
    text.textContent = `${width}×${height} · ${ms.toFixed(ms < 10 ? 1 : 0)} ms${pace}${more}`;
  });
  return text;
}
