/**
 * Shader texts to a program, without holding up the page.
 *
 * Input: a `Program` of the payload. Output: a linked WebGLProgram with its uniforms' places, or a
 * `ShaderError` with the driver's words and the table that maps them to the author's lines.
 */

import type { FilmUse } from "./paths";
import type { LineRange, Program, UniformEntry } from "./payload";
import { nextFrame, pause } from "./waiting";

export interface Linked {
  source: Program;
  handle: WebGLProgram;
  uniforms: [UniformEntry, WebGLUniformLocation][];
  /** Of a program of a film: what it reads and draws. */
  film?: FilmUse;
}

export class ShaderError extends Error {
  constructor(
    readonly log: string,
    readonly lines: LineRange[],
  ) {
    super("The graphics driver refused the scene's shader.");
  }
}

/** The context went away meanwhile; its return starts all over. */
export class LostError extends Error {}

/** Compiles and links; resolves when the driver is done with it. */
export async function link(gl: WebGL2RenderingContext, source: Program): Promise<Linked> {
  const parallel = gl.getExtension("KHR_parallel_shader_compile");
  const handle = gl.createProgram()!;
  const shaders = [
    [gl.VERTEX_SHADER, source.vertex, source.vertex_lines] as const,
    [gl.FRAGMENT_SHADER, source.fragment, source.lines] as const,
  ].map(([type, text, lines]) => {
    const shader = gl.createShader(type);
    if (!shader) throw new LostError();
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(handle, shader);
    return { shader, lines };
  });
  gl.linkProgram(handle);
  if (parallel) {
    while (!gl.getProgramParameter(handle, parallel.COMPLETION_STATUS_KHR)) {
      if (gl.isContextLost()) throw new LostError();
      await pause(4);
    }
  } else {
    // The question below blocks: let the page first show what it waits for.
    await nextFrame();
    await pause(0);
  }
  const linked = gl.getProgramParameter(handle, gl.LINK_STATUS) as boolean;
  if (gl.isContextLost()) throw new LostError();
  if (!linked) {
    const bad = shaders.find(({ shader }) => !gl.getShaderParameter(shader, gl.COMPILE_STATUS));
    const log = bad ? gl.getShaderInfoLog(bad.shader) : gl.getProgramInfoLog(handle);
    gl.deleteProgram(handle);
    throw new ShaderError(log ?? "", bad?.lines ?? source.lines);
  }
  for (const { shader } of shaders) gl.deleteShader(shader);
  const places = source.uniforms.map(
    (entry) => [entry, gl.getUniformLocation(handle, entry.uniform)] as const,
  );
  const used = places.filter((pair): pair is [UniformEntry, WebGLUniformLocation] => !!pair[1]);
  return { source, handle, uniforms: used };
}
