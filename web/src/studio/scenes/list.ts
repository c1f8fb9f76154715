/**
 * The sheet of a person's scenes: pictures, names, and what can be done with each.
 *
 * Input: the scenes of this browser. Output: a dialog. What it does is done by `scenes`; it is filled again after
 * that, and when another tab has written something.
 */

import { make } from "../../dom";
import { sheet } from "../sheets";
import { download, saveScene } from "../sharing";
import type { Studio } from "../studio";
import { packed, unpacked } from "./archive";
import { editName } from "./heading";
import type { SceneRecord } from "./records";
import type { Scenes } from "./scenes";
import { openVersions } from "./versions";
import { momentOf, quoted } from "./wording";

/** Of more scenes there is a field to search them. */
const FEW = 6;
const NO_MATCH = "No scene of that name.";
const PLACE =
  "Scenes are stored in this browser only, and some browsers clear them after a week without a visit. Save all keeps them as files.";

export function openScenes(studio: Studio): void {
  void new SceneList(studio, studio.scenes!).fill();
}

class SceneList {
  #search = make("input", { type: "search", placeholder: "Search", "aria-label": "Search your scenes", hidden: true });
  #status = make("p", { className: "told", role: "status" });
  #list = make("ul", { className: "posters scenes" });
  #deleted = make("details", { className: "deleted", hidden: true });
  #dialog: HTMLDialogElement;
  /** The records that the list shows. */
  #shown = "";

  constructor(
    readonly studio: Studio,
    readonly scenes: Scenes,
  ) {
    const button = (text: string, act: () => void) => make("button", { type: "button", onclick: act }, text);
    const files = make("input", { type: "file", accept: ".py,.zip", multiple: true, hidden: true });
    files.onchange = () => void this.#read([...files.files!]).then(() => (files.value = ""));
    const tools = make(
      "div",
      { className: "choices tools" },
      button("New", () => this.#go("#new")),
      button("Open files", () => files.click()),
      button("Save all (.zip)", () => void this.#saveAll()),
      files,
    );
    const place = make("p", { className: "quiet" }, PLACE);
    this.#dialog = sheet("Your scenes", tools, this.#search, this.#status, this.#list, this.#deleted, place);
    this.#dialog.classList.add("wide");
    this.#search.oninput = () => this.#filter();
    scenes.onChange = () => void this.fill();
    this.#dialog.addEventListener("close", () => (scenes.onChange = () => {}));
  }

  /** Shows the scenes as they are now; the focus stays at the scene that had it. */
  async fill(): Promise<void> {
    const [all, taken] = await Promise.all([this.scenes.shelf.all(), this.scenes.turns.locks.taken()]);
    // A name that is typed now is not taken away, nor a menu that is open.
    if (this.#list.querySelector("input, .menu[open]")) return;
    const shown = JSON.stringify(all.map(({ files: _, ...one }) => [one, taken.has(one.id)]));
    if (shown === this.#shown) return;
    this.#shown = shown;
    const focused = (document.activeElement as HTMLElement | null)?.closest<HTMLElement>("[data-scene]")?.dataset["scene"];
    const here = all.filter(({ deleted }) => deleted === null);
    this.#list.replaceChildren(...here.map((scene) => this.#card(scene, taken.has(scene.id))));
    if (!here.length) this.#list.append(make("li", { className: "quiet" }, NOTHING));
    this.#search.hidden = here.length <= FEW;
    this.#fillDeleted(all.filter(({ deleted }) => deleted !== null));
    this.#filter();
    if (focused) this.#focus(focused);
  }

  #focus(id: string): void {
    this.#list.querySelector<HTMLElement>(`[data-scene="${id}"] summary`)?.focus();
  }

  #filter(): void {
    const words = this.#search.hidden ? [] : this.#search.value.toLowerCase().split(/\s+/);
    const cards = [...this.#list.querySelectorAll<HTMLElement>("[data-name]")];
    for (const card of cards) card.hidden = !words.every((word) => card.dataset["name"]!.includes(word));
    if (cards.length && cards.every(({ hidden }) => hidden)) this.#tell(NO_MATCH);
    else if (this.#status.textContent === NO_MATCH) this.#tell("");
  }

  #tell(text: string, label = "", act = () => {}): void {
    const button = label && make("button", { type: "button", onclick: act }, label);
    this.#status.replaceChildren(...(button ? [text, " ", button] : [text]));
  }

  #card(scene: SceneRecord, isTaken: boolean): HTMLElement {
    const { id, name, thumb, changed } = scene;
    const isHere = id === this.scenes.id;
    const when = momentOf(changed);
    const image = thumb ? make("img", { src: thumb, alt: "" }) : make("span", { className: "blank" });
    const place = isHere ? " · open here" : isTaken ? " · open in another tab" : "";
    const title = make("strong", {}, name);
    const open = make("button", { type: "button", className: "open", "aria-label": `Open ${quoted(name)}, ${when}${place}` }, image);
    open.onclick = () => this.#go(`#scene=${id}`);
    const about = make("div", { className: "about" }, title, make("span", {}, `${when}${place}`));
    const card = make("li", { "data-scene": id, "data-name": name.toLowerCase() }, open, about, this.#menu(scene, title));
    if (isHere) card.setAttribute("aria-current", "true");
    return card;
  }

  #menu(scene: SceneRecord, title: HTMLElement): HTMLElement {
    const { id, name } = scene;
    const summary = make("summary", { "aria-label": `More for ${quoted(name)}`, title: "More" }, "⋯");
    const menu = make("details", { className: "menu" }, summary);
    const item = (text: string, act: () => void) => {
      const button = make("button", { type: "button" }, text);
      button.onclick = () => {
        menu.open = false;
        act();
      };
      return button;
    };
    const ended = () => void this.fill().then(() => this.#focus(id));
    const renamed = (typed: string) => void this.scenes.rename(id, typed).then(ended);
    menu.append(
      make(
        "div",
        {},
        item("Rename", () => editName(title, name, renamed, ended)),
        item("Duplicate", () => void this.#duplicate(id)),
        item("Versions", () => void openVersions(this.studio, scene)),
        item("Save as a file", () => saveScene(scene)),
        item("Delete", () => void this.#remove(scene)),
      ),
    );
    menu.onkeydown = (event) => {
      if (event.key !== "Escape" || !menu.open) return;
      event.preventDefault();
      menu.open = false;
      summary.focus();
    };
    menu.addEventListener("toggle", () => !menu.open && void this.fill());
    menu.addEventListener("focusout", ({ relatedTarget }) => {
      if (!menu.contains(relatedTarget as Node | null)) menu.open = false;
    });
    return menu;
  }

  async #duplicate(id: string): Promise<void> {
    const { name } = await this.scenes.duplicate(id);
    await this.fill();
    this.#tell(`The copy is ${quoted(name)}.`);
  }

  async #remove({ id, name }: SceneRecord): Promise<void> {
    await this.scenes.remove(id);
    await this.fill();
    this.#tell(`${quoted(name)} is deleted.`, "Undo", () => {
      this.#tell("");
      void this.scenes.restore(id);
    });
    this.#status.querySelector("button")?.focus();
  }

  #fillDeleted(scenes: readonly SceneRecord[]): void {
    const wasOpen = this.#deleted.open;
    const items = scenes.map(({ id, name, deleted }) => {
      const back = make("button", { type: "button", "aria-label": `Bring back ${quoted(name)}` }, "Bring back");
      back.onclick = () => void this.scenes.restore(id);
      return make("li", {}, make("span", {}, `${name}, deleted ${momentOf(deleted!)}`), back);
    });
    const summary = make("summary", {}, `Deleted (${scenes.length})`);
    const about = make("p", { className: "quiet" }, "They are removed 30 days after they were deleted.");
    this.#deleted.replaceChildren(summary, make("ul", {}, ...items), about);
    this.#deleted.hidden = !scenes.length;
    this.#deleted.open = wasOpen;
  }

