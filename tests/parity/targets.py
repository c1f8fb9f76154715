"""Every way of running an image module, by one name and one call each.

Input: an image module before all passes, without uniforms, a size and the data of the
module's buffers. Output: the picture, float32, top row first, neither clamped nor rounded.
Raises ``Unavailable`` with a reason where this machine lacks what a target needs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.backends import emit, get_target
from distal.backends.numpy import interpreter as reference_backend
from distal.compiler.driver import run_passes
from distal.devices import cpu as cpu_device
from distal.devices.cache import Cache
from distal.ir.nodes import Module
from tests import egl, gpu
from tests.glsl import run_glsl

Picture = NDArray[np.float32]
Buffers = dict[str, NDArray[np.uint32]]
Runner = Callable[[Module, int, int, Buffers], Picture]


class Unavailable(Exception):  # noqa: N818 (a reason to skip, not an error)
    """This machine cannot run the target."""


def reference(
    module: Module, width: int, height: int, buffers: Buffers, precision: int = 32
) -> Picture:
    """NumPy, which the others are held against."""
    module = run_passes(module, get_target("numpy"), precision)
    return reference_backend.render(module, width, height, {}, buffers, precision)


def cpu(module: Module, width: int, height: int, buffers: Buffers, precision: int = 32) -> Picture:
    """Vector code through LLVM."""
    kernel = cpu_device.prepare(module, precision=precision, cache=Cache(None))
    return kernel.render(width, height, {}, buffers)


def glsl(name: str) -> Runner:
    """GLSL on the machine's OpenGL."""

    def run(module: Module, width: int, height: int, buffers: Buffers) -> Picture:
        try:
            egl.context()
        except egl.EglUnavailableError as error:
            raise Unavailable(str(error)) from error
        target = get_target(name)
        artifact = emit(run_passes(module, target), target)
        return run_glsl(artifact, (width, height), buffers=buffers)

    return run


def wgsl(name: str, path: str) -> Runner:
    """WGSL on the machine's Vulkan or OpenGL."""

    def run(module: Module, width: int, height: int, buffers: Buffers) -> Picture:
        try:
            gpu.device()
        except gpu.GpuUnavailableError as error:
            raise Unavailable(str(error)) from error
        target = get_target(name)
        artifact = emit(run_passes(module, target), target)
        return gpu.run_wgsl(artifact, (width, height), path=path, buffers=buffers)

    return run


# All but the reference.
TARGETS: Final[dict[str, Runner]] = {
    "llvm": cpu,
    "glsl-es300": glsl("glsl-es300"),
    "glsl-330": glsl("glsl-330"),
    "wgsl": wgsl("wgsl", "fragment"),
    "wgsl-compute": wgsl("wgsl-compute", "compute"),
}
