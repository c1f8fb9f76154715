/**
 * Small pictures of scenes.
 *
 * Input: a player. Output: its picture as the address of data; "" where there is none.
 */

import type { Player } from "../../player";
import { paint } from "../layers";

const WIDTH_PX = 320;
const HEIGHT_PX = 240;
/** Letters of an address, in base64: 20 kB. */
const LONGEST = 27_000;
const QUALITIES = [0.8, 0.6, 0.4, 0.2];

export async function thumbOf(player: Player): Promise<string> {
  const [wide, high] = player.payload.size;
  const scale = Math.min(WIDTH_PX / wide, HEIGHT_PX / high);
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(Math.round(wide * scale), 1);
  canvas.height = Math.max(Math.round(high * scale), 1);
  const { programs, views } = player.payload;
  const number = views.find(({ name }) => name === player.view)?.program ?? -1;
  const program = programs.encoding === "plain" ? programs.data[number] : null;
  // What keeps frames or traces paths has its picture on the canvas only.
  const bytes = program ? await player.drawn(program, {}, [canvas.width, canvas.height]).catch(() => null) : null;
  if (bytes) paint(canvas, bytes);
  else if (!(await copied(player, canvas))) return "";
  for (const kind of ["image/webp", "image/jpeg"]) {
    for (const quality of QUALITIES) {
      // A browser that writes no WebP writes a large PNG instead.
      const address = canvas.toDataURL(kind, quality);
      if (address.length <= LONGEST) return address;
    }
  }
  return "";
}

async function copied(player: Player, canvas: HTMLCanvasElement): Promise<boolean> {
  const blob = await player.screenshot(1);
  if (!blob) return false;
  const image = await createImageBitmap(blob);
  canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
  return true;
}
