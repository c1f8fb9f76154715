/**
 * Questions about the picture: what a pixel shows, what a line makes, how often it runs.
 *
 * Input: clicks, the line under the mouse, a switch. Output: marks in the code, outlines in the picture,
 * counts beside lines.
 */

import type { ShapeMap } from "../generated/messages";
import { runsOf, type Runs } from "./costs";
import type { Studio } from "./studio";

/** The mouse rests so long on a line until its shape is outlined. */
const POINTED_MS = 70;
/** So long a line is outlined that the caret came to. */
const CARET_MS = 1600;

export class Asking {
  /** Whether the editor shows how often lines run. */
  counts = false;
  #runs = new Map<string, Runs[]>();
  #pointing = 0;
  #pointedAt: number | null = null;
  #shapes: { revision: number; object: string | null; map: Promise<ShapeMap | null> } | null = null;

  constructor(readonly studio: Studio) {}

  toggleCounts(): void {
    this.counts = !this.counts;
    this.studio.commands.refresh();
    this.showRuns();
    void this.studio.channel.start?.();
    void this.count();
  }

  /** Counts again, where counts are shown. */
  async count(): Promise<void> {
    const { client, looking, picture, texts } = this.studio;
    if (!this.counts || !looking.can("count")) return;
    const { revision } = texts;
    const { player } = picture;
    const isWanted = () => this.counts && texts.revision === revision && picture.player === player;
    const answer = await client.ask({ kind: "count", ...looking.source });
    if (answer?.kind !== "answer" || answer.request !== "count" || !player || !isWanted()) return;
    const runs = await runsOf(answer.result, player, isWanted);
    if (!runs) return;
    this.#runs = runs;
    this.showRuns();
  }

  showRuns(): void {
    const { editor } = this.studio;
    editor.setRuns(this.counts ? (this.#runs.get(editor.name) ?? []) : []);
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
