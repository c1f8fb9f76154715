"""Runs the GLSL of a compiled image on WebGL in a real browser, for tests and tools.

In: an ``Artifact`` of glsl-es300 or shadertoy (WebGL 2) or of glsl-es100 (WebGL 1, a text as
glslCanvas wraps it), the picture's size, values of uniforms, textures and buffers by the author's
names. Out: the picture in 32-bit floats. What to set is read from the artifact's interface alone,
and a uniform that it keeps silent about is an error. Nothing here is the player's:
``tests/webgl_page.html`` is a second opinion on the texts. One page of each driver serves the
process; a program is compiled once.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.backends.base import Artifact
from tests.browser import MESA, SWIFTSHADER, BrowserUnavailableError, browser
from tests.buffer_data import buffer_data
from tests.glsl import buffer_width, complete_text, uniform_values

PAGE: Final = Path(__file__).with_name("webgl_page.html")
CONTEXTS: Final = {"glsl-es300": "webgl2", "shadertoy": "webgl2", "glsl-es100": "webgl"}
COVERING: Final = "void main() { gl_Position = vec4(position, 0.0, 1.0); }\n"
QUAD: Final = {
    "webgl2": f"#version 300 es\nin vec2 position;\n{COVERING}",
    "webgl": f"attribute vec2 position;\n{COVERING}",
}
SHAPES: Final = {"Texture2D": "flat", "TextureCube": "cube", "Texture3D": "volume"}
DRIVERS: Final[dict[str, tuple[str, ...]]] = {"swiftshader": SWIFTSHADER, "mesa": MESA}
LIMIT_S: Final = 60.0
GRACE_S: Final = 5.0  # for a page that answers late, because its driver holds it up
POLLING_MS: Final = 10


class WebGLError(RuntimeError):
    """The browser refused the program, lost it, or did not finish; the message says which."""


@dataclass
class Drawn:
    """A picture and how long it took.

    Attributes:
        pixels: float32 (height, width, 4), top row first, neither clamped nor rounded.
        compile_s: Until the program was linked; 0 or nearly so when it was known.
        draw_s: Until the pixels were read back, in the page.
    """

    pixels: NDArray[np.float32]
    compile_s: float
    draw_s: float


def run_webgl(
    artifact: Artifact,
    size: tuple[int, int],
    uniforms: Mapping[str, Any] | None = None,
    textures: Mapping[str, NDArray[np.float32]] | None = None,
    buffers: Mapping[str, NDArray[Any]] | None = None,
    driver: str = "swiftshader",
) -> NDArray[np.float32]:
    """The picture, float32 of shape (height, width, 4), top row first.

    Args:
        artifact: What was compiled.
        size: Width and height.
        uniforms: Values by the author's names; the rest take their defaults.
        textures: float32 arrays (height, width, 4), bottom row first, or (depth or face, …).
        buffers: Arrays (count,) or (count, components).
        driver: What the browser's WebGL runs on: ``swiftshader``, or ``mesa`` for large scenes.

    Raises:
        BrowserUnavailableError: There is no browser.
        WebGLError: The text is refused, or not drawn within ``LIMIT_S``.
        ValueError: A value names no uniform.
    """
    return drawn(artifact, size, uniforms, textures, buffers, driver).pixels


def drawn(
    artifact: Artifact,
    size: tuple[int, int],
    uniforms: Mapping[str, Any] | None = None,
    textures: Mapping[str, NDArray[np.float32]] | None = None,
    buffers: Mapping[str, NDArray[Any]] | None = None,
    driver: str = "swiftshader",
    limit_s: float = LIMIT_S,
) -> Drawn:
    """The same as ``run_webgl``, with the time it took."""
    context = CONTEXTS[artifact.interface["target"]]
    values = uniform_values(artifact, size, dict(uniforms or {}))
    bound = _bound(artifact, textures or {}, buffers or {}, values)
    fragment = complete_text(artifact)
    vertex = artifact.vertex or QUAD[context]
    request = {
        "context": context,
        "key": hashlib.sha256(f"{context}\0{vertex}\0{fragment}".encode()).hexdigest(),
        "vertex": vertex,
        "fragment": fragment,
        "vertices": 6 if artifact.vertex is None else artifact.interface["vertices"],
        "values": {name: np.ravel(value).tolist() for name, value in values.items()},
        "textures": bound,
        "size": size,
        "limit_s": limit_s,
    }
    answer = _answer(driver, request)
    pixels = np.frombuffer(base64.b64decode(answer["pixels"]), np.float32)
    picture = pixels.reshape(size[1], size[0], 4)[::-1].copy()
    return Drawn(picture, answer["compile_s"], answer["draw_s"])


def renderer(driver: str = "swiftshader", context: str = "webgl2") -> str:
    """What draws, as the browser tells it: ``ANGLE (…, SwiftShader driver)``."""
    _, page = _page(driver)
    return str(page.evaluate("(context) => rendererOf(context)", context))


_pages: dict[str, tuple[Any, Any]] = {}


def _page(driver: str) -> tuple[Any, Any]:
    """The browser of a driver and its page."""
    running = browser(*DRIVERS[driver])
    known = _pages.get(driver)
    if known is None or known[0] is not running or known[1].is_closed():
        page = running.new_page()
        page.goto(PAGE.resolve().as_uri())
        known = _pages[driver] = (running, page)
    return known


def _answer(driver: str, request: dict[str, Any]) -> Any:
    """What the page makes of a request, within its limit and a little.

    After a fault the next call gets a fresh browser: one that is still busy with a program would
    keep all others waiting, and Chromium refuses WebGL to a page that lost it too often.
    """
    running, page = _page(driver)
    limit_s = request["limit_s"]
    try:
        page.evaluate("(request) => start(request)", request)
        page.wait_for_function("answer", timeout=(limit_s + GRACE_S) * 1e3, polling=POLLING_MS)
        answer = page.evaluate("answer")
    except Exception as error:
        running.close()
        if type(error).__name__ == "TimeoutError":
            raise WebGLError(f"the browser is held up for more than {limit_s:g} s") from None
        raise WebGLError(str(error)) from None
    if "error" in answer:
        running.close()
        raise WebGLError(answer["error"])
    return answer["drawn"]


def _bound(
    artifact: Artifact,
    textures: Mapping[str, NDArray[np.float32]],
    buffers: Mapping[str, NDArray[Any]],
    values: dict[str, Any],
) -> list[dict[str, Any]]:
    """What is bound to texture units; which unit, and how many elements, become values."""
    found: list[dict[str, Any]] = []
    for entry in artifact.interface["textures"]:
        values[entry["uniform"]] = len(found)
        texels = np.ascontiguousarray(textures[entry["name"]], np.float32)
        told = {"shape": SHAPES[entry["type"]], "wrap": entry["wrap"], "linear": True}
        found.append({"unit": len(found), **told, **_texels(texels)})
    for entry in artifact.interface["buffers"]:
        values[entry["uniform"]] = len(found)
        data = buffer_data(entry, buffers)
        values[entry["count"]] = len(data)
        told = {"shape": "flat", "wrap": "clamp", "linear": False}
        found.append({"unit": len(found), **told, **_texels(_rows_of(data))})
    return found


def _rows_of(data: NDArray[Any]) -> NDArray[Any]:
    """Elements as texels, row by row, the last row filled up."""
    elements = data.reshape(len(data), -1)
    width = buffer_width(len(elements))
    height = -(-len(elements) // width)
    kind = {"f": "f4", "i": "i4", "u": "u4", "b": "i4"}[data.dtype.kind]
    texels = np.zeros((height * width, 4), kind)
    texels[: len(elements), : elements.shape[1]] = elements
    return texels.reshape(height, width, 4)


def _texels(texels: NDArray[Any]) -> dict[str, Any]:
    return {
        "kind": texels.dtype.kind,
        "size": [*texels.shape[-2:-4:-1], texels.shape[0] if texels.ndim == 4 else 1],
        "data": base64.b64encode(texels.tobytes()).decode("ascii"),
    }


__all__ = ["BrowserUnavailableError", "Drawn", "WebGLError", "drawn", "renderer", "run_webgl"]
