"""Panes of glass against Fresnel's formulas, Snell's law and Beer's law with inner reflections.

Panes as thin as a hundred-thousandth of their distance, next to each other, next to a floor, and
around the camera.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Plane, Sphere, emissive, glass
from tests.optics.looking import bent, clear, fresnel, seen, through_ball, unit, way_seen

WHITE = (1.0, 1.0, 1.0)
BOUNCES = 8


def pane(thickness, depth=0.0, **look):
    """A pane that faces +z; ``depth`` is the optical depth of its thickness."""
    coefficient = depth / thickness
    painted = glass(absorption=(coefficient,) * 3, **look)
    return Box(400.0, 400.0, thickness).translate(z=-0.5 * thickness).paint(painted)


def left_by_a_pane(angle, depth, ior=1.5):
    """What a pane before even light lets through or mirrors, by rays of at most 8 bounces."""
    mirrored = fresnel(angle, 1.0, ior)
    along = math.exp(-depth / math.sqrt(1.0 - (math.sin(angle) / ior) ** 2))
    inside, total = (1.0 - mirrored) * along, mirrored
    for _ in range(1, BOUNCES):
        total += inside * (1.0 - mirrored)
        inside *= mirrored * along
    return total


def toward(angle):
    return np.array([math.sin(angle), 0.0, -math.cos(angle)])


@pytest.mark.parametrize(
    ("distance", "thickness", "allowed"),
    [
        (5.0, 0.1, 3e-3),
        (5.0, 0.004, 3e-3),
        (5.0, 0.0005, 3e-3),
        (5.0, 0.0001, 3e-3),
        (50.0, 0.004, 3e-3),
        # 32 bits: a place 50 away is known to 4e-6.
        (50.0, 0.0005, 1e-2),
    ],
)
def test_a_pane_absorbs_and_mirrors_by_its_thickness(distance, thickness, allowed):
    for angle in (0.0, 0.9, 1.3):
        found = seen(
            pane(thickness, 0.7),
            -distance * toward(angle),
            (0, 0, 0),
            background=WHITE,
            bounces=BOUNCES,
        )
        assert found == pytest.approx([left_by_a_pane(angle, 0.7)] * 3, abs=allowed), angle


@pytest.mark.parametrize("thickness", [0.0005, 0.004, 0.1])
@pytest.mark.parametrize("angle", [0.0, 0.6, 1.2])
def test_a_ray_leaves_a_pane_as_it_came(thickness, angle):
    thin = Box(400.0, 400.0, thickness).paint(clear(1.5))
    found = way_seen(thin, -15.0 * toward(angle), (0, 0, 0))
    assert found == pytest.approx(toward(angle), abs=2e-3)


@pytest.mark.parametrize("thickness", [0.02, 0.5])
def test_a_pane_moves_a_ray_aside_by_snell(thickness):
    """The wall behind it is seen up to its edge, where the moved ray passes it."""
    angle = 0.9
    way = toward(angle)
    inside = math.asin(math.sin(angle) / 1.5)
    aside = thickness * (math.tan(angle) - math.tan(inside))  # at the back of the pane, along x
    back = Box(400.0, 400.0, thickness).translate(z=-0.5 * thickness).paint(clear(1.5))
    edge = (1.0 + thickness) * math.tan(angle) - aside  # where the ray through the origin ends
    for beyond, light in ((0.03 * thickness, 1.0), (-0.03 * thickness, 0.0)):
        wall = Box(50.0, 50.0, 1.0).translate(edge + beyond - 25.0, 0.0, -1.5 - thickness)
        found = seen(back | wall.paint(emissive("#fff")), -5.0 * way, (0, 0, 0))
        assert found == pytest.approx([light] * 3, abs=0.02), beyond


def test_two_panes_one_behind_the_other():
    """Double glazing of 4 mm with a gap of 2 mm, seen from 5: four faces of Fresnel's share."""
    both = pane(0.004, 0.2) | pane(0.004, 0.2).translate(z=-0.006)
    r = fresnel(0.0, 1.0, 1.5)
    a = math.exp(-0.2)
    one = (1.0 - r) ** 2 * a / (1.0 - (r * a) ** 2)
    back = r + (1.0 - r) ** 2 * a**2 * r / (1.0 - (r * a) ** 2)
    # All light that both let through or mirror to the eye.
    expected = back + one**2 / (1.0 - back**2) + one**2 * back / (1.0 - back**2)
    found = seen(both, (0, 0, 5), (0, 0, 0), background=WHITE, bounces=12)
    assert found == pytest.approx([expected] * 3, abs=0.02)


def test_a_pane_just_above_a_floor_shows_the_floor():
    """4 mm of glass, .1 mm above the floor, seen from 5 m."""
    floor = Plane(y=0.0).paint(emissive((0.5, 0.5, 0.5)))
    sheet = Box(4.0, 0.004, 4.0).translate(y=0.0021).paint(clear(1.5))
    found = seen(floor | sheet, (0.3, 5.0, 0.2), (0.1, 0.0, 0.1))
    assert found == pytest.approx([0.5] * 3, abs=0.01)


def test_from_inside_glass_light_is_absorbed_up_to_its_side():
    block = Sphere(2.0).paint(clear(1.5, absorption=(0.3, 0.3, 0.3)))
    found = seen(block, (0.0, 0.0, 0.5), (0.0, 0.0, -2.0), background=WHITE)
    assert found == pytest.approx([math.exp(-0.3 * 2.5)] * 3, abs=3e-3)
    way = unit(0.3, 0.1, -1.0)
    origin = np.array([0.0, 0.0, 0.5])
    t = -(origin @ way) + math.sqrt((origin @ way) ** 2 + 4.0 - 0.25)
    place = origin + t * way
    expected = bent(way, -place / 2.0, 1.5, 1.0)
    assert way_seen(Sphere(2.0).paint(clear(1.5)), tuple(origin), tuple(place)) == pytest.approx(
        expected, abs=3e-3
    )


def test_a_far_ball_of_glass_as_small_as_a_bead_bends_as_snell_says():
    for radius, distance in ((0.02, 5.0), (0.002, 5.0)):
        height = 0.4 * radius
        origin = np.array([0.0, height, distance])
        _, expected = through_ball(origin, np.array([0.0, 0.0, -1.0]), radius, 1.5)
        found = way_seen(Sphere(radius).paint(clear(1.5)), tuple(origin), (0.0, height, 0.0))
        assert found == pytest.approx(expected, abs=0.01), radius


def test_no_ray_is_lost_in_a_pane_at_any_angle():
    """Before even light clear glass is not there: every ray that enters comes out."""
    lost = []
    for angle in np.linspace(0.0, 1.4, 5):
        found = seen(
            Box(400.0, 400.0, 0.002).paint(glass()),
            -7.0 * toward(float(angle)),
            (0, 0, 0),
            background=WHITE,
            bounces=12,
        )
        lost.append(1.0 - float(found[0]))
    assert max(lost) < 0.02
