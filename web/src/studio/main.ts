/**
 * The studio: code, picture and parameters side by side.
 *
 * Input: the settings in the page, a channel to the worker. Output: the running app. Here what a person
 * does becomes requests, and answers become what is seen; how either looks is in the other modules.
 */

import { make } from "../dom";
import type {
  Change,
  Changed,
  Edit,
  LiteralValue,
  Mistake,
  NumbersFound,
  Ready,
  Response,
  Results,
  SceneFound,
  ShapeMap,
  SourceLiteral,
} from "../generated/messages";
import type { Payload, Program, Value } from "../payload";
import { CellChannel } from "./cell_channel";
import { SocketChannel, type Channel } from "./channel";
import { Client, type Asked } from "./client";
import { CostBar } from "./cost_bar";
import { Editor } from "./editor";
import { Emitted } from "./emitted";
import { linkOf, sharedOf, type Shared } from "./links";
import { Page } from "./page";
import { Picture } from "./picture";
import { exports, gallery, help, share, sheet, type Example } from "./sheets";
import { Texts } from "./texts";

interface Settings {
  main: string;
  folder: string;
  isNew: boolean;
  gallery: Example[];
  nonce: string;
  version: string;
  /** Of the playground: the folder of Python's files, and what it begins with. */
  python?: string;
  start?: Opened;
}

/** A scene that is opened; its picture needs no Python where there is a payload. */
interface Opened {
  main: string;
  files: Record<string, string>;
  payload?: Payload;
}

/** What a hand is turning. */
interface Turn {
  literal: SourceLiteral;
  value: LiteralValue;
  revision: number;
  /** The name of the program's input that it is; of a number in a `@func`. */
  held: string | null;
  edits: Edit[];
  isDone: boolean;
  isBusy: boolean;
  /** The value of the last answer. */
  answered: LiteralValue | null;
}

/** After the last key, so long until the code is run. */
const TYPING_MS = 120;
/** After the last answer, so long until the camera's guide is compiled as well. */
const GUIDE_MS = 500;
/** The mouse rests so long on a line until its shape is outlined. */
const POINTED_MS = 70;
/** So long a line is outlined that the caret came to. */
const CARET_MS = 1600;
const SIZE: [number, number] = [640, 480];
const TEXT_TAB = "Emitted text";

class Studio {
  readonly texts: Texts;
  readonly page = new Page(document.body);
  readonly channel: Channel;
  readonly client: Client;
  readonly editor: Editor;
  readonly picture: Picture;
  readonly emitted: Emitted;
  #ready: Ready | null = null;
  #key: string | null = null;
  #object: string | null = null;
  #isLooking = false;
  #isStopped = false;
  /** Whether the notice that it was stopped is to be seen. */
  #isStoppedTold = false;
  #wanted = -1;
  #done = -1;
  #timer = 0;
  #guiding = 0;
  /** The revision whose guide was asked for. */
  #guided = -1;
  #turn: Turn | null = null;
  #mistakes: readonly Mistake[] = [];
  #tab = "";
  #line = 0;
  #keepsCamera = false;
  #shared: Shared | null = null;
  readonly costs: CostBar;
  #pointing = 0;
  #pointedAt: number | null = null;
  /** File and line of all that makes a shape. */
  #makers = new Set<string>();
  #shapes: { revision: number; object: string | null; map: Promise<ShapeMap | null> } | null = null;

  constructor(readonly settings: Settings) {
    const { folder, main, nonce, python } = settings;
    // In another page it is small, and a draft of the whole playground is none of its text.
    const isFramed = new URLSearchParams(location.search).has("embed");
    if (isFramed) this.page.beFramed(() => this.#whole());
    this.texts = new Texts(isFramed ? location.href : folder);
    this.picture = new Picture({
      view: () => this.look(),
      clicked: (x, y) => void this.#probe(x, y),
      keepParameter: (name, value) => void this.#write({ what: "parameter", name, value: value as LiteralValue }),
      keepCamera: (text) => {
        this.#keepsCamera = true;
        void this.#write({ what: "camera", text });
      },
      drawn: (text) => (this.page.drawn.textContent = text),
      guide: () => this.#guide(this.texts.revision),
      program: (view) => this.#program(view),
      map: () => this.#map(),
    });
    const { element, strip, layers, knobs } = this.picture;
    this.page.show.append(element, strip, layers.element, knobs);
    this.editor = new Editor(
      this.page.code,
      {
        typed: (name, text) => this.#typed(name, text),
        moved: (name, line) => this.#moved(name, line),
        pointed: (name, line, isMouse) => this.#pointed(name, line, isMouse),
        save: () => void this.save(),
        run: () => {
          this.#isStopped = false;
          this.look();
        },
        turn: (literal, value) => this.#turned(literal, value),
        release: () => this.#released(),
      },
      nonce,
    );
    this.emitted = new Emitted(
      nonce,
      (file, line) => {
        if (file in this.texts.files) this.#goTo(file, line);
      },
      () => void this.#emit(),
    );
    this.page.code.append(this.emitted.element);
    this.costs = new CostBar({
      count: (work) => this.#lineProgram("count", { work }),
      time: () => this.#lineProgram("time"),
      player: () => this.picture.player,
      file: () => this.editor.name,
      show: (figures) => this.editor.setFigures(figures),
      wanted: () => void this.channel.start?.(),
    });
    this.page.tabRow.after(this.costs.element);
    this.page.tabRow.append(this.emitted.menu);
    this.#fillButtons();
    this.channel = python ? this.#cell(python) : new SocketChannel(`ws://${location.host}/socket`);
    this.client = new Client(this.channel, {
      ready: (message) => this.#started(message),
      changed: (message) => this.#changed(message),
      printed: ({ text }) => this.#print(text),
      restarted: ({ reason }) => this.#restarted(reason),
      state: (isOpen) => this.#connected(isOpen),
    });
    document.title = `${main} · distal`;
    if (settings.start) void this.#begin(settings.start);
    addEventListener("beforeunload", () => this.texts.names.forEach((name) => this.texts.keepDraft(name)));
  }

  // The playground

  #cell(folder: string): CellChannel {
    const cell = new CellChannel(folder);
    cell.onProgress = (part) => {
      this.page.work.textContent = part < 1 ? `Loading Python: ${Math.round(100 * part)} %` : "Starting Python …";
    };
    // Python is large: it comes when somebody wants to change something.
    for (const kind of ["pointerdown", "focusin"]) {
      this.page.left.addEventListener(kind, () => void cell.start(), { once: true });
    }
    return cell;
  }

  /** Shows what a link shares, an example, or the start; its picture before Python is there. */
  async #begin(start: Opened): Promise<void> {
    const name = /^#example=(\w+)$/.exec(location.hash)?.[1];
    const shared = await sharedOf(location.hash);
    const opened: Opened = shared ?? (name ? await this.#example(name) : undefined) ?? start;
    const given = opened.payload;
    this.settings.main = opened.main;
    const digests = Object.fromEntries(Object.keys(opened.files).map((file) => [file, location.hash || "start"]));
    if (given) await this.picture.show(given);
    this.#changed({ kind: "changed", files: opened.files, digests });
    const isNew = this.texts.names.some((file) => this.texts.files[file] !== opened.files[file]);
    if (!given || isNew) void this.channel.start?.();
    // Where pages from disk or old browsers have none, everything works but without a network.
    void navigator.serviceWorker?.register("offline.js").catch(() => {});
    this.#shared = shared;
  }

