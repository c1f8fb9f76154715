/**
 * Small stills of any view and values, drawn by a second player that nobody sees.
 *
 * The one picture that people look at never changes for a still. Requests wait for each other.
 */

import { mount } from "../main";
import type { Payload, Values } from "../payload";
import type { Player } from "../player";

const WIDTH_PX = 192;
const SAMPLES = 4;

export class Stills {
  #player: Player | undefined;
  #last: Promise<unknown> = Promise.resolve();
  #host: HTMLElement;

  constructor(readonly payload: Payload) {
    this.#host = document.createElement("div");
    this.#host.className = "aside";
    this.#host.inert = true;
    this.#host.setAttribute("aria-hidden", "true");
    const [width, height] = payload.size;
    this.#host.style.width = `${WIDTH_PX}px`;
    this.#host.style.height = `${Math.round((WIDTH_PX * height) / width)}px`;
    document.body.append(this.#host);
  }

  /** A still as a PNG; null where none can be drawn. */
  take(view: string, values: Values, time: number): Promise<Blob | null> {
    const made = this.#last.then(() => this.#draw(view, values, time));
    this.#last = made.catch(() => null);
    return made;
  }

  async #draw(view: string, values: Values, time: number): Promise<Blob | null> {
    this.#player ??= mount(this.#host, this.payload, { embed: true, playing: false });
    const player = this.#player;
    for (const [name, value] of Object.entries(values)) player.setParameter(name, value);
    player.setView(view);
    player.setTime(time);
    return (await player.settled()) ? player.screenshot(SAMPLES) : null;
  }
}

/** Shows a picture in an image, and frees the one before it. */
export function show(image: HTMLImageElement, picture: Blob): void {
  const last = image.src;
  image.src = URL.createObjectURL(picture);
  if (last.startsWith("blob:")) URL.revokeObjectURL(last);
}

/** Calls `act` a moment after the last of many calls. */
export function later(act: () => void, wait_ms = 350): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(act, wait_ms);
  };
}
