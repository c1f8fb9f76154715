/**
 * The script of a cell that shows a mesh (`src/distal/notebook/mesh_cell.py`).
 *
 * Input: elements with the data of a mesh behind them. Output: viewers in them, kept as `host.distal`.
 */

import { unpacked, type Packed } from "./unpacking";
import { Viewer, type Shown } from "./viewer";

async function mount(host: HTMLElement, text: string): Promise<void> {
  const content = JSON.parse(text) as Packed & Shown;
  try {
    Object.assign(host, { distal: new Viewer(host, await unpacked(content), content) });
  } catch (error) {
    const note = document.createElement("p");
    note.textContent = (error as Error).message;
    host.prepend(note);
  }
}

for (const script of document.querySelectorAll('script[type="application/distal+json"]')) {
  const host = script.previousElementSibling;
  if (host instanceof HTMLElement && !("distal" in host)) void mount(host, script.textContent ?? "");
}
