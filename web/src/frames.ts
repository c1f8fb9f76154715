/**
 * What changes with each frame: the buffers that a picture draws before itself and keeps, its own last
 * picture, the keyboard, the number of the frame.
 *
 * Input: programs and the inputs of a picture. Output: textures and values that the picture reads. A
 * later time is the next frame; an earlier one, or another size, begins again at frame 0. Each buffer is
 * two textures of floats: a program reads one and draws the other. Only the script of pages of such
 * pictures contains this.
 */

import type { Keys } from "./keys";
import { Music } from "./music";
import type { Painter } from "./painter";
import type { FramePass, FrameProgram } from "./payload";
import type { Reads } from "./photons";
import type { Linked } from "./program";
import { dropSheet, newSheet, type Sheet } from "./sheets";
import { SOUND_WIDTH, type Sound } from "./sound";
import type { Inputs } from "./uniforms";

/** Seconds, before there was another frame. */
const FIRST_DELTA = 0.0166666667;

interface Pass {
  name: string;
  program: Linked;
  /** The last frame, and the one that is drawn next. */
  sheets: [Sheet, Sheet];
}

export class Frames {
  #passes: Pass[] = [];
  #itself: Pass | null = null;
  #reads: Reads = {};
  #size: [number, number] = [0, 0];
  #time = 0;
  #index = -1;
  #delta = FIRST_DELTA;
  #isNext = false;
  #keyboard: WebGLTexture;
  #microphone: WebGLTexture;
  #music: [music: Music, texture: WebGLTexture][];
  #images = new Map<string, [picture: ImageBitmap, texture: WebGLTexture]>();

  constructor(
    readonly painter: Painter,
    readonly source: FrameProgram,
    readonly keys: Keys,
    readonly sound: Sound | null,
    /** What a person has put in place of an image, by its name. */
    readonly pictures: Map<string, ImageBitmap>,
  ) {
    this.#keyboard = painter.gl.createTexture()!;
    this.#microphone = painter.gl.createTexture()!;
    this.#music = source.sounds.map((each) => [new Music(each), painter.gl.createTexture()!]);
  }

