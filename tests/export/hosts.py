"""Places that shaders are written for, as far as a text can tell: what they put around it.

Input: a text as it was exported, and what its place would be told by a person. What flows
out: the picture, 8 bits, top row first, drawn by WebGL in a real browser. Nothing is read from the
compiler's interface: a host knows the text alone.

Sources: shadertoy.com's Image tab; glslCanvas, which compiles the text as it stands; the ISF
documentation (docs.isf.video: "ISF JSON Reference", "Automatically Generated Variables") and its
JavaScript host, which replaces IMG_NORM_PIXEL up to the next closing bracket.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.browser import kept_page

Texels = NDArray[np.uint8]

_DRAW = """
(told) => {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = told.size;
  const gl = canvas.getContext(told.context, {alpha: true, premultipliedAlpha: false});
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, told.vertex], [gl.FRAGMENT_SHADER, told.text]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
      throw new Error("refused: " + gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, "position");
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error("refused: " + gl.getProgramInfoLog(program));
  gl.useProgram(program);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  const corners = new Float32Array([-1, -1, 1, -1, -1, 1, -1, 1, 1, -1, 1, 1]);
  gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  for (const [name, [setter, ...numbers]] of Object.entries(told.uniforms))
    gl[`uniform${setter}`](gl.getUniformLocation(program, name), ...numbers);
  Object.entries(told.textures).forEach(([name, {size, data}], unit) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, ...size, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    const wrap = told.repeat ? gl.REPEAT : gl.CLAMP_TO_EDGE;
    for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
      gl.texParameteri(gl.TEXTURE_2D, axis, wrap);
    gl.uniform1i(gl.getUniformLocation(program, name), unit);
  });
  gl.drawArrays(gl.TRIANGLES, 0, 6);
  const pixels = new Uint8Array(4 * told.size[0] * told.size[1]);
  gl.readPixels(0, 0, ...told.size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const error = gl.getError();
  if (error) throw new Error(`WebGL error ${error}`);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return Array.from(pixels);
}
"""


def shadertoy(
    text: str,
    size: tuple[int, int],
    time: float = 0.0,
    textures: Mapping[str, Texels] | None = None,
) -> Texels:
    """As the Image tab of a new shader shows it."""
    channels = "".join(f"uniform sampler2D iChannel{i};\n" for i in range(4))
    head = f"""#version 300 es
#ifdef GL_ES
precision highp float;
precision highp int;
precision mediump sampler3D;
#endif
#define HW_PERFORMANCE 1
uniform vec3 iResolution;
uniform float iTime, iTimeDelta, iFrameRate, iSampleRate;
uniform float iChannelTime[4];
uniform vec3 iChannelResolution[4];
uniform vec4 iMouse, iDate;
uniform int iFrame;
{channels}void mainImage(out vec4 c, in vec2 f);
void st_assert(bool condition);
out vec4 shadertoy_out_color;
void main() {{
    shadertoy_out_color = vec4(1.0);
    vec4 color = vec4(1e20);
    mainImage(color, gl_FragCoord.xy);
    shadertoy_out_color = vec4(color.xyz, 1.0);
}}
"""
    vertex = (
        "#version 300 es\nin vec2 position;\nvoid main() { gl_Position = vec4(position, 0., 1.); }"
    )
    uniforms = {
        "iResolution": ("3f", *size, 1.0),
        "iTime": ("1f", time),
        "iMouse": ("4f", 0.0, 0.0, 0.0, 0.0),
        "iFrame": ("1i", 0),
    }
    return _drawn("webgl2", vertex, head + text, size, uniforms, textures)


def glsl_canvas(
    text: str,
    size: tuple[int, int],
    time: float = 0.0,
    textures: Mapping[str, Texels] | None = None,
) -> Texels:
    """As a canvas of class glslCanvas shows it; the text is handed to WebGL 1 as it stands."""
    vertex = """
