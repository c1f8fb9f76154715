/**
 * When to draw what: the schedule of one canvas.
 *
 * Input: "something changed", the view's program, whether anybody looks. Output: pictures, as sharp as
 * time allows: small ones while things move, a full one, in bands, once they rest, then with more
 * samples for each pixel, where the program can take them. A program with a film shows direct light
 * while things move, and random paths once they rest. Nothing is drawn when nothing changed, when the
 * canvas is out of sight, or while the context is lost.
 */

import { Frames } from "./frames";
import type { Keys } from "./keys";
import { Painter } from "./painter";
import { Paths } from "./paths";
import type { Payload, Program } from "./payload";
import { LostError, type Linked } from "./program";
import { PACKED, PROBE, hasRange, rangeOf } from "./range";
import { PROBE_PIXELS, Resolution } from "./resolution";
import { forget } from "./trust";
import type { Given, Inputs } from "./uniforms";
import type { Sound } from "./sound";
import { gpuDone, nextFrame, soonFrame } from "./waiting";

export type State = "waiting" | "compiling" | "ready" | "lost" | "failed" | "unsupported";
export type Scale = number | "auto";

export interface FrameReport {
  /** What the GPU took, in milliseconds. */
  ms: number;
  width: number;
  height: number;
  /** Pictures in a row, in a second; 0 for a still. */
  fps: number;
  /** Of each pixel. */
  samples: number;
  /** Of random paths: samples a second. */
  rate?: number;
}

/** What the schedule needs to know of the scene it draws. */
export interface Subject {
  readonly playing: boolean;
  /** A sharp picture is shown until ours is sharp: no coarse one in between. */
  readonly hasPoster: boolean;
  /** A new frame is about to be drawn; `now` in milliseconds. */
  tick(now: number): void;
  /** `isWhole`: nothing covers the picture. */
  inputs(width: number, height: number, isWhole?: boolean): Inputs;
  /** A picture was drawn from the inputs. */
  drawn(report: FrameReport): void;
  state(state: State, error?: unknown): void;
  /** Direct light is shown, because paths cannot be traced. */
  noPaths?(error: unknown): void;
}

interface Plan {
  scale: number;
  samples: number;
  size: [number, number];
  revision: number;
  /** A still nobody wants any more is dropped; a moving picture is shown whatever comes next. */
  abortable: boolean;
  /** A picture to save, which is not shown. */
  isAside: boolean;
  /** More samples of the film. */
  isTraced?: boolean;
}

interface Capture {
  samples: number;
  resolve: (blob: Blob | null) => void;
}

/** After the last change things count as moving for so long. */
const REST_MS = 180;
/** Who waits longer for a still wants to see something meanwhile. */
const LONG_MS = 300;
/** Pixels that cost nothing. */
const FEW = 64;
/** The way to the GPU and back takes a few milliseconds; what takes longer is something else. */
const LONGEST_WAY_MS = 8;
/** A draw must take this many times the overhead for its time to measure its pixels. */
const CLEAR_MS = 6;
/** Samples of a pixel, one after the other, where a picture rests. */
const SAMPLES = [1, 4, 16] as const;
/** A picture with more samples that would take longer is not worth the work. */
const LONGEST_MS = 4000;
/** The samples of a saved picture. */
export const FINEST_SAMPLES = SAMPLES.at(-1)!;

