/**
 * Running the code: one request at a time, and what its answer changes.
 *
 * Input: texts that change, a view, an object of the file. Output: the picture, mistakes and literals of the
 * newest text. What a hand turns meanwhile goes its own way (`turning.ts`) and comes back to `take`.
 */

import { make } from "../dom";
import type { Change, Edit, Mistake, NumbersFound, Ready, Response, SceneFound } from "../generated/messages";
import type { Program, Value } from "../payload";
import type { Studio } from "./studio";

/** After the last key, so long until the code is run. */
const TYPING_MS = 120;
/** After the last answer, so long until the camera's guide is compiled as well. */
const GUIDE_MS = 500;
const SIZE: [number, number] = [640, 480];

export class Looking {
  /** What the worker can do; null while nobody is there. */
  ready: Ready | null = null;
  /** The program of the last answer. */
  key: string | null = null;
  /** Which picture of the file; null for the only one. */
  object: string | null = null;
  isStopped = false;
  /** The camera that is written next is the picture's own afterwards. */
  keepsCamera = false;
  /** File and line of all that makes a shape. */
  makers = new Set<string>();
  #isBusy = false;
  #waiting: ((ready: Ready) => void)[] = [];
  /** Whether the notice that it was stopped is to be seen. */
  #isStoppedTold = false;
  #wanted = -1;
  #done = -1;
  #timer = 0;
  #guiding = 0;
  /** The revision whose guide was asked for. */
  #guided = -1;

  constructor(readonly studio: Studio) {}

  /** Whether the text that is there may be asked about: no run is under way, nothing is turned. */
  get isFree(): boolean {
    return !this.#isBusy && !this.studio.turning.isOn;
  }

  /** Resolves once the worker is there. */
  whenReady(): Promise<Ready> {
    return new Promise((resolve) => (this.ready ? resolve(this.ready) : this.#waiting.push(resolve)));
  }

  can(ability: string): boolean {
    return !!this.ready?.abilities.includes(ability);
  }

  /** What requests say of the text as it is. */
  get source() {
    const { picture, settings, texts } = this.studio;
    const { player } = picture;
    const { files, revision } = texts;
    const moved = player?.payload.parameters.filter(
      ({ name, default: fallback }) => JSON.stringify(player.parameters()[name]) !== JSON.stringify(fallback),
    );
    const values = Object.fromEntries((moved ?? []).map(({ name }) => [name, player!.parameters()[name]!]));
    return {
      revision,
      files,
      main: settings.main,
      object: this.object,
      view: player?.view ?? "color",
      values: values as Record<string, Value>,
      time: 0,
      size: SIZE,
    };
  }

  // Runs

  /** Runs the code as it is now; while one run is under way, once more after it. */
  look(): void {
    clearTimeout(this.#timer);
    this.#wanted = Math.max(this.#wanted, 0) + 1;
    void this.#lookOn();
  }

  /** The texts are others: nothing that is known of a program holds. */
  begin(): void {
    this.object = null;
    this.key = null;
    this.isStopped = false;
    this.keepsCamera = false;
    this.studio.turning.drop();
  }

  /** Shows another picture of the file. */
  choose(object: string): void {
    this.object = object;
    this.look();
  }

  /** Runs the code once nobody types any more. */
  lookSoon(): void {
    this.isStopped = false;
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.look(), TYPING_MS);
  }

  /** Runs the code now, also after it was stopped. */
  run(): void {
    void this.studio.channel.start?.();
    this.isStopped = false;
    this.look();
  }

  /** The text that was turned is answered already. */
  settle(): void {
    this.#done = this.#wanted;
  }

  async #lookOn(): Promise<void> {
    const { costs, picture, texts, turning } = this.studio;
    if (this.#isBusy || this.isStopped || !this.ready || turning.isOn || !texts.names.length) return;
    this.#isBusy = true;
    try {
      await this.#lookNow();
    } finally {
      this.#isBusy = false;
    }
    this.#guideSoon();
    void costs.compiled();
    if (picture.player && picture.layers.isOpen) void picture.layers.draw(picture.player);
  }

  /** Asks until the newest text is answered. */
  async #lookNow(): Promise<void> {
    const { client, keeping, page, texts, turning } = this.studio;
    while (this.#done !== this.#wanted && !this.isStopped && !turning.isOn) {
      const wanted = this.#wanted;
      const { revision } = texts;
      keeping.keep();
      page.work.textContent = "…";
      const answer = await client.ask({ kind: "look", ...this.source, guided: false });
      this.#done = wanted;
      if (answer) await this.take(answer, revision);
    }
  }

  /** The program of a view of the text as it is. */
  async program(view: string): Promise<Program | null> {
    const { channel, client, texts } = this.studio;
    void channel.start?.();
    // What is drawn without a worker is drawn again once one is there.
    if (!this.isFree || !this.ready) return null;
    const { revision } = texts;
    const asked = { ...this.source, view, lean: true, guided: false };
    const answer = await client.ask({ kind: "look", ...asked });
    if (answer?.kind !== "scene" || revision !== texts.revision) return null;
    const { views, programs } = answer.payload;
    const number = views.find(({ name }) => name === view)?.program ?? -1;
    return programs.encoding === "plain" ? (programs.data[number] ?? null) : null;
  }

  /** While one types, the camera moves freely; in a pause the program that guides it follows. */
  #guideSoon(): void {
    clearTimeout(this.#guiding);
    const { picture, texts } = this.studio;
    const { revision } = texts;
    const steering = picture.player?.payload.steering;
    if (!steering || (steering.guide ?? -1) >= 0 || this.#guided === revision) return;
    this.#guiding = window.setTimeout(() => {
      if (this.isFree && !this.isStopped) void this.guide(revision);
    }, GUIDE_MS);
  }

