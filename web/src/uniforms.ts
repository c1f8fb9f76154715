/**
 * Values to uniforms, by the types of GLSL.
 *
 * Input: a program in use and values by the author's names. It knows no parameter and no camera.
 */

import type { UniformEntry, Value } from "./payload";
import type { Linked } from "./program";

export type Given = Readonly<Record<string, Value | undefined>>;

/** What the draws of one frame read: by origin, so that a parameter may be called "time". */
export interface Inputs {
  frame: Given;
  parameter: Given;
  number: Given;
}

/** Sets every uniform of the program in use: the value given, or the default of the scene. */
export function setUniforms(gl: WebGL2RenderingContext, program: Linked, inputs: Inputs): void {
  for (const [entry, place] of program.uniforms) {
    const value = inputs[entry.origin][entry.name] ?? entry.default;
    if (value !== null) setUniform(gl, place, entry, value);
  }
}

function setUniform(
  gl: WebGL2RenderingContext,
  place: WebGLUniformLocation,
  { type }: UniformEntry,
  value: NonNullable<UniformEntry["default"]>,
): void {
  const numbers = [value].flat(2).map(Number);
  const size = type.at(-1) as "2" | "3" | "4";
  if (type.startsWith("mat")) gl[`uniformMatrix${size}fv`](place, false, numbers);
  else if (type === "float") gl.uniform1f(place, numbers[0]!);
  else if (type === "uint") gl.uniform1ui(place, numbers[0]!);
  else if (type === "int" || type === "bool") gl.uniform1i(place, numbers[0]!);
  else if (type.startsWith("vec")) gl[`uniform${size}fv`](place, numbers);
  else if (type.startsWith("uvec")) gl[`uniform${size}uiv`](place, numbers);
  else gl[`uniform${size}iv`](place, numbers);
}
