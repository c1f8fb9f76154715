"""Random numbers and scattering on shader targets: the same bits, and the same light."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from distal import Camera, PointLight, Scene, Sphere
from distal.lang import Frame, image, ivec2, normalize, select, vec3, vec4
from distal.lang.composed import Composed
from distal.lang.render_options import RenderOptions
from distal.render import scatter
from distal.render.material import Surface
from distal.render.sampling import points
from distal.runtime.executor import PythonExecutor
from tests.drivers import driver_picture

SIZE = (24, 16)
UP = vec3(0.0, 0.0, 1.0)


@image
def numbers(frame: Frame) -> vec4:
    """Two samples' numbers of each pixel; multiples of 2^-24 are exact."""
    pixel = ivec2(int(frame.coord.x), int(frame.coord.y))
    here = points.triple(points.scattered_stream(pixel, 77, 5), 3)
    there = points.pair(points.dithered_stream(pixel, 6, 4, 5), 3)
    return vec4(here.x, here.z, there)


@image
def scattered(frame: Frame) -> vec4:
    """The mean weight and value of a few samples, by roughness and by transmission."""
    pixel = ivec2(int(frame.coord.x), int(frame.coord.y))
    share = frame.coord / frame.resolution
    surface = Surface(
        vec3(0.9, 0.7, 0.5), 0.5 * (1.0 - share.x), 0.2, 0.6 * share.x, 1.5, share.y, 0.2,
        fresnel=share.x,
    )  # fmt: skip
    view = normalize(vec3(0.5, 0.2, 0.7))
    total = vec3(0.0)
    for k in range(4):
        stream = points.scattered_stream(pixel, k, 5)
        meeting = scatter.meet(surface, view, UP, k == 3)
        found = scatter.sample_from(meeting, points.triple(stream, 0))
        light = select(found.specular, UP, found.direction)
        value = scatter.respond_to(meeting, light).value
        total += found.weight + value / (1.0 + value)
    return vec4(0.1 * total, 1.0)


@cache
def expected(number: int) -> np.ndarray:
    what = (numbers, scattered)[number]
    options = RenderOptions(size=SIZE, device="reference")
    return PythonExecutor().render(what, options).array


@cache
def film() -> tuple[Composed, np.ndarray]:
    """One sample of paths through a lens, placed by a filter; on the CPU."""
    lamp = PointLight((2.0, 3.0, 4.0), intensity=9.0, radius=1.0)
    scene = Scene(Sphere(), lights=lamp, camera=Camera(aperture=0.2), floor=True)
    made = scene.render(SIZE, mode="path", spp=1, filter="mitchell").linear
    # The program gives light times alpha, and the weight as alpha.
    return scene.view("color", paths=True, filter="mitchell"), made[..., :3]


def compare_film(found: np.ndarray) -> None:
    straight = found[..., :3] / np.where(found[..., 3:] > 0.0, found[..., 3:], 1.0)
    known = (found[..., 3:] > 0.0) & (found[..., 3:] < 1.5)
    off = np.where(known, np.abs(straight - film()[1]), 0.0).max(-1)
    assert known.mean() > 0.8
    assert np.quantile(off, 0.98) < 2e-3


def compare(found: np.ndarray, number: int) -> None:
    if number == 0:
        assert np.array_equal(found, expected(0))
    else:
        # A sample at the border of two lobes may fall on the other side; few pixels do.
        off = np.abs(found - expected(1)).max(-1)
        assert np.quantile(off, 0.98) < 2e-3


@pytest.mark.parametrize("number", [0, 1])
def test_cpu(number: int) -> None:
    picture = PythonExecutor().render((numbers, scattered)[number], RenderOptions(size=SIZE))
    compare(picture.array, number)


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl"])
@pytest.mark.parametrize("number", [0, 1])
def test_drivers(number: int, target: str) -> None:
    compare(driver_picture((numbers, scattered)[number], target, SIZE), number)


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl"])
def test_film_of_drivers(target: str) -> None:
    compare_film(driver_picture(film()[0], target, SIZE))
