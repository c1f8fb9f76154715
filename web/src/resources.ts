/**
 * Textures and buffers of a scene on the GPU.
 *
 * Input: the payload's resources (base64) and what a program reads. Output: texture units that are bound
 * before each draw. A buffer is a texture of one texel an element, row by row.
 */

import { numbersIn, type BufferEntry, type Format, type Resource, type TextureEntry } from "./payload";
import type { Linked } from "./program";

type GL = WebGL2RenderingContext;
type Numbers = Uint8Array | Uint16Array | Float32Array | Int32Array | Uint32Array;

export const BUFFER_WIDTH = 1024;
const ARRAYS = {
  rgba8: Uint8Array,
  float16: Uint16Array,
  float32: Float32Array,
  int32: Int32Array,
  uint32: Uint32Array,
};

export class Resources {
  readonly textures = new Map<string, [target: number, texture: WebGLTexture]>();

  constructor(
    readonly gl: GL,
    readonly sources: Record<string, Resource>,
  ) {}

  /** Binds what a program in use reads; uploads what is read for the first time. */
  bind(program: Linked): void {
    const { gl } = this;
    const { textures, buffers } = program.source;
    [...textures, ...buffers].forEach((entry, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      const read = (PATHS || FRAMES) && program.film?.reads[entry.name];
      const [target, texture] = read
        ? ([gl.TEXTURE_2D, read[0]] as const)
        : this.#texture(entry);
      gl.bindTexture(target, texture);
      gl.uniform1i(gl.getUniformLocation(program.handle, entry.uniform), unit);
      if ("count" in entry) {
        const count = (read && read[1]) || (this.sources[entry.name]?.size[0] ?? 0);
        gl.uniform1i(gl.getUniformLocation(program.handle, entry.count), count);
      }
    });
  }

  #texture(entry: TextureEntry | BufferEntry): [number, WebGLTexture] {
    // The same pixels may be read with two wraps: they are two textures.
    const key = `${entry.name} ${"wrap" in entry ? entry.wrap : ""}`;
    const known = this.textures.get(key);
    if (known) return known;
    const source = this.sources[entry.name];
    if (!source) throw new Error(`The page has no data for '${entry.name}'.`);
    const made: [number, WebGLTexture] =
      "count" in entry ? uploadBuffer(this.gl, source) : uploadTexture(this.gl, entry, source);
    this.textures.set(key, made);
    return made;
  }
}

/** How WebGL names the numbers of a texture: the end of a sized format, and the type. */
const STORED = {
  rgba8: ["8", "UNSIGNED_BYTE"],
  float16: ["16F", "HALF_FLOAT"],
  float32: ["32F", "FLOAT"],
  int32: ["32I", "INT"],
  uint32: ["32UI", "UNSIGNED_INT"],
} as const;

/** The sized format, format and type of a texture of so many components. */
function formats(gl: GL, format: Format, components: number): [number, number, number] {
  const channels = "RGBA".slice(0, components) as "R" | "RG" | "RGB" | "RGBA";
  const [end, type] = STORED[format];
  const whole = format.includes("int") ? "_INTEGER" : "";
  return [gl[`${channels}${end}`], gl[`${channels === "R" ? "RED" : channels}${whole}`], gl[type]];
}

function numbersOf(source: Resource): Numbers {
  const { format, grey, components } = source;
  const stored = new ARRAYS[format](numbersIn(source));
  return grey ? new ARRAYS[format](stored.length * components).map((_, i) => stored[(i / components) | 0]!) : stored;
}

export function newTexture(gl: GL, target: number, filter: number, wrap: number): WebGLTexture {
  const texture = gl.createTexture()!;
  gl.bindTexture(target, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
    gl.texParameteri(target, axis, wrap);
  }
  return texture;
}

/** A buffer as a texture; `numbers` are other ones than those of the payload. */
export function uploadBuffer(
  gl: GL,
  source: Resource,
  numbers: ArrayLike<number> = numbersOf(source),
): [number, WebGLTexture] {
  const target = gl.TEXTURE_2D;
  const texture = newTexture(gl, target, gl.NEAREST, gl.CLAMP_TO_EDGE);
  const count = numbers.length / source.components;
  // Textures have 4096 rows and more on all devices, 8192 on most.
  const width = count > 2 ** 22 ? 4096 : BUFFER_WIDTH;
  const height = Math.max(1, Math.ceil(count / width));
  // The last row is filled up: a texture is a rectangle.
  const full = new ARRAYS[source.format](width * height * source.components);
  full.set(numbers);
  const [sized, format, type] = formats(gl, source.format, source.components);
  gl.texImage2D(target, 0, sized, width, height, 0, format, type, full);
  return [target, texture];
}

function uploadTexture(gl: GL, entry: TextureEntry, source: Resource): [number, WebGLTexture] {
  const [width, height, depth] = source.size as [number, number, number?];
  const wrap = entry.wrap === "repeat" ? gl.REPEAT : gl.CLAMP_TO_EDGE;
  const numbers = numbersOf(source);
  let [sized, format, type] = formats(gl, source.format, source.components);
  if (source.format === "float32" && !gl.getExtension("OES_texture_float_linear")) {
    // Half floats are filtered everywhere; the driver rounds to them on the way in.
    [sized] = formats(gl, "float16", source.components);
  }
  if (entry.type === "Texture3D") {
    const texture = newTexture(gl, gl.TEXTURE_3D, gl.LINEAR, wrap);
    gl.texImage3D(gl.TEXTURE_3D, 0, sized, width, height, depth ?? 1, 0, format, type, numbers);
    return [gl.TEXTURE_3D, texture];
  }
  if (entry.type === "TextureCube") {
    const texture = newTexture(gl, gl.TEXTURE_CUBE_MAP, gl.LINEAR, gl.CLAMP_TO_EDGE);
    const face = width * height * source.components;
    for (let side = 0; side < 6; side++) {
      const part = numbers.subarray(side * face, (side + 1) * face);
      const target = gl.TEXTURE_CUBE_MAP_POSITIVE_X + side;
      gl.texImage2D(target, 0, sized, width, height, 0, format, type, part);
    }
    return [gl.TEXTURE_CUBE_MAP, texture];
  }
  const texture = newTexture(gl, gl.TEXTURE_2D, gl.LINEAR, wrap);
  gl.texImage2D(gl.TEXTURE_2D, 0, sized, width, height, 0, format, type, numbers);
  return [gl.TEXTURE_2D, texture];
}
