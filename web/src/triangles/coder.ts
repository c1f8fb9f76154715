/**
 * The range decoder of `src/distal/triangles/range_coder.py`.
 *
 * Input: bytes. Output: decisions and numbers, by context. Throws where the bytes end too early.
 */

import { ALWAYS, CONTEXTS, NEVER, NUMBER_CONTEXTS, RATES, UNARY } from "../generated/triangles";

export { NUMBER_CONTEXTS };

export class RangeDecoder {
  #chances = new Uint16Array(CONTEXTS).fill(32768);
  #seen = new Uint8Array(CONTEXTS);
  #bytes: Uint8Array;
  #at: number;
  #range = 0xffffffff;
  #code = 0;

  constructor(bytes: Uint8Array, start: number) {
    this.#bytes = bytes;
    this.#at = start;
    for (let i = 0; i < 4; i++) this.#next();
  }

  bit(context: number): number {
    const chance = this.#chances[context]!;
    const seen = this.#seen[context]!;
    const bound = (this.#range >>> 16) * chance;
    const value = this.#code < bound ? 1 : 0;
    if (value) this.#range = bound;
    else {
      this.#code -= bound;
      this.#range -= bound;
    }
    this.#chances[context] = chance + ((((value ? ALWAYS : NEVER) - chance) * RATES[seen]!) >> 12);
    if (seen < RATES.length - 1) this.#seen[context] = seen + 1;
    while (this.#range < 1 << 24) {
      this.#range *= 256;
      this.#next();
    }
    return value;
  }

  number(context: number): number {
    for (let step = 0; step < UNARY; step++) if (!this.bit(context + step)) return step;
    let bits = 0;
    while (this.bit(context + UNARY)) bits++;
    let found = 1;
    while (bits--) found = 2 * found + this.bit(context + UNARY + 1);
    return found + UNARY - 1;
  }

  signed(context: number, sign: number): number {
    const size = this.number(context);
    return size && this.bit(sign) ? -size : size;
  }

  #next(): void {
    if (this.#at >= this.#bytes.length) throw new Error("The picture's data ends too early.");
    this.#code = ((this.#code << 8) | this.#bytes[this.#at++]!) >>> 0;
  }
}
