/**
 * The groups of the panel that cut a scene open and measure it, the pointer on the picture, and the
 * ruler over it.
 *
 * Input: a player's elements, its inspection. Output: elements in its shadow root. It decides nothing
 * about pictures.
 */

import { rowOf } from "../controls";
import { make } from "../dom";
import { CUT_AXES } from "../generated/inspect";
import type { Parameter } from "../payload";
import { drawRuler } from "./drawing";
import type { Axis, Inspection, Point } from "./inspection";
import type { Sight } from "./sight";
import style from "./inspect.css";

const NAMES: Record<Axis, string> = { x: "X", y: "Y", z: "Z", view: "View" };
/** A pointer that moves farther while it is down drags. */
const CLICK_PX = 5;
let count = 0;

/** Adds everything to a player's root; returns what draws the ruler anew, after each picture. */
export function inspectorOf(root: ShadowRoot, inspection: Inspection, sight: Sight): () => void {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(style);
  root.adoptedStyleSheets.push(sheet);
  const body = root.querySelector(".body")!;
  const cuts = cutGroup(inspection);
  const measures = measureGroup(inspection);
  body.lastElementChild!.before(cuts.element, measures.element);
  const stage = root.querySelector<HTMLElement>(".stage")!;
  const over = make("canvas", { className: "over", "aria-hidden": true });
  const cross = make("div", { className: "cross", "aria-hidden": true });
  // A sheet on a small screen may hide the panel's own words.
  const hint = make("div", { className: "todo", "aria-hidden": true });
  stage.append(over, cross, hint);
  listen(root, stage, inspection, sight);
  let drawing = false;
  let isOld = false;
  const draw = async () => {
    isOld = true;
    if (drawing) return;
    drawing = true;
    while (isOld) {
      isOld = false;
      const ruler = await inspection.seen();
      const { width, height, clientWidth } = sight.canvas;
      if (over.width !== width) over.width = width;
      if (over.height !== height) over.height = height;
      const context = over.getContext("2d")!;
      context.clearRect(0, 0, width, height);
      if (ruler) drawRuler(context, ruler, sight.frame().offset, width / (clientWidth || 1));
      measures.tell(ruler?.lines ?? []);
    }
    drawing = false;
  };
  inspection.onChange = () => {
    cuts.show();
    measures.show();
    stage.classList.toggle("measures", inspection.isMeasuring);
    hint.textContent = inspection.hint;
    const { size, offset } = sight.frame();
    const { width, height } = sight.canvas;
    cross.style.left = `${(100 * (offset[0] + size[0] / 2)) / width}%`;
    cross.style.bottom = `${(100 * (offset[1] + size[1] / 2)) / height}%`;
    void draw();
  };
  inspection.onChange();
  return () => {
    if (inspection.ends.length) void draw();
  };
}

function group(title: string, ...children: (Node | string)[]): HTMLElement {
  const heading = make("h3", {}, title);
  return make("div", { className: "group", role: "group", "aria-label": title }, heading, ...children);
}

function cutGroup(inspection: Inspection): { element: HTMLElement; show(): void } {
  const { why, unit } = inspection.facts;
  if (why) {
    const hint = make("p", { className: "hint" }, `${why[0]!.toUpperCase()}${why.slice(1)}.`);
    return { element: group("Cut open", hint), show() {} };
  }
  const choices = [null, ...CUT_AXES].map((axis) => {
    const name = axis ? NAMES[axis] : "Off";
    const act = () => void inspection.cut(axis);
    const button = make("button", { type: "button", className: "text", onclick: act }, name);
    if (axis === "view") button.title = "Across the line of sight, as the camera stands now";
    return { axis, button };
  });
  const buttons = choices.map(({ button }) => button);
  const bar = make("div", { className: "choices", role: "group", "aria-label": "Cut along" }, ...buttons);
  const rows = make("div");
  let shownAxis = "";
  let show = () => {};
  const fill = () => {
    const { plane } = inspection;
    if (!plane) return rows.replaceChildren();
    const { low, high, axis } = plane;
    const label = `Place${axis === "view" ? "" : ` along ${axis}`} (${unit})`;
    const place = rowOf(slider(label, low, high), (value) => {
      inspection.move({ share: ((value as number) - low) / (high - low || 1) });
    });
    const side = rowOf(toggle("Other side"), (value) => inspection.move({ isFlipped: !!value }));
    rows.replaceChildren(place.element, side.element);
    show = () => {
      place.show(low + plane.share * (high - low));
      side.show(plane.isFlipped);
    };
  };
  return {
    element: group("Cut open", bar, rows),
    show() {
      const { plane } = inspection;
      for (const { axis, button } of choices) {
        button.setAttribute("aria-pressed", String(axis === (plane?.axis ?? null)));
      }
      // The row of a slider knows its ends: others need another row.
      const key = plane ? `${plane.axis} ${plane.low} ${plane.high}` : "";
      if (key !== shownAxis) fill();
      shownAxis = key;
      if (plane) show();
    },
  };
}

