/**
 * Runs the passes of a mesh on the GPU: one row for each pixel, numbers of 32 bits in and out.
 *
 * Input: programs of the payload, buffers as arrays. Output: arrays. Pixels are drawn in tiles of some
 * milliseconds on a context of its own, so that neither page nor GPU is held up. It computes nothing.
 */

import type { Player } from "../player";
import type { Linked } from "../program";
import type { Given, Inputs } from "../uniforms";
import { fail } from "./slices";

const WIDTH = 1024;
/** A tile on a fast GPU should fit a frame. */
const TILE_MS = 12;
const MOST_LINES = 256;
const MOST_PICTURES = 3;
/** Each pass counts the same. */
const PASSES = 13;

export type Numbers = ArrayLike<number>;

/** What a payload has of passes. */
export interface Programs {
  /** The numbers of the programs by the names of passes. */
  programs: Record<string, number>;
  /** The buffers of passes by the names that programs have for them. */
  buffers: Record<string, string>;
}

/** Runs a pass for so many rows. Returns four numbers a row for each picture that it draws. */
export type Run = (
  name: string,
  count: number,
  given?: Record<string, Numbers>,
  pictures?: number,
) => Promise<Float32Array[]>;

/**
 * What runs passes with the values that a player has now.
 *
 * `numbers` are what all passes read, at the time they run; `tell` hears the share that is done.
 */
export async function runner(
  gl: WebGL2RenderingContext,
  player: Player,
  printing: Programs,
  numbers: Given,
  signal: AbortSignal,
  tell: (share: number) => void,
): Promise<Run> {
  const { kit } = player.constructor as typeof Player;
  const sources = { ...player.payload.resources };
  const resources = new kit.Resources(gl, sources);
  const parameter = player.parameters();
  const { time } = player;
  const programs = await kit.programsOf(player.payload);
  const known = new Map<Numbers, [number, WebGLTexture]>();
  const linked: Record<string, Linked> = {};
  const places = Array.from({ length: MOST_PICTURES }, (_, i) => gl.COLOR_ATTACHMENT0 + i);
  let done = 0;
  gl.bindBuffer(gl.PIXEL_PACK_BUFFER, gl.createBuffer());
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  for (const place of places) {
    const target = kit.newTexture(gl, gl.TEXTURE_2D, gl.NEAREST, gl.CLAMP_TO_EDGE);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, WIDTH, MOST_LINES);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, place, gl.TEXTURE_2D, target, 0);
  }
  return async (name, count, given = {}, pictures = 1) => {
    const before = done++;
    const height = Math.ceil(count / WIDTH);
    const all = Array.from({ length: pictures }, () => new Float32Array(4 * WIDTH * height));
    if (!count) return all;
    const program = (linked[name] ??= await kit.link(gl, programs[printing.programs[name]!]!));
    for (const [name, key] of Object.entries(printing.buffers)) {
      const numbers = given[key];
      if (!numbers) continue;
      const source = sources[name]!;
      if (!known.has(numbers)) known.set(numbers, kit.uploadBuffer(gl, source, numbers));
      resources.textures.set(`${name} `, known.get(numbers)!);
      sources[name] = { ...source, size: [numbers.length / source.components] };
    }
    const used = places.slice(0, pictures);
    gl.useProgram(program.handle);
    resources.bind(program);
    gl.drawBuffers(used);
    for (let line = 0, lines = 1; line < height; ) {
      const now = Math.min(lines, height - line);
      const frame = { resolution: [WIDTH, height], time };
      const number = { ...numbers, Frame_offset: [0, -line] };
      kit.setUniforms(gl, program, { frame, parameter, number } as Inputs);
      gl.viewport(0, 0, WIDTH, now);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      const length = 4 * WIDTH * now;
      gl.bufferData(gl.PIXEL_PACK_BUFFER, 4 * length * pictures, gl.STREAM_READ);
      used.forEach((place, i) => {
        gl.readBuffer(place);
        gl.readPixels(0, 0, WIDTH, now, gl.RGBA, gl.FLOAT, 4 * length * i);
      });
      const ms = await kit.gpuDone(gl);
      signal.throwIfAborted();
      // As the player, which gives no reason.
      if (ms === null) fail("");
      all.forEach((numbers, i) =>
        gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 4 * length * i, numbers, 4 * WIDTH * line, length),
      );
      line += now;
      lines = Math.ceil(Math.min((now * TILE_MS) / ms, 2 * now, MOST_LINES));
      tell((before + line / height) / PASSES);
    }
    return all.map((numbers) => numbers.subarray(0, 4 * count));
  };
}
