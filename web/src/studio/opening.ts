/**
 * Opening: what a link shares, an example, or the start of the playground.
 *
 * Input: the page's address, the name of an example. Output: its texts in the editor, its picture, and the
 * camera, values and time of a link.
 */

import { REASONS } from "./access";
import type { Studio } from "./studio";
import type { Opened } from "./settings";
import { sharedOf, type Shared } from "./links";

export class Opening {
  /** What a link has besides the code, until its picture is there. */
  #shared: Shared | null = null;

  constructor(readonly studio: Studio) {}

  /** Shows what the address names, or the start; its picture before Python is there. */
  async begin(start: Opened): Promise<void> {
    const { channel, files, picture, settings, texts } = this.studio;
    const name = /^#example=(\w+)$/.exec(location.hash)?.[1];
    const shared = await sharedOf(location.hash);
    const opened: Opened = shared ?? (name ? await this.#example(name) : undefined) ?? start;
    const given = opened.payload;
    settings.main = opened.main;
    const digests = Object.fromEntries(Object.keys(opened.files).map((file) => [file, location.hash || "start"]));
    if (given) await picture.show(given);
    files.changed({ kind: "changed", files: opened.files, digests });
    const isNew = texts.names.some((file) => texts.files[file] !== opened.files[file]);
    if (!given || isNew) void channel.start?.();
    // Where pages from disk or old browsers have none, everything works but without a network.
    void navigator.serviceWorker?.register("offline.js").catch(() => {});
    this.#shared = shared;
  }

  /** The camera, values and time of a link, once its picture is there. */
  takeShared(): void {
    if (!this.#shared) return;
    const { player } = this.studio.picture;
    const { camera, values = {}, time } = this.#shared;
    this.#shared = null;
    if (!player) return;
    attempt(() => camera && player.setSteering(camera));
    attempt(() => time !== undefined && player.setTime(time));
    for (const { name } of player.payload.parameters) {
      attempt(() => values?.[name] !== undefined && player.setParameter(name, values[name]));
    }
  }

  /** An example takes the place of the text; undo brings the old one back. */
  async open(name: string): Promise<void> {
    const { channel, files, looking, page, picture, settings, tabs, texts } = this.studio;
    if (channel.isOpen === false) return page.tell(REASONS.away, ["Close", () => {}]);
    const found = await this.#example(name);
    if (!found) return page.tell(`There is no example ${name}.`, ["Close", () => {}]);
    void channel.start?.();
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

  async #example(name: string): Promise<Opened | undefined> {
    if (!this.studio.settings.gallery.some((one) => one.name === name)) return undefined;
    const response = await fetch(`gallery/${encodeURIComponent(name)}.json`);
    return response.ok ? ((await response.json()) as Opened) : undefined;
  }
}

/** A link made by hand: what does not fit is left out. */
function attempt(act: () => void): void {
  try {
    act();
  } catch {
    // As above.
  }
}
