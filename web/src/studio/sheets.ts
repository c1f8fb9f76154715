/**
 * Sheets over the page: the gallery, exports, keys, and a choice between two texts.
 *
 * Input: what they list. Output: dialogs; Escape and a press beside them close them.
 */

import { make } from "../dom";

export interface Example {
  name: string;
  title: string;
}

/** A dialog that is removed when it closes. */
export function sheet(title: string, ...children: (Node | string)[]): HTMLDialogElement {
  const close = make("button", { type: "button", className: "icon", "aria-label": "Close" }, "×");
  const heading = make("h2", {}, title);
  const body = make("div", { className: "sheet-body" }, ...children);
  const dialog = make("dialog", { className: "sheet" }, make("header", {}, heading, close), body);
  dialog.setAttribute("aria-label", title);
  close.onclick = () => dialog.close();
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
  dialog.onclose = () => dialog.remove();
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

export function gallery(examples: readonly Example[], open: (name: string) => void): void {
  const search = make("input", { type: "search", placeholder: "Search", "aria-label": "Search the gallery" });
  const list = make("ul", { className: "examples" });
  const show = () => {
    const words = search.value.toLowerCase().split(/\s+/);
    const found = examples.filter(({ name, title }) => {
      const text = `${name} ${title}`.toLowerCase();
      return words.every((word) => text.includes(word));
    });
    list.replaceChildren(
      ...found.map(({ name, title }) => {
        const button = make(
          "button",
          { type: "button" },
          make("strong", {}, name.replaceAll("_", " ")),
          make("span", {}, title),
        );
        button.onclick = () => {
          dialog.close();
          open(name);
        };
        return make("li", {}, button);
      }),
    );
    if (!found.length) list.replaceChildren(make("li", {}, "Nothing of that name."));
  };
  search.oninput = show;
  const dialog = sheet("Gallery", search, list);
  show();
}

export const EXPORTS: Record<string, string> = {
  page: "A page: one HTML file that needs no network",
  embed: "A page's picture alone, as HTML to paste into another page",
  shadertoy: "Shadertoy",
  isf: "ISF, for VJ programs",
  glslcanvas: "glslCanvas, The Book of Shaders",
  "glsl-es300": "GLSL ES 3.00, for WebGL 2",
  "glsl-330": "GLSL 3.30, for OpenGL",
  "glsl-es100": "GLSL ES 1.00, for WebGL 1",
  wgsl: "WGSL, for WebGPU",
  "wgsl-compute": "WGSL as a compute shader",
};

export function exports(
  formats: readonly string[],
  take: (format: string) => Promise<string>,
  saveSource: () => void,
  pictures: HTMLElement,
): void {
  const status = make("p", { className: "result", role: "status" });
  const source = make("button", { type: "button" }, make("strong", {}, "py"), make("span", {}, "The code itself"));
  source.onclick = saveSource;
  const items = formats.map((format) => {
    const button = make(
      "button",
      { type: "button" },
      make("strong", {}, format),
      make("span", {}, EXPORTS[format] ?? ""),
    );
    button.onclick = async () => {
      button.disabled = true;
      status.textContent = `Making ${format} …`;
      status.textContent = await take(format);
      button.disabled = false;
    };
    return make("li", {}, button);
  });
  const list = make("ul", { className: "examples" }, ...items, make("li", {}, source));
  sheet("Export", pictures, make("h3", {}, "Pages and code"), list, status);
}

/** A link with the code, and one that has values, camera and time too; or a frame for another page. */
export function share(plain: string, full: string, title: string): void {
  const field = make("input", { type: "text", readOnly: true, "aria-label": "Link" });
  const isFull = make("input", { type: "checkbox" });
  const isFrame = make("input", { type: "checkbox" });
  const length = make("p", { className: "quiet" });
  const copied = make("button", { type: "button" }, "Copy");
  const show = () => {
    const link = isFull.checked ? full : plain;
    field.value = isFrame.checked ? frameOf(link, title) : link;
    length.textContent = `${field.value.length.toLocaleString("en")} characters. The link has the code in it: nothing is stored elsewhere.`;
    copied.textContent = "Copy";
  };
  isFull.onchange = isFrame.onchange = show;
  copied.onclick = async () => {
    field.select();
    await navigator.clipboard?.writeText(field.value).catch(() => document.execCommand("copy"));
    copied.textContent = "Copied";
  };
  show();
  const option = make("label", { className: "option" }, isFull, "With the sliders' values, the camera and the time");
  const frame = make("label", { className: "option" }, isFrame, "As a frame: the HTML that shows it in another page");
  sheet("Share", make("div", { className: "choices" }, field, copied), option, frame, length);
}

/** The HTML of a frame that shows a link. */
function frameOf(link: string, title: string): string {
  const [address, code] = link.split("#");
  const frame = make("iframe", { src: `${address!.split("?")[0]}?embed#${code}`, title, width: "800", height: "460" });
  frame.setAttribute("loading", "lazy");
  frame.style.border = "0";
  return frame.outerHTML;
}

const KEYS: [string, string][] = [
  ["Mod S", "Save the file"],
  ["Mod Enter", "Run the code now"],
  ["Mod .", "Turn the number, color or switch at the caret"],
  ["Mod Z", "Undo"],
  ["Mod F", "Search"],
  ["Mod Space", "Complete a name"],
  ["F8", "Go to the next mistake"],
  ["F6", "Go to the next part of the page"],
  ["Escape, then Tab", "Leave the code"],
];

export function help(version: string): void {
  const mod = /Mac|iP/.test(navigator.platform) ? "⌘" : "Ctrl";
  const rows = KEYS.flatMap(([keys, text]) => [
    make("dt", {}, make("kbd", {}, keys.replace("Mod", mod))),
    make("dd", {}, text),
  ]);
  sheet(
    "Keys",
    make("dl", { className: "keys" }, ...rows),
    make("p", {}, "A click on a number in the code opens its dial. A click on the picture selects the line of the shape."),
    make("p", { className: "quiet" }, `distal ${version}`),
  );
}
