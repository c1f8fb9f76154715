/**
 * Sheets over the page: exports, keys, and the dialog that all sheets are.
 *
 * Input: what they list. Output: dialogs; Escape and a press beside them close them.
 */

import { make } from "../dom";
import { shownKeys } from "./command_keys";
import type { Command } from "./commands";

/** A dialog without a heading that is removed when it closes. */
export function bareSheet(title: string, ...children: (Node | string)[]): HTMLDialogElement {
  const dialog = make("dialog", { className: "sheet", "aria-label": title }, ...children);
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
  dialog.onclose = () => dialog.remove();
  // One that was closed a moment ago has not heard of it yet.
  for (const closed of document.querySelectorAll("dialog.sheet:not([open])")) closed.remove();
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

/** A dialog with a heading. */
export function sheet(title: string, ...children: (Node | string)[]): HTMLDialogElement {
  const close = make("button", { type: "button", className: "icon", "aria-label": "Close" }, "×");
  const header = make("header", {}, make("h2", {}, title), close);
  const dialog = bareSheet(title, header, make("div", { className: "sheet-body" }, ...children));
  close.onclick = () => dialog.close();
  return dialog;
}

/** A page's fragment for other pages. */
export const EMBED = "embed";

/** What each format is. */
export const EXPORTS: Record<string, string> = {
  page: "A page: one HTML file that needs no network",
  [EMBED]: "A page's picture alone, as HTML to paste into another page",
  shadertoy: "Shadertoy",
  isf: "ISF, for VJ programs",
  glslcanvas: "glslCanvas, The Book of Shaders",
  "glsl-es300": "GLSL ES 3.00, for WebGL 2",
  "glsl-330": "GLSL 3.30, for OpenGL",
  "glsl-es100": "GLSL ES 1.00, for WebGL 1",
  wgsl: "WGSL, for WebGPU",
  "wgsl-compute": "WGSL as a compute shader",
};

/** Exports: the formats come once the worker is there. */
export async function exports(
  formats: Promise<readonly string[]>,
  take: (format: string) => Promise<string>,
  saveSource: () => void,
  pictures: HTMLElement,
): Promise<void> {
  const status = make("p", { className: "result", role: "status" }, "Starting Python …");
  const choice = (name: string, about: string) =>
    make("button", { type: "button" }, make("strong", {}, name), make("span", {}, about));
  const source = choice("py", "The code itself");
  source.onclick = saveSource;
  const last = make("li", {}, source);
  const list = make("ul", { className: "examples" }, last);
  sheet("Export", pictures, make("h3", {}, "Pages and code"), list, status);
  const items = (await formats).map((format) => {
    const button = choice(format, EXPORTS[format] ?? "");
    button.onclick = async () => {
      button.disabled = true;
      status.textContent = `Making ${format} …`;
      status.textContent = await take(format);
      button.disabled = false;
    };
    return make("li", {}, button);
  });
  last.before(...items);
  status.textContent = "";
}

/** The list of keys. */
export function help(commands: readonly Command[], version: string): void {
  const rows = commands.flatMap(({ keys, text }) =>
    keys ? [make("dt", {}, make("kbd", {}, shownKeys(keys))), make("dd", {}, text)] : [],
  );
  sheet(
    "Keys",
    make("dl", { className: "keys" }, ...rows),
    make("p", {}, "Drag a number in the code, or click it for its dial. A click on the picture selects the line of the shape."),
    make("p", { className: "quiet" }, `distal ${version}`),
  );
}
