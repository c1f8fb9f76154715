/**
 * A scene on a page: its state, and the events of its changes.
 *
 * Input: a host element and a payload; later what people and programs do. Output: the picture in the
 * host's shadow root, events. Styles and names stay inside; no network is used.
 */

import { Camera, type Steering } from "./camera";
import { Clock } from "./clock";
import { cameraOf, pythonOf } from "./code";
import { make } from "./dom";
import { Emitter, type Events } from "./events";
import { Frame, type Theme } from "./frame";
import { NOTHING_COVERED, frameOn } from "./framing";
import { gpuMs } from "./gpu_clock";
import { GUIDE_PIXELS, answer, numbersOf, question } from "./guide";
import { Hands, movesOf } from "./hands";
import type { Actions } from "./keyboard";
import { Keys } from "./keys";
import { Mouse } from "./mouse";
import { failureOf } from "./notices";
import {
  bytesOf,
  inflated,
  programsOf,
  type Parameter,
  type Payload,
  type Program,
  type UniformEntry,
  type Value,
  type Values,
} from "./payload";
import { link } from "./program";
import {
  FINEST_SAMPLES,
  Renderer,
  type FrameReport,
  type Scale,
  type State,
  type Subject,
} from "./renderer";
import { Resources, newTexture, uploadBuffer } from "./resources";
import { Sound } from "./sound";
import { copy, save } from "./taking";
import { setUniforms, type Given, type Inputs } from "./uniforms";
import { gpuDone } from "./waiting";

type Numbers = Record<string, UniformEntry["default"]>;
import { checked, clamp, same } from "./values";

export interface Options {
  /** The bare canvas instead of the whole player; the payload's choice where not given. */
  embed?: boolean;
  /** Colors of the panel; as the system has them where not given. */
  theme?: Theme;
  /** The page shows through where the scene is transparent. */
  transparent?: boolean;
  /** Whether time runs from the start; else it does where the scene moves and people like it. */
  playing?: boolean;
}

export class Player {
  /** What scripts beside this one use, which have no copy of it. */
  static readonly kit = {
    ...{ Resources, bytesOf, gpuDone, inflated, link, make, newTexture, programsOf, save, setUniforms, uploadBuffer },
  };
  payload: Payload;
  readonly camera: Camera | null;
  /** What the hand on the canvas does. */
  readonly hands: Hands;
  #emitter = new Emitter();
  #clock: Clock;
  #mouse = new Mouse();
  #values: Values = {};
  #view: string;
  #programs: Program[] = [];
  #renderer: Renderer;
  #frame: Frame;
  #state: State = "waiting";
  #ticked = 0;
  #held = false;
  #isGone = false;
  /** Of an editor: the scene's numbers that are drawn in place of the payload's. */
  declare numbers?: Numbers;
  /** Draws with other numbers of the scene, until the next payload. */
  declare setNumbers: (numbers: Numbers) => void;
  /** What another program draws of the whole frame: its bytes; null where the GPU went away. */
  declare drawn: (source: Program, number: Given, size: [number, number], inputs?: Inputs) => Promise<Uint8Array | null>;
  /** What a picture of the whole frame reads now. */
  declare inputs: (size: [number, number]) => Inputs;
  /** The milliseconds of some drawings of another program; null where it cannot be drawn. */
  declare timed: (source: Program, inputs: Inputs, size: [number, number], draws: number) => Promise<number | null>;
  /** Gives the GPU's program back. */
  declare forget: (source: Program) => void;
  /** Draws no new pictures meanwhile. */
  declare pauseDrawing: (isPaused: boolean) => void;
  /** Of a page with paths: whether direct light is shown instead. */
  declare isDirect?: boolean;
  /** Of a picture that keeps frames: the keyboard and the buttons that it reads. */
  declare keys?: Keys;
  declare sound?: Sound | null;

