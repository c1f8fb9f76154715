/**
 * Whether the driver's own sine and the like are good enough to draw with.
 *
 * Input: what draws. Output: the names of those built-ins that a scene's text may use in place of its
 * careful ones, and the text that does. Measured once for a page, beside JavaScript's own.
 */

import type { Painter } from "./painter";
import type { Program } from "./payload";

const NAMES = ["sin", "cos", "asin", "acos"] as const;
/** Arguments that are measured: exact in the shader and here, and all around the turn. */
const COUNT = 256;
/** Angles to 99.6 either way. */
const STEP = 25 / 32;
/**
 * An angle near 100 is itself known to half its last bit, 4e-6, and a driver that folds it in single
 * precision loses as much again. 1e-5 of a scene is a hundredth of a pixel; the 2e-4 that SwiftShader
 * gets wrong moves edges.
 */
const MOST = 1e-5;

// Every driver draws bytes, and not every one floats. A row for each name.
const SOURCE: Program = {
  vertex: `#version 300 es
void main(){gl_Position=vec4(gl_VertexID%2*4-1,gl_VertexID/2*4-1,0,1);}`,
  fragment: `#version 300 es
precision highp float;precision highp int;out vec4 c;
void main(){vec2 p=gl_FragCoord.xy;float y=p.y,i=p.x-${COUNT / 2}.,a=i*${STEP},r=i/${COUNT / 2}.;
uint b=floatBitsToUint(y<1.?sin(a):y<2.?cos(a):y<3.?asin(r):acos(r));
c=vec4(uvec4(b,b>>8,b>>16,b>>24)&255u)/255.;}`,
  uniforms: [],
  textures: [],
  buffers: [],
  trust: {},
  lines: [],
  vertex_lines: [],
};

let known: Promise<readonly string[]> | null = null;

/** The built-ins that are good enough; none where that is not known. */
export function trusted(painter: Painter): Promise<readonly string[]> {
  known ??= painter.bytes(SOURCE, COUNT, NAMES.length).then(good, () => {
    forget();
    return [];
  });
  return known;
}

/** A context that went away may come back on another driver. */
export function forget(): void {
  known = null;
}

/** The fragment text with the driver's own functions in it; its lines keep their numbers. */
export function trusting({ fragment, trust }: Program, names: readonly string[]): string {
  const macros = names.flatMap((name) => trust[name] ?? []);
  if (!macros.length) return fragment;
  const lines = macros.map((macro) => `#define ${macro}\n`).join("");
  return fragment.replace("\n", `\n${lines}#line 2\n`); // Nothing may precede the version.
}

function good(bytes: Uint8Array | null): string[] {
  if (!bytes) return [];
  const values = new Float32Array(bytes.buffer);
  return NAMES.filter((name, row) => {
    for (let i = 0; i < COUNT; i++) {
      const x = (i + 0.5 - COUNT / 2) * (row < 2 ? STEP : 2 / COUNT);
      const exact = Math[name](x);
      const off = Math.abs(values[row * COUNT + i]! - exact);
      if (!(off <= MOST)) return false; // Nor where it is no number.
    }
    return true;
  });
}
