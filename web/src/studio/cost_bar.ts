/**
 * What the column of costs shows: runs, work or time, and the button that measures time.
 *
 * Input: who answers, the player, the line of the caret. Output: elements, figures for the editor.
 * Whatever changes the picture makes all figures stale: they go, runs and work come again by
 * themselves, time when it is asked for.
 */

import { make } from "../dom";
import type { Counting, LineTiming } from "../generated/messages";
import type { Player } from "../player";
import type { Figure, Figures } from "./costs";
import { countsOf, runFigures, workFigures, type Count } from "./counts";
import { timeFigures, timesOf, type Times } from "./times";

export interface CostHost {
  /** The worker's program; null where there is none. */
  count(work: boolean): Promise<Counting | null>;
  time(): Promise<LineTiming | null>;
  player(): Player | null;
  /** The file that is shown. */
  file(): string;
  /** Shows figures; null takes the column away. */
  show(figures: readonly Figure[] | null): void;
  /** The column came or went. */
  toggled(): void;
}

type Which = "runs" | "work" | "time";

const CHOICES: [Which, label: string, about: string][] = [
  ["runs", "Runs", "How often each line runs for a pixel, on average: counted on the GPU."],
  ["work", "Work (estimated)", "Operations of each line for a pixel, on average: an estimate."],
  ["time", "Time (measured)", "The part of the picture's time that each line takes on this GPU."],
];
/** After the last change of the picture, so long until lines are counted again. */
const REST_MS = 400;

export class CostBar {
  readonly element = make("div", { className: "cost-bar", role: "group", "aria-label": "Cost of lines", hidden: true });
  #measure = make("button", { type: "button" }, "Measure");
  #progress = make("progress", { max: 1, value: 0, hidden: true, "aria-label": "Lines measured" });
  #about = make("p", { className: "cost-about", "aria-live": "polite" });
  /** What was found last, of the picture as it is. */
  counts: Map<string, Count[]> | null = null;
  times: Times | null = null;
  #which: Which = "runs";
  #figures: Figures = new Map();
  #line = 0;
  #isMeasuring = false;
  /** Grows with each change: what was asked before it is stale. */
  #state = 0;
  #timer = 0;
  #player: Player | null = null;
  #ends: (() => void)[] = [];

  constructor(readonly host: CostHost) {
    this.#measure.onclick = () => (this.#isMeasuring ? this.changed("Stopped.") : void this.#time());
    const choices = CHOICES.map(([which, label]) => {
      const input = make("input", { type: "radio", name: "cost", value: which, checked: which === this.#which });
      input.onchange = () => {
        // Figures of another kind did not become stale.
        this.#figures = new Map();
        this.#which = which;
        this.changed();
        void this.#count();
      };
      return make("label", {}, input, label);
    });
    const row = make("div", { className: "cost-choices" }, ...choices, this.#measure, this.#progress);
    this.element.append(row, this.#about);
  }

  get isOpen(): boolean {
    return !this.element.hidden;
  }

  toggle(): void {
    this.element.hidden = this.isOpen;
    this.changed();
    this.host.toggled();
    if (this.isOpen) void this.#count();
  }

  /** The text, the camera, a value or something else is another: what was found is stale. */
  changed(why = ""): void {
    this.#state += 1;
    clearTimeout(this.#timer);
    const isStale = this.#isMeasuring || this.#figures.size > 0;
    if (this.#isMeasuring) this.#player?.pauseDrawing(false);
    this.#isMeasuring = false;
    this.#figures = new Map();
    this.counts = this.times = null;
    this.#show();
    this.#say(why || (isStale && this.#which === "time" ? "Something has changed since: measure again." : ""));
  }

  /** The text was compiled: runs and work are counted again. */
  async compiled(): Promise<void> {
    if (this.element.hidden) return;
    this.changed();
    await this.#count();
  }

  /** Another file is shown. */
  shown(): void {
    this.#show();
    this.#say();
  }

  /** The caret is on another line: its figure is explained. */
  moved(line: number): void {
    this.#line = line;
    if (!this.element.hidden && !this.#isMeasuring && this.#figures.size) this.#say();
  }

  #show(): void {
    this.host.show(this.element.hidden ? null : (this.#figures.get(this.host.file()) ?? []));
  }

  #say(text = ""): void {
    const isTime = this.#which === "time";
    this.#measure.hidden = !isTime;
    this.#measure.textContent = this.#isMeasuring ? "Stop" : "Measure";
    this.#progress.hidden = !this.#isMeasuring;
    const about = CHOICES.find(([which]) => which === this.#which)![2];
    const own = this.#figures.get(this.host.file())?.find(({ line }) => line === this.#line);
    const line = own ? `Line ${own.line}: ${own.hint}.` : "";
    this.#about.textContent = text || line || about;
  }

  /** Follows what changes the picture. */
  #follow(player: Player): void {
    if (player === this.#player) return;
    for (const end of this.#ends.splice(0)) end();
    this.#player = player;
    const moved = () => {
      if (this.element.hidden) return;
      this.changed();
      this.#timer = window.setTimeout(() => void this.#count(), REST_MS);
    };
    let time = player.time;
    this.#ends.push(
      player.on("steering", moved),
      player.on("parameter", moved),
      player.on("view", moved),
      player.on("mode", moved),
      // While it plays, the figures are those of the time when they were asked for.
      player.on("time", ({ time: now, playing }) => {
        if (!playing && now !== time) moved();
        time = now;
      }),
    );
  }

  async #count(): Promise<void> {
    const player = this.host.player();
    if (this.element.hidden || this.#which === "time" || !player) return;
    this.#follow(player);
    const state = this.#state;
    const isWanted = () => state === this.#state && this.host.player() === player;
    const isWork = this.#which === "work";
    const counting = await this.host.count(isWork);
    if (!counting || !isWanted()) return;
    const counts = await countsOf(counting, player, isWanted);
    if (!counts || !isWanted()) return;
    this.counts = counts;
    this.#found(isWork ? workFigures(counts, counting.most) : runFigures(counts));
  }

  async #time(): Promise<void> {
    const player = this.host.player();
    if (!player) return this.#say("There is no picture to measure.");
    this.#follow(player);
    this.changed();
    const state = this.#state;
    const isWanted = () => state === this.#state && this.host.player() === player;
    this.#isMeasuring = true;
    this.#progress.value = 0;
    this.#say("Compiling …");
    const timing = await this.host.time();
    if (!isWanted()) return;
    player.pauseDrawing(true);
    this.#say("Measuring line by line; it may take a minute.");
    const progress = (part: number) => (this.#progress.value = part);
    const times = timing && (await timesOf(timing, player, { isWanted, progress }));
    if (!isWanted()) return;
    this.#isMeasuring = false;
    player.pauseDrawing(false);
    this.times = times;
    if (times) this.#found(timeFigures(times));
    else this.#say("Not measurable: there is no program of this scene that the GPU draws.");
  }

  #found(figures: Figures): void {
    this.#figures = figures;
    this.#show();
    this.#say();
  }
}
