/**
 * Caustics of pictures by paths: before each pass, photons are traced on the GPU, sorted here, and
 * handed to the program of the paths as textures.
 *
 * Input: the programs of a scene's photons, the inputs of a pass. Output: numbers and tables for the
 * pass. How photons fly, and how the radius shrinks, is scene code (`distal.render.photons`).
 */

import { drawBands } from "./bands";
import type { Painter } from "./painter";
import type { PhotonPrograms } from "./payload";
import { photonTable, type PhotonTable } from "./photon_table";
import type { Linked } from "./program";
import { Resolution } from "./resolution";
import { BUFFER_WIDTH } from "./resources";
import { dropSheet, floatsOf, nearest, newSheet, type Sheet } from "./sheets";
import type { Given, Inputs } from "./uniforms";

/** What a program reads in place of the payload's resource: a texture; of a buffer, its elements. */
export type Read = [texture: WebGLTexture, count?: number];
export type Reads = Record<string, Read>;

/** Wide enough for bands of columns. */
const WIDTH = 256;

export class Photons {
  #plan!: Linked;
  #deposits!: Linked;
  #resolution = new Resolution();
  #planned: Sheet | null = null;
  #sheet: Sheet | null = null;
  #textures: WebGLTexture[] = [];

  constructor(
    readonly painter: Painter,
    readonly source: PhotonPrograms,
  ) {}

  async prepare(): Promise<void> {
    this.#plan = await this.painter.program(this.source.plan);
    this.#deposits = await this.painter.program(this.source.deposits);
  }

  /** The photons of a pass of so many pixels; null where it was broken off. */
  async of(
    inputs: Inputs,
    first: number,
    pixels: number,
    floor: number,
    isStale: () => boolean,
  ): Promise<{ numbers: Given; reads: Reads } | null> {
    const { gl } = this.painter;
    const { of_sample, fewest, most } = this.source;
    const { resolution, index } = inputs.frame;
    const number: Inputs["number"] = {
      ...inputs.number,
      First_sample: first,
      Frame_offset: [0, 0],
      Picture_size: resolution,
      Photons_index: index,
    };
    const plan = await this.#planOf({ ...inputs, number });
    if (!plan || isStale()) return null;
    const [low, high, radius] = plan;
    const wanted = Math.min(Math.max(of_sample * pixels, fewest), most);
    const height = Math.ceil(wanted / WIDTH);
    const count = WIDTH * height;
    const slots = 2 ** Math.floor(Math.log2(count));
    const numbers: Given = {
      Photons_low: low,
      Photons_high: high,
      Photons_radius: radius,
      Photons_slots: slots,
      Photons_maps: 1,
      Photons_share: 1 / count,
    };
    let texels: Float32Array[] | null = [0, 1, 2].map(() => new Float32Array(0));
    if (low.every((side, i) => side < high[i]!)) {
      if (this.#sheet?.height !== height) {
        if (this.#sheet) dropSheet(gl, this.#sheet);
        this.#sheet = newSheet(gl, [WIDTH, height], 3);
      }
      this.#deposits.film = { reads: {}, onto: this.#sheet };
      this.#resolution.floor = floor;
      const frame = { ...inputs.frame, resolution: [WIDTH, height] };
      const given = { ...inputs, frame, number: { ...number, ...numbers } };
      const size: [number, number] = [WIDTH, height];
      const { painter } = this;
      if (!(await drawBands(painter, this.#deposits, given, size, 1, this.#resolution, isStale))) {
        return null;
      }
      texels = await floatsOf(gl, this.#sheet);
      if (!texels || isStale()) return null;
    }
    const [places, arrivals, powers] = texels;
    return { numbers, reads: this.#upload(photonTable([places!, arrivals!, powers!], slots)) };
  }

  /** The corners of the target, and the radius. */
  async #planOf(inputs: Inputs): Promise<[number[], number[], number] | null> {
    const { painter } = this;
    this.#planned ??= newSheet(painter.gl, [1, 1], 2);
    this.#plan.film = { reads: {}, onto: this.#planned };
    painter.draw(this.#plan, inputs, [1, 1], 0, 1);
    const texels = await floatsOf(painter.gl, this.#planned);
    if (!texels) return null;
    const [[x, y, z, radius], high] = texels.map((texel) => [...texel]) as [number[], number[]];
    return [[x!, y!, z!], high.slice(0, 3), radius!];
  }

  #upload({ places, arrivals, starts }: PhotonTable): Reads {
    const { gl } = this.painter;
    const all = [
      [places, 4, gl.RGBA32F, gl.RGBA, gl.FLOAT],
      [arrivals, 4, gl.RGBA32F, gl.RGBA, gl.FLOAT],
      [starts, 1, gl.R32I, gl.RED_INTEGER, gl.INT],
    ] as const;
    const read = all.map(([numbers, components, sized, format, type], i): [string, Read] => {
      const count = numbers.length / components;
      const height = Math.ceil(count / BUFFER_WIDTH);
      // The last row is filled up: a texture is a rectangle.
      const kind = numbers.constructor as new (length: number) => typeof numbers;
      const full = new kind(BUFFER_WIDTH * height * components);
      full.set(numbers);
      const texture = (this.#textures[i] ??= gl.createTexture()!);
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      nearest(gl);
      gl.texImage2D(gl.TEXTURE_2D, 0, sized, BUFFER_WIDTH, height, 0, format, type, full);
      return [this.source.tables[i]!, [texture, count]];
    });
    return Object.fromEntries(read);
  }
}
