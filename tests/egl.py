"""Runs one GLSL text natively through EGL, for tests, tools and benchmarks.

In: the text of a fragment stage (``#version 100``, ``300 es``, ``330`` and so on), optionally the
text of the vertex stage that feeds it, and uniform values by name. Out: the picture as the shader
wrote it, in 32-bit floats, neither clamped nor rounded. It knows nothing of distal: what a text
means here is what the driver (Mesa's llvmpipe on a machine without a graphics card) makes of it.
llvmpipe really computes in 16 bits where an ES text leaves precision at mediump, and mediump is a
fragment stage's default for int: a text has to say ``precision highp int;`` beside the float one.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

# One fullscreen quad as two triangles, the way web pages and tutorials draw it.
QUAD_CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float32)
QUAD_INDICES = np.array([0, 1, 2, 2, 3, 0], np.int32)

VERSION_LINE = re.compile(r"#version[ \t]+(\d+(?:[ \t]+\w+)?)")
SCALAR_TYPES: dict[str, type[np.generic]] = {"f": np.float32, "i": np.int32, "I": np.uint32}


class EglUnavailableError(RuntimeError):
    """No OpenGL context can be made on this machine; a test skips aloud on it."""


class ShaderRejectedError(ValueError):
    """The driver refused the text; the message is the driver's own log."""


def context() -> moderngl.Context:
    """The process's one context: made on first use, so that callers may set driver options before.

    Raises:
        EglUnavailableError: if the machine has no EGL driver.
    """
    made = _made_context()
    made.__enter__()  # wgpu in the same process makes a context of its own current
    return made


@cache
def _made_context() -> moderngl.Context:
    try:
        return moderngl.create_context(
            standalone=True,
            backend="egl",  # type: ignore[arg-type]  # its stub asks for a dict
        )
    except Exception as error:  # moderngl raises bare Exception for a missing library or device
        raise EglUnavailableError(f"no OpenGL context through EGL: {error}") from error


def renderer() -> str:
    """The driver's own name for what runs the shaders, such as ``llvmpipe (LLVM 15.0.6, ...)``."""
    return str(context().info["GL_RENDERER"])


