"""A scene of a thousand numbers, and of time, is the same picture on every driver."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import distal
from distal.lang.expressions import time
from distal.lang.render_options import RenderOptions
from distal.runtime.executor import PythonExecutor
from tests import egl, gpu
from tests.glsl import run_glsl
from tests.unit.executor.composing import Ramp

SIZE = (48, 3)
# Whole numbers and their halves: every sum is exact in 32 bits.
RAMP = Ramp([float(n % 7) for n in range(1000)], time * 2.0 + 0.25)


@cache
def expected() -> np.ndarray:
    picture = PythonExecutor().render(RAMP, RenderOptions(size=SIZE, time=1.5, device="reference"))
    return picture.array


@pytest.mark.parametrize("target", ["glsl-es300", "glsl-330", "glsl-es100", "shadertoy"])
def test_glsl(target: str) -> None:
    try:
        egl.context()
    except egl.EglUnavailableError as error:
        pytest.skip(str(error))
    picture = run_glsl(distal.compile(RAMP, target), SIZE, {"time": 1.5})
    assert np.array_equal(picture, expected())


@pytest.mark.parametrize(("target", "path"), [("wgsl", "fragment"), ("wgsl-compute", "compute")])
def test_wgsl(target: str, path: str) -> None:
    try:
        gpu.device()
    except gpu.GpuUnavailableError as error:
        pytest.skip(str(error))
    picture = gpu.run_wgsl(distal.compile(RAMP, target), SIZE, {"time": 1.5}, path=path)
    assert np.array_equal(picture, expected())


def test_cpu() -> None:
    picture = PythonExecutor().render(RAMP, RenderOptions(size=SIZE, time=1.5))
    assert np.array_equal(picture.array, expected())
