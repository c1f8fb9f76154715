"""Segments are the same on every target: rays straight through three solids, by their crossings."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import distal
from distal.fields.guarantees import Bounds
from distal.fields.solids.boxes import box
from distal.fields.solids.rings import torus
from distal.fields.solids.round import sphere
from distal.lang import Frame, abs, dot, func, image, min, vec3, vec4
from distal.lang.render_options import RenderOptions
from distal.render.camera import Ray, look_at
from distal.render.march import March
from distal.render.segment import landing, segment
from distal.runtime.executor import PythonExecutor
from tests import egl, gpu
from tests.glsl import run_glsl

SIZE = (24, 18)


@func
def three(p: vec3) -> float:
    """A ball, a box and a torus."""
    ball = sphere(p - vec3(0.0, 0.5, 0.0), 0.5)
    brick = box(p - vec3(0.9, 0.3, 0.2), vec3(0.5, 0.6, 0.5))
    return min(ball, min(brick, torus(p - vec3(-0.8, 0.3, 0.3), 0.35, 0.15)))


@image
def crossings(frame: Frame) -> vec4:
    """The length of a ray up to its last crossing, and within solids; how many there are."""
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    ray = look_at(uv, vec3(1.0, 1.5, 3.0), vec3(0.0, 0.35, 0.0), vec3(0.0, 1.0, 0.0), fov=0.8)
    origin = ray.origin
    side = 0.0
    slope = 0.0
    way = 0.0
    within = 0.0
    count = 0.0
    bounds = Bounds(vec3(-2.0), vec3(2.0))
    for _ in range(6):
        here = Ray(origin, ray.direction)
        numbers = March(1.0, 0.0, 100.0, 0.0)
        hit = segment(lambda p: three(p), here, side, slope, bounds, numbers, 200)
        if not hit.found:
            break
        place = landing(lambda p: three(p), here, hit)
        way += place.t
        within += place.t if hit.side < 0.0 else 0.0
        count += 1.0
        origin = place.p
        slope = abs(dot(place.n, ray.direction)) * place.slope
        side = -hit.side
    return vec4(way / 8.0, within / 2.0, count / 8.0, 1.0)


@cache
def expected() -> np.ndarray:
    options = RenderOptions(size=SIZE, device="reference")
    return np.asarray(PythonExecutor().render(crossings, options).array)


def same(picture: np.ndarray, allowed: float) -> None:
    """Equal but where a ray touches a solid; solids are entered as often as they are left."""
    found, true = picture[..., :3], expected()[..., :3]
    assert true[..., 2].max() >= 0.5
    assert np.all(np.round(8.0 * true[..., 2]) % 2 == 0)
    apart = np.abs(found - true).max(axis=-1) > allowed
    assert apart.mean() < 0.005


def test_cpu() -> None:
    same(PythonExecutor().render(crossings, RenderOptions(size=SIZE)).array, 1e-5)


@pytest.mark.parametrize("target", ["glsl-es300", "glsl-es100", "shadertoy"])
def test_glsl(target: str) -> None:
    try:
        egl.context()
    except egl.EglUnavailableError as error:
        pytest.skip(str(error))
    same(run_glsl(distal.compile(crossings, target), SIZE), 1e-5)


@pytest.mark.parametrize(("target", "path"), [("wgsl", "fragment"), ("wgsl-compute", "compute")])
def test_wgsl(target: str, path: str) -> None:
    try:
        gpu.device()
    except gpu.GpuUnavailableError as error:
        pytest.skip(str(error))
    same(gpu.run_wgsl(distal.compile(crossings, target), SIZE, path=path), 1e-5)
