/**
 * The part of a page that saves what it shows for printing: a group of the panel with two buttons.
 *
 * Input: players whose payload has the programs of a mesh. Output: elements in their panels, and files.
 */

import type { Payload } from "../payload";
import type { Player } from "../player";
import { archived, modelOf, stlOf } from "./files";
import { drop, floatContext, makes, type Made, type Printing } from "./making";
import { sliced } from "./slices";

const CELLS = [64, 128, 256];
const FORMATS = ["3mf", "stl"] as const;

for (const host of document.querySelectorAll("[data-distal]")) {
  const player = (host as { distal?: Player }).distal;
  const payload = player?.payload as (Payload & { printing?: Printing }) | undefined;
  const body = host.shadowRoot?.querySelector(".body");
  if (player && payload?.printing && body) body.lastElementChild!.before(groupOf(player, payload.printing));
}

function groupOf(player: Player, printing: Printing): HTMLElement {
  const { bytesOf, make, save } = (player.constructor as typeof Player).kit;
  const group = make("div", { className: "group", role: "group", "aria-label": "Print" }, make("h3", {}, "Print"));
  const status = make("p", { className: "hint", role: "status" });
  const gl = floatContext();
  if (gl) drop(gl);
  else {
    status.textContent =
      "This browser cannot save the part: its graphics draw no floats (EXT_color_buffer_float).";
    group.append(status);
    return group;
  }
  const items = CELLS.map((count) => make("option", { value: count }, `${count} cells`));
  const detail = make("select", { id: "print" }, ...items);
  detail.value = "128";
  const bar = make("progress", { "aria-label": "Making the part" });
  let stop = new AbortController();
  let made: Promise<Made> | undefined;
  let key = "";
  const button = (text: string, onclick: () => unknown) =>
    make("button", { type: "button", className: "text", onclick }, text);
  const buttons = FORMATS.map((format, i) => button(`Save ${format.toUpperCase()}`, () => start(format, i)));
  const cancel = button("Cancel", () => stop.abort());
  const acts = make("div", {}, ...buttons, bar, cancel);
  acts.style.cssText = "display:flex;gap:6px;align-items:center;padding:4px 0";
  bar.style.flex = "1";
  const label = make("label", { className: "label", for: "print" }, "Detail");
  group.append(make("div", { className: "row choice" }, label, detail), acts, status);
  const show = (text: string, isBusy = false) => {
    for (const each of buttons) each.hidden = isBusy;
    detail.disabled = isBusy;
    bar.hidden = cancel.hidden = !isBusy;
    status.textContent = text;
  };
  show("");
  const forget = () => void (detail.disabled || show(""));
  player.on("parameter", forget);
  detail.onchange = forget;

  async function start(format: (typeof FORMATS)[number], at: number): Promise<void> {
    stop = new AbortController();
    const { signal } = stop;
    bar.value = 0;
    show("Making the part …", true);
    cancel.focus();
    try {
      const now = JSON.stringify([player.parameters(), player.time, detail.value]);
      if (key !== now) made = undefined;
      key = now;
      made ??= makes(player, printing, +detail.value, signal, (share) => (bar.value = share));
      const part = await made;
      const { frame } = printing;
      const file =
        format === "stl"
          ? await sliced(stlOf(part, frame), signal)
          : await archived(await sliced(modelOf(part, frame), signal), frame, bytesOf);
      save(file, player.payload.name, format);
      show(wordsOf(part, +detail.value));
    } catch (error) {
      made = undefined;
      show(signal.aborted ? "Cancelled" : (error as Error).message || "The graphics driver stopped.");
    }
    buttons[at]!.focus();
    player.redraw();
  }
  return group;
}

function wordsOf({ triangles, sides, error, tolerance, isThin }: Made, detail: number): string {
  const size = sides.map((side) => +side.toPrecision(4)).join(" × ");
  const count = (triangles.length / 4).toLocaleString("en");
  const least = (detail * error) / tolerance;
  const better = CELLS.find((cells) => cells >= least);
  let text = `${count} triangles, ${size} mm, up to ${error.toPrecision(2)} mm from the surface, measured.`;
  if (error > tolerance) {
    text += ` ${better ? `${better} cells` : "distal mesh"} should keep ${tolerance.toPrecision(2)} mm.`;
  }
  return text + (isThin ? " Parts thinner than a cell are missing." : "");
}
