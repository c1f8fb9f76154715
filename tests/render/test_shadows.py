"""Soft shadows against many rays to the light's disc, counted in NumPy without fields.

Boxes and balls are met in closed form by each of 400 rays. A picture is a floor 0.0012 above which
shadow rays start.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal import DistantLight, Plane, Scene, Shape
from distal.fields.guarantees import Bounds
from distal.lang import Field3, abs, func, length, max, min, normalize, vec3
from distal.lang.runtime_access import executor
from distal.render import shadows
from distal.render.lights import LightSample
from distal.render.march import March

SUN = (0.35, 0.9, 0.25)
START = 0.0012


def asked(function: Any, *args: Any) -> Any:
    return executor().call(function, args, {}, device="cpu")


@func
def box(p: vec3, size: vec3) -> float:
    q = abs(p) - 0.5 * size
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0)


@func
def left_of(field: Field3, p: vec3, light: LightSample, sample: int, samples: int) -> float:
    """What is left of a light at a point, by 64 steps of each ray in an endless box."""
    found = shadows.soft_shadow(
        field,
        p,
        light,
        Bounds(vec3(-1e18), vec3(1e18)),
        March(1.0, 0.001, 600.0, 5e-4),
        64,
        False,
        sample,
        samples,
    )
    return found.share


@func
def under_a_box(
    p: vec3, toward: vec3, size: vec3, height: float, radius: float, sample: int, samples: int
) -> float:
    """What is left of a light under a box that is ``height`` above the floor."""
    light = LightSample(normalize(toward), 1e9, vec3(1.0), radius)
    return left_of(
        lambda q: min(q.y, box(q - vec3(0.0, height + 0.5 * size.y, 0.0), size)),
        p,
        light,
        sample,
        samples,
    )


@func
def under_a_ball(p: vec3, toward: vec3, radius: float, sample: int, samples: int) -> float:
    light = LightSample(normalize(toward), 1e9, vec3(1.0), radius)
    return left_of(
        lambda q: min(q.y, length(q - vec3(0.0, 1.0, 0.0)) - 0.6), p, light, sample, samples
    )


def disc(toward: Any, radius: float, count: int = 400) -> Any:
    """Unit directions to points of the light's disc."""
    ahead = np.array(toward) / np.linalg.norm(toward)
    right = np.cross(ahead, (0.3, 0.1, 0.9))
    right /= np.linalg.norm(right)
    k = np.arange(count)[:, None]
    across, angle = radius * np.sqrt((k + 0.5) / count), 2.399963 * k
    ways = ahead + across * (np.cos(angle) * right + np.sin(angle) * np.cross(ahead, right))
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


def floor(count: int = 28) -> Any:
    x, z = np.meshgrid(np.linspace(-1.7, 1.0, count), np.linspace(-1.5, 1.0, count))
    return np.stack([x.ravel(), np.full(x.size, START), z.ravel()], axis=1)


def past_a_box(points: Any, ways: Any, size: Any, height: float) -> Any:
    """The share of the rays of each point that miss a box (the slabs' entry after their exit)."""
    middle = np.array((0.0, height + size[1] / 2, 0.0))
    half = np.array(size) / 2
    near = (middle - half - points[:, None]) / ways
    far = (middle + half - points[:, None]) / ways
    first, last = np.minimum(near, far).max(axis=2), np.maximum(near, far).min(axis=2)
    return (first > last).mean(axis=1)


def past_a_ball(points: Any, ways: Any) -> Any:
    offset = points[:, None] - (0.0, 1.0, 0.0)
    along = (offset * ways).sum(axis=2)
    return ((offset**2).sum(axis=2) - along**2 > 0.36).mean(axis=1)


WIDTHS = (0.003, 0.05, 0.2)
BOXES = ((1.0, 0.002, 1.0), (1.0, 0.1, 1.0), (1.0, 0.5, 1.0), (0.05, 0.8, 1.0), (0.1, 0.1, 2.0))


def errors(samples: int) -> list[float]:
    """The rms of each box and the ball under each light, as the mean over a pixel's samples."""
    points, found = floor(), []
    for radius in WIDTHS:
        ways = disc(SUN, radius)
        for size in BOXES:
            shown = [
                asked(under_a_box, points, SUN, size, 1.0, radius, k, samples)
                for k in range(samples)
            ]
            found.append(np.mean(shown, axis=0) - past_a_box(points, ways, size, 1.0))
        shown = [asked(under_a_ball, points, SUN, radius, k, samples) for k in range(samples)]
        found.append(np.mean(shown, axis=0) - past_a_ball(points, ways))
    return [float(np.sqrt((error**2).mean())) for error in found]


@pytest.mark.parametrize(("samples", "allowed"), [(1, 0.01), (4, 0.015), (16, 0.009)])
def test_a_lights_disc_shows_as_much_as_its_rays_count(samples, allowed):
    found = errors(samples)
    assert np.mean(found) < allowed
    assert np.max(found) < 5.0 * allowed


LIGHTS = {"high": SUN, "above": (0.0, 1.0, 0.0), "low": (0.9, 0.3, 0.1)}