  async guide(revision: number): Promise<void> {
    const { client, picture, texts, turning } = this.studio;
    if (texts.revision !== revision) return;
    this.#guided = revision;
    const answer = await client.ask({ kind: "look", ...this.source, lean: true });
    const isStale = texts.revision !== revision || turning.isOn;
    if (answer?.kind === "scene" && !isStale) await this.#try(() => picture.show(answer.payload));
  }

  // Answers

  /** Shows an answer to a text; -1 for one that is not in the editor. */
  async take(answer: Response, revision: number): Promise<void> {
    await this.#try(() => this.#take(answer, revision));
  }

  /** Does what an answer says; one that cannot be shown leaves the last picture. */
  async #try(act: () => Promise<void>): Promise<void> {
    const { channel, page } = this.studio;
    try {
      await act();
    } catch (error) {
      const reason = String((error as Error).message).slice(0, 200);
      // The next answer is a whole picture.
      this.key = null;
      page.work.textContent = "";
      if (channel.refuse) channel.refuse(reason);
      else page.print(`The picture cannot be shown: ${reason}`);
    }
  }

  async #take(answer: Response, revision: number): Promise<void> {
    const { editor, page, picture, tabs, texts } = this.studio;
    if (answer.kind === "scene") {
      await this.#show(answer, revision);
    } else if (answer.kind === "numbers") {
      picture.setNumbers(answer);
      this.key = answer.key;
    } else if (answer.kind !== "mistakes") return;
    if (this.#isStoppedTold) page.tell(null);
    this.#isStoppedTold = false;
    const mistakes: readonly Mistake[] = answer.kind === "mistakes" ? answer.mistakes : [];
    page.work.textContent = answer.kind === "mistakes" ? "Mistakes" : workOf(answer);
    picture.isOld = mistakes.length > 0;
    if (texts.revision !== revision) return; // The text has gone on: its places would be wrong.
    tabs.showMistakes(mistakes);
    if (answer.literals) editor.setLiterals(answer.literals);
    tabs.emitAgain();
    if (!mistakes.length) this.studio.scenes?.pictured();
    if (!mistakes.length && this.keepsCamera) {
      this.keepsCamera = false;
      picture.player?.resetCamera();
    }
  }

  showScene(answer: SceneFound, revision = this.studio.texts.revision): Promise<void> {
    return this.#try(() => this.#show(answer, revision));
  }

  async #show(answer: SceneFound, revision: number): Promise<void> {
    await this.studio.picture.show(answer.payload);
    this.key = answer.key;
    if (answer.shapes) this.makers = new Set(answer.shapes.map(({ file, line }) => `${file}:${line}`));
    const { objects } = this.studio.page;
    objects.hidden = answer.objects.length < 2;
    objects.replaceChildren(...answer.objects.map((name) => make("option", { value: name }, name)));
    if (this.object) objects.value = this.object;
    this.studio.commands.refresh();
    this.studio.opening.takePose(revision);
  }

  // The code is written

  async write(change: Partial<Change> & Pick<Change, "what">): Promise<void> {
    const { client, page, texts } = this.studio;
    const full = { file: null, start: null, end: null, name: null, value: null, text: null, ...change };
    const { revision } = texts;
    const answer = await client.ask({ kind: "write", ...this.source, changes: [full as Change] });
    if (answer?.kind === "mistakes") {
      this.keepsCamera = false;
      return page.tell(answer.mistakes[0]!.message, ["Close", () => {}]);
    }
    if (answer?.kind !== "answer" || answer.request !== "write" || revision !== texts.revision) return;
    this.apply(answer.result.edits);
  }

  apply(edits: readonly Edit[]): void {
    const file = edits[0]?.file;
    if (!file) return;
    this.studio.tabs.show(file);
    this.studio.editor.apply(edits);
    this.look();
  }

  // The worker comes and goes

  started(message: Ready): void {
    this.ready = message;
    for (const resolve of this.#waiting.splice(0)) resolve(message);
    this.studio.emitted.targets = message.targets;
    this.key = null;
    this.look();
  }

  restarted(reason: string): void {
    const { page, picture, tabs, turning } = this.studio;
    this.ready = null;
    this.isStopped = true;
    this.#isStoppedTold = true;
    turning.drop();
    picture.isOld = true;
    // They are those of an older text.
    tabs.showMistakes([]);
    page.work.textContent = "Stopped";
    page.tell(`Stopped: ${reason}. Change the code, or run it again.`, ["Run again", () => this.run()]);
  }

  connected(isOpen: boolean): void {
    if (isOpen) return;
    this.ready = null;
    this.studio.turning.drop();
  }
}

function workOf({ ms }: SceneFound | NumbersFound): string {
  return `${Math.round(ms["all"] ?? 0)} ms`;
}
