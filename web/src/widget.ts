/**
 * The same player in a notebook (anywidget's `render`), its state bound both ways to the model.
 *
 * Input: a model with the traits "payload", "params", "time", "playing", "view", "steering", "error".
 * Output: a player in the cell, disposed of with the cell. What a person does reaches the model, what
 * Python sets reaches the player; several cells may show one model.
 */

import type { Steering } from "./camera";
import { NARROW_PX } from "./frame";
import type { Payload, Values } from "./payload";
import { Player } from "./player";
import { same } from "./values";

export interface Model {
  get(name: string): unknown;
  set(name: string, value: unknown): void;
  save_changes(): void;
  on(event: string, listener: () => void): void;
  off(event: string, listener: () => void): void;
}

/** How long Python is left alone between two messages: time runs 60 frames a second. */
const PAUSE_MS = 100;
// As the style sheet has them.
const PANEL_PX = 304 + 2 * 12;
const TOOLBAR_PX = 44 + 12;

export function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const payload = model.get("payload") as Payload;
  const host = hostOf(payload);
  el.append(host);
  const player = new Player(host, payload, { playing: model.get("playing") as boolean });
  Object.assign(host, { distal: player }); // as a page's host keeps it
  const mine = new Outbox(model);

  const take: Record<string, () => void> = {
    params: () => {
      for (const [name, value] of Object.entries(model.get("params") as Values)) {
        if (!same(value, player.parameters()[name])) player.setParameter(name, value);
      }
    },
    time: () => {
      const time = model.get("time") as number;
      if (time !== mine.last("time")) player.setTime(time);
    },
    playing: () => {
      if (model.get("playing") !== player.playing) player.toggle();
    },
    view: () => player.setView(model.get("view") as string),
    steering: () => {
      const steering = model.get("steering") as Steering;
      if (steering !== mine.last("steering")) player.setSteering(steering);
    },
  };
  const ended = [
    player.on("change", () => mine.put("params", player.parameters())),
    player.on("time", ({ time, playing }) => {
      mine.put("time", time);
      mine.put("playing", playing);
    }),
    player.on("view", ({ name }) => mine.put("view", name)),
    player.on("steering", (steering) => mine.put("steering", { ...steering })),
    player.on("error", ({ message, log }) => mine.put("error", `${message}\n${log}`.trim())),
  ];
  for (const [name, act] of Object.entries(take)) {
    act();
    model.on(`change:${name}`, act);
  }
  return () => {
    for (const [name, act] of Object.entries(take)) model.off(`change:${name}`, act);
    for (const end of ended) end();
    mine.close();
    player.dispose();
  };
}

/** The element of the player: the picture has its size, and the panel is next to it. */
function hostOf({ size: [width, height], panel }: Payload): HTMLElement {
  const host = document.createElement("div");
  // No narrower than where the panel would go below the picture.
  const full = panel ? Math.max(width + PANEL_PX, NARROW_PX) : width;
  host.style.width = `min(100%, ${full}px)`;
  host.style.height = `${height + (panel ? TOOLBAR_PX : 0)}px`;
  // Keys meant for the player are not the notebook's: JupyterLab reads the mark before any listener
  // here is asked, other notebooks listen to what bubbles up.
  host.dataset.distal = "";
  host.dataset.lmSuppressShortcuts = "true";
  host.addEventListener("keydown", (event) => event.stopPropagation());
  return host;
}

/** What to send to Python: the newest of each, a few times a second. */
class Outbox {
  #waiting = new Map<string, unknown>();
  #sent = new Map<string, unknown>();
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(readonly model: Model) {}

  put(name: string, value: unknown): void {
    if ((this.#waiting.get(name) ?? this.model.get(name)) === value) return;
    this.#waiting.set(name, value);
    this.#timer ??= setTimeout(() => this.#send(), PAUSE_MS);
  }

  /** What was last put under a name, so that one's own word is not taken for another's. */
  last(name: string): unknown {
    return this.#sent.get(name);
  }

  #send(): void {
    this.#timer = undefined;
    const waiting = [...this.#waiting];
    this.#waiting.clear();
    for (const [name, value] of waiting) {
      this.#sent.set(name, value);
      this.model.set(name, value);
    }
    this.model.save_changes();
  }

  close(): void {
    clearTimeout(this.#timer);
    if (this.#waiting.size) this.#send();
  }
}
