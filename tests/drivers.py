"""Draws pictures with the drivers: GLSL through EGL, WGSL through wgpu."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import distal
from tests import egl, gpu
from tests.glsl import run_glsl


def driver_picture(image: Any, target: str, size: tuple[int, int]) -> NDArray[np.float32]:
    """A picture of shape (height, width, 4), drawn by its target; skips where there is no driver.

    Args:
        image: A scene, a view, an ``@image``.
        target: "glsl-es300" or "wgsl", as a fragment.
        size: Width and height.
    """
    program = distal.compile(image, target=target)
    try:
        if target == "wgsl":
            gpu.device()
            return gpu.run_wgsl(program, size, path="fragment")
        egl.context()
        return run_glsl(program, size)
    except (egl.EglUnavailableError, gpu.GpuUnavailableError) as error:
        pytest.skip(str(error))
