/**
 * Questions about the picture: what a pixel shows, what a line makes, which program measures lines.
 *
 * Input: clicks, the line under the mouse. Output: marks in the code, outlines in the picture, programs.
 */

import type { Results, ShapeMap } from "../generated/messages";
import type { Asked } from "./client";
import type { Studio } from "./studio";

/** The mouse rests so long on a line until its shape is outlined. */
const POINTED_MS = 70;
/** So long a line is outlined that the caret came to. */
const CARET_MS = 1600;

export class Asking {
  #pointing = 0;
  #pointedAt: number | null = null;
  #shapes: { revision: number; object: string | null; map: Promise<ShapeMap | null> } | null = null;

  constructor(readonly studio: Studio) {}

  /** The worker's program that measures lines of the text as it is. */
  async lineProgram<K extends "count" | "time">(kind: K, more: object = {}): Promise<Results[K] | null> {
    const { client, looking, texts } = this.studio;
    if (!looking.can(kind)) return null;
    const { revision } = texts;
    const answer = await client.ask({ kind, ...looking.source, ...more } as Asked);
    const isIt = answer?.kind === "answer" && answer.request === kind && revision === texts.revision;
    return isIt ? (answer.result as Results[K]) : null;
  }

  /** Outlines what a line makes: while the mouse is on it, and for a moment when the caret comes. */
  pointed(name: string, line: number | null, isMouse: boolean): void {
    if (isMouse && line === this.#pointedAt) return;
    this.#pointedAt = isMouse ? line : null;
    clearTimeout(this.#pointing);
    const { looking, picture } = this.studio;
    const { outline, player } = picture;
    this.#pointing = window.setTimeout(() => {
      const makes = line !== null && looking.makers.has(`${name}:${line}`);
      outline.show(player, makes ? { file: name, line } : null);
      if (isMouse || !makes) return;
      this.#pointing = window.setTimeout(() => outline.show(player, null), CARET_MS);
    }, POINTED_MS);
  }

  /** Which shape each pixel shows; asked for once for each text. */
  map(): Promise<ShapeMap | null> {
    const { client, looking, texts, turning } = this.studio;
    const { revision } = texts;
    const { object } = looking;
    if (!looking.can("map") || looking.isStopped || turning.isOn) return Promise.resolve(null);
    if (this.#shapes?.revision !== revision || this.#shapes.object !== object) {
      const asked = client.ask({ kind: "map", ...looking.source });
      const map = asked.then((answer) => {
        if (answer?.kind === "answer" && answer.request === "map") return answer.result;
        // Dropped for something newer: the next one asks again.
        if (answer?.kind === "dropped" && this.#shapes?.map === map) this.#shapes = null;
        return null;
      });
      this.#shapes = { revision, object, map };
    }
    return this.#shapes.map;
  }

  /** Names what a pixel shows, and marks the line that makes it. */
  async probe(x: number, y: number): Promise<void> {
    const { client, editor, looking, page, picture, tabs, texts } = this.studio;
    if (!looking.can("probe")) return;
    const { player } = picture;
    const { yaw = 0, pitch = 0, zoom = 1, pan = [0, 0] } = player?.steering() ?? {};
    const steering = { yaw, pitch, zoom, pan_x: pan[0]!, pan_y: pan[1]! };
    const { revision } = texts;
    const time = player?.time ?? 0;
    const answer = await client.ask({ kind: "probe", ...looking.source, time, x, y, steering });
    if (answer?.kind !== "answer" || answer.request !== "probe" || revision !== texts.revision) return;
    const { shape, material, file, line, numbers } = answer.result;
    const what = shape ? [shape, material].filter(Boolean).join(", ") : "The background";
    const count = numbers["steps"];
    const steps = count === undefined ? "" : ` · ${count} ${count === 1 ? "step" : "steps"}`;
    page.announcer.textContent = `${what}${steps}`;
    page.work.textContent = `${what}${steps}`;
    if (file && line) {
      tabs.goTo(file, line);
      editor.link([line]);
    } else editor.link([]);
  }
}
