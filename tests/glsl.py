"""Runs the GLSL of a compiled image through EGL, whatever place it was written for.

In: an ``Artifact`` of a GLSL target, the picture's size, values of uniforms, textures and buffers
by the author's names. Out: the picture in 32-bit floats. What to set is read from the artifact's
interface alone: the runner is also a test of that. ``tests.gpu`` is the same for WGSL.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from distal.backends.base import Artifact
from distal.backends.messages import map_message
from tests import egl
from tests.buffer_data import buffer_data

# What shadertoy.com writes around a text, as far as we use it.
SHADERTOY_HEAD = """#version 300 es
precision highp float;
precision highp int;
uniform vec3 iResolution;
uniform float iTime;
uniform vec4 iMouse;
uniform int iFrame;
"""
SHADERTOY_TAIL = """
out vec4 shadertoy_color;
void main() { mainImage(shadertoy_color, gl_FragCoord.xy); }
"""
SAMPLERS = {"Texture2D": "sampler2D", "TextureCube": "samplerCube", "Texture3D": "sampler3D"}
BUFFER_WIDTH = 7  # no power of two, so that rows are really counted


def complete_text(artifact: Artifact) -> str:
    """The fragment text as its place would hand it to the driver."""
    if artifact.interface["target"] != "shadertoy":
        return artifact.text
    channels = "".join(
        f"uniform highp {SAMPLERS[t['type']]} {t['uniform']};\n"
        for t in artifact.interface["textures"]
    )
    return f"{SHADERTOY_HEAD}{channels}{artifact.text}{SHADERTOY_TAIL}"


def assert_valid(artifact: Artifact) -> None:
    """Khronos' reference compiler takes every stage, without a warning.

    Says nothing where it is not installed; ``test_texts`` skips aloud then.
    """
    validator = shutil.which("glslangValidator")
    if validator is None:
        return
    text = complete_text(artifact)
    if artifact.interface["target"] == "glsl-es100":
        text = f"#version 100\n{text}"
    stages = {"frag": text} if artifact.vertex is None else {"frag": text, "vert": artifact.vertex}
    for stage, source in stages.items():
        words = [validator, "--stdin", "-S", stage]
        done = subprocess.run(words, input=source, capture_output=True, text=True, check=False)
        assert done.returncode == 0, map_message(artifact, done.stdout)
        assert "WARNING" not in done.stdout, done.stdout


def run_glsl(
    artifact: Artifact,
    size: tuple[int, int],
    uniforms: Mapping[str, Any] | None = None,
    textures: Mapping[str, NDArray[np.float32]] | None = None,
    buffers: Mapping[str, NDArray[Any]] | None = None,
) -> NDArray[np.float32]:
    """The picture, float32 of shape (height, width, 4), top row first; the text is validated too.

    Args:
        artifact: What was compiled.
        size: Width and height.
        uniforms: Values by the author's names; the rest take their defaults.
        textures: float32 arrays (height, width, 4) or (depth, height, width, 4), bottom row first.
        buffers: Arrays (count,) or (count, components).

    Raises:
        EglUnavailableError: There is no driver.
        ShaderRejectedError: The text is refused.
        ValueError: A value names no uniform.
    """
    assert_valid(artifact)
    shader = egl.EglShader(complete_text(artifact), artifact.interface["version"], artifact.vertex)
    values = uniform_values(artifact, size, dict(uniforms or {}))
    bound: list[Any] = []
    for entry in artifact.interface["textures"]:
        assert textures is not None
        bound.append(_texture(entry, textures[entry["name"]]))
        values[entry["uniform"]] = len(bound) - 1
    for entry in artifact.interface["buffers"]:
        data = buffer_data(entry, buffers or {})
        bound.append(_buffer(data))
        values[entry["uniform"]] = len(bound) - 1
        values[entry["count"]] = len(data)
    for unit, texture in enumerate(bound):
        texture.use(unit)
    try:
        used = set(shader.uniforms)
        return shader.render(size, {name: v for name, v in values.items() if name in used})
    finally:
        shader.release()
        for texture in bound:
            texture.release()


def uniform_values(
    artifact: Artifact, size: tuple[int, int], uniforms: dict[str, Any]
) -> dict[str, Any]:
    """The value of every uniform by the name that the text has for it, defaults filled in.

    Raises:
        ValueError: A value names no uniform.
    """
    values: dict[str, Any] = {}
    for entry in artifact.interface["uniforms"]:
        value = uniforms.pop(entry["name"], entry["default"])
        if entry["name"] == "resolution" and entry["origin"] == "frame":
            value = size
        spelled = entry["uniform"].partition(".")[0]  # iResolution.xy
        if spelled == "iResolution":
            value = (*size, 1.0)
        elif spelled == "u_mouse":
            value = value[:2]
        values[spelled] = value
    uniforms.pop("resolution", None)
    if uniforms:
        raise ValueError(f"the program has no uniform {', '.join(sorted(uniforms))}")
    return values


def _texture(entry: dict[str, Any], texels: NDArray[np.float32]) -> Any:
    texels = np.ascontiguousarray(texels, np.float32)
    height, width = texels.shape[-3:-1]
    context = egl.context()
    texture: Any
    if entry["type"] == "TextureCube":
        return context.texture_cube((width, height), 4, texels.tobytes(), dtype="f4")
    if entry["type"] == "Texture3D":
        shape = (width, height, texels.shape[0])
        texture = context.texture3d(shape, 4, texels.tobytes(), dtype="f4")
    else:
        texture = context.texture((width, height), 4, texels.tobytes(), dtype="f4")
    texture.repeat_x = texture.repeat_y = entry["wrap"] == "repeat"
    if entry["type"] == "Texture3D":
        texture.repeat_z = entry["wrap"] == "repeat"
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    return texture


def buffer_width(count: int) -> int:
    """How many elements a row of a buffer's texture has; drivers have 8192 rows or more."""
    return BUFFER_WIDTH << max(0, (count // (BUFFER_WIDTH * 8192)).bit_length())


def _buffer(data: NDArray[Any]) -> Any:
    """The elements as texels, row by row, the last row filled up."""
    kind = {"f": "f4", "i": "i4", "u": "u4", "b": "i4"}[data.dtype.kind]
    rows = data.reshape(len(data), -1).astype(kind)
    width = buffer_width(len(rows))
    height = -(-len(rows) // width)
    texels = np.zeros((height * width, 4), kind)
    texels[: len(rows), : rows.shape[1]] = rows
    texture = egl.context().texture((width, height), 4, texels.tobytes(), dtype=kind)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture
