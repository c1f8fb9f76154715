/**
 * Values that move where people can see it: a phrase or an experiment turns sliders over a moment.
 *
 * Input: values by name. Output: the player's parameters, step by step; marks on the sliders.
 */

import { shown } from "../numbers";
import type { Value, Values } from "../payload";
import type { Player } from "../player";
import type { Sliders } from "./sliders";

const MOVE_MS = 600;
const MARK_MS = 1600;

export class Changes {
  #moving = 0;

  constructor(
    readonly player: Player,
    readonly sliders: Sliders,
    readonly say: (text: string) => void,
  ) {}

  /** Moves parameters to values; resolves when they are there. A newer move ends this one. */
  async move(values: Values): Promise<void> {
    const mine = ++this.#moving;
    const before = this.player.parameters();
    const names = Object.keys(values);
    for (const name of names) this.#mark(name);
    this.say(names.map((name) => `${this.#label(name)}: ${told(values[name]!)}`).join(", "));
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const start = performance.now();
    let part = calm ? 1 : 0;
    while (part < 1 && mine === this.#moving) {
      const now = await new Promise<number>(requestAnimationFrame);
      part = Math.min(1, Math.max(0, (now - start) / MOVE_MS));
      const eased = part * part * (3 - 2 * part);
      if (mine !== this.#moving) return;
      for (const name of names) this.#set(name, between(before[name]!, values[name]!, eased));
    }
    if (mine === this.#moving) for (const name of names) this.#set(name, values[name]!);
  }

  #set(name: string, value: Value): void {
    this.player.change(name, value);
  }

  #label(name: string): string {
    return this.player.payload.parameters.find((p) => p.name === name)?.label ?? name;
  }

  /** Brings a slider into its strip and marks it. */
  #mark(name: string): void {
    const element = this.sliders.get(name)?.element;
    const strip = element?.parentElement;
    if (!element || !strip) return;
    // Only the strip scrolls: the reader's place in the text stays.
    strip.scrollLeft += element.getBoundingClientRect().left - strip.getBoundingClientRect().left;
    const bench = strip.parentElement!;
    const [row, frame] = [element.getBoundingClientRect(), bench.getBoundingClientRect()];
    if (row.bottom > frame.bottom) bench.scrollTop += row.bottom - frame.bottom;
    element.classList.add("moved");
    setTimeout(() => element.classList.remove("moved"), MARK_MS);
  }
}

/** A value on the way; what is no number changes at once. */
function between(from: Value, to: Value, part: number): Value {
  if (typeof from === "number" && typeof to === "number") return from + (to - from) * part;
  if (Array.isArray(from) && Array.isArray(to)) {
    return to.map((value, i) => from[i]! + (value - from[i]!) * part);
  }
  return to;
}

function told(value: Value): string {
  if (typeof value === "boolean") return value ? "on" : "off";
  return Array.isArray(value) ? value.map(shown).join(", ") : shown(value);
}

/** What a button of the page sets. */
export function valuesOf(button: HTMLElement): Values {
  return JSON.parse(button.dataset["values"] ?? "{}") as Values;
}
