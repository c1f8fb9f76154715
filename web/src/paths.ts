/**
 * Pictures by random paths: a film in floats, to which passes add samples, and what is shown of it.
 *
 * Input: the programs of a scene's film, inputs, sizes. Output: the picture in the painter's target. A
 * film is two textures: a pass reads one and draws the other, so that a pass that is broken off
 * changes nothing. Only the script of pages with paths contains this.
 */

import { drawBands } from "./bands";
import type { Painter, Target } from "./painter";
import type { FilmPrograms } from "./payload";
import { Photons, type Reads } from "./photons";
import type { Linked } from "./program";
import { Resolution } from "./resolution";
import { dropSheet, newSheet, type Sheet } from "./sheets";
import type { Given, Inputs } from "./uniforms";

/** A film has enough: its error is 1/128 of that of one sample. */
export const MOST_SAMPLES = 16384;
/** With fewer samples direct light looks better. */
const FEWEST_SHOWN = 4;
/** A pass on a fast GPU should fit a frame. */
const PASS_MS = 12;
const MOST_OF_A_PASS = 16;
/** A film that takes longer for a sample is preceded by a coarse one. */
const LONG_MS = 300;
/** The scale of a coarse film, and how many samples it has. */
const COARSE = 0.25;
const OF_COARSE = 8;
/** Samples a second are those of the last passes. */
const RATE_MS = 2000;

/** What a program reads of a film, and the target that it draws onto; see `Linked`. */
export interface FilmUse {
  reads: Reads;
  onto?: Target;
}

export class Paths {
  /** Of each pixel of the film. */
  samples = 0;
  #trace!: Linked;
  #show!: Linked;
  #isReady = false;
  #film: { revision: number; size: [number, number] } | null = null;
  #sheets: [Sheet, Sheet] | null = null;
  #resolution = new Resolution();
  #photons: Photons | null;
  #isCoarse = true;
  #passes: [at: number, ms: number, samples: number][] = [];

  constructor(
    readonly painter: Painter,
    readonly source: FilmPrograms,
  ) {
    this.#photons = source.photons ? new Photons(painter, source.photons) : null;
  }

  get isReady(): boolean {
    return this.#isReady;
  }

  /** Whether the film of a state is not finished. */
  wants(revision: number): boolean {
    return this.#isReady && !(this.#film?.revision === revision && this.samples >= MOST_SAMPLES);
  }

  /** The scale of the film that a state gets next; the whole one is at `scale`. */
  scale(revision: number, pixels: number, scale: number, hasPoster: boolean): number {
    const { cost } = this.#resolution;
    const isQuick = cost !== null && cost * pixels < LONG_MS;
    const isBegun = this.#film?.revision === revision;
    // A coarse picture does not follow a sharp one.
    if (!isBegun) this.#isCoarse = !isQuick && !hasPoster;
    else if (isQuick || this.samples >= OF_COARSE) this.#isCoarse = false;
    return this.#isCoarse ? COARSE * scale : scale;
  }

  /** Whether the film has enough samples to be shown. */
  get isShown(): boolean {
    return this.samples >= (this.#isCoarse ? OF_COARSE : FEWEST_SHOWN);
  }

  /** Samples a second. */
  get rate(): number {
    const [ms, samples] = this.#passes.reduce(([t, n], [, ms, count]) => [t + ms, n + count], [0, 0]);
    return ms > 0 ? (1000 * samples) / ms : 0;
  }

  /** Compiles; throws where the browser draws no floats, or refuses the programs. */
  async prepare(): Promise<void> {
    const { painter, source } = this;
    if (!painter.gl.getExtension("EXT_color_buffer_float")) {
      throw new Error("This browser draws no float pictures");
    }
    this.#show = await painter.program(source.show);
    this.#trace = await painter.program(source.trace);
    await this.#photons?.prepare();
    this.#isReady = true;
  }

  /** Adds samples to the film of a state; null where it was broken off, else the milliseconds. */
  async add(
    revision: number,
    size: [number, number],
    inputs: Inputs,
    floor: number,
    isStale: () => boolean,
  ): Promise<number | null> {
    const [width, height] = size;
    this.#begin(revision, size);
    const cost = this.#resolution.cost;
    const most = cost === null ? 1 : Math.floor(PASS_MS / (cost * width * height));
    const samples = Math.min(Math.max(most, 1), MOST_OF_A_PASS, MOST_SAMPLES - this.samples);
    this.#resolution.floor = floor;
    const begin = performance.now();
    const [from, onto] = this.#sheets!;
    const photons = await this.#photons?.of(inputs, this.samples, width * height, floor, isStale);
    if (photons === null) return null;
    this.#trace.film = {
      reads: { [this.source.name]: [from.textures[0]!], ...photons?.reads },
      onto,
    };
    inputs = this.#inputs(inputs, samples, photons?.numbers);
    const { painter } = this;
    if (!(await drawBands(painter, this.#trace, inputs, size, samples, this.#resolution, isStale))) {
      return null;
    }
    this.#sheets = [onto, from];
    this.samples += samples;
    const now = performance.now();
    const recent = this.#passes.filter(([at]) => now - at < RATE_MS);
    this.#passes = [...recent, [now, now - begin, samples]];
    return now - begin;
  }

  /** Draws the film's picture, which is then to be presented. */
  show(inputs: Inputs): void {
    const { size } = this.#film!;
    this.#show.film = { reads: { [this.source.name]: [this.#sheets![0].textures[0]!] } };
    this.painter.draw(this.#show, this.#inputs(inputs, 0), size, 0, size[0]);
  }

  #inputs({ frame, parameter, number }: Inputs, samples: number, more: Given = {}): Inputs {
    const own = { Samples: samples, First_sample: this.samples, Film_offset: number["Frame_offset"] };
    return { frame, parameter, number: { ...number, ...own, ...more } };
  }

  #begin(revision: number, size: [number, number]): void {
    const known = this.#film;
    const isSame = known && size.every((side, i) => side === known.size[i]);
    if (isSame && known.revision === revision) return;
    const { gl } = this.painter;
    if (!isSame) {
      for (const sheet of this.#sheets ?? []) dropSheet(gl, sheet);
      this.#sheets = [newSheet(gl, size), newSheet(gl, size)];
    }
    this.#film = { revision, size };
    this.samples = 0;
    this.#passes = [];
  }
}
