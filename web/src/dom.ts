/** Elements made by code: texts are always text, never markup. */

type Child = Node | string | null | undefined | false;

/** A new element; properties are set, "aria-..." and other names with a dash become attributes. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Record<string, unknown> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role" || name === "for") {
      element.setAttribute(name, String(value));
    } else {
      (element as unknown as Record<string, unknown>)[name] = value;
    }
  }
  element.append(...children.filter((child): child is Node | string => !!child));
  return element;
}

/** A drawing of strokes on a field of 20 by 20. */
export function icon(path: string): SVGSVGElement {
  const space = "http://www.w3.org/2000/svg";
  const drawing = document.createElementNS(space, "svg");
  const line = document.createElementNS(space, "path");
  line.setAttribute("d", path);
  drawing.setAttribute("viewBox", "0 0 20 20");
  drawing.setAttribute("aria-hidden", "true");
  drawing.append(line);
  return drawing;
}

export const ICONS = {
  play: "M6 4v12l10-6z",
  pause: "M7 4v12M13 4v12",
  reset: "M4.5 10a5.5 5.5 0 1 0 1.8-4.1M6 2.8V6h3.2",
  camera: "M3 7h3l1.5-2h5L14 7h3v9H3zM10 13.5a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5z",
  full: "M4 8V4h4M12 4h4v4M16 12v4h-4M8 16H4v-4",
  views: "M10 4 3 7.5l7 3.5 7-3.5zM3 11l7 3.5 7-3.5",
  panel: "M3 4h14v12H3zM12 4v12M14 7.5h1M14 10h1",
  copy: "M7 7V3h10v10h-4M3 7h10v10H3z",
  help: "M7.5 7.5a2.5 2.5 0 1 1 3.6 2.3c-.8.4-1.1.8-1.1 1.7M10 14.5v.2",
};

/** A button with a drawing; its name is what a screen reader says and a pointer shows. */
export function iconButton(name: string, path: string, act: () => void): HTMLButtonElement {
  const button = make("button", { type: "button", className: "icon", onclick: act }, icon(path));
  rename(button, name);
  return button;
}

export function rename(element: HTMLElement, name: string): void {
  element.title = name;
  element.setAttribute("aria-label", name);
}