  #go(fragment: string): void {
    this.#dialog.close();
    void this.studio.opening.goTo(fragment);
  }

  async #saveAll(): Promise<void> {
    await this.scenes.write();
    const scenes = (await this.scenes.shelf.all()).filter(({ deleted }) => deleted === null);
    if (!scenes.length) return this.#tell("There is no scene to save.");
    download(new Blob([packed(scenes)], { type: "application/zip" }), "distal-scenes.zip");
    this.#tell(`${countOf(scenes.length)} saved in distal-scenes.zip.`);
  }

  async #read(files: File[]): Promise<void> {
    try {
      const bytes = files.map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())] as [string, Uint8Array]);
      const loaded = unpacked(await Promise.all(bytes));
      const added: boolean[] = [];
      for (const one of loaded) added.push(await this.scenes.shelf.take(one));
      const fresh = added.filter(Boolean).length;
      const old = added.length - fresh;
      await this.fill();
      const known = old ? ` ${countOf(old)} ${old === 1 ? "was" : "were"} here already.` : "";
      this.#tell(loaded.length ? `${countOf(fresh)} opened.${known}` : "These files have no scene: Python files and archives of them have.");
    } catch (error) {
      this.#tell((error as Error).message);
    }
  }
}

const NOTHING = "No scene yet: change an example or a new one, and it is kept here.";

function countOf(count: number): string {
  return count === 1 ? "1 scene" : `${count} scenes`;
}
