/**
 * What leaves the app: links with the code in them, and exported files.
 *
 * Input: the text and the picture as they are. Output: addresses, files that the browser saves.
 */

import { make } from "../dom";
import { linkOf, type Shared } from "./links";
import { drawnPicture, renderPart } from "./render_form";
import { packed } from "./scenes/archive";
import { fileNameOf, type SceneRecord } from "./scenes/records";
import { openShare } from "./share_sheet";
import { EMBED, exports } from "./sheets";
import type { Studio } from "./studio";

export class Sharing {
  constructor(readonly studio: Studio) {}

  /** Shows the link of the code, and one that has values, camera and time too. */
  async share(): Promise<void> {
    const { picture, settings, texts } = this.studio;
    const { player } = picture;
    const plain: Shared = { files: texts.files, main: settings.main };
    const full: Shared = { ...plain };
    if (player) {
      full.values = player.parameters();
      full.time = player.time;
      const camera = player.steering();
      if (camera) full.camera = camera;
    }
    const links = await Promise.all([plain, full].map(async (what) => address() + (await linkOf(what))));
    openShare(links[0]!, links[1]!, document.title);
  }

  /** The address of the playground with the text as it is. */
  async whole(): Promise<string> {
    const { settings, texts } = this.studio;
    return address() + (await linkOf({ files: texts.files, main: settings.main }));
  }

  /** Shows what the picture can be exported as. */
  export(): Promise<void> {
    const { channel, looking } = this.studio;
    void channel.start?.();
    return exports(
      looking.whenReady().then(() => this.formats),
      (format) => this.exportAs(format),
      () => this.saveSource(),
      this.#pictures(),
    );
  }

  /** What a page or code can be exported as, once the worker is there. */
  get formats(): string[] {
    const known = this.studio.looking.ready?.formats ?? [];
    return known.flatMap((format) => (format === "page" ? [format, EMBED] : [format]));
  }

  /** The sheet's part for pictures and films. */
  #pictures(): HTMLElement {
    const { client, jobs, looking, picture, settings, texts } = this.studio;
    const player = () => picture.player;
    if (settings.python) return drawnPicture(player);
    const isUnsaved = () => texts.names.some((name) => texts.isChanged(name));
    return renderPart(client, { source: () => looking.source, player, isUnsaved }, jobs);
  }

  /** Saves a format's file; returns a sentence about it. */
  async exportAs(chosen: string): Promise<string> {
    const { client, looking } = this.studio;
    const embed = chosen === EMBED;
    const format = embed ? "page" : chosen;
    const poster = format === "page" ? await this.#poster() : null;
    const answer = await client.ask({ kind: "export", ...looking.source, format, embed, poster });
    if (answer?.kind === "mistakes") return answer.mistakes[0]!.message;
    if (answer?.kind !== "answer" || answer.request !== "export") return "Nobody answers.";
    const { name, media_type, text, base64, command } = answer.result;
    const data = text ?? Uint8Array.from(atob(base64 ?? ""), (letter) => letter.charCodeAt(0));
    const named = this.#named(name);
    download(new Blob([data], { type: media_type }), named);
    return `${named} is saved. The same: ${command}`;
  }

  /** Saves a copy of the code: one file, or an archive of several. */
  saveSource(): void {
    const { scenes, settings, texts } = this.studio;
    const { main } = settings;
    if (scenes?.record) saveScene({ ...scenes.record, files: texts.files });
    else download(new Blob([texts.files[main]!]), `${main.replace(/\.py$/, "")}.py`);
  }

  /** Saves a copy of each file that is not as on the disk. */
  saveChanged(): void {
    const { texts } = this.studio;
    for (const name of texts.names.filter((one) => texts.isChanged(one))) download(new Blob([texts.files[name]!]), name);
  }

  /** A file's name, which is that of the scene instead of its main file. */
  #named(name: string): string {
    const { scenes, settings } = this.studio;
    const stem = settings.main.replace(/\.py$/, "");
    return scenes && name.startsWith(stem) ? fileNameOf(scenes.name) + name.slice(stem.length) : name;
  }

  /** The picture that a page shows first, as base64. */
  async #poster(): Promise<string | null> {
    const blob = await this.studio.picture.player?.screenshot(4);
    if (!blob) return null;
    const bytes = new Uint8Array(await blob.arrayBuffer());
    return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  }
}

function address(): string {
  return location.href.split(/[?#]/)[0]!;
}

/** Saves a scene's code as one file, or an archive of several. */
export function saveScene(scene: SceneRecord): void {
  const { files, main, name } = scene;
  const isOne = Object.keys(files).length === 1;
  const data = isOne ? files[main]! : packed([scene]);
  download(new Blob([data]), `${fileNameOf(name)}.${isOne ? "py" : "zip"}`);
}

export function download(blob: Blob, name: string): void {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
