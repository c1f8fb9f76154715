/**
 * The microphone as a texture, as on Shadertoy: 512 columns; the lower row is the spectrum, the upper one
 * the wave.
 *
 * Input: the first gesture of a person, who is then asked for the microphone. Output: texels; silence
 * before that, and where it is refused. Only the script of pages of pictures that keep frames has this.
 */

export const SOUND_WIDTH = 512;
const SAMPLES = 2048;
export const SILENT_WAVE = 128;

export class Sound {
  readonly texels = new Uint8Array(2 * SOUND_WIDTH).fill(SILENT_WAVE, SOUND_WIDTH);
  /** Whether a person has touched the picture: files are heard from then on. */
  isWanted = false;
  #analyser: AnalyserNode | null = null;
  #isAsked = false;
  #stream: MediaStream | null = null;

  /** Browsers give the microphone after a gesture only. */
  async ask(): Promise<void> {
    if (this.#isAsked) return;
    this.#isAsked = true;
    try {
      this.#stream = await navigator.mediaDevices.getUserMedia({ audio: true });
      const context = new AudioContext();
      this.#analyser = context.createAnalyser();
      this.#analyser.fftSize = SAMPLES;
      context.createMediaStreamSource(this.#stream).connect(this.#analyser);
    } catch {
      this.#analyser = null; // Refused, or there is none: silence.
    }
  }

  listen(): void {
    const spectrum = this.texels.subarray(0, SOUND_WIDTH);
    this.#analyser?.getByteFrequencyData(spectrum);
    this.#analyser?.getByteTimeDomainData(this.texels.subarray(SOUND_WIDTH));
  }

  dispose(): void {
    for (const track of this.#stream?.getTracks() ?? []) track.stop();
  }
}