@pytest.mark.parametrize("height", [1.0, 40.0])
@pytest.mark.parametrize("toward", LIGHTS)
def test_no_light_leaks_through_a_plate_of_any_thickness(toward, height):
    """In the middle of the shadow of a plate so large that it hides the whole disc."""
    way = np.array(LIGHTS[toward]) / np.linalg.norm(LIGHTS[toward])
    points = np.zeros((12, 3))
    points[:] = -way / way[1] * height
    points[:, 0] += np.linspace(-1.0, 1.0, 12)
    points[:, 1] = START
    side = 40.0 * height
    for thickness in (0.0005, 0.002, 0.01, 0.1, 0.5):
        for radius in (0.0, 0.0047, 0.02, 0.05, 0.2):
            for k, samples in ((0, 1), (0, 4), (3, 4)):
                left = asked(
                    under_a_box, points, tuple(way), (side, thickness, side), height, radius, k,
                    samples,
                )  # fmt: skip
                assert left.max() < 0.03, (thickness, radius, k, samples)


@func
def over(p: vec3, toward: vec3, radius: float, big: float) -> float:
    """On a ball of this radius about the origin; a plane if it is 0."""
    light = LightSample(normalize(toward), 1e9, vec3(1.0), radius)
    return left_of(lambda q: q.y if big <= 0.0 else length(q) - big, p, light, 0, 1)


@pytest.mark.parametrize("degrees", [1.0, 2.0, 10.0])
def test_a_plane_in_grazing_light_has_no_bands(degrees):
    low = math.radians(degrees)
    points = np.zeros((60, 3))
    points[:, 0] = np.linspace(-30.0, 30.0, 60)
    points[:, 1] = np.geomspace(1e-4, 0.02, 60)
    toward = (math.cos(low), math.sin(low), 0.0)
    for radius in (0.0, 0.0047, 0.01):
        assert asked(over, points, toward, radius, 0.0) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("big", [0.05, 1.0, 50.0])
def test_a_lit_ball_has_no_shadow_of_its_own(big):
    """Up to where the light's disc begins to set behind its horizon."""
    for radius in (0.0, 0.0047, 0.05, 0.2):
        angles = np.linspace(0.0, math.pi / 2 - 1.1 * math.atan(radius) - 0.003, 40)
        points = np.stack([np.sin(angles), np.cos(angles), 0.0 * angles], axis=1)
        lifted = points * (big + 1e-4 + 4e-3 * big)
        shown = asked(over, lifted, (0.0, 1.0, 0.0), radius, big)
        assert shown.min() > 0.995, radius


@func
def under_a_lamp(p: vec3, lamp: vec3, radius: float, sample: int, samples: int) -> float:
    """A plate of 1 x .002 x 1, 1 above the floor, before a lamp of this radius."""
    offset = lamp - p
    distance = length(offset)
    light = LightSample(offset / distance, distance, vec3(1.0), radius / distance)
    return left_of(
        lambda q: min(q.y, box(q - vec3(0.0, 1.001, 0.0), vec3(1.0, 0.002, 1.0))),
        p,
        light,
        sample,
        samples,
    )


@pytest.mark.parametrize(("radius", "allowed"), [(0.01, 0.002), (0.1, 0.015), (0.4, 0.03)])
def test_a_lamp_above_a_plate_shows_as_much_of_itself_as_rays_count(radius, allowed):
    """The lamp is a ball, whose disc faces each point; 16 samples."""
    lamp = np.array((0.4, 3.0, 0.2))
    points = floor(20)
    expected = []
    for p in points:
        offset = lamp - p
        ways = disc(offset, radius / np.linalg.norm(offset))
        expected.append(past_a_box(p[None], ways, (1.0, 0.002, 1.0), 1.0)[0])
    shown = [asked(under_a_lamp, points, tuple(lamp), radius, k, 16) for k in range(16)]
    error = np.mean(shown, axis=0) - expected
    assert np.sqrt((error**2).mean()) < allowed
    above = np.array([[0.3, 1.1, 0.1]])
    assert asked(under_a_lamp, above, tuple(lamp), radius, 0, 1)[0] == pytest.approx(1.0)


@func
def ball(p: vec3) -> float:
    return length(p - vec3(0.0, 0.8, 0.0)) - 0.6


def test_a_safer_slope_does_not_change_shadows():
    """The outline of the shadow is that of the ball, whatever slope its author declares."""
    lights = [DistantLight((0.5, 1.0, 0.3), angle=0.1)]
    pictures = []
    for slope in (1.0, 3.0, 10.0):
        shape = (Plane(y=0.0) | Shape.from_function(ball, slope=slope)).paint("#fff")
        scene = Scene(shape, lights=lights, ambient_occlusion=0.0)
        pictures.append(scene.render(size=(80, 60)).linear[..., 0])
    for safer in pictures[1:]:
        error = np.abs(safer - pictures[0])
        assert np.percentile(error, 97.0) < 0.03
        assert np.sqrt((error**2).mean()) < 0.05
