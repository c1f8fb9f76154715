/**
 * Triangles in WebGL.
 *
 * Input: corners, the texts of two functions of scene code, how the camera moved. Output: a canvas. All
 * formulas are in the texts; here are attributes, uniforms and a draw.
 */

import type { Steering } from "../camera";
import type { Corners } from "./unpacking";

export interface Texts {
  /** `seen_corner` of `src/distal/mesh/preview_arithmetic.py`, and what it calls. */
  corner: string;
  /** `seen_color`. */
  color: string;
}

const VERTEX = `
in vec3 place;
in vec3 facing;
in vec3 code;
uniform vec3 size;
uniform vec4 turned;
uniform vec2 moved;
out vec3 normal;
out vec3 paint;
void main() {
    SeenCorner seen = seen_corner(place, facing, size, turned.x, turned.y, turned.z, moved, turned.w);
    gl_Position = seen.place;
    normal = seen.normal;
    paint = code;
}
`;
const FRAGMENT = `
in vec3 normal;
in vec3 paint;
out vec4 pixel;
void main() { pixel = seen_color(normal, paint); }
`;

export class Drawing {
  #gl: WebGL2RenderingContext;
  #uniform: (name: string) => WebGLUniformLocation | null;
  #count: number;

  /** Throws where a driver refuses the program. */
  constructor(gl: WebGL2RenderingContext, corners: Corners, texts: Texts, size: readonly number[]) {
    this.#gl = gl;
    const program = linked(gl, texts.corner + VERTEX, texts.color + FRAGMENT);
    this.#uniform = (name) => gl.getUniformLocation(program, name);
    gl.useProgram(program);
    gl.bindVertexArray(gl.createVertexArray());
    gl.enable(gl.DEPTH_TEST);
    gl.uniform3f(this.#uniform("size"), size[0]!, size[1]!, size[2]!);
    // Each row has as many bytes as its attribute and one number more: WebGL likes multiples of four.
    const bind = (name: string, columns: ArrayLike<number>[], rows: Uint16Array | Int8Array | Uint8Array, type: number) => {
      columns.forEach((column, axis) => {
        for (let row = 0; row < column.length; row++) rows[4 * row + axis] = column[row]!;
      });
      const place = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, rows, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, type, true, 4 * rows.BYTES_PER_ELEMENT, 0);
    };
    const { places, normals, codes, triangles } = corners;
    const numbers = 4 * places[0]!.length;
    bind("place", places, new Uint16Array(numbers), gl.UNSIGNED_SHORT);
    bind("facing", normals, new Int8Array(numbers), gl.BYTE);
    bind("code", codes, new Uint8Array(numbers), gl.UNSIGNED_BYTE);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    this.#count = triangles.length;
  }

  draw({ yaw, pitch, zoom, pan }: Steering): void {
    const gl = this.#gl;
    const { width, height } = gl.canvas;
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniform4f(this.#uniform("turned"), yaw, pitch, zoom, width / height);
    gl.uniform2f(this.#uniform("moved"), pan[0], pan[1]);
    gl.drawElements(gl.TRIANGLES, this.#count, gl.UNSIGNED_INT, 0);
  }
}

function linked(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const program = gl.createProgram();
  const stages = [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].map((stage, i) => {
    const shader = gl.createShader(stage)!;
    gl.shaderSource(shader, i ? fragment : vertex);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    return shader;
  });
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    const logs = [gl.getProgramInfoLog(program), ...stages.map((shader) => gl.getShaderInfoLog(shader))];
    throw new Error(logs.join("\n"));
  }
  return program;
}