class EglShader:
    """A linked pair of shader stages that draws one fullscreen picture.

    Args:
        fragment_text: The fragment stage. ``gl_FragCoord`` of the lower left pixel is (.5, .5).
        version: What to write after ``#version`` where a text has no such line of its own.
        vertex_text: The vertex stage, or None for one that only covers the screen. It has either
            a single ``vec2`` input (of any name), fed with the corners of the clip-space quad, or
            no input at all: then it is run for one triangle, by ``gl_VertexID``.

    Raises:
        ShaderRejectedError: if the driver does not compile or link the texts.
        EglUnavailableError: if there is no driver.
    """

    def __init__(
        self, fragment_text: str, version: str | None = None, vertex_text: str | None = None
    ) -> None:
        fragment_text = _with_version(fragment_text, version)
        match = VERSION_LINE.match(fragment_text)
        assert match is not None
        version = match[1]
        if vertex_text is None:
            vertex_text = _covering_vertex_text(version)
        vertex_text = _with_version(vertex_text, version)
        self._texts = vertex_text + fragment_text
        try:
            self._program = context().program(
                vertex_shader=vertex_text, fragment_shader=fragment_text
            )
        except moderngl.Error as error:
            raise ShaderRejectedError(str(error).strip()) from error
        self._buffers: list[moderngl.Buffer] = []
        self._vertices = self._vertex_array()

    @property
    def uniforms(self) -> tuple[str, ...]:
        """Names of the uniforms that the linked program really reads."""
        members = ((name, self._program[name]) for name in self._program)
        return tuple(name for name, member in members if isinstance(member, moderngl.Uniform))

    def render(
        self, size: tuple[int, int], uniforms: Mapping[str, Any] | None = None
    ) -> NDArray[np.float32]:
        """The picture as float32 of shape (height, width, 4), top row first."""
        width, height = size
        target = context().simple_framebuffer((width, height), components=4, dtype="f4")
        try:
            self.draw(target, uniforms or {})
            pixels = np.frombuffer(target.read(components=4, dtype="f4"), np.float32)
        finally:
            target.release()
        return pixels.reshape(height, width, 4)[::-1].copy()

    def draw(self, target: moderngl.Framebuffer, uniforms: Mapping[str, Any]) -> None:
        """Draw into ``target`` without waiting for the driver to finish.

        A uniform's value is a number or nested sequence of numbers; a matrix is given by columns.

        Raises:
            ValueError: if a value is missing, has the wrong number of components, or names
                something that stands nowhere in the texts (one the driver optimised away may stay).
        """
        self._set(uniforms)
        target.use()
        target.clear(0.0, 0.0, 0.0, 0.0)
        self._vertices.render(moderngl.TRIANGLES)

    def release(self) -> None:
        """Give the driver's objects back; the shader cannot draw afterwards."""
        self._vertices.release()
        for buffer in self._buffers:
            buffer.release()
        self._program.release()

    def _set(self, uniforms: Mapping[str, Any]) -> None:
        if missing := [name for name in self.uniforms if name not in uniforms]:
            raise ValueError(f"no value for uniform {', '.join(missing)}")
        for name, value in uniforms.items():
            if name not in self.uniforms:
                if not re.search(rf"\b{re.escape(name)}\b", self._texts):
                    raise ValueError(f"the shader has no uniform {name!r}")
                continue
            member = self._program[name]
            assert isinstance(member, moderngl.Uniform)
            # A count and a letter: "3f" is a vec3, "9f" a mat3, "1i" an int, bool or sampler.
            layout = str(member.fmt)  # type: ignore[attr-defined]  # missing from its stub
            data = np.asarray(value, SCALAR_TYPES[layout[-1]])
            expected = int(layout[:-1]) * member.array_length
            if data.size != expected:
                raise ValueError(f"uniform {name} takes {expected} numbers, not {data.size}")
            member.write(data.tobytes())

    def _vertex_array(self) -> moderngl.VertexArray:
        members = ((name, self._program[name]) for name in self._program)
        # gl_VertexID is listed as well; with the quad's indices it would draw a second triangle.
        inputs = [
            name
            for name, member in members
            if isinstance(member, moderngl.Attribute) and not name.startswith("gl_")
        ]
        if not inputs:
            array = context().vertex_array(self._program, [])
            array.vertices = 3
            return array
        if len(inputs) > 1:
            raise ValueError(f"the vertex stage has more than one input: {', '.join(inputs)}")
        corners = context().buffer(QUAD_CORNERS.tobytes())
        indices = context().buffer(QUAD_INDICES.tobytes())
        self._buffers = [corners, indices]
        return context().vertex_array(
            self._program, [(corners, "2f", inputs[0])], index_buffer=indices
        )


def to_bytes(picture: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Float colors as the 8-bit RGB that pictures are stored in: clamp, scale, round half up."""
    rgb = np.nan_to_num(picture[..., :3], nan=0.0)
    rounded: NDArray[np.uint8] = np.floor(np.clip(rgb, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    return rounded


def _covering_vertex_text(version: str) -> str:
    # GLSL ES 1.00 and desktop GLSL before 1.30 call a vertex input an attribute.
    modern = version.endswith("es") or int(version.split()[0]) >= 130
    return (
        f"{'in' if modern else 'attribute'} vec2 position;\n"
        "void main() { gl_Position = vec4(position, 0.0, 1.0); }\n"
    )


def _with_version(text: str, version: str | None) -> str:
    # The standards let nothing but comments and blanks stand before #version; drop the blanks.
    text = text.lstrip()
    if VERSION_LINE.match(text):
        return text
    if version is None:
        raise ValueError("the shader text has no #version line and no version was given")
    return f"#version {version}\n{text}"
