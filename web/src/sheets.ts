/** Textures of 32-bit floats: a sheet of them is drawn at once, and read by programs or by the page. */

import type { Target } from "./painter";
import { gpuDone } from "./waiting";

export interface Sheet extends Target {
  textures: WebGLTexture[];
}

export function newSheet(gl: WebGL2RenderingContext, size: [number, number], count = 1): Sheet {
  const [width, height] = size;
  const frame = gl.createFramebuffer()!;
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.activeTexture(gl.TEXTURE0);
  const places = Array.from({ length: count }, (_, i) => gl.COLOR_ATTACHMENT0 + i);
  const textures = places.map((place) => {
    const texture = gl.createTexture()!;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
    nearest(gl);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, place, gl.TEXTURE_2D, texture, 0);
    return texture;
  });
  gl.drawBuffers(places);
  return { textures, frame, pixels: null, width, height };
}

/** Floats are not filtered everywhere. */
export function nearest(gl: WebGL2RenderingContext): void {
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  }
}

export function dropSheet(gl: WebGL2RenderingContext, { textures, frame }: Sheet): void {
  for (const texture of textures) gl.deleteTexture(texture);
  gl.deleteFramebuffer(frame);
}

/** The floats of each texture, as soon as the GPU has them; null where the context was lost. */
export async function floatsOf(
  gl: WebGL2RenderingContext,
  { textures, frame, width, height }: Sheet,
): Promise<Float32Array[] | null> {
  const length = 4 * width * height;
  const buffer = gl.createBuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
  gl.bufferData(gl.PIXEL_PACK_BUFFER, 4 * length * textures.length, gl.STREAM_READ);
  textures.forEach((_, i) => {
    gl.readBuffer(gl.COLOR_ATTACHMENT0 + i);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, 4 * length * i);
  });
  gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
  const isDone = (await gpuDone(gl)) !== null;
  const all = new Float32Array(length * textures.length);
  if (isDone) {
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, all);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
  }
  gl.deleteBuffer(buffer);
  return isDone ? textures.map((_, i) => all.subarray(i * length, (i + 1) * length)) : null;
}
