/**
 * The script of a page: mounts every payload in the document.
 *
 * As a module it gives `mount`, and `render` for notebooks; there it finds nothing to mount.
 */

import type { Payload } from "./payload";
import { Player, type Options } from "./player";
import { render } from "./widget";

export type { Options, Payload, Player };

/** Shows a scene in an element. The element keeps its player as `host.distal`. */
export function mount(host: HTMLElement, payload: Payload, options: Options = {}): Player {
  if (payload.format !== 1) throw new TypeError(`a payload of format ${payload.format} is too new`);
  const player = new Player(host, payload, options);
  // For measurements of pages: the first picture is finished.
  const end = player.on("frame", () => {
    performance.mark("distal:first-frame");
    end();
  });
  return Object.assign(host, { distal: player }).distal;
}

function mountAll(): void {
  for (const script of document.querySelectorAll('script[type="application/distal+json"]')) {
    const host = script.previousElementSibling;
    if (!(host instanceof HTMLElement) || !host.matches("[data-distal]") || "distal" in host) continue;
    try {
      mount(host, JSON.parse(script.textContent ?? "") as Payload);
    } catch (error) {
      reportError(error); // One that is broken, or for a newer player, is not the others' end.
    }
  }
}

mountAll();

export default { render };