  /** Compiles; throws where the browser draws no floats, or refuses the programs. */
  async prepare(): Promise<void> {
    const { painter, source } = this;
    const { gl } = painter;
    const { passes, itself } = source;
    if ((passes.length || itself) && !gl.getExtension("EXT_color_buffer_float")) {
      throw new Error("This browser draws no float pictures");
    }
    const made = async ({ name, program }: FramePass): Promise<Pass> => {
      const linked = { ...(await painter.program(program)) };
      return { name, program: linked, sheets: [] as unknown as Pass["sheets"] };
    };
    this.#passes = await Promise.all(passes.map(made));
    this.#itself = itself && (await made(itself));
    for (const [music] of this.#music) await music.prepare();
  }

  /** Draws what comes before a picture, if it is of a new frame. Returns what the picture reads. */
  begin(program: Linked, inputs: Inputs): Inputs {
    const size = inputs.frame["resolution"] as [number, number];
    const time = inputs.frame["time"] as number;
    const isSame = size.every((side, i) => side === this.#size[i]);
    if (!isSame || time < this.#time) this.#reset(size);
    const isNext = (this.#isNext = this.#index < 0 || time > this.#time);
    if (isNext) {
      this.#delta = this.#index < 0 ? FIRST_DELTA : time - this.#time;
      this.#index += 1;
      this.#time = time;
    }
    const frame = { ...inputs.frame, ...this.#values() };
    this.#show(time);
    if (isNext && this.sound?.isWanted) for (const [music] of this.#music) music.follow(time);
    if (isNext) this.#draw({ ...inputs, frame, number: { ...inputs.number, Frame_offset: [0, 0] } });
    program.film = { reads: this.#reads };
    return { ...inputs, frame };
  }

  /** The picture is drawn: after that of a new frame, no key is news any more. */
  end(): void {
    if (this.#isNext) this.keys.settle();
  }

  dispose(): void {
    const { gl } = this.painter;
    for (const { sheets } of this.#all()) for (const sheet of sheets) dropSheet(gl, sheet);
    gl.deleteTexture(this.#keyboard);
    gl.deleteTexture(this.#microphone);
    for (const [music, texture] of this.#music) {
      music.dispose();
      gl.deleteTexture(texture);
    }
    for (const [, texture] of this.#images.values()) gl.deleteTexture(texture);
  }

  #all(): Pass[] {
    return this.#itself ? [...this.#passes, this.#itself] : this.#passes;
  }

  #values(): Inputs["frame"] {
    const now = new Date();
    const midnight = new Date(now.getFullYear(), now.getMonth(), now.getDate());
    const seconds = (now.getTime() - midnight.getTime()) / 1000;
    return {
      index: this.#index,
      delta: this.#delta,
      date: [now.getFullYear(), now.getMonth(), now.getDate(), seconds],
      buttons: this.keys.buttons,
    };
  }

  #reset(size: [number, number]): void {
    const { gl } = this.painter;
    for (const pass of this.#all()) {
      for (const sheet of pass.sheets) dropSheet(gl, sheet);
      pass.sheets = [newBuffer(gl, size), newBuffer(gl, size)];
      this.#reads[pass.name] = [pass.sheets[0].textures[0]!];
    }
    this.#size = [...size];
    this.#index = -1;
  }

  /** Each buffer reads what those before it drew in this frame, and the last frame of the others. */
  #draw(inputs: Inputs): void {
    const { painter } = this;
    const size = this.#size;
    // What the picture itself was, as it was drawn aside in the last frame.
    if (this.#itself && this.#index > 0) this.#turn(this.#itself);
    for (const pass of this.#all()) {
      pass.program.film = { reads: this.#reads, onto: pass.sheets[1] };
      painter.draw(pass.program, inputs, size, 0, size[0]);
      if (pass !== this.#itself) this.#turn(pass);
    }
  }

  #turn(pass: Pass): void {
    const [old, fresh] = pass.sheets;
    pass.sheets = [fresh, old];
    this.#reads[pass.name] = [fresh.textures[0]!];
  }

  #show(time: number): void {
    const { keyboard, microphone, images } = this.source;
    if (keyboard !== null) {
      const { WIDTH, HEIGHT, texels } = this.keys;
      this.#bytes(keyboard, this.#keyboard, WIDTH, HEIGHT, texels);
    }
    if (microphone !== null && this.sound) {
      this.sound.listen();
      this.#bytes(microphone, this.#microphone, SOUND_WIDTH, 2, this.sound.texels);
    }
    for (const [music, texture] of this.#music) {
      this.#bytes(music.source.name, texture, SOUND_WIDTH, 2, music.texels(time));
    }
    for (const { name, wrap } of images) this.#showImage(name, wrap);
  }

  #bytes(name: string, texture: WebGLTexture, width: number, height: number, texels: Uint8Array): void {
    const { gl } = this.painter;
    this.#reads[name] = [texture];
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, width, height, 0, gl.RED, gl.UNSIGNED_BYTE, texels);
    sampled(gl, name === this.source.keyboard ? gl.NEAREST : gl.LINEAR, gl.CLAMP_TO_EDGE);
  }

  #showImage(name: string, wrap: string): void {
    const picture = this.pictures.get(name);
    const known = this.#images.get(name);
    if (!picture || picture === known?.[0]) return;
    const { gl } = this.painter;
    const texture = known?.[1] ?? gl.createTexture()!;
    this.#images.set(name, [picture, texture]);
    this.#reads[name] = [texture];
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, picture);
    sampled(gl, gl.LINEAR, wrap === "repeat" ? gl.REPEAT : gl.CLAMP_TO_EDGE);
  }
}

/** How the texture that is bound is read. */
function sampled(gl: WebGL2RenderingContext, filter: number, wrap: number): void {
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, name, filter);
  }
  for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) {
    gl.texParameteri(gl.TEXTURE_2D, axis, wrap);
  }
}

function newBuffer(gl: WebGL2RenderingContext, size: [number, number]): Sheet {
  const sheet = newSheet(gl, size);
  gl.bindTexture(gl.TEXTURE_2D, sheet.textures[0]!);
  // Where floats cannot be filtered, the nearest texel is read.
  const filter = gl.getExtension("OES_texture_float_linear") ? gl.LINEAR : gl.NEAREST;
  sampled(gl, filter, gl.CLAMP_TO_EDGE);
  return sheet;
}