  /** The camera, values and time of a link, once its picture is there. */
  #takeShared(): void {
    const { player } = this.picture;
    const { camera, values = {}, time } = this.#shared ?? {};
    this.#shared = null;
    if (!player) return;
    if (camera) player.setSteering(camera);
    if (time !== undefined) player.setTime(time);
    for (const { name } of player.payload.parameters) {
      try {
        if (values[name] !== undefined) player.setParameter(name, values[name]);
      } catch {
        // A link made by hand: what does not fit is left out.
      }
    }
  }

  async #share(): Promise<void> {
    const { player } = this.picture;
    const { files } = this.texts;
    const plain: Shared = { files, main: this.settings.main };
    const full: Shared = { ...plain };
    if (player) {
      full.values = player.parameters();
      full.time = player.time;
      const camera = player.steering();
      if (camera) full.camera = camera;
    }
    const address = location.href.split(/[?#]/)[0]!;
    const links = await Promise.all([plain, full].map(async (what) => address + (await linkOf(what))));
    share(links[0]!, links[1]!, document.title);
  }

  /** The address of the playground with the text as it is. */
  async #whole(): Promise<string> {
    const { files } = this.texts;
    return location.href.split(/[?#]/)[0]! + (await linkOf({ files, main: this.settings.main }));
  }

  async #example(name: string): Promise<Opened | undefined> {
    if (!this.settings.gallery.some((one) => one.name === name)) return undefined;
    const response = await fetch(`gallery/${encodeURIComponent(name)}.json`);
    return response.ok ? ((await response.json()) as Opened) : undefined;
  }

  // Requests

  get #source() {
    const { player } = this.picture;
    const { files, revision } = this.texts;
    const moved = player?.payload.parameters.filter(
      ({ name, default: fallback }) => JSON.stringify(player.parameters()[name]) !== JSON.stringify(fallback),
    );
    const values = Object.fromEntries((moved ?? []).map(({ name }) => [name, player!.parameters()[name]!]));
    return {
      revision,
      files,
      main: this.settings.main,
      object: this.#object,
      view: player?.view ?? "color",
      values: values as Record<string, Value>,
      time: 0,
      size: SIZE,
    };
  }

  /** Runs the code as it is now; while one run is under way, once more after it. */
  look(): void {
    clearTimeout(this.#timer);
    this.#wanted = Math.max(this.#wanted, 0) + 1;
    void this.#lookOn();
  }

  async #lookOn(): Promise<void> {
    if (this.#isLooking || this.#isStopped || !this.#ready || this.#turn) return;
    this.#isLooking = true;
    while (this.#done !== this.#wanted && !this.#isStopped && !this.#turn) {
      const wanted = this.#wanted;
      const { revision } = this.texts;
      for (const name of this.texts.names) this.texts.keepDraft(name);
      this.page.work.textContent = "…";
      const answer = await this.client.ask({ kind: "look", ...this.#source, guided: false });
      this.#done = wanted;
      if (answer) await this.#take(answer, revision);
    }
    this.#isLooking = false;
    this.#guideSoon();
    void this.costs.compiled();
    if (this.picture.player && this.picture.layers.isOpen) void this.picture.layers.draw(this.picture.player);
  }

  /** The program of a view of the text as it is. */
  async #program(view: string): Promise<Program | null> {
    if (this.#isLooking || this.#turn) return null;
    const { revision } = this.texts;
    const asked = { ...this.#source, view, lean: true, guided: false };
    const answer = await this.client.ask({ kind: "look", ...asked });
    if (answer?.kind !== "scene" || revision !== this.texts.revision) return null;
    const { views, programs } = answer.payload;
    const number = views.find(({ name }) => name === view)?.program ?? -1;
    return programs.encoding === "plain" ? (programs.data[number] ?? null) : null;
  }

  /** The worker's program that measures lines of the text as it is. */
  async #lineProgram<K extends "count" | "time">(kind: K, more: object = {}): Promise<Results[K] | null> {
    if (!this.#can(kind)) return null;
    const { revision } = this.texts;
    const answer = await this.client.ask({ kind, ...this.#source, ...more } as Asked);
    const isIt = answer?.kind === "answer" && answer.request === kind && revision === this.texts.revision;
    return isIt ? (answer.result as Results[K]) : null;
  }

  /** While one types, the camera moves freely; in a pause the program that guides it follows. */
  #guideSoon(): void {
    clearTimeout(this.#guiding);
    const { revision } = this.texts;
    const steering = this.picture.player?.payload.steering;
    if (!steering || (steering.guide ?? -1) >= 0 || this.#guided === revision) return;
    this.#guiding = window.setTimeout(() => {
      if (!this.#isLooking && !this.#turn && !this.#isStopped) void this.#guide(revision);
    }, GUIDE_MS);
  }

  async #guide(revision: number): Promise<void> {
    if (this.texts.revision !== revision) return;
    this.#guided = revision;
    const answer = await this.client.ask({ kind: "look", ...this.#source, lean: true });
    const isStale = this.texts.revision !== revision || this.#turn;
    if (answer?.kind === "scene" && !isStale) await this.picture.show(answer.payload);
  }

  /** Shows an answer. */
  async #take(answer: Response, revision: number): Promise<void> {
    if (answer.kind === "scene") {
      await this.#scene(answer);
    } else if (answer.kind === "numbers") {
      this.#key = answer.key;
      this.picture.setNumbers(answer);
    } else if (answer.kind !== "mistakes") return;
    if (this.#isStoppedTold) this.page.tell(null);
    this.#isStoppedTold = false;
    const mistakes = answer.kind === "mistakes" ? answer.mistakes : [];
    if (answer.kind === "mistakes") this.page.work.textContent = "Mistakes";
    else this.page.work.textContent = workOf(answer);
    this.picture.isOld = mistakes.length > 0;
    if (this.texts.revision !== revision) return; // The text has gone on: its places would be wrong.
    this.#showMistakes(mistakes);
    if (answer.literals) this.editor.setLiterals(answer.literals);
    if (this.#tab === TEXT_TAB) void this.#emit();
    if (!mistakes.length && this.#keepsCamera) {
      this.#keepsCamera = false;
      this.picture.player?.resetCamera();
    }
  }

  async #scene(answer: SceneFound): Promise<void> {
    this.#key = answer.key;
    if (answer.shapes) this.#makers = new Set(answer.shapes.map(({ file, line }) => `${file}:${line}`));
    const { objects } = this.page;
    objects.hidden = answer.objects.length < 2;
    objects.replaceChildren(...answer.objects.map((name) => make("option", { value: name }, name)));
    if (this.#object) objects.value = this.#object;
    await this.picture.show(answer.payload);
    if (this.#shared) this.#takeShared();
  }

  async #write(change: Partial<Change> & Pick<Change, "what">): Promise<void> {
    const full = { file: null, start: null, end: null, name: null, value: null, text: null, ...change };
    const { revision } = this.texts;
    const answer = await this.client.ask({ kind: "write", ...this.#source, changes: [full as Change] });
    if (answer?.kind === "mistakes") {
      this.#keepsCamera = false;
      return this.page.tell(answer.mistakes[0]!.message, ["Close", () => {}]);
    }
    if (answer?.kind !== "answer" || answer.request !== "write" || revision !== this.texts.revision) return;
    this.#apply(answer.result.edits);
  }

  #apply(edits: readonly Edit[]): void {
    const file = edits[0]?.file;
    if (!file) return;
    this.#showFile(file);
    this.editor.apply(edits);
    this.look();
  }

  // Literals

  #turned(literal: SourceLiteral, value: LiteralValue): void {
    this.#turn ??= {
      literal,
      value,
      revision: this.texts.revision,
      held: null,
      edits: [],
      isDone: false,
      isBusy: false,
      answered: null,
    };
    this.#turn.value = value;
    this.#turn.isDone = false;
    this.costs.changed();
    void this.#turnOn();
  }

  /** While a literal is turned, the worker's last answer decides when the next request goes out. */
  async #turnOn(): Promise<void> {
    const turn = this.#turn;
    if (!turn || turn.isBusy) return;
    turn.isBusy = true;
    if (turn.literal.way === "hold" && turn.answered === null) await this.#hold(turn);
    while (!same(turn.answered, turn.value) || (turn.isDone && this.#turn === turn)) {
      if (turn.held && !turn.isDone) {
        turn.answered = turn.value;
        this.picture.setNumber(turn.held, turn.value as number);
        break;
      }
      const { value } = turn;
      const answer = await this.client.ask({
        kind: "look",
        ...this.#source,
        known: this.#key,
        changes: [this.#changeOf(turn, value)],
        lean: true,
        guided: false,
      });
      turn.answered = value;
      if (!answer || answer.kind === "dropped") {
        if (turn.isDone) this.#turn = null;
        break;
      }
      if ("edits" in answer) turn.edits = answer.edits;
      await this.#take(answer, -1);
      if (turn.isDone && same(turn.answered, turn.value)) {
        this.#turn = null;
        this.#done = this.#wanted;
        this.#apply(turn.edits);
      }
    }
    turn.isBusy = false;
  }

  #changeOf({ literal }: Turn, value: LiteralValue): Change {
    const { file, start, end } = literal;
    return { what: "literal", file, start, end, value, name: null, text: null };
  }

  /** A number of a `@func` becomes an input of the program, if it can. */
  async #hold(turn: Turn): Promise<void> {
    const { file, start, end, type } = turn.literal;
    if (type !== "number") return;
    const answer = await this.client.ask({ kind: "hold", ...this.#source, file, start, end });
    if (answer?.kind !== "scene" || !answer.held || this.#turn !== turn) return;
    await this.#scene(answer);
    turn.held = answer.held;
  }

  #released(): void {
    const turn = this.#turn;
    if (!turn) return;
    turn.isDone = true;
    void this.#turnOn();
  }

  // Texts

  #changed({ files, digests }: Changed): void {
    const kept: string[] = [];
    for (const [name, text] of Object.entries(files)) {
      const isNew = !(name in this.texts.files);
      const mine = this.texts.take(name, text, digests[name] ?? "");
      if (mine !== null) kept.push(name);
      else if (isNew) {
        this.#offerDraft(name, text);
        if (this.editor.name === name) this.editor.replace(name, this.texts.files[name]!);
      } else this.editor.replace(name, text);
    }
    if (!this.editor.name) this.#showFile(this.settings.main);
    for (const name of kept) {
      this.page.tell(
        `${name} was changed by another program; your changes are still here.`,
        ["Keep mine", () => {}],
        ["Take the other", () => this.#replace(name, files[name]!)],
      );
    }
    this.#fillFiles();
    this.look();
  }

  /** Unsaved changes of an earlier visit: here again, or offered where the file has changed since. */
  #offerDraft(name: string, text: string): void {
    const draft = this.texts.draft(name);
    if (!draft) return;
    if (draft.isCurrent) {
      this.texts.set(name, draft.text);
      const discard = () => this.#replace(name, text);
      return this.page.tell(
        `Unsaved changes of ${name} are here again.`,
        ["Keep them", () => {}],
        ["Discard them", discard],
      );
    }
    this.page.tell(
      `${name} was changed since you left unsaved changes of it.`,
      ["Show my changes", () => this.#replace(name, draft.text)],
      ["Discard them", () => this.texts.forgetDraft(name)],
    );
  }

  #replace(name: string, text: string): void {
    this.texts.set(name, text);
    this.editor.replace(name, text);
    this.texts.keepDraft(name);
    this.look();
  }

  #typed(name: string, text: string): void {
    if (!name || this.texts.files[name] === text) return;
    this.texts.set(name, text);
    this.#isStopped = false;
    this.costs.changed();
    this.picture.outline.show(null, null);
    this.#fillFiles();
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.look(), TYPING_MS);
  }

  async save(): Promise<void> {
    if (this.settings.python) {
      for (const name of this.texts.names) this.texts.keepDraft(name);
      this.page.announcer.textContent = "Kept in this browser";
      return;
    }
    for (const name of this.texts.names.filter((one) => this.texts.isChanged(one))) {
      const text = this.texts.files[name]!;
      const { revision } = this.texts;
      const digest = this.texts.digest(name) || null;
      const answer = await this.client.ask({ kind: "save", revision, file: name, text, digest });
      if (!answer) return this.page.tell("The file is not saved: nobody answers.", ["Close", () => {}]);
      if (answer.kind === "mistakes") return this.page.tell(answer.mistakes[0]!.message, ["Close", () => {}]);
      if (answer.kind !== "answer" || answer.request !== "save") return;
      const { conflict, digest: now } = answer.result;
      if (conflict !== null) return this.#conflict(name, conflict, now);
      this.texts.saved(name, text, now);
      this.page.announcer.textContent = `${name} is saved`;
    }
    this.#fillFiles();
  }

  #conflict(name: string, theirs: string, digest: string): void {
    const overwrite = make("button", { type: "button" }, "Overwrite the file");
    const take = make("button", { type: "button" }, "Take the file's text");
    const dialog = sheet(
      `${name} is another text on the disk`,
      make("p", {}, "Nothing was overwritten. Undo brings either text back."),
      make("pre", { className: "theirs", tabIndex: 0 }, theirs),
      make("div", { className: "choices" }, overwrite, take),
    );
    overwrite.onclick = () => {
      dialog.close();
      this.texts.saved(name, theirs, digest);
      void this.save();
    };
    take.onclick = () => {
      dialog.close();
      this.texts.saved(name, theirs, digest);
      this.#replace(name, theirs);
      this.#fillFiles();
    };
  }

  // Places

  #fillFiles(): void {
    const names = [...this.texts.names, TEXT_TAB];
    this.page.files.replaceChildren(
      ...names.map((name) => {
        const isHere = name === this.#tab;
        const isChanged = name !== TEXT_TAB && this.texts.isChanged(name);
        const tab = make("button", { type: "button", role: "tab" }, isChanged ? `${name} •` : name);
        tab.setAttribute("aria-selected", String(isHere));
        if (isChanged) tab.setAttribute("aria-label", `${name}, not saved`);
        tab.tabIndex = isHere ? 0 : -1;
        tab.onclick = () => this.#showFile(name);
        tab.onkeydown = ({ key }) => {
          const step = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
          if (!step) return;
          this.#showFile(names[(names.indexOf(name) + step + names.length) % names.length]!);
          this.page.files.querySelector<HTMLElement>("[aria-selected=true]")!.focus();
        };
        return tab;
      }),
    );
    const isText = this.#tab === TEXT_TAB;
    this.emitted.menu.hidden = !isText;
    this.emitted.element.hidden = !isText;
    this.page.code.classList.toggle("beside", isText);
    this.page.name.textContent = this.settings.main;
  }

  #showFile(name: string): void {
    const was = this.#tab;
    this.#tab = name;
    if (name === TEXT_TAB) void this.#emit();
    else this.editor.show(name, this.texts.files[name]!);
    if (was !== name) this.#fillFiles();
    if (was !== name && name !== TEXT_TAB) {
      this.#showMistakes(this.#mistakes);
      this.costs.shown();
    }
  }

  #goTo(file: string, line: number, column = 0, isFocused = false): void {
    if (this.editor.name !== file) this.#showFile(file);
    this.editor.goTo(line, column, isFocused);
  }

  #moved(name: string, line: number): void {
    if (line === this.#line) return;
    this.#line = line;
    this.costs.moved(line);
    if (this.#tab === TEXT_TAB) this.emitted.link(name, line);
  }

  /** Outlines what a line makes: while the mouse is on it, and for a moment when the caret comes. */
  #pointed(name: string, line: number | null, isMouse: boolean): void {
    if (isMouse && line === this.#pointedAt) return;
    this.#pointedAt = isMouse ? line : null;
    clearTimeout(this.#pointing);
    const { outline, player } = this.picture;
    this.#pointing = window.setTimeout(() => {
      const makes = line !== null && this.#makers.has(`${name}:${line}`);
      outline.show(player, makes ? { file: name, line } : null);
      if (isMouse || !makes) return;
      this.#pointing = window.setTimeout(() => outline.show(player, null), CARET_MS);
    }, POINTED_MS);
  }

  /** Which shape each pixel shows; asked for once for each text. */
  #map(): Promise<ShapeMap | null> {
    const { revision } = this.texts;
    const object = this.#object;
    if (!this.#can("map") || this.#isStopped || this.#turn) return Promise.resolve(null);
    if (this.#shapes?.revision !== revision || this.#shapes.object !== object) {
      const asked = this.client.ask({ kind: "map", ...this.#source });
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

  async #probe(x: number, y: number): Promise<void> {
    if (!this.#can("probe")) return;
    const { player } = this.picture;
    const { yaw = 0, pitch = 0, zoom = 1, pan = [0, 0] } = player?.steering() ?? {};
    const steering = { yaw, pitch, zoom, pan_x: pan[0]!, pan_y: pan[1]! };
    const { revision } = this.texts;
    const time = player?.time ?? 0;
    const answer = await this.client.ask({ kind: "probe", ...this.#source, time, x, y, steering });
    if (answer?.kind !== "answer" || answer.request !== "probe" || revision !== this.texts.revision) return;
    const { shape, material, file, line, numbers } = answer.result;
    const what = shape ? [shape, material].filter(Boolean).join(", ") : "The background";
    const count = numbers["steps"];
    const steps = count === undefined ? "" : ` · ${count} ${count === 1 ? "step" : "steps"}`;
    this.page.announcer.textContent = `${what}${steps}`;
    this.page.work.textContent = `${what}${steps}`;
    if (file && line) {
      this.#goTo(file, line);
      this.editor.link([line]);
    } else this.editor.link([]);
  }

  async #emit(): Promise<void> {
    const { target } = this.emitted;
    const answer = await this.client.ask({ kind: "text", ...this.#source, target });
    if (answer?.kind !== "answer" || answer.request !== "text") return;
    this.emitted.show(answer.result);
    this.emitted.link(this.editor.name, this.#line);
  }

  // What is seen besides

  #showMistakes(mistakes: readonly Mistake[]): void {
    this.#mistakes = mistakes;
    this.editor.setMistakes(mistakes);
    this.page.mistakes.replaceChildren(
      ...mistakes.slice(0, 20).map(({ file, line, column, message, hint, severity }) => {
        const place = line === null ? "" : `${file === this.settings.main ? "" : `${file} `}line ${line}: `;
        const text = make("span", {}, make("b", {}, place), message);
        const about = hint && make("em", {}, hint);
        if (line === null || !file) return make("div", { className: severity }, text, about);
        const button = make("button", { type: "button", className: severity }, text, about);
        button.onclick = () => this.#goTo(file, line, column, true);
        return button;
      }),
    );
    const [first] = mistakes;
    if (first) this.page.announcer.textContent = `${first.line === null ? "" : `Line ${first.line}: `}${first.message}`;
  }

  #print(text: string): void {
    this.page.printed.hidden = !text;
    this.page.printed.textContent = text;
  }

  #started(message: Ready): void {
    this.#ready = message;
    this.emitted.targets = message.targets;
    this.#key = null;
    this.look();
  }

  #restarted(reason: string): void {
    this.#ready = null;
    this.#isStopped = true;
    this.#isStoppedTold = true;
    this.#turn = null;
    this.picture.isOld = true;
    this.page.work.textContent = "Stopped";
    this.page.tell(`Stopped: ${reason}. Change the code, or run it again.`, [
      "Run again",
      () => {
        this.#isStopped = false;
        this.look();
      },
    ]);
  }

  #connected(isOpen: boolean): void {
    if (isOpen) return this.page.tell(null);
    this.#ready = null;
    this.#turn = null;
    if (this.settings.python) return;
    this.page.tell("The studio's server has ended; your text is kept in this browser.");
  }

  #can(ability: string): boolean {
    return !!this.#ready?.abilities.includes(ability);
  }

  #fillButtons(): void {
    const button = (text: string, title: string, act: () => void) => {
      const made = make("button", { type: "button", title, onclick: act }, text);
      return made;
    };
    this.page.objects.onchange = () => {
      this.#object = this.page.objects.value;
      this.look();
    };
    this.page.buttons.append(
      button("Gallery", "Open a copy of an example", () =>
        gallery(this.settings.gallery, (name) => void this.#open(name)),
      ),
      this.costs.button,
      button("Export", "Make a page or a shader of it", () => {
        void this.channel.start?.();
        this.#export();
      }),
      this.settings.python
        ? button("Share", "A link that has the code in it", () => void this.#share())
        : button("Save", "Save the file (Mod S)", () => void this.save()),
      button("?", "Keys", () => help(this.settings.version)),
    );
  }

  /** An example takes the place of the text; undo brings the old one back. */
  async #open(name: string): Promise<void> {
    const found = await this.#example(name);
    if (!found) return this.page.tell(`There is no example ${name}.`, ["Close", () => {}]);
    const { main, files } = found;
    void this.channel.start?.();
    for (const [file, text] of Object.entries(files)) {
      const into = file === main ? this.settings.main : file;
      if (into in this.texts.files) this.#replace(into, text);
      else this.texts.take(into, text, "");
    }
    this.#object = null;
    this.picture.player?.resetCamera();
    this.#showFile(this.settings.main);
    this.#fillFiles();
    this.look();
  }

  #export(): void {
    const stem = this.settings.main.replace(/\.py$/, "");
    exports(
      this.#ready?.formats ?? [],
      async (format) => {
        const poster = format === "page" ? await this.#poster() : null;
        const answer = await this.client.ask({ kind: "export", ...this.#source, format, poster });
        if (answer?.kind === "mistakes") return answer.mistakes[0]!.message;
        if (answer?.kind !== "answer" || answer.request !== "export") return "Nobody answers.";
        const { name, media_type, text, base64, command } = answer.result;
        const data = text ?? Uint8Array.from(atob(base64 ?? ""), (letter) => letter.charCodeAt(0));
        download(new Blob([data], { type: media_type }), name);
        return `${name} is saved. The same: ${command}`;
      },
      () => download(new Blob([this.texts.files[this.settings.main]!]), `${stem}.py`),
    );
  }

  /** The picture that a page shows first, as base64. */
  async #poster(): Promise<string | null> {
    const blob = await this.picture.player?.screenshot(4);
    if (!blob) return null;
    const bytes = new Uint8Array(await blob.arrayBuffer());
    return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  }
}

function download(blob: Blob, name: string): void {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

function workOf({ ms }: SceneFound | NumbersFound): string {
  return `${Math.round(ms["all"] ?? 0)} ms`;
}

function same(a: LiteralValue | null, b: LiteralValue | null): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}

const settings = JSON.parse(document.getElementById("settings")!.textContent!) as Settings;
(window as unknown as { studio: Studio }).studio = new Studio(settings);
