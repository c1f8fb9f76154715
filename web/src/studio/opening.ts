/**
 * Opening: what the playground's address names, and its picture.
 *
 * Input: the address: a scene of this browser, a link, an example, a new one. Output: its texts in the editor,
 * its picture, and the camera, values and time that belong to it. What was open is kept by `scenes`.
 */

import type { Payload } from "../payload";
import { REASONS } from "./access";
import { sharedOf } from "./links";
import { digestOf, poseOf, type Origin, type Pose, type SceneRecord } from "./scenes/records";
import type { Opened } from "./settings";
import type { Studio } from "./studio";

/** What an address means. */
interface Named extends Opened {
  origin: Omit<Origin, "digest">;
  pose?: Pose;
}

const CLOSE: [string, () => void] = ["Close", () => {}];

export class Opening {
  /** What belongs to the texts besides them, until their picture is there. */
  #waiting: { pose: Pose; revision: number; isReset: boolean } | null = null;
  #start: Opened | null = null;
  #turn = 0;

  constructor(readonly studio: Studio) {}

  /** Shows what the address names, or the start; its picture before Python is there. */
  async begin(start: Opened): Promise<void> {
    this.#start = start;
    await this.studio.scenes!.start();
    addEventListener("hashchange", () => void this.#follow());
    await this.#follow();
    // Where pages from disk or old browsers have none, everything works but without a network.
    void navigator.serviceWorker?.register("offline.js").catch(() => {});
  }

  /** Goes to what an address of this page names: the way back stays. */
  async goTo(fragment: string): Promise<void> {
    // The address of what is open now is that of its scene, if it has become one.
    await this.studio.scenes!.write("typed");
    if (location.hash !== fragment) history.pushState(null, "", fragment);
    await this.#follow();
  }

  /** An example as a scene of its own, which the first edit keeps; the local studio has files. */
  open(name: string): Promise<void> {
    return this.studio.scenes ? this.goTo(`#example=${name}`) : this.#copy(name);
  }

  /** An example takes the place of the text; undo brings the old one back. */
  async #copy(name: string): Promise<void> {
    const { channel, files, looking, page, picture, settings, tabs, texts } = this.studio;
    if (channel.isOpen === false) return page.tell(REASONS.away, CLOSE);
    const found = await this.#example(name);
    if (!found) return page.tell(`There is no example ${name}.`, CLOSE);
    for (const [file, text] of Object.entries(found.files)) {
      const into = file === found.main ? settings.main : file;
      if (into in texts.files) files.replace(into, text);
      else texts.take(into, text, "");
    }
    looking.object = null;
    picture.player?.resetCamera();
    tabs.show(settings.main);
    tabs.fill();
    looking.look();
  }