function slider(label: string, low: number, high: number): Parameter {
  return { ...toggle(label), kind: "slider", default: (low + high) / 2, low, high };
}

function toggle(label: string): Parameter {
  const kind = "toggle" as const;
  const none = { low: null, high: null, step: null, log: false, group: "", help: "", options: [] };
  return { ...none, name: `inspect${++count}`, label, kind, default: false };
}

interface MeasureGroup {
  element: HTMLElement;
  show(): void;
  /** Shows the lines of a label. */
  tell(lines: string[]): void;
}

function measureGroup(inspection: Inspection): MeasureGroup {
  const act = () => inspection.measure();
  const text = "Measure a distance";
  const title = "D; Enter chooses the middle of the picture, Esc removes the ruler";
  const button = make("button", { type: "button", className: "text", onclick: act, title }, text);
  const again = make("button", { type: "button", className: "text" }, "Start anew");
  again.onclick = () => inspection.measure(true);
  const status = make("div", { className: "hint", role: "status" });
  let said = "";
  const say = (lines: string[]) => {
    const text = lines.join("\n");
    if (text === said) return;
    said = text;
    status.replaceChildren(...lines.map((line) => make("p", {}, line)));
  };
  return {
    element: group("Measure", make("div", { className: "choices" }, button, again), status),
    show() {
      const { isMeasuring, ends, hint } = inspection;
      button.setAttribute("aria-pressed", String(isMeasuring));
      again.hidden = !ends.length;
      if (ends.length < 2) say(hint ? [hint] : []);
      else if (hint) say([hint]);
    },
    tell(lines) {
      if (lines.length && !inspection.hint) say(lines);
    },
  };
}

/** Clicks, taps and Enter choose places while one measures; Esc removes the ruler. */
function listen(root: ShadowRoot, stage: HTMLElement, inspection: Inspection, sight: Sight): void {
  let start: Point | null = null;
  const down = new Set<number>();
  const isOurs = (event: Event) => inspection.isMeasuring && event.target === sight.canvas;
  stage.addEventListener("pointerdown", (event) => {
    down.add(event.pointerId);
    const isClick = isOurs(event) && down.size === 1 && event.button === 0 && !event.shiftKey;
    start = isClick ? [event.clientX, event.clientY] : null;
  });
  // Before the canvas, whose camera stays while a place is chosen.
  stage.addEventListener(
    "pointermove",
    (event) => {
      if (!start) return;
      if (Math.hypot(event.clientX - start[0], event.clientY - start[1]) > CLICK_PX) start = null;
      else event.stopPropagation();
    },
    true,
  );
  stage.addEventListener("pointerup", (event) => {
    down.delete(event.pointerId);
    if (!start) return;
    const box = sight.canvas.getBoundingClientRect();
    const { width, height } = sight.canvas;
    const x = ((event.clientX - box.left) / box.width) * width;
    const y = ((box.bottom - event.clientY) / box.height) * height;
    const { offset } = sight.frame();
    start = null;
    void inspection.choose([x - offset[0], y - offset[1]]);
  });
  stage.addEventListener("pointercancel", (event) => {
    down.delete(event.pointerId);
    start = null;
  });
  // Two clicks choose two places: they do not reset the camera.
  stage.addEventListener("dblclick", (event) => isOurs(event) && event.stopPropagation(), true);
  stage.addEventListener("keydown", (event) => {
    if (!isOurs(event) || event.key !== "Enter") return;
    const { size } = sight.frame();
    void inspection.choose([size[0] / 2, size[1] / 2]);
    event.preventDefault();
  });
  document.addEventListener("keydown", (event) => {
    const isHere = event.target === document.body || event.target === root.host;
    if (event.key === "Escape" && inspection.isMeasuring && isHere && !root.querySelector("dialog")) {
      inspection.measure(false);
    }
  });
}
