"""Fog and occlusion in whole scenes: each leg of a ray's way by its own length.

Of what a leg shows exp(-density * its length) is left and the rest is fog; what lies behind a
mirror or a pane comes through the fog of all legs before. Inside glass there is no fog, and what a
ray sees that meets nothing is behind no fog of its own.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import AmbientLight, Box, DistantLight, Material, Plane, emissive, mirror
from distal.lang import func, min, vec3
from distal.render import shade
from tests.optics.looking import clear, seen, unit

FOG = np.array([0.7, 0.2, 0.4])
DENSITY = 0.3
LAMP = np.array([0.9, 1.6, 0.3])
TINT = np.array([0.8, 0.5, 0.9])
FAR_GLASS = Box(0.1, 0.1, 0.1).translate(40.0, 40.0, 40.0).paint(clear(1.5))


def through(light, length):
    """A light seen through fog."""
    left = math.exp(-DENSITY * length)
    return left * np.asarray(light) + (1.0 - left) * FOG


def left_after(length):
    return math.exp(-DENSITY * length)


def foggy(shape, position, target, **scene):
    return seen(shape, position, target, fog=tuple(FOG), fog_density=DENSITY, **scene)


# A ray comes down on a mirror 2.5 away and goes up to a lamp's wall 4 away, or to the sky.
DOWN = unit(0.6, -0.8, 0.0)
MIRROR = Plane(y=0.0).paint(mirror(tuple(TINT)))
EYE = tuple(-2.5 * DOWN)
WALL = Box(1.0, 40.0, 40.0).translate(x=2.4 + 0.5)  # its near side at x = 2.4: 4 along the ray
HALF = np.array([0.5, 0.7, 0.6])
SHINING_MIRROR = Material(
    color=tuple(HALF), diffuse=0.0, specular=1.0, metal=1.0, emission=tuple(LAMP)
)
MIRRORS = MIRROR | WALL.paint(SHINING_MIRROR)
SKY = np.array([0.3, 0.9, 0.6])


@pytest.mark.parametrize("glass", [False, True])
def test_what_mirrors_show_is_behind_the_fog_of_all_legs_before(glass):
    """Down to the floor, to the wall, which shines and mirrors, and back to the left: to the sky.

    The floor's own light is black: of the first leg only fog is seen.
    """
    shape = MIRRORS | FAR_GLASS if glass else MIRRORS
    found = foggy(shape, EYE, (0, 0, 0), background=tuple(SKY))
    expected = through((0, 0, 0), 2.5) + left_after(2.5) * TINT * through(LAMP, 4.0)
    expected = expected + left_after(6.5) * TINT * HALF * SKY
    assert found == pytest.approx(expected, rel=2e-3)
    up = foggy(shape, EYE, (-4.0, 4.0, 0.0), background=tuple(SKY))
    assert up == pytest.approx(SKY, rel=1e-5), "nothing is before a background"


def test_fog_before_a_pane_and_behind_it_but_not_within():
    """An index of 1: straight on through 1.5 of an absorbing pane to a lamp 3 behind it."""
    absorbs = np.array([0.2, 0.7, 0.4])
    pane = Box(20.0, 20.0, 1.5).translate(z=-0.75).paint(clear(1.0, absorption=tuple(absorbs)))
    lamp = Box(20.0, 20.0, 1.0).translate(z=-5.0)
    shape = pane | lamp.paint(emissive(tuple(LAMP / LAMP.max()), strength=float(LAMP.max())))
    found = foggy(shape, (0, 0, 2.0), (0, 0, 0))
    expected = through((0, 0, 0), 2.0) + left_after(2.0) * np.exp(-1.5 * absorbs) * through(
        LAMP, 3.0
    )
    assert found == pytest.approx(expected, rel=2e-3)


# Occlusion: a floor beside a wall; ``tests/render/test_occlusion`` has the formula.

WHITE = Plane(y=0.0).paint("#fff")
BLACK_WALL = Box(1.0, 40.0, 40.0).paint("#000")


@func
def open_beside(wall: float, reach: float) -> float:
    return shade.ambient_occlusion(
        lambda p: min(p.y, wall - p.x), vec3(0.0), vec3(0.0, 1.0, 0.0), reach, 1.0
    )


@pytest.mark.parametrize(("wall", "reach"), [(0.1, 0.5), (0.3, 1.2), (2.0, 1.2), (0.9, 0.0)])
def test_a_wall_hides_ambient_light_within_reach_and_no_other(wall, reach):
    """The sun's share stays; ambient light of 0.6 is occluded."""
    shape = WHITE | BLACK_WALL.translate(x=0.5 + wall)
    lights = [AmbientLight(0.6), DistantLight((0.0, 0.8, 0.6), 0.5)]
    look = {"position": (-1.0, 2.0, 0.5), "target": (0.0, 0.0, 0.0), "lights": lights}
    found = seen(shape, **look, ambient_occlusion=reach)
    share = open_beside(wall, reach) if reach else 1.0
    assert found == pytest.approx([0.6 * share + 0.5 * 0.8] * 3, abs=3e-3)
    assert reach <= wall or share < 0.99
