/**
 * The outline of what a line makes, over the picture.
 *
 * Input: the worker's program that draws which shape each pixel shows, a player, a line. Output: a
 * canvas with the edges. It is drawn again where the picture moves while it is seen.
 */

import { make } from "../dom";
import type { ShapeMap } from "../generated/messages";
import type { Player } from "../player";

/** The longer side of the drawing, at most. */
const PIXELS = 560;
/** After the picture has moved, so long until the outline follows. */
const FOLLOW_MS = 60;
const INNER = [255, 255, 255, 255] as const;
const OUTER = [20, 60, 160, 230] as const;

/** A line of a file. */
export interface Place {
  file: string;
  line: number;
}

export class Outline {
  readonly element = make("canvas", { className: "outline", hidden: true });
  #place: Place | null = null;
  /** Of what is outlined. */
  #moment = "";
  #turn = 0;
  #timer = 0;

  constructor(
    /** The map of the text as it is; null where there is none. */
    readonly map: () => Promise<ShapeMap | null>,
  ) {
    this.element.setAttribute("aria-hidden", "true");
  }

  /** Outlines what a line makes; null for nothing. */
  show(player: Player | null, place: Place | null): void {
    this.#place = player && place;
    this.#turn += 1;
    clearTimeout(this.#timer);
    if (player && place) void this.#draw(player, place);
    else this.element.hidden = true;
  }

  /** The picture was drawn again; it may have moved. */
  follow(player: Player): void {
    const place = this.#place;
    if (!place || this.element.hidden || momentOf(player) === this.#moment) return;
    this.element.hidden = true;
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.show(player, place), FOLLOW_MS);
  }

  async #draw(player: Player, { file, line }: Place): Promise<void> {
    const turn = this.#turn;
    const map = await this.map();
    if (turn !== this.#turn) return;
    const number = map?.files.indexOf(file) ?? -1;
    const parts = new Set<number>();
    map?.parts.forEach((lines, part) => {
      if (lines.some(([where, from]) => where === number && from === line)) parts.add(part);
    });
    const host = this.element.parentElement!;
    const scale = Math.min(PIXELS / Math.max(host.clientWidth, host.clientHeight, 1), 1);
    const size: [number, number] = [Math.ceil(host.clientWidth * scale), Math.ceil(host.clientHeight * scale)];
    if (!map || !parts.size || !size[0] || !size[1]) return void (this.element.hidden = true);
    this.#moment = momentOf(player);
    const bytes = await player.drawn(map.program, {}, size).catch(() => null);
    if (turn !== this.#turn) return;
    this.element.hidden = !bytes;
    if (!bytes) return;
    if (momentOf(player) !== this.#moment) this.follow(player); // It has moved meanwhile.
    [this.element.width, this.element.height] = size;
    const image = new ImageData(edges(bytes, parts, ...size), ...size);
    this.element.getContext("2d", { willReadFrequently: true })!.putImageData(image, 0, 0);
  }
}

/** What a picture depends on besides its text. */
function momentOf(player: Player): string {
  return JSON.stringify([player.steering(), player.parameters(), player.time]);
}

/** The pixels of an outline, upper row first, of a map whose first row is the lowest. */
export function edges(
  bytes: Uint8Array,
  parts: ReadonlySet<number>,
  width: number,
  height: number,
): Uint8ClampedArray<ArrayBuffer> {
  const inside = new Uint8Array(width * height);
  for (let i = 0; i < inside.length; i++) {
    const [r, g, b, a] = [bytes[4 * i]!, bytes[4 * i + 1]!, bytes[4 * i + 2]!, bytes[4 * i + 3]!];
    inside[i] = a && parts.has(r + 256 * g + 65536 * b) ? 1 : 0;
  }
  const image = new Uint8ClampedArray(4 * width * height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const own = inside[y * width + x]!;
      let isEdge = false;
      for (const [dx, dy] of BESIDE) {
        // What goes on beyond the picture has no edge there.
        const [u, v] = [clamped(x + dx, width), clamped(y + dy, height)];
        if (inside[v * width + u] !== own) isEdge = true;
      }
      if (isEdge) image.set(own ? INNER : OUTER, 4 * ((height - 1 - y) * width + x));
    }
  }
  return image;
}

/** The circle of pixels that makes an edge two pixels wide at each side. */
const BESIDE = [-2, -1, 0, 1, 2]
  .flatMap((dy) => [-2, -1, 0, 1, 2].map((dx) => [dx, dy] as const))
  .filter(([dx, dy]) => dx * dx + dy * dy === 4 || dx * dx + dy * dy === 2);

function clamped(place: number, size: number): number {
  return Math.min(Math.max(place, 0), size - 1);
}