export class Renderer {
  canvas: HTMLCanvasElement;
  #painter: Painter | null = null;
  #wanted: Program | null = null;
  #program: Linked | null = null;
  #resolution = new Resolution();
  #scale: Scale = "auto";
  #visible = false;
  #pumping = false;
  #revision = 0;
  #changed = 0;
  #shown = { revision: -1, scale: 0, samples: 0 };
  #captures: Capture[] = [];
  #range: { revision: number; program: Linked | null; numbers: Given } = {
    revision: -1,
    program: null,
    numbers: {},
  };
  #resting: ((isSharp: boolean) => void)[] = [];
  #isBroken = false;
  #times: number[] = [];
  /** Of an editor: the programs that are still needed. */
  declare kept?: Program[];
  /** The film of the program in use, if it has one. */
  declare paths?: Paths | null;
  /** What the program in use reads of other frames, if it does. */
  declare frames?: Frames | null;
  declare keys?: Keys;
  declare sound?: Sound | null;
  declare pictures?: Map<string, ImageBitmap>;

  /** What draws, for an editor; null before it starts and after it was lost. */
  declare painter: () => Painter | null;

  constructor(
    readonly subject: Subject,
    public resources: Payload["resources"],
    readonly transparent: boolean,
    canvas: HTMLCanvasElement,
  ) {
    this.canvas = canvas;
    if (EDITED) this.painter = () => this.#painter;
  }

  /** Takes a context, on a fresh canvas after an earlier one failed. */
  start(canvas = this.canvas): void {
    this.canvas = canvas;
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault(); // Else it never comes back.
      if (canvas === this.canvas && this.#painter) this.#lose();
    });
    canvas.addEventListener("webglcontextrestored", () => {
      if (canvas === this.canvas) this.#begin();
    });
    this.#begin();
  }

  /** Shows a program's picture as soon as it is compiled; until then the old one stays. */
  async use(source: Program): Promise<void> {
    this.#wanted = source;
    const painter = this.#painter;
    if (!painter) return;
    this.#enter("compiling");
    const isStale = () => this.#wanted !== source || this.#painter !== painter;
    try {
      const program = await painter.program(source);
      if (FRAMES && !isStale()) {
        const frames = source.frames ? new Frames(painter, source.frames, this.keys!, this.sound ?? null, this.pictures!) : null;
        await frames?.prepare();
        if (isStale()) return frames?.dispose();
        this.frames?.dispose();
        this.frames = frames;
      }
      if (isStale()) return;
      this.#program = program;
      this.#resolution.forget();
      if (PATHS) this.paths = source.film ? new Paths(painter, source.film) : null;
      this.#enter("ready");
      if (EDITED) painter.keep(this.kept!, this.resources);
      this.change();
      if (PATHS && this.paths) {
        await this.paths.prepare().catch((error: unknown) => {
          if (isStale() || error instanceof LostError) return;
          this.paths = null;
          this.subject.noPaths?.(error);
        });
        void this.#pump();
      }
    } catch (error) {
      if (!isStale() && !(error instanceof LostError)) this.#enter("failed", error);
    }
  }

  /** Something that the picture shows has changed. */
  change(): void {
    this.#revision += 1;
    this.#changed = performance.now();
    void this.#pump();
  }

  /** Draws again; what a pixel costs is measured again. */
  redraw(): void {
    this.#resolution.forget();
    this.change();
  }

  set scale(scale: Scale) {
    this.#scale = scale;
    this.#shown.scale = 0;
    void this.#pump();
  }

  get scale(): Scale {
    return this.#scale;
  }

  set visible(visible: boolean) {
    this.#visible = visible;
    void this.#pump();
  }

  /** The canvas has another size in pixels; the last picture is stretched until a new one is. */
  resize(width: number, height: number): void {
    const { canvas } = this;
    if (canvas.width === width && canvas.height === height) return;
    canvas.width = width;
    canvas.height = height;
    this.#painter?.show();
    this.change();
  }

  /** What a program draws from some inputs, byte by byte; null where it cannot be drawn. */
  async pixels(source: Program, inputs: Inputs, size: [number, number]): Promise<Uint8Array | null> {
    const painter = this.#painter;
    if (!painter) return null;
    try {
      return await painter.pixels(await painter.program(source), inputs, size);
    } catch {
      return null;
    }
  }

  /** A PNG of what is to be seen, at the canvas's full scale, as if nothing covered it. */
  capture(samples: number): Promise<Blob | null> {
    return new Promise((resolve) => {
      this.#captures.push({ samples, resolve });
      void this.#pump();
    });
  }

  /** Whether the sharp picture of the current state is shown, as soon as that is known. */
  rest(): Promise<boolean> {
    return new Promise((resolve) => {
      this.#resting.push(resolve);
      void this.#pump();
    });
  }

  dispose(): void {
    const painter = this.#painter;
    this.#painter = null;
    this.#visible = false;
    this.#isBroken = true;
    this.#endRest();
    painter?.dispose();
  }

  #begin(): void {
    this.#program = null;
    this.#shown = { revision: -1, scale: 0, samples: 0 };
    try {
      this.#painter = new Painter(this.canvas, this.resources, this.transparent);
    } catch (error) {
      this.#painter = null;
      this.#enter("unsupported", error);
      return;
    }
    if (this.#wanted) void this.use(this.#wanted);
  }

  #lose(): void {
    this.#painter = null;
    this.#program = null;
    forget();
    this.#enter("lost");
  }

  get #stillScale(): number {
    return this.#scale === "auto" ? 1 : this.#scale;
  }

  get #isSharp(): boolean {
    const { revision, scale } = this.#shown;
    return revision === this.#revision && scale >= this.#stillScale;
  }

  #wants(): boolean {
    if (!this.#visible || !this.#painter || !this.#program) return false;
    if (PATHS && this.paths?.wants(this.#revision)) return true;
    const isDone = this.#isSharp && !this.#nextSamples();
    return this.subject.playing || !isDone || this.#captures.length > 0;
  }

  /** How many samples the picture that rests gets next; 0 if it has enough. */
  #nextSamples(): number {
    const program = this.#program;
    if (PATHS && this.paths) return 0;
    if (this.subject.playing || !this.#isSharp || !program || !canSample(program)) return 0;
    const next = SAMPLES.find((samples) => samples > this.#shown.samples) ?? 0;
    const [width, height] = this.#painter!.size(this.#stillScale);
    return (this.#resolution.cost ?? 0) * width * height * next <= LONGEST_MS ? next : 0;
  }

  async #pump(): Promise<void> {
    if (this.#pumping) return;
    this.#pumping = true;
    try {
      while (this.#wants()) {
        const traces = PATHS && this.paths && !this.subject.playing;
        const now = await (traces ? soonFrame() : nextFrame());
        if (!this.#wants()) break;
        this.subject.tick(now);
        const plan = this.#plan();
        if (plan) await this.#picture(plan);
      }
    } catch (error) {
      // Data that no texture can be made of: shown like a shader that fails, not tried each frame.
      this.#program = null;
      this.#enter("failed", error);
    } finally {
      this.#pumping = false;
    }
    this.#endRest();
  }

  #endRest(): void {
    // The old view's picture is outdated while the new one compiles.
    const isThere = this.#isSharp && this.#program?.source === this.#wanted;
    if (PATHS && this.paths && this.paths.samples < FINEST_SAMPLES && !this.#isBroken) return;
    if (!isThere && !this.#isBroken) return;
    for (const resolve of this.#resting.splice(0)) resolve(isThere);
  }

  /** Tells of the state; nobody is kept waiting for a picture that does not come. */
  #enter(state: State, error?: unknown): void {
    this.#isBroken = state === "failed" || state === "unsupported";
    this.subject.state(state, error);
    if (state === "compiling" || state === "ready") return;
    for (const { resolve } of this.#captures.splice(0)) resolve(null);
    this.#endRest();
  }

  #plan(): Plan | null {
    const painter = this.#painter!;
    const revision = this.#revision;
    const plan = (scale: number, abortable: boolean, samples = 1, isAside = false): Plan => {
      return { scale, samples, size: painter.size(scale), revision, abortable, isAside };
    };
    if (PATHS && this.paths && !this.subject.playing) {
      const { paths } = this;
      const isNew = revision !== this.#shown.revision;
      // Until there are samples, the poster or direct light is to be seen.
      if (!isNew || (this.#shown.revision < 0 && this.subject.hasPoster)) {
        if (performance.now() - this.#changed < REST_MS || !paths.isReady) return null;
        const [width, height] = painter.size(this.#stillScale);
        const scale = paths.scale(revision, width * height, this.#stillScale, isNew);
        return { ...plan(scale, true), isTraced: true };
      }
    } else if (this.#captures[0]) {
      const samples = canSample(this.#program!) ? this.#captures[0].samples : 1;
      return plan(Math.max(1, this.#stillScale), false, samples, true);
    }
    // Frames build on one another: all have one size.
    if (FRAMES && this.frames) return this.#wants() ? plan(this.#stillScale, false) : null;
    const rests = performance.now() - this.#changed >= REST_MS;
    const next = this.#nextSamples();
    if (next) return rests ? plan(this.#stillScale, true, next) : null;
    if (this.#scale !== "auto") return plan(this.#scale, false);
    const { cost } = this.#resolution;
    if (cost === null) return plan(1, true); // Settled after the probe.
    const pixels = this.canvas.width * this.canvas.height;
    const playing = this.subject.playing;
    const isNews = revision !== this.#shown.revision;
    if (!playing && rests) {
      // A still that takes long is heralded by a coarse picture.
      const isAwaited = this.#shown.revision >= 0 || !this.subject.hasPoster;
      if (!isNews || !isAwaited || cost * pixels < LONG_MS) return plan(1, true);
    } else if (!playing && !isNews) return null; // It may come to rest.
    return plan(this.#resolution.moving(pixels), false);
  }

  async #picture(plan: Plan): Promise<void> {
    if (this.#resolution.cost === null && !(PATHS && plan.isTraced) && !(FRAMES && this.frames)) {
      await this.#probe();
      return; // The cost is known now: plan again.
    }
    const painter = this.#painter!;
    const program = this.#program!;
    const { samples, isAside } = plan;
    const [width, height] = plan.size;
    let inputs = this.subject.inputs(width, height, FRAMES && this.frames ? false : isAside);
    if (FRAMES && this.frames) inputs = this.frames.begin(program, inputs);
    if (PATHS && this.paths && plan.isTraced) {
      const { paths } = this;
      const isStale = () => {
        const isOld = plan.revision !== this.#revision || painter !== this.#painter;
        return isOld || paths !== this.paths;
      };
      const { floor } = this.#resolution;
      const ms = await paths.add(plan.revision, plan.size, inputs, floor, isStale);
      if (ms === null || !paths.isShown) return;
      const { samples, rate } = paths;
      paths.show(inputs);
      const least = plan.scale < this.#stillScale ? Infinity : this.#captures[0]?.samples;
      const blob = least !== undefined && samples >= least && painter.png(this.transparent);
      this.#present(painter, { ...plan, samples });
      if (blob) this.#captures.shift()?.resolve(await blob);
      this.#endRest();
      return this.subject.drawn({ ms, width, height, fps: 0, samples, rate });
    }
    const range = await this.#rangeOf(painter, program, plan.revision);
    if (painter !== this.#painter || (EDITED && program !== this.#program)) return;
    inputs.number = { ...inputs.number, ...range, Samples: samples };
    let total = 0;
    for (let column = 0; column < width; ) {
      const columns = Math.min(this.#resolution.columns(height * samples), width - column);
      painter.draw(program, inputs, plan.size, column, columns);
      column += columns;
      // In the task of the last draw: the picture appears whole, and as early as it can.
      if (column >= width && !isAside) this.#present(painter, plan);
      const ms = await gpuDone(painter.gl);
      if (ms === null || painter !== this.#painter) return;
      // What an editor replaced is gone, its textures too.
      if (EDITED && program !== this.#program) return;
      this.#resolution.measure(ms, columns * height * samples);
      total += ms;
      const isOld = plan.revision !== this.#revision || program !== this.#program;
      if (plan.abortable && isOld && column < width) return;
    }
    if (FRAMES) this.frames?.end();
    if (!isAside) return this.subject.drawn({ ms: total, width, height, fps: this.#fps(), samples });
    const blob = await painter.png(this.transparent);
    this.#captures.shift()?.resolve(blob);
  }

  #present(painter: Painter, { revision, scale, samples }: Plan): void {
    painter.present();
    this.#shown = { revision, scale, samples };
  }

  /** The range of the values that a view shows, measured once for each state. */
  async #rangeOf(painter: Painter, program: Linked, revision: number): Promise<Given> {
    if (!hasRange(program.source)) return {};
    const known = this.#range;
    if (known.revision === revision && known.program === program && !this.subject.playing) {
      return known.numbers;
    }
    const inputs = this.subject.inputs(...PROBE, true);
    inputs.frame = { ...inputs.frame, resolution: PROBE };
    inputs.number = { ...inputs.number, ...PACKED, Frame_offset: [0, 0] };
    const bytes = await painter.pixels(program, inputs, PROBE);
    const numbers = bytes ? rangeOf(bytes) : {};
    this.#range = { revision, program, numbers };
    return numbers;
  }

  /** What does a pixel cost? Nobody sees these draws; they grow until there is time to measure. */
  async #probe(): Promise<void> {
    const all = this.canvas.width * this.canvas.height;
    await this.#try(FEW); // What drivers put off until the first draw.
    const way = await this.#try(FEW); // The way to the GPU and back.
    if (!way) return;
    this.#resolution.floor = Math.min(way.ms, LONGEST_WAY_MS);
    for (let most = PROBE_PIXELS; ; most *= 6) {
      const tried = await this.#try(most);
      if (!tried) return;
      this.#resolution.forget();
      this.#resolution.measure(tried.ms, tried.pixels);
      if (tried.ms > way.ms + CLEAR_MS || most >= all) return;
    }
  }

  /** Draws about so many pixels for the clock alone; null where the program went away. */
  async #try(most: number): Promise<{ ms: number; pixels: number } | null> {
    const painter = this.#painter;
    const program = this.#program;
    if (!painter || !program) return null;
    const { width, height } = this.canvas;
    const size = painter.size(Math.min(1, Math.sqrt(most / (width * height))));
    painter.draw(program, this.subject.inputs(...size), size, 0, size[0]);
    const ms = await gpuDone(painter.gl);
    return ms === null || program !== this.#program ? null : { ms, pixels: size[0] * size[1] };
  }

  #fps(): number {
    if (!this.subject.playing) {
      this.#times = [];
      return 0;
    }
    const now = performance.now();
    this.#times = [...this.#times.filter((time) => now - time < 1000), now];
    const span = now - this.#times[0]!;
    return span > 0 ? ((this.#times.length - 1) * 1000) / span : 0;
  }
}

function canSample({ source }: Linked): boolean {
  return source.uniforms.some(({ name, origin }) => origin === "number" && name === "Samples");
}
