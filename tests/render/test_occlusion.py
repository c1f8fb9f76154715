"""Ambient occlusion against many rays, where the distance to the walls is a formula.

A ray of the hemisphere that meets a wall after the share s of the reach loses 1 - s of its light;
directions count by the cosine. The rays are counted in NumPy, without fields.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import distal
from distal import AmbientLight, Box, Camera, DistantLight, Plane, Scene, Shape, Sphere
from distal.lang import func, length, max, min, normalize, vec3
from distal.lang.runtime_access import executor
from distal.render import shade

REACH = 0.4


def asked(function: Any, *args: Any) -> Any:
    return executor().call(function, args, {}, device="reference")


def hemisphere(count: int = 4096) -> Any:
    """Directions about y, as dense as the cosine."""
    k = np.arange(count)
    across = np.sqrt((k + 0.5) / count)
    angle = 2.399963 * k
    return np.stack([across * np.cos(angle), np.sqrt(1 - across**2), across * np.sin(angle)], 1)


def left_open(distances: Any, reach: float) -> float:
    """What rays leave open that meet a wall at these distances; infinite for none."""
    return float(1.0 - np.clip(1.0 - distances / reach, 0.0, 1.0).mean())


@func
def wall(p: vec3, height: float) -> float:
    outside = length(vec3(max(p.x, 0.0), max(p.y - height, 0.0), 0.0))
    return outside + min(max(p.x, p.y - height), 0.0)


@func
def beside_a_wall(at: vec3, reach: float, scale: float) -> float:
    """On a floor, ``at.x`` from a wall that is ``at.y`` high; values times a scale."""
    return shade.ambient_occlusion(
        lambda p: scale * min(p.y, wall(p, at.y)),
        vec3(at.x, 0.001, 0.0),
        vec3(0.0, 1.0, 0.0),
        reach,
        scale,
    )


@func
def in_a_corner(at: vec3, reach: float) -> float:
    """On a floor, ``at.x`` and ``at.z`` from two walls."""
    return shade.ambient_occlusion(
        lambda p: min(p.y, min(p.x, p.z)),
        vec3(at.x, 0.001, at.z),
        vec3(0.0, 1.0, 0.0),
        reach,
        1.0,
    )


@func
def on_a_slope(n: vec3, reach: float, slope: float) -> float:
    """On a plane of any direction whose field grows by ``slope``."""
    m = normalize(n)
    return shade.ambient_occlusion(
        lambda p: slope * (m.x * p.x + m.y * p.y + m.z * p.z), 0.002 * m, m, reach, slope
    )


def test_a_plane_is_fully_open():
    rng = np.random.default_rng(5)
    normals = rng.normal(size=(200, 3))
    for slope in (0.3, 1.0, 4.0):
        assert np.all(asked(on_a_slope, normals, 0.7, slope) == 1.0)


def test_a_wall_of_any_height_hides_what_rays_count():
    """The mean error of 40 places is at most the prototype's in a corner."""
    rays = hemisphere()
    places = [(x, h, 0.0) for x in np.linspace(0.03, 0.45, 8) for h in (0.05, 0.15, 0.3, 0.6, 5.0)]
    expected = []
    for x, height, _ in places:
        with np.errstate(divide="ignore"):
            t = np.where(rays[:, 0] < 0, -x / rays[:, 0], np.inf)
        expected.append(left_open(np.where(t * rays[:, 1] < height, t, np.inf), REACH))
    found = asked(beside_a_wall, np.array(places), REACH, 1.0)
    error = found - expected
    assert np.sqrt((error**2).mean()) < 0.035
    assert np.abs(error).max() < 0.1
    steep = asked(beside_a_wall, np.array(places), REACH, 5.0)
    assert steep == pytest.approx(found, abs=1e-6), "the field's slope does not count"


def test_a_corner_hides_what_rays_count():
    rays = hemisphere()
    places = [(x, 0.0, z) for x in (0.05, 0.15, 0.3, 0.6) for z in (0.05, 0.15, 0.3, 0.6)]
    expected = []
    for x, _, z in places:
        with np.errstate(divide="ignore"):
            walls = [np.where(rays[:, i] < 0, -d / rays[:, i], np.inf) for i, d in ((0, x), (2, z))]
        expected.append(left_open(np.minimum(*walls), REACH))
    error = asked(in_a_corner, np.array(places), REACH) - expected
    assert np.sqrt((error**2).mean()) < 0.04


AROUND = {"lights": [AmbientLight(1.0)], "background": (0.0, 0.0, 0.0), "ambient_occlusion": 0.4}


def rendered(shape):
    camera = Camera((2.2, 1.9, 3.0), (0.0, 0.4, 0.0))
    return Scene(shape.paint("#fff"), camera=camera, **AROUND).render(size=(64, 48)).linear[..., 0]


def test_a_steep_shape_far_away_darkens_nothing():
    """A box twisted 40 away has a slope of 60; the floor was 0.44 of its light."""
    here = Plane(y=0.0) | Sphere(0.6).translate(y=0.6)
    far_away = Box((1.0, 3.0, 1.0)).twist(1.6).translate(40.0, 3.0, 0.0)
    error = np.abs(rendered(here | far_away) - rendered(here))
    assert np.percentile(error, 98.0) < 2e-3  # the others are at the ball's outline
    assert error.max() < 0.1
    floor = rendered(Plane(y=0.0) | far_away)
    assert floor[-1].min() > 0.999


@func
def ball(p: vec3) -> float:
    return length(p - vec3(0.0, 0.6, 0.0)) - 0.6


def test_a_safer_slope_does_not_change_occlusion():
    pictures = [
        rendered(Plane(y=0.0) | Shape.from_function(ball, slope=k)) for k in (1.0, 3.0, 10.0)
    ]
    for safer in pictures[1:]:
        error = np.abs(safer - pictures[0])
        assert np.percentile(error, 98.0) < 0.01
        assert np.sqrt((error**2).mean()) < 0.02


@pytest.mark.parametrize("ambient", [True, False])
def test_occlusion_is_not_computed_where_there_is_no_ambient_light(ambient):
    lights = [DistantLight((0.3, 0.8, 0.5)), *[AmbientLight(0.3)] * ambient]
    text = distal.compile(Scene(Sphere(1.0) | Plane(y=-1.0), lights=lights)).text
    assert ("ambient_occlusion_union" in text) is ambient