#ifdef GL_ES
precision mediump float;
#endif
attribute vec2 position;
varying vec2 v_texcoord;
void main() { gl_Position = vec4(position, 0.0, 1.0); v_texcoord = 0.5 * position + 0.5; }
"""
    uniforms = {
        "u_resolution": ("2f", *size),
        "u_time": ("1f", time),
        "u_mouse": ("2f", 0.0, 0.0),
    }
    return _drawn("webgl", vertex, text, size, uniforms, textures)


_ISF_TYPES = {"float": "float", "long": "int", "bool": "bool", "color": "vec4", "point2D": "vec2"}
_ISF_SETTERS = {"float": "1f", "long": "1i", "bool": "1i", "color": "4f", "point2D": "2f"}


def isf_header(text: str) -> dict[str, Any]:
    """The JSON of the comment that an ISF file begins with."""
    found = re.match(r"/\*(.*?)\*/", text, re.DOTALL)
    assert found is not None
    told: dict[str, Any] = json.loads(found[1])
    return told


def isf(
    text: str,
    size: tuple[int, int],
    time: float = 0.0,
    values: Mapping[str, Any] | None = None,
    textures: Mapping[str, Texels] | None = None,
) -> Texels:
    """As an ISF host shows it: inputs have their defaults, but for ``values``."""
    told = isf_header(text)
    inputs = {one["NAME"]: one for one in told["INPUTS"]}
    assert set(values or {}) <= set(inputs)
    assert set(textures or {}) == set(told.get("IMPORTED", {}))
    declared = [f"uniform {_ISF_TYPES[one['TYPE']]} {name};" for name, one in inputs.items()]
    declared += [f"uniform sampler2D {name};" for name in told.get("IMPORTED", {})]
    shared = "uniform int PASSINDEX;\nuniform vec2 RENDERSIZE;\nvarying vec2 isf_FragNormCoord;\n"
    head = (
        f"precision highp float;\nprecision highp int;\n{shared}"
        "uniform float TIME, TIMEDELTA;\nuniform int FRAMEINDEX;\nuniform vec4 DATE;\n"
    )
    main = text[text.index("*/") + 2 :]
    main = re.sub(r"IMG_NORM_PIXEL\((.+?),(.+?)\)", r"texture2D(\1,\2)", main)
    uniforms: dict[str, Any] = {"RENDERSIZE": ("2f", *size), "TIME": ("1f", time)}
    for name, one in inputs.items():
        value = (values or {}).get(name, one["DEFAULT"])
        uniforms[name] = (_ISF_SETTERS[one["TYPE"]], *np.atleast_1d(value).tolist())
    vertex = (
        f"precision highp float;\nprecision highp int;\nattribute vec2 position;\n{shared}"
        "void main() { gl_Position = vec4(position, 0.0, 1.0);"
        " isf_FragNormCoord = 0.5 * position + 0.5; }"
    )
    whole = "\n".join((head, *declared, main))
    return _drawn("webgl", vertex, whole, size, uniforms, textures, repeat=False)


def _drawn(
    context: str,
    vertex: str,
    text: str,
    size: tuple[int, int],
    uniforms: Mapping[str, Any],
    textures: Mapping[str, Texels] | None,
    *,
    repeat: bool = True,
) -> Texels:
    """Textures are (height, width, 4), bottom row first."""
    sent = {
        name: {
            "size": [texels.shape[1], texels.shape[0]],
            "data": base64.b64encode(texels.tobytes()).decode(),
        }
        for name, texels in (textures or {}).items()
    }
    told = {"context": context, "vertex": vertex, "text": text, "size": size}
    with kept_page() as kept:
        pixels = kept.page.evaluate(
            _DRAW, {**told, "uniforms": dict(uniforms), "textures": sent, "repeat": repeat}
        )
    return np.array(pixels, np.uint8).reshape(size[1], size[0], 4)[::-1].copy()