  async #follow(): Promise<void> {
    const { page } = this.studio;
    const scenes = this.studio.scenes!;
    const turn = ++this.#turn;
    const { hash } = location;
    // Without any name, one goes on where one was.
    const id = /^#scene=([\w-]+)$/.exec(hash)?.[1] ?? (hash ? "" : (await scenes.last())?.id);
    if (turn !== this.#turn) return;
    if (id && (await scenes.open(id))) {
      if (!hash && scenes.id === id) history.replaceState(null, "", `#scene=${id}`);
      return;
    }
    if (turn !== this.#turn) return;
    const named = await this.#named(hash);
    if (turn !== this.#turn) return;
    if (!named) page.tell(reasonOf(hash), CLOSE);
    const { origin, main, files, pose = {}, payload } = named ?? this.#started();
    const digest = await digestOf(main, files);
    if (turn !== this.#turn) return;
    const ref = origin.kind === "link" ? digest : origin.ref;
    await scenes.openUnsaved({ ...origin, ref, digest }, main, files, pose, payload);
  }

  /** What a fragment means; null where that is nothing. */
  async #named(hash: string): Promise<Named | null> {
    if (hash === "" || hash === "#start") return this.#started();
    const { starter } = this.studio.settings;
    if (hash === "#new" && starter) return { origin: { kind: "new", ref: "" }, ...starter };
    const name = /^#example=(\w+)$/.exec(hash)?.[1];
    const opened = name && (await this.#example(name));
    if (opened) return { origin: { kind: "example", ref: name }, ...opened };
    const shared = await sharedOf(hash);
    return shared && { origin: { kind: "link", ref: "" }, ...shared, pose: poseOf(shared) };
  }

  #started(): Named {
    const start = this.#start!;
    return { origin: { kind: "example", ref: start.main.replace(/\.py$/, "") }, ...start };
  }

  async #example(name: string): Promise<Opened | undefined> {
    if (!this.studio.settings.gallery.some((one) => one.name === name)) return undefined;
    const response = await fetch(`gallery/${encodeURIComponent(name)}.json`).catch(() => null);
    return response?.ok ? ((await response.json()) as Opened) : undefined;
  }

  // The picture

  /** Shows texts that have begun; their picture follows. `isOther`: not those of the scene that was open. */
  show(record: SceneRecord, isOther: boolean, payload?: Payload): void {
    const { channel, costs, editor, looking, page, picture, tabs, texts } = this.studio;
    const here = !isOther && editor.name in texts.files ? editor.name : record.main;
    tabs.show(here);
    tabs.fill();
    if (isOther) {
      looking.begin();
      tabs.showMistakes([]);
      costs.changed();
      picture.outline.show(null, null);
      page.print("");
      this.#waiting = { pose: poseOf(record), revision: texts.revision, isReset: !!picture.player };
    }
    if (payload) return void this.#draw(payload, texts.revision);
    if (record.thumb) picture.preview(record.thumb);
    picture.isOld = isOther;
    void channel.start?.();
    looking.look();
  }

  /** Draws what needs no Python, then asks for the rest. */
  async #draw(payload: Payload, revision: number): Promise<void> {
    const { looking, picture } = this.studio;
    await picture.show(payload);
    picture.isOld = false;
    this.takePose(revision);
    looking.look();
  }

  /** Whether the picture is that of the texts, or of earlier ones of the same scene. */
  get isShown(): boolean {
    return !this.#waiting;
  }

  /** How the picture stands, or will once it is there. */
  get pose(): Pose {
    if (this.#waiting) return this.#waiting.pose;
    const { looking, picture } = this.studio;
    const { player } = picture;
    if (!player) return {};
    const { values } = looking.source;
    const camera = player.camera?.moved ? player.steering() : null;
    return {
      ...(Object.keys(values).length && { values }),
      ...(camera && { camera }),
      ...(player.payload.time.animated && { time: player.time }),
    };
  }

  /** The camera, values and time of a scene or link, once the picture of its texts is there. */
  takePose(revision: number): void {
    const waiting = this.#waiting;
    const { player } = this.studio.picture;
    if (!waiting || !player || revision < waiting.revision) return;
    this.#waiting = null;
    const { camera, values = {}, time } = waiting.pose;
    if (waiting.isReset) {
      player.resetCamera();
      player.resetAll();
      player.setTime(player.timeRange[0]);
    }
    attempt(() => camera && player.setSteering(camera));
    attempt(() => time !== undefined && player.setTime(time));
    for (const { name } of player.payload.parameters) {
      attempt(() => values?.[name] !== undefined && player.setParameter(name, values[name]));
    }
  }
}

function reasonOf(hash: string): string {
  if (hash.startsWith("#scene=")) return "This scene is not in this browser, or it was deleted. Here is the first example.";
  if (hash.startsWith("#c=")) return "This link is damaged or too long: its code cannot be read. Here is the first example.";
  if (hash.startsWith("#example=")) return "There is no example of that name. Here is the first one.";
  return "This address names no scene. Here is the first example.";
}

/** A link made by hand: what does not fit is left out. */
function attempt(act: () => void): void {
  try {
    act();
  } catch {
    // As above.
  }
}
