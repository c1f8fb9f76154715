/**
 * A picture's triangles in WebGL.
 *
 * Input: rows of `reading.ts`, a size in pixels. Output: a canvas. All formulas are in the texts of scene
 * code (`src/distal/triangles/arithmetic.py`); here are attributes, uniforms and a draw.
 */

import { SEEN_COLOR, SEEN_CORNER } from "../generated/triangles";
import { ROW, type Triangles } from "./reading";

const VERTEX = `
in vec4 ab;
in vec2 c;
in vec3 code_a;
in vec3 code_b;
in vec3 code_c;
in vec2 cut;
uniform vec2 size;
out vec3 outer;
out float away;
flat out vec3 inner;
void main() {
SeenTriangleCorner seen = seen_corner(gl_VertexID, ab, c, code_a, code_b, code_c, cut, size);
gl_Position = seen.place;
outer = seen.outer;
away = seen.away;
inner = code_a;
}
`;
const FRAGMENT = `
in vec3 outer;
in float away;
flat in vec3 inner;
uniform float scale;
out vec4 pixel;
void main() { pixel = seen_color(outer, inner, away, scale); }
`;
const ATTRIBUTES = [
  ["ab", 4],
  ["c", 2],
  ["code_a", 3],
  ["code_b", 3],
  ["code_c", 3],
  ["cut", 2],
] as const;

/** Draws the picture in so many pixels; throws where WebGL 2 is missing or refuses it. */
export function draw(target: HTMLCanvasElement, { width, height, rows }: Triangles, scale: number): void {
  target.width = Math.round(width * scale);
  target.height = Math.round(height * scale);
  const canvas = new OffscreenCanvas(target.width, target.height);
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: false });
  if (!gl) throw new Error("WebGL 2 is missing.");
  const program = gl.createProgram();
  [SEEN_CORNER + VERTEX, SEEN_COLOR + FRAGMENT].forEach((text, i) => {
    const shader = gl.createShader(i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER)!;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  });
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error("WebGL refused the triangles.");
  gl.useProgram(program);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, rows, gl.STATIC_DRAW);
  let start = 0;
  for (const [name, count] of ATTRIBUTES) {
    const place = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * ROW, 4 * start);
    gl.vertexAttribDivisor(place, 1); // Each row is an instance with three corners.
    start += count;
  }
  gl.uniform2f(gl.getUniformLocation(program, "size"), width, height);
  gl.uniform1f(gl.getUniformLocation(program, "scale"), scale);
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.drawArraysInstanced(gl.TRIANGLES, 0, 3, rows.length / ROW);
  target.getContext("2d")!.drawImage(canvas, 0, 0);
  // A page has a limited number of contexts: the picture stays in the other canvas.
  gl.getExtension("WEBGL_lose_context")?.loseContext();
}