  constructor(
    readonly host: HTMLElement,
    payload: Payload,
    options: Options = {},
  ) {
    this.payload = { ...payload, embed: options.embed ?? payload.embed };
    const { time, steering, parameters } = payload;
    this.#clock = new Clock(time.start, time.duration);
    this.camera = steering && new Camera(steering.elevation);
    if (this.camera) this.camera.onMoved = () => this.#steered();
    this.#view = payload.view;
    this.hands = new Hands(
      this.camera,
      this.#mouse,
      () => this.readsMouse,
      () => this.#steered(),
    );
    const sped = () => {
      this.setSpeed(this.#clock.speed);
      this.#frame.notices.brief(`Speed ${this.#clock.speed}×`);
    };
    this.actions = {
      ...movesOf(this.hands, this.#clock, time.animated, () => this.#timed(), sped),
      pause: () => time.animated && done(this.toggle()),
      nextView: () => this.#turnViews(1),
      lastView: () => this.#turnViews(-1),
      fullScreen: () => document.fullscreenEnabled && done(this.toggleFullScreen()),
      screenshot: () => done(void this.saveScreenshot()),
      parameters: () => !this.payload.embed && done(this.togglePanel()),
      help: () => done(this.showHelp()),
      copyCamera: () => !!this.camera && done(void this.copyCamera()),
      ...((PATHS && {
        mode: () => {
          this.isDirect = !this.isDirect;
          this.#emitter.emit("mode", { isDirect: this.isDirect });
          return done(this.#compile());
        },
      }) as Pick<Actions, "mode">),
    };
    if (FRAMES) {
      const keys = (this.keys = new Keys());
      // An editor hears nothing: its picture is drawn as it is in a file.
      this.sound = EDITED ? null : new Sound();
      this.hear = () => {
        if (EDITED) return;
        this.sound!.isWanted = true;
        if (this.payload.frames?.microphone) void this.sound!.ask();
      };
      this.takesKey = (event) => {
        this.hear();
        if (this.payload.frames?.keyboard == null || !keys.take(event)) return false;
        this.#renderer.change();
        return true;
      };
      this.pressed = (buttons) => {
        keys.buttons = buttons;
        this.hear();
        this.#renderer.change();
      };
    }
    this.#take(parameters, payload.values);
    this.#clock.playing = time.animated && (options.playing ?? !isCalm());
    this.#frame = new Frame(this, options.theme ?? "auto");
    const { canvas } = this.#frame;
    const transparent = options.transparent ?? false;
    this.#renderer = new Renderer(this.#subject(), payload.resources, transparent, canvas);
    if (FRAMES) {
      const pictures = new Map<string, ImageBitmap>();
      Object.assign(this.#renderer, { keys: this.keys, sound: this.sound, pictures });
      this.setImage = async (name, file) => {
        const options = { imageOrientation: "flipY", premultiplyAlpha: "none" } as const;
        pictures.set(name, await createImageBitmap(file, options));
        this.#renderer.change();
      };
    }
    if (EDITED) {
      this.setNumbers = (numbers) => {
        this.numbers = { ...this.numbers, ...numbers };
        this.#renderer.change();
      };
      this.inputs = (size) => this.#subject().inputs(...size, true);
      this.timed = async (source, inputs, size, draws) => {
        const painter = this.#renderer.painter();
        try {
          return painter && (await gpuMs(painter, await painter.program(source), inputs, size, draws));
        } catch {
          return null; // The driver refuses it.
        }
      };
      this.forget = (source) => this.#renderer.painter()?.forget(source);
      this.pauseDrawing = (isPaused) => (this.#renderer.visible = !isPaused);
      this.drawn = (source, number, size, inputs = this.inputs(size)) => {
        const { number: own, ...rest } = inputs;
        return this.#renderer.pixels(source, { ...rest, number: { ...own, ...number } }, size);
      };
    }
    this.#frame.follow(
      (width, height) => this.#renderer.resize(width, height),
      (isVisible) => this.#see(isVisible),
      (isOpen) => this.#emitter.emit("panel", { isOpen }),
      () => this.#renderer.change(),
    );
  }

  /** Calls `listener` at each event of the kind. Returns what ends that. */
  on<K extends keyof Events>(event: K, listener: (detail: Events[K]) => void): () => void {
    return this.#emitter.on(event, listener);
  }

  // An editor's own

  /**
   * Shows another payload in place. Camera, time, view, and the values of parameters that a person
   * has changed and that still exist, are kept. False where a camera came or went: that needs
   * another player.
   */
  async load(payload: Payload): Promise<boolean> {
    if (!EDITED || !payload.steering !== !this.camera) return false;
    const old = this.payload;
    const { time, parameters } = payload;
    this.payload = { ...payload, embed: old.embed, poster: null };
    const programs = kept(this.#programs, await programsOf(payload));
    if (this.payload.programs !== payload.programs) return true; // A newer one came.
    if (this.camera) this.camera.elevation = payload.steering!.elevation;
    Object.assign(this.#clock, { start: time.start, duration: time.duration });
    if (time.animated !== old.time.animated) this.#run(time.animated && !isCalm());
    const moved = old.parameters.filter((p) => !same(this.#values[p.name]!, p.default));
    const values = moved.map(({ name }) => [name, this.#values[name]!]);
    this.#values = {};
    this.#take(parameters, Object.fromEntries(values) as Values);
    this.numbers = {};
    if (!payload.views.some(({ name }) => name === this.#view)) this.#view = payload.view;
    this.#frame.refresh(old);
    this.#renderer.resources = payload.resources;
    if (this.#state === "waiting") return true;
    this.#programs = programs;
    if (this.camera) this.camera.ask = null; // The old guide knows another scene.
    this.#beGuided();
    this.#compile();
    return true;
  }

  #take(parameters: Parameter[], values: Values): void {
    for (const parameter of parameters) {
      const given = checked(parameter, values[parameter.name]);
      this.#values[parameter.name] = given ?? parameter.default;
    }
  }

  // Parameters

  /** All values by name: numbers, a choice's number, linear colors, coordinates. */
  parameters(): Values {
    return structuredClone(this.#values);
  }

  /** Sets a parameter, within its range. Unknown names and values of another kind are refused. */
  setParameter(name: string, value: Value): void {
    const parameter = this.payload.parameters.find((p) => p.name === name);
    const fit = parameter && checked(parameter, value);
    if (fit === undefined || fit === null) throw new TypeError(`'${name}' cannot be that`);
    if (same(fit, this.#values[name])) return;
    this.#values[name] = fit;
    this.#emitter.emit("parameter", { name, value: fit });
    this.#renderer.change();
  }

  /** The same by the user: listeners are notified. */
  change(name: string, value: Value): void {
    if (same(value, this.#values[name])) return;
    this.setParameter(name, value);
    this.#emitter.emit("change", { name, value: this.#values[name]! });
  }

  /** Every parameter as the author wrote it. */
  resetAll(): void {
    for (const { name, default: value } of this.payload.parameters) this.change(name, value);
  }

  // Time

  get time(): number {
    return this.#clock.time;
  }

  get playing(): boolean {
    return this.#clock.playing;
  }

  /** The ends of the time slider, in seconds. */
  get timeRange(): [number, number] {
    return this.#clock.range();
  }

  play(): void {
    this.#run(this.payload.time.animated);
  }

  pause(): void {
    this.#run(false);
  }

  toggle(): void {
    this.#run(!this.playing && this.payload.time.animated);
  }

  /** Jumps to a time in seconds. */
  setTime(time: number): void {
    this.#clock.set(time);
    this.#timed();
  }

  setSpeed(speed: number): void {
    this.#clock.speed = clamp(speed, 0.01, 100);
    this.#emitter.emit("speed", { speed: this.#clock.speed });
  }

  /** The clock waits while a hand holds the slider. */
  hold(isHeld: boolean): void {
    this.#held = isHeld;
    this.#renderer.change();
  }

  // View and camera

  get view(): string {
    return this.#view;
  }

  setView(name: string): void {
    const view = this.payload.views.find((v) => v.name === name);
    if (!view) throw new TypeError(`there is no view '${name}'`);
    if (name === this.#view) return;
    this.#view = name;
    this.#emitter.emit("view", { name });
    this.#compile();
  }

  steering(): Steering | null {
    return this.camera?.steering ?? null;
  }

  /** Moves the camera: any of yaw, pitch, zoom, pan. */
  setSteering(change: Partial<Steering>): void {
    this.camera?.set(change);
    this.#renderer.change();
  }

  /** The author's own picture again. */
  resetCamera(): void {
    this.hands.reset();
  }

  // The picture

  /** A factor on the canvas's pixels, or "auto": what the GPU can do in time. */
  setResolution(scale: Scale): void {
    this.#renderer.scale = scale;
  }

  /** Draws again, and learns again what a pixel costs: after other work on the GPU. */
  redraw(): void {
    this.#renderer.redraw();
  }

  /** The size in pixels of the part of the canvas that shows the author's frame. */
  get frameSize(): [number, number] {
    const { canvas, covered } = this.#frame;
    const [wide, high] = this.payload.size;
    return frameOn(canvas.width, canvas.height, covered, wide / high).size;
  }

  /** A PNG of the picture at full scale, without what covers it; null where there is none. */
  screenshot(samples = FINEST_SAMPLES): Promise<Blob | null> {
    return this.#state === "ready" ? this.#renderer.capture(samples) : Promise.resolve(null);
  }

  async saveScreenshot(): Promise<void> {
    const picture = await this.screenshot();
    if (!picture) return;
    save(picture, `${this.payload.name}${this.#view === "color" ? "" : ` ${this.#view}`}`);
    this.#frame.notices.brief("Picture saved");
  }

  /** The state as Python: a line that renders the same picture. */
  code(): string {
    const { parameters, time, code: [before, after] = ["", ""] } = this.payload;
    const steering = this.camera?.moved ? this.camera.steering : null;
    // `render` begins at 0, wherever the page does; that of an `@image` knows no views.
    const view = this.camera ? this.#view : "color";
    const mode = PATHS && view === "color" ? `, mode="${this.isDirect ? "direct" : "path"}"` : "";
    return (
      before + pythonOf(parameters, this.#values, time.animated ? this.time : 0, view, steering) + mode + after
    );
  }

  copyCode(): Promise<void> {
    return this.#copy(this.code());
  }

  async #copy(text: string): Promise<void> {
    const isCopied = await copy(text, this.#frame.root);
    this.#frame.notices.brief(isCopied ? `Copied: ${text}` : text);
  }

  /** Where the camera is, as the author would write it; null where no guide knows. */
  async cameraText(): Promise<string | null> {
    const place = await this.camera?.place();
    const form = this.payload.steering?.camera;
    return place && form ? cameraOf(place, form) : null;
  }

  async copyCamera(): Promise<void> {
    const text = await this.cameraText();
    if (text !== null) await this.#copy(text);
  }

  /** Resolves to true when the sharp picture of the current state is shown, to false where none can be. */
  async settled(): Promise<boolean> {
    await this.camera?.rest();
    return this.#renderer.rest();
  }

  // The frame around it

  toggleFullScreen(): void {
    // Refused where a page forbids it: then nothing happens, and nothing is to be said.
    const done = document.fullscreenElement
      ? document.exitFullscreen()
      : this.host.requestFullscreen();
    done.catch(() => {});
  }

  togglePanel(): void {
    this.#frame.togglePanel();
  }

  showHelp(): void {
    this.#frame.showHelp();
  }

  /** Stops everything and gives the GPU's memory back. */
  dispose(): void {
    this.#isGone = true;
    if (FRAMES) this.sound?.dispose();
    this.#renderer.dispose();
    this.#frame.dispose();
  }

  /** What keys do; false where a key means nothing here and stays the page's. */
  readonly actions: Actions;

  /** Whether the scene reads where the mouse is; only without a camera of its own. */
  get readsMouse(): boolean {
    const uniforms = this.camera ? [] : this.#programs.flatMap((program) => program.uniforms);
    return uniforms.some(({ origin, name }) => {
      return origin === "frame" && (FRAMES ? /^(mouse|buttons)$/.test(name) : name === "mouse");
    });
  }

  /** Takes a key that the picture reads; false for one that is the player's. */
  declare takesKey: (event: KeyboardEvent) => boolean;
  /** A gesture: a picture that reads the microphone asks for it, and a sound file is heard. */
  declare hear: () => void;
  /** Shows a person's picture in place of the `ImageInput` of this name; rejects what is no picture. */
  declare setImage: (name: string, file: Blob) => Promise<void>;
  /** Buttons of the mouse went down or up. */
  declare pressed: (buttons: number) => void;

  #turnViews(steps: number): boolean {
    const { views } = this.payload;
    const at = views.findIndex(({ name }) => name === this.#view) + steps + views.length;
    if (views.length > 1) this.setView(views[at % views.length]!.name);
    return views.length > 1;
  }

  #steered(): void {
    if (this.camera) this.#emitter.emit("steering", this.camera.steering);
    this.#renderer.change();
  }

  #run(isPlaying: boolean): void {
    this.#clock.playing = isPlaying;
    this.#ticked = performance.now();
    this.#timed();
  }

  #timed(): void {
    this.#tellTime();
    this.#renderer.change();
  }

  #tellTime(): void {
    this.#emitter.emit("time", { time: this.time, playing: this.playing });
  }

  /** In sight for the first time: now the work begins. */
  #see(isVisible: boolean): void {
    this.#ticked = performance.now();
    this.#renderer.visible = isVisible;
    if (isVisible && this.#state === "waiting") {
      this.#state = "compiling";
      void this.#start();
    }
  }

  async #start(): Promise<void> {
    try {
      const { payload } = this;
      const programs = await programsOf(payload);
      if (EDITED && payload !== this.payload) return void this.#start();
      this.#programs = programs;
    } catch (error) {
      this.#enter("failed", error);
      return;
    }
    if (this.#isGone) return;
    this.#beGuided();
    this.#frame.listen(!!this.camera || this.readsMouse);
    this.#renderer.start();
    if (this.#state !== "unsupported") this.#compile();
  }

  /** From now on the camera asks the scene's guide, if the page has one. */
  #beGuided(): void {
    const source = this.#programs[this.payload.steering?.guide ?? -1];
    if (!source || !this.camera) return;
    this.camera.ask = async (action, now, goal) => {
      const number = question(action, now, goal, this.frameSize);
      const inputs = { ...this.#subject().inputs(GUIDE_PIXELS, 1, true), number };
      const bytes = await this.#renderer.pixels(source, inputs, [GUIDE_PIXELS, 1]);
      return bytes && answer(bytes);
    };
  }

  #compile(): void {
    const view = this.payload.views.find(({ name }) => name === this.#view)!;
    const program = this.#programs[view.program];
    if (EDITED) this.#renderer.kept = this.#programs;
    if (PATHS && program && view.film) {
      const { trace, show, name, photons } = view.film;
      const at = (number: number) => this.#programs[number]!;
      const film = {
        trace: at(trace),
        show: at(show),
        name,
        ...(photons && {
          photons: { ...photons, plan: at(photons.plan), deposits: at(photons.deposits) },
        }),
      };
      program.film = this.isDirect ? undefined : film;
    }
    if (FRAMES && program && this.payload.frames) {
      const at = ({ program, name }: { program: number; name: string }) => {
        return { program: this.#programs[program]!, name };
      };
      const { passes, itself, ...others } = this.payload.frames;
      program.frames = { passes: passes.map(at), itself: itself && at(itself), ...others };
    }
    if (program) void this.#renderer.use(program);
  }

  #retry(): void {
    if (this.#state === "failed" && this.#programs.length) this.#compile();
    else if (this.#programs.length) {
      this.#renderer.start(this.#frame.newCanvas());
      this.#frame.listen(!!this.camera || this.readsMouse);
      this.#compile();
    } else void this.#start();
  }

  #subject(): Subject {
    const player = this;
    return {
      get playing() {
        return player.playing && !player.#held;
      },
      hasPoster: !!this.payload.poster || !!this.host.querySelector("img,canvas"),
      tick(now) {
        if (this.playing) {
          player.#clock.advance((now - player.#ticked) / 1000);
          player.#tellTime();
        }
        player.#ticked = now;
      },
      inputs(width, height, isWhole = false) {
        const [wide, high] = player.payload.size;
        const covered = isWhole ? NOTHING_COVERED : player.#frame.covered;
        const { size, offset } = frameOn(width, height, covered, wide / high);
        const steering: Given = player.camera ? numbersOf(player.camera.steering) : {};
        return {
          frame: {
            resolution: size,
            time: player.time,
            mouse: player.#mouse.pixels(width, height, offset),
            index: player.#clock.index,
          },
          parameter: player.#values,
          number: { ...(EDITED && player.numbers), ...steering, Frame_offset: offset },
        };
      },
      drawn: (report) => player.#drawn(report),
      state: (state, error) => player.#enter(state, error),
      ...(PATHS && {
        noPaths: (error: unknown) => {
          player.#frame.notices.brief(`${String((error as Error).message)}: direct light is shown.`);
          player.isDirect = true;
          player.#emitter.emit("mode", { isDirect: true });
        },
      }),
    };
  }

  #drawn(report: FrameReport): void {
    this.#frame.live = true;
    if (this.#mouse.settle() && this.readsMouse) this.#renderer.change();
    this.#emitter.emit("frame", { ...report, time: this.time, view: this.#view });
  }

  #enter(state: State, error?: unknown): void {
    this.#state = state;
    const { notices } = this.#frame;
    this.#frame.state = state;
    const { label } = this.payload.views.find(({ name }) => name === this.#view)!;
    if (state === "compiling") notices.busy(`Compiling ${label} …`);
    if (state === "ready") {
      notices.clear();
      notices.say(`${label} is shown`);
    }
    if (state === "lost") {
      this.#frame.live = false;
      const sentence = "The graphics driver let go of the picture. It returns when the driver does.";
      notices.failure({ sentence, rows: [] }, () => this.#retry());
    }
    if (state === "failed" || state === "unsupported") {
      const failure = failureOf(error, this.payload.files, state === "unsupported");
      notices.failure(failure, () => this.#retry());
      const log = failure.rows.map(({ place, text }) => `${place} ${text}`.trim()).join("\n");
      this.#emitter.emit("error", { message: failure.sentence, log });
    }
  }
}

/** Whether people asked for less motion. */
function isCalm(): boolean {
  return matchMedia("(prefers-reduced-motion: reduce)").matches;
}

/** The new programs; those whose texts were there before are the old ones with new numbers. */
function kept(old: Program[], fresh: Program[]): Program[] {
  return fresh.map((program) => {
    const same = old.find(
      (one) => one.fragment === program.fragment && one.uniforms.length === program.uniforms.length,
    );
    if (!same) return program;
    // Linked programs have these entries.
    same.uniforms.forEach((entry, i) => Object.assign(entry, program.uniforms[i]));
    const { uniforms } = same;
    return Object.assign(same, { ...program, uniforms });
  });
}

function done(_: void): true {
  return true;
}
