/**
 * One WebGL 2 context: draws bands of a picture into a hidden target and shows whole pictures.
 *
 * Input: linked programs, inputs, sizes. Output: the canvas. The hidden target lets a large still grow
 * over several frames while the old picture stays, and lets a picture be smaller or larger than the
 * canvas. It knows no time and no schedule.
 */

import type { Payload, Program } from "./payload";
import { link, type Linked } from "./program";
import { Resources } from "./resources";
import { trusted, trusting } from "./trust";
import { setUniforms, type Inputs } from "./uniforms";
import { gpuDone } from "./waiting";

export interface Target {
  frame: WebGLFramebuffer;
  /** Null where a texture is drawn onto. */
  pixels: WebGLRenderbuffer | null;
  width: number;
  height: number;
}

export class Painter {
  readonly gl: WebGL2RenderingContext;
  #programs = new Map<Program, Promise<Linked>>();
  #resources: Resources;
  #work: Target;
  #shown: Target;
  /** For pictures that are read, not shown: what is being drawn is not touched. */
  #read: Target;
  #largest: number;

  /** Throws where the browser gives no WebGL 2. */
  constructor(
    readonly canvas: HTMLCanvasElement,
    resources: Payload["resources"],
    transparent: boolean,
  ) {
    let why = "";
    const listen = (event: Event) => (why = (event as WebGLContextEvent).statusMessage);
    canvas.addEventListener("webglcontextcreationerror", listen);
    const gl = canvas.getContext("webgl2", {
      alpha: transparent,
      antialias: false,
      depth: false,
      premultipliedAlpha: false,
      powerPreference: "high-performance",
    });
    canvas.removeEventListener("webglcontextcreationerror", listen);
    if (!gl) throw new Error(why);
    this.gl = gl;
    this.#resources = new Resources(gl, resources);
    this.#work = newTarget(gl);
    this.#shown = newTarget(gl);
    this.#read = newTarget(gl);
    this.#largest = Math.min(gl.getParameter(gl.MAX_RENDERBUFFER_SIZE) as number, 8192);
    gl.bindVertexArray(gl.createVertexArray());
    gl.disable(gl.DITHER);
  }

