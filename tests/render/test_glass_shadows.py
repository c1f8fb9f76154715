"""Shadows of glass in direct light: what a straight way through it leaves of a light."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Cylinder, DistantLight, Plane, PointLight, Sphere, glass, matte
from tests.optics.looking import seen

WHITE = (1.0, 1.0, 1.0)
FLOOR = Plane().paint(matte(WHITE))
EYE = {"position": (3, 1, 0), "target": (0, 0, 0)}
PLAIN = {"background": (0, 0, 0), "floor": False, "ambient_occlusion": 0.0}


def on_floor(shape, lights=None):
    above = DistantLight((0, 1, 0)) if lights is None else lights
    return seen(FLOOR | shape, lights=[above], **EYE, **PLAIN)


def pane(thickness, absorption):
    clear = glass(absorption=absorption)
    return Box((2, thickness, 2)).translate(y=1).paint(clear)


@pytest.mark.parametrize("thickness", [1e-3, 0.1, 0.5])
def test_a_pane_colors_the_light(thickness):
    absorption = np.array([0.1, 1.0, 3.0])
    found = on_floor(pane(thickness, tuple(absorption)))
    assert found == pytest.approx(0.96**2 * np.exp(-absorption * thickness), abs=2e-4)


def test_solids_without_a_chord_are_measured():
    """The hull of a cup: 0.2 of glass above, 0.1 below."""
    cup = (Box((2, 1.0, 2)) - Box((1.9, 0.7, 1.9)).translate(y=-0.05)).translate(y=1.5)
    found = on_floor(cup.paint(glass(absorption=(1.0, 1.0, 1.0))))
    assert found == pytest.approx(0.96**2 * math.exp(-0.3), abs=0.04)


def test_two_solids_multiply():
    both = pane(0.5, (1.0,) * 3) | pane(0.25, (2.0,) * 3).translate(y=1)
    assert on_floor(both) == pytest.approx(0.96**4 * math.exp(-1.0), abs=2e-4)


def test_light_that_is_bent_away_is_lost():
    ball = Sphere(0.5).translate(y=1).paint(glass())
    middle, side = (
        seen(
            FLOOR | ball, (3 + x, 1, 0), (x, 0, 0), lights=[DistantLight((0, 1, 0))], **PLAIN
        ).mean()
        for x in (0.0, 0.4)
    )
    assert middle == pytest.approx(0.96**2, abs=1e-3)
    assert side < 0.6 * middle


def test_glass_behind_the_light_is_not_in_front_of_it():
    lamp = PointLight((0, 0.5, 0), intensity=0.25)
    assert on_floor(pane(0.1, (5.0,) * 3), lamp) == pytest.approx(1.0, abs=1e-3)


def test_opaque_solids_keep_their_shadow():
    disc = Cylinder(0.5, 0.1).translate(y=2).paint(matte(WHITE))
    assert on_floor(pane(0.1, WHITE) | disc).max() < 1e-3


def test_only_glass_has_no_dark_shadow():
    """A scene of glass alone: what is under the glass is glass, too."""
    found = seen(
        pane(0.1, WHITE) | Box((4, 0.1, 4)).paint(glass()),
        lights=[DistantLight((0, 1, 0))],
        **EYE,
        **PLAIN,
    )
    assert np.isfinite(found).all()
