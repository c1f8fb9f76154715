"""Media inside of each other, against closed forms; and priorities that make no sense."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, CompileError, Plane, Scene, Sphere, emissive, glass, matte
from distal.render import media
from tests.optics.looking import seen, upper_half
from tests.paths.test_integrator import WHITE, check, estimate

WIDE = 50.0


def layers(indices, absorptions, thicknesses):
    """What goes straight through layers, with all reflections between them, incoherently.

    Each layer and each face is a pair (through, back); two in a row add up as a geometric series.
    """
    through, back_down, back_up = 1.0, 0.0, 0.0  # of light from above, from above, from below
    for k in range(len(indices) + 1):
        before = 1.0 if k == 0 else indices[k - 1]
        after = 1.0 if k == len(indices) else indices[k]
        face = ((before - after) / (before + after)) ** 2
        series = 1.0 / (1.0 - back_up * face)
        through, back_down, back_up = (
            through * (1 - face) * series,
            back_down + through**2 * face * series,
            face + (1 - face) ** 2 * back_up * series,
        )
        if k < len(indices):
            left = math.exp(-absorptions[k] * thicknesses[k])
            through, back_up = through * left, back_up * left**2
    return through


def slab(top, bottom, material, priority=0):
    thick = top - bottom
    return (
        Box((WIDE, thick, WIDE)).translate(y=bottom + thick / 2).paint(material, priority=priority)
    )


def clear(ior, absorption):
    return glass(ior, absorption=(absorption,) * 3)


def straight_up(shape, spp=128, **scene):
    return estimate(shape, (0.1, -3, 0.2), (0.1, 0, 0.2), spp, background=upper_half, **scene)


WATER = clear(1.33, 0.4)
PANE = clear(1.5, 0.9)


@pytest.mark.parametrize("overlap", [0.001, 0.2])
def test_water_between_panes(overlap):
    """The panes displace the water, however far it reaches into them."""
    water = slab(0.5 + overlap, -0.5 - overlap, WATER, 1)
    shape = slab(0.75, 0.5, PANE, 2) | water | slab(-0.5, -0.75, PANE, 2)
    expected = layers((1.5, 1.33, 1.5), (0.9, 0.4, 0.9), (0.25, 1.0, 0.25))
    check(straight_up(shape), expected, 2e-3)


def test_a_body_inside_of_another():
    shape = slab(0.75, -0.75, PANE) | slab(0.5, -0.5, clear(1.1, 0.2), 1)
    expected = layers((1.5, 1.1, 1.5), (0.9, 0.2, 0.9), (0.25, 1.0, 0.25))
    check(straight_up(shape), expected, 2e-3)


def test_one_of_a_lower_priority_is_not_there():
    shape = slab(0.75, -0.75, PANE) | slab(0.5, -0.5, clear(1.1, 0.2), -1)
    check(straight_up(shape), layers((1.5,), (0.9,), (1.5,)), 2e-3)


def test_a_body_of_the_same_index_is_not_seen():
    shape = Sphere(1.0).paint(glass()) | Sphere(0.6).translate(x=0.2).paint(glass(), priority=1)
    for place in ((0.2, 0.3, 0.0), (-0.5, -0.3, 0.0)):
        both = estimate(shape, (*place[:2], 4), place, background=upper_half)
        one = estimate(Sphere(1.0).paint(glass()), (*place[:2], 4), place, background=upper_half)
        assert both[0] == pytest.approx(one[0], abs=4 * (both[1].max() + one[1].max()) + 1e-4)


def test_an_opaque_solid_inside_of_glass_is_seen():
    """Water over a floor, at its lower side and reaching into it, and the floor in it."""
    lit = emissive(WHITE, 0.5)
    expected = (1 - (0.33 / 2.33) ** 2) * 0.5 * math.exp(-0.4)  # an emissive floor reflects nothing
    for water, floor in (
        (slab(1.0, -0.5, WATER, 1), Plane().paint(lit)),  # the water displaces the floor
        (slab(1.0, -0.5, WATER, -1), Plane().paint(lit)),
        (slab(1.0, -0.5, WATER), Plane().paint(lit, priority=1)),
    ):
        deep = 1.5 if water.node.material.priority == 1 else 1.0
        found = estimate(water | floor, (0.1, 3, 0.2), (0.1, 0, 0.2), 128)
        check(found, expected * math.exp(-0.4 * (deep - 1.0)), 2e-3)


@pytest.mark.parametrize("distance", [0.5, 2.0])
def test_a_camera_in_water_inside_of_glass(distance):
    lamp = Sphere(0.1).translate(x=distance + 0.1).paint(emissive(WHITE, 3.0), priority=3)
    shape = Sphere(8.0).paint(PANE) | Sphere(4.0).paint(WATER, priority=1) | lamp
    found = estimate(shape, (0, 0, 0), (1, 0, 0), 16)
    check(found, 3.0 * math.exp(-0.4 * distance), 1e-3)


def test_direct_light_bends_by_both_media():
    """The direction straight through a nested slab is that of the ray; its place is not."""
    shape = slab(0.75, -0.75, glass(1.5)) | slab(0.5, -0.5, glass(1.2), 1)
    view = {"lights": [], "background": upper_half, "floor": False, "bounces": 24}
    found = seen(shape, (0.1, -3, 0.2), (0.1, 0, 0.2), **view)
    assert found == pytest.approx(layers((1.5, 1.2, 1.5), (0,) * 3, (0.25, 1, 0.25)), abs=5e-3)


def test_bodies_and_parts_belong_together():
    for common in range(4):
        parts = [int(media.part_of(body, common)) for body in range(4)]
        assert parts[common] == -1
        assert len(set(parts)) == 4
        assert [int(media.body_of(part, common)) for part in parts] == [0, 1, 2, 3]
        assert int(media.body_of(7, common)) == common  # a row of its table
    sets = np.array([0, 1, 2, 5, 8, 15])
    assert np.asarray(media.highest(sets, 4)).tolist() == [-1, 0, 1, 2, 3, 3]


def paths_of(shape):
    return Scene(shape, background=(0, 0, 0)).render(size=(8, 8), mode="path", spp=1)


def test_a_blend_is_one_body():
    with pytest.raises(CompileError, match="'Sphere' has priority 2 in a shape of priority 0"):
        paths_of(Box().union(Sphere().paint(glass(), priority=2), smooth=0.1))


def test_too_many_priorities():
    shape = Plane()
    for i in range(9):
        shape = shape | Sphere(0.1).translate(x=i).paint(matte(WHITE), priority=i + 1)
    with pytest.raises(CompileError, match="10 different priorities; 8 are possible"):
        paths_of(shape)


def test_a_priority_is_a_whole_number():
    with pytest.raises(TypeError, match="priority"):
        Sphere().paint(glass(), priority=0.5)


def test_glass_that_stands_on_a_floor_shows_the_floor():
    """At most the two faces of a gap that rounding may find are lost, with all reflections."""
    floor = Plane().paint(emissive(WHITE, 0.5))
    block = Box((2, 1, 2)).translate(y=0.5).paint(glass())
    mean, sigma = estimate(block | floor, (0.1, 3, 0.2), (0.1, 0, 0.2), 64)
    assert 0.5 * layers((1.5,), (0,), (1.0,)) - 4 * sigma.max() <= mean.min()
    assert mean.max() <= 0.5 * 0.96 + 4 * sigma.max()
