"""Paths against closed forms: what a narrow camera sees, in units of its standard error.

Each pixel of a small picture is an independent estimate of the same light, so their spread tells
how far their mean may be off.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
    DistantLight,
    Environment,
    HemisphereLight,
    Material,
    Plane,
    PointLight,
    Scene,
    Sphere,
    emissive,
    glass,
    matte,
    metal,
    mirror,
)
from tests.optics.looking import upper_half

SIDE = 24
BLACK = (0.0, 0.0, 0.0)
WHITE = (1.0, 1.0, 1.0)


def estimate(shape: Any, position: Any, target: Any, spp: int = 64, **scene: Any) -> Any:
    """The light from a place, and its standard error, of each color."""
    way = np.subtract(target, position)
    up = (0, 0, -1) if abs(way[1]) > 0.99 * np.linalg.norm(way) else (0, 1, 0)
    camera = Camera(position, target, up=up, fov=1e-5)
    scene = {"lights": [], "background": BLACK, "floor": False, **scene}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the picture is black")
        picture = Scene(shape, camera=camera, **scene).render(
            size=(SIDE, SIDE), mode="path", spp=spp
        )
    light = picture.linear[..., :3].reshape(-1, 3).astype(float)
    return light.mean(axis=0), light.std(axis=0, ddof=1) / math.sqrt(len(light))


def check(found: Any, expected: float, error: float) -> None:
    """The mean is as expected within four standard errors, which are at most ``error``."""
    mean, sigma = found
    assert sigma.max() <= error, sigma
    assert np.abs(mean - expected).max() <= 4.0 * sigma.max() + 2e-5 * expected, (mean, sigma)


@pytest.mark.parametrize("height", [0.01, 1.0, 100.0])
def test_a_point_light_falls_off_with_the_square_of_the_distance(height):
    light = PointLight((0, height, height), intensity=3.0)
    found = estimate(
        Plane(),
        (-height, height, 0),
        (0, 0, 0),
        1,
        lights=light,
        default_material=matte((0.5,) * 3),
    )
    check(found, 0.5 * 3.0 * math.sqrt(0.5) / (2.0 * height**2), 1e-6 / height**2)


@pytest.mark.parametrize("angle", [0.001, 0.3, 1.2])
def test_a_wide_sun_lights_by_the_cosine(angle):
    sun = DistantLight((1, 1, 0), intensity=2.0, angle=angle)
    found = estimate(Plane(), (1, 2, 1), (0, 0, 0), lights=sun, default_material=matte(WHITE))
    check(found, 2.0 * math.sqrt(0.5), 2e-3)


def test_ambient_light_is_that_of_the_half_space():
    lights = HemisphereLight((0.9,) * 3, (0.1,) * 3, 1.0)
    ball = Sphere().paint(matte((0.5,) * 3))
    for height in (-0.9, 0.0, 0.6):
        x = math.sqrt(1.0 - height**2)
        found = estimate(ball, (3 * x, 3 * height, 0), (x, height, 0), 256, lights=lights)
        share = 0.5 + 0.5 * height
        check(found, 0.5 * (0.9 * share + 0.1 * (1.0 - share)), 1e-3)


@pytest.mark.parametrize(("albedo", "glow"), [(0.5, 0.3), (0.9, 0.1)])
def test_a_closed_cavity_glows_evenly(albedo, glow):
    room = Sphere(2.0) - Sphere(1.0)
    walls = Material(color=(albedo,) * 3, emission=(glow,) * 3)
    found = estimate(room, (0.1, 0.2, 0.3), (1, 0.4, -0.2), 256, default_material=walls)
    check(found, glow / (1.0 - albedo), 6e-3)


@pytest.mark.parametrize("material", [matte(WHITE), mirror(), glass(), metal(WHITE, 0.0)], ids=str)
def test_a_white_solid_disappears_in_a_white_furnace(material):
    for place in ((0, 0, 0.0), (0.4, 0.2, 0), (0.97, 0.1, 0)):
        found = estimate(
            Sphere().paint(material),
            (place[0], place[1], 4),
            place,
            lights=AmbientLight(1.0),
            background=WHITE,
        )
        check(found, 1.0, 2e-3)


@pytest.mark.parametrize("thickness", [1e-3, 0.1, 1.0])
@pytest.mark.parametrize("absorption", [0.0, 2.0])
def test_a_pane_by_all_its_inner_reflections(thickness, absorption):
    clear = Material(
        diffuse=0.0, transmission=1.0, ior=1.5, fresnel=1.0, absorption=(absorption,) * 3
    )
    pane = Box((50, thickness, 50)).paint(clear)
    found = estimate(pane, (0.1, -3, 0.2), (0.1, 0, 0.2), 128, background=upper_half)
    mirrored = 0.04
    left = math.exp(-absorption * thickness)
    through = (1 - mirrored) ** 2 * left / (1 - (mirrored * left) ** 2)
    check(found, through, 3e-3)


@pytest.mark.parametrize("size", [0.5, 0.15])
@pytest.mark.parametrize("material", [matte(WHITE), metal((0.8,) * 3, 0.5)], ids=str)
def test_a_lamp_and_a_glowing_ball_are_alike(size, material):
    # The disc of a light of intensity I and radius r shines with I / r^2.
    floor = Plane().paint(material)
    seen = {"position": (-3, 3, 0), "target": (0, 0, 0)}
    lamp = estimate(floor, lights=PointLight((3, 3, 0), intensity=18.0, radius=size), **seen)
    ball = Sphere(size).translate(3, 3, 0).paint(emissive(WHITE, 18.0 / size**2))
    glowing = estimate(floor | ball, spp=2048, **seen)
    apart = np.abs(lamp[0] - glowing[0]).max()
    allowed = 4.0 * math.hypot(lamp[1].max(), glowing[1].max())
    assert glowing[1].max() < 0.05 * lamp[0].max()
    # The disc of a lamp is as wide as its tangent says, that of a ball as its sine.
    assert apart <= allowed + lamp[0].max() * size**2 / 18.0, (lamp, glowing)


def spotted(rows=16, columns=32):
    """A dim panorama with one bright place, in its upper half."""
    light = np.full((rows, columns, 3), 0.02, np.float32)
    light[3, 20] = (90.0, 60.0, 30.0)
    return light


@pytest.mark.parametrize("turn", [0.0, 2.5])
def test_a_bright_place_of_an_environment_is_sampled(turn):
    image = spotted()
    rows = len(image)
    # A floor sees the upper half by the sine of the height; texels are interpolated.
    fine = 100
    down = (np.arange(rows * fine // 2) + 0.5) / fine - 0.5
    low = np.clip(np.floor(down).astype(int), 0, rows - 2)
    part = np.clip(down - low, 0.0, 1.0)[:, None]
    bands = image.mean(axis=1)
    band = (1.0 - part) * bands[low] + part * bands[low + 1]
    height = 0.5 * math.pi - math.pi * (down + 0.5) / rows
    ring = np.sin(height) * np.cos(height) * (math.pi / (rows * fine)) * 2.0
    expected = 0.5 * 1.5 * (ring[:, None] * band).sum(axis=0)
    light = Environment(image, intensity=1.5, turn=turn)
    mean, sigma = estimate(
        Plane(), (1, 2, 1), (0, 0, 0), 64, lights=light, default_material=matte((0.5,) * 3)
    )
    assert (sigma <= 0.008 * expected).all(), (sigma, expected)
    assert (np.abs(mean - expected) <= 4.0 * sigma + 1e-3 * expected).all(), (mean, sigma, expected)