  /** The linked program; each is compiled once, when it is first used. */
  program(source: Program): Promise<Linked> {
    let made = this.#programs.get(source);
    if (!made) {
      made = this.#link(source);
      this.#programs.set(source, made);
      // A call after a failure tries again.
      made.catch(() => this.#programs.delete(source));
    }
    return made;
  }

  /** Forgets all other programs, textures and buffers, for an editor. */
  keep(programs: Program[], resources: Payload["resources"]): void {
    if (!EDITED) return;
    for (const source of this.#programs.keys()) {
      if (!programs.includes(source)) this.forget(source);
    }
    const { sources, textures } = this.#resources;
    if (resources === sources || JSON.stringify(resources) === JSON.stringify(sources)) return;
    for (const [, texture] of textures.values()) this.gl.deleteTexture(texture);
    this.#resources = new Resources(this.gl, resources);
  }

  /** What a program draws that reads nothing, byte by byte, as `pixels`. */
  async bytes(source: Program, width: number, height: number): Promise<Uint8Array | null> {
    const program = await link(this.gl, source);
    return this.pixels(program, {} as Inputs, [width, height]);
  }

  /** What a program draws, byte by byte, as soon as the GPU has it; null where it was lost. */
  pixels(program: Linked, inputs: Inputs, size: [number, number]): Promise<Uint8Array | null> {
    this.aside(program, inputs, size);
    return this.#bytes(...size);
  }

  /** Draws a whole picture that is not shown. */
  aside(program: Linked, inputs: Inputs, size: [number, number]): void {
    const work = this.#work;
    this.#work = this.#read;
    this.draw(program, inputs, size, 0, size[0]);
    this.#work = work;
  }

  /** Forgets a program, for an editor. */
  forget(source: Program): void {
    if (!EDITED) return;
    const made = this.#programs.get(source);
    this.#programs.delete(source);
    void made?.then(({ handle }) => this.gl.deleteProgram(handle), () => {});
  }

  /** The bytes of the target that is bound, as soon as the GPU has them; null where it was lost. */
  async #bytes(width: number, height: number): Promise<Uint8Array | null> {
    const { gl } = this;
    const read = new Uint8Array(4 * width * height);
    // Into a buffer first: to read pixels at once would hold up the page until they are drawn.
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, read.byteLength, gl.STREAM_READ);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    const isDone = (await gpuDone(gl)) !== null;
    if (isDone) {
      gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
      gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, read);
      gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    }
    gl.deleteBuffer(buffer);
    return isDone ? read : null;
  }

  async #link(source: Program): Promise<Linked> {
    const { gl } = this;
    const names = Object.keys(source.trust).length ? await trusted(this) : [];
    return { ...(await link(gl, { ...source, fragment: trusting(source, names) })), source };
  }

  /** The size of a picture at a scale of the canvas, as far as the GPU goes. */
  size(scale: number): [number, number] {
    const { width, height } = this.canvas;
    const most = Math.min(scale, this.#largest / Math.max(width, height));
    return [Math.max(1, Math.round(width * most)), Math.max(1, Math.round(height * most))];
  }

  /** Draws some columns of the next picture, counted from its left edge. */
  draw(program: Linked, inputs: Inputs, size: [number, number], from: number, columns: number): void {
    const { gl } = this;
    const [width, height] = size;
    const target = ((PATHS || FRAMES) && program.film?.onto) || this.#work;
    resize(gl, target, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
    gl.viewport(0, 0, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(from, 0, columns, height);
    gl.useProgram(program.handle);
    this.#resources.bind(program);
    setUniforms(gl, program, inputs);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.disable(gl.SCISSOR_TEST);
  }

  /** The picture that was drawn, as a PNG; the one that is shown stays. */
  async png(isTransparent: boolean): Promise<Blob | null> {
    const { gl } = this;
    const { frame, width, height } = this.#work;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    const bytes = await this.#bytes(width, height);
    if (!bytes) return null;
    const image = new ImageData(width, height);
    const row = 4 * width;
    for (let y = 0; y < height; y++) {
      image.data.set(bytes.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
    }
    if (!isTransparent) for (let i = 3; i < image.data.length; i += 4) image.data[i] = 255;
    const canvas = document.createElement("canvas");
    Object.assign(canvas, { width, height });
    canvas.getContext("2d")!.putImageData(image, 0, 0);
    return new Promise((resolve) => canvas.toBlob(resolve));
  }

  /** The picture that was drawn is the one to show. */
  present(): void {
    [this.#work, this.#shown] = [this.#shown, this.#work];
    this.show();
  }

  /** Copies the last whole picture to the canvas, once more after the canvas changed its size. */
  show(): void {
    const { gl, canvas } = this;
    const { frame, width, height } = this.#shown;
    if (!width) return;
    const exact = width === canvas.width && height === canvas.height;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, frame);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(
      ...([0, 0, width, height, 0, 0, canvas.width, canvas.height] as const),
      gl.COLOR_BUFFER_BIT,
      exact ? gl.NEAREST : gl.LINEAR,
    );
  }

  /** Gives the memory back at once instead of when the browser comes round to it. */
  dispose(): void {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

function newTarget(gl: WebGL2RenderingContext): Target {
  return { frame: gl.createFramebuffer()!, pixels: gl.createRenderbuffer()!, width: 0, height: 0 };
}

function resize(gl: WebGL2RenderingContext, target: Target, width: number, height: number): void {
  if (target.width === width && target.height === height) return;
  Object.assign(target, { width, height });
  gl.bindRenderbuffer(gl.RENDERBUFFER, target.pixels);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
  const { FRAMEBUFFER, COLOR_ATTACHMENT0, RENDERBUFFER } = gl;
  gl.framebufferRenderbuffer(FRAMEBUFFER, COLOR_ATTACHMENT0, RENDERBUFFER, target.pixels);
}
