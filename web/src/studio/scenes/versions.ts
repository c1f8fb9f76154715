/**
 * The sheet of a scene's versions: when, why, the text; and the way back to one.
 *
 * Input: a scene. Output: a dialog; restoring is a step in the editor that can be undone.
 */

import { make } from "../../dom";
import { sheet } from "../sheets";
import type { Studio } from "../studio";
import { sameTexts, type SceneRecord, type Version } from "./records";
import { REASONS, momentOf, quoted } from "./wording";

export async function openVersions(studio: Studio, { id, name, files }: SceneRecord): Promise<void> {
  const scenes = studio.scenes!;
  const versions = await scenes.store.versions(id);
  const title = `Versions of ${quoted(name)}`;
  if (!versions.length) {
    sheet(title, make("p", {}, "None yet: a version is kept after each pause of typing."));
    return;
  }
  const text = make("pre", { className: "theirs", tabIndex: 0, "aria-label": "Text of the version" });
  const restore = make("button", { type: "button", className: "go" }, "Restore");
  let chosen: Version = versions[0]!;
  const choices = versions.map((version) => {
    const now = sameTexts(version.files, files) ? " · as it is now" : "";
    const button = make("button", { type: "button" }, momentOf(version.at, true), make("span", {}, `${REASONS[version.why]}${now}`));
    button.onclick = () => show(version, button);
    return make("li", {}, button);
  });
  const show = (version: Version, button: HTMLElement) => {
    chosen = version;
    for (const one of list.querySelectorAll("button")) one.setAttribute("aria-pressed", String(one === button));
    const others = Object.entries(version.files).filter(([file]) => file !== version.main);
    text.textContent = [version.files[version.main], ...others.map(([file, other]) => `# ${file}\n${other}`)].join("\n");
    restore.disabled = sameTexts(version.files, files);
  };
  const list = make("ul", { className: "examples versions" }, ...choices);
  const about = make("p", { className: "quiet" }, "Undo takes it back. What is there now becomes a version.");
  const dialog = sheet(title, make("div", { className: "beside" }, list, text), restore, about);
  dialog.classList.add("wide");
  restore.onclick = async () => {
    for (const open of document.querySelectorAll<HTMLDialogElement>("dialog.sheet[open]")) open.close();
    await studio.opening.goTo(`#scene=${id}`);
    // Another tab may edit it, or have deleted it: then something else is open.
    if (scenes.isReader || scenes.id !== id) return;
    await scenes.restoreVersion(chosen);
    studio.page.announcer.textContent = `The version of ${momentOf(chosen.at)} is restored`;
  };
  list.querySelector("button")!.click();
}
