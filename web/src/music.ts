/**
 * A sound from a file: its texels at each time, which Python made, and the sound itself.
 *
 * Input: a table of bytes (60 rows a second: 512 of the spectrum, 512 of the wave), the file, the time of
 * each frame. Output: texels; what is heard, once a person has touched the picture. It stops when no frame
 * follows. Only the script of pages of pictures that keep frames has this.
 */

import { bytesOf, inflated } from "./payload";
import type { SoundEntry } from "./payload";
import { SILENT_WAVE, SOUND_WIDTH } from "./sound";

const ROW = 2 * SOUND_WIDTH;
const RATE = 60;
/** What a person hears as late. */
const LATE_S = 0.15;
/** Slower pictures than this are silent in between. */
const LONGEST_FRAME_MS = 500;

export class Music {
  #rows = new Uint8Array();
  readonly #silence = new Uint8Array(ROW).fill(SILENT_WAVE, SOUND_WIDTH);
  #context: AudioContext | null = null;
  #sound: AudioBuffer | null = null;
  #node: AudioBufferSourceNode | null = null;
  /** The context's time at which the sound was at its beginning. */
  #began = 0;
  #rest = 0;

  constructor(readonly source: SoundEntry) {}

  async prepare(): Promise<void> {
    this.#rows = new Uint8Array(await inflated(this.source.rows).arrayBuffer());
  }

  texels(time: number): Uint8Array {
    const count = this.#rows.length / ROW;
    const row = Math.floor(time * RATE + 0.5);
    if (row < 0 || (row >= count && !this.source.loop)) return this.#silence;
    const at = (row % count) * ROW;
    return this.#rows.subarray(at, at + ROW);
  }

  /** Whether something is heard now. */
  get isHeard(): boolean {
    return this.#node !== null;
  }

  /** A frame is shown: the sound goes on from its time. */
  follow(time: number): void {
    clearTimeout(this.#rest);
    this.#rest = window.setTimeout(() => this.stop(), LONGEST_FRAME_MS);
    if (!this.#context) {
      void this.#open();
      return;
    }
    const sound = this.#sound;
    if (!sound) return;
    const { loop } = this.source;
    const place = loop ? time % sound.duration : time;
    const heard = this.#context.currentTime - this.#began;
    const gap = Math.abs((loop ? heard % sound.duration : heard) - place);
    if (this.#node && Math.min(gap, loop ? sound.duration - gap : gap) < LATE_S) return;
    this.stop();
    if (place >= sound.duration) return;
    this.#node = new AudioBufferSourceNode(this.#context, { buffer: sound, loop });
    this.#node.connect(this.#context.destination);
    this.#node.start(0, place);
    this.#began = this.#context.currentTime - place;
  }

  async #open(): Promise<void> {
    this.#context = new AudioContext();
    try {
      this.#sound = await this.#context.decodeAudioData(bytesOf(this.source.file).buffer);
    } catch {
      this.#sound = null; // A format that this browser does not play: the picture is as it was.
    }
  }

  stop(): void {
    this.#node?.stop();
    this.#node = null;
  }

  dispose(): void {
    clearTimeout(this.#rest);
    this.stop();
    void this.#context?.close();
  }
}
