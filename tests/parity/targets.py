"""Every way of running an image module, by one name and one call each.

What flows in: an image module before all passes, and a size. What flows out: the picture, float32,
top row first, neither clamped nor rounded. Raises ``Unavailable`` with a reason where this machine
lacks what a target needs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.backends import emit, get_target
from distal.backends import numpy as reference_backend
from distal.compiler import run_passes
from distal.ir.nodes import Module

Picture = NDArray[np.float32]


class Unavailable(Exception):  # noqa: N818 (a reason to skip, not an error)
    """This machine cannot run the target."""


def frame_uniforms(module: Module, width: int, height: int) -> dict[str, Any]:
    """The frame's values, for those uniforms that there are."""
    values: dict[str, Any] = {
        "resolution": (float(width), float(height)),
        "time": 0.0,
        "mouse": (0.0, 0.0, 0.0, 0.0),
        "index": 0,
        "seed": 0,
    }
    return {u.name: values[u.name] for u in module.uniforms}


def reference(module: Module, width: int, height: int, precision: int = 32) -> Picture:
    """NumPy, which the others are held against."""
    module = run_passes(module, get_target("numpy"), precision)
    uniforms = frame_uniforms(module, width, height)
    return reference_backend.render(module, width, height, uniforms, {}, precision)


def cpu(module: Module, width: int, height: int) -> Picture:
    """Vector code through LLVM."""
    from distal.devices import cpu as device

    kernel = device.prepare(module, run_passes)
    uniforms = {"resolution": (float(width), float(height)), "time": 0.0}
    return kernel.render(width, height, uniforms, {})


def glsl(name: str) -> Callable[[Module, int, int], Picture]:
    """GLSL on the driver's OpenGL."""

    def run(module: Module, width: int, height: int) -> Picture:
        from tests import egl

        try:
            egl.context()
        except egl.EglUnavailableError as error:
            raise Unavailable(str(error)) from error
        target = get_target(name)
        module = run_passes(module, target)
        artifact = emit(module, target)
        shader = egl.EglShader(artifact.text, vertex_text=artifact.vertex)
        try:
            return shader.render((width, height), frame_uniforms(module, width, height))
        finally:
            shader.release()

    return run


def wgsl(name: str, path: str) -> Callable[[Module, int, int], Picture]:
    """WGSL on the driver's Vulkan."""

    def run(module: Module, width: int, height: int) -> Picture:
        gpu = _gpu()
        target = get_target(name)
        module = run_passes(module, target)
        uniforms = frame_uniforms(module, width, height)
        picture: Picture = gpu.run_wgsl(emit(module, target), (width, height), uniforms, path=path)
        return picture

    return run


@cache
def _gpu() -> Any:
    try:
        from tests import gpu
    except ImportError as error:
        raise Unavailable(str(error)) from error
    return gpu


# The reference is not among them. The last four need no driver of ours, or Mesa's.
TARGETS: Final[dict[str, Callable[[Module, int, int], Picture]]] = {
    "llvm": cpu,
    "glsl-es300": glsl("glsl-es300"),
    "glsl-330": glsl("glsl-330"),
    "wgsl": wgsl("wgsl", "fragment"),
    "wgsl-compute": wgsl("wgsl-compute", "compute"),
}
