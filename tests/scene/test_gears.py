"""Gears have involute flanks, and pairs turn without overlapping by more than their backlash."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal.lang.runtime_access import executor

ANGLE = math.radians(20.0)


def values(shape, points):
    return np.asarray(executor().call(shape, (np.asarray(points, float),), {}, device="reference"))


def grid(middle, half, count=90):
    axes = [np.linspace(m - h, m + h, count) for m, h in zip(middle, half, strict=True)]
    flat = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.concatenate([flat, np.zeros((len(flat), 1))], axis=1)


def involute(teeth, module, backlash, roll):
    """A point of the right flank of the tooth at +y: where a string of length base * roll ends."""
    radius = 0.5 * module * teeth
    base = radius * math.cos(ANGLE)
    half = 0.5 * math.pi / teeth - 0.5 * backlash / radius + math.tan(ANGLE) - ANGLE
    at = half - roll + math.atan(roll)
    out = base * math.sqrt(1.0 + roll * roll)
    return [out * math.sin(at), out * math.cos(at), 0.0]


@pytest.mark.parametrize(("teeth", "module", "backlash"), [(20, 1.0, 0.0), (33, 2.5, 0.2)])
def test_flanks_are_involutes(teeth, module, backlash):
    gear = distal.Gear(module, teeth, 6.0, backlash=backlash)
    # from a little above the base circle to a little below the tip
    tip = math.sqrt(((1.0 + 2.0 / teeth) / math.cos(ANGLE)) ** 2 - 1.0)
    flank = [involute(teeth, module, backlash, r) for r in np.linspace(0.1, tip - 0.02, 12)]
    assert values(gear, flank) == pytest.approx(0.0, abs=1e-5 * module)
    # the normals of the flank, and of curves beside it, touch the base circle
    beside = np.array(flank) + np.array([0.01 * module, 0.0, 0.0])
    normals = np.asarray(executor().call(gear._gradient, (beside,), {}, device="reference"))
    reach = np.abs(np.cross(normals, beside)[:, 2])
    assert reach == pytest.approx(0.5 * module * teeth * math.cos(ANGLE), rel=2e-5)


def test_a_gear_has_its_radii():
    gear = distal.Gear(2.0, 20, 6.0, bore_diameter=8.0)
    # On the axis of a tooth, of a gap, in the bore; and the two ends.
    gap = np.array([math.sin(math.pi / 20), math.cos(math.pi / 20), 0.0])
    points = [[0.0, 23.0, 0.0], 18.0 * gap, [0.0, 3.0, 0.0], [0.0, 15.0, 4.0]]
    assert values(gear, points) == pytest.approx([1.0, 0.5, 1.0, 1.0], abs=1e-5)
    assert gear.pitch_radius == 20.0


PAIRS = [
    (lambda: distal.Gear(1.0, 20), lambda: distal.Gear(1.0, 41), (10.0, 0.0)),
    (lambda: distal.Gear(1.0, 18), lambda: distal.Gear(1.0, 19), (9.0, 0.0)),
    (lambda: distal.Gear(1.0, 25), lambda: distal.RingGear(1.0, 61), (12.5, 0.0)),
    (lambda: distal.Gear(1.0, 20), lambda: distal.Rack(1.0, 12), (0.0, -10.0)),
    (lambda: distal.Gear(1.0, 30), lambda: distal.Rack(1.0, 13), (0.0, -15.0)),
]


@pytest.mark.parametrize(("first", "second", "contact"), PAIRS)
def test_a_pair_turns_without_overlap_and_without_a_gap(first, second, contact):
    """Without backlash the flanks touch at every angle: nowhere are both inside."""
    half = (2.3, 5.0) if contact[1] == 0.0 else (5.0, 2.3)
    points = grid(contact, half)
    for turn in np.linspace(0.0, math.tau / first().teeth, 5) + 0.03:
        one, other = distal.mesh_gears(first(), second(), float(turn))
        both = np.maximum(values(one, points), values(other, points))
        assert both.min() > -2e-5
        assert both.min() < 0.02


@pytest.mark.parametrize(("first", "second", "contact"), PAIRS[:1] + PAIRS[2:4])
def test_a_pair_with_backlash_keeps_half_of_it_on_either_side(first, second, contact):
    """The second, turned by nearly the whole backlash either way, still does not overlap."""
    backlash = 0.1
    thin = [type(g())(1.0, g().teeth, backlash=backlash) for g in (first, second)]
    half = (2.3, 5.0) if contact[1] == 0.0 else (5.0, 2.3)
    points = grid(contact, half)
    one, other = distal.mesh_gears(*thin, 0.4)
    along = (lambda s, by: s.translate(by, 0.0, 0.0)) if contact[0] == 0.0 else None
    for share, free in ((0.97, True), (-0.97, True), (1.3, False), (-1.3, False)):
        by = share * backlash  # half of each tooth's backlash on either side, of two gears
        if along is not None:
            moved = along(other, by)
        else:  # turn the first instead, about its own axis
            moved, by = other, by / thin[0].pitch_radius
        turned = one if along is not None else one.rotate(z=by)
        both = np.maximum(values(turned, points), values(moved, points))
        assert (both.min() > -2e-5) == free, share


def test_helical_gears_mesh_in_every_plane():
    first, second = distal.Gear(1.0, 20, helix=0.3), distal.Gear(1.0, 30, helix=-0.3)
    one, other = distal.mesh_gears(first, second, 0.2)
    points = grid((10.0, 0.0), (2.3, 5.0))
    for z in (-2.9, 0.0, 1.7):
        points[:, 2] = z
        both = np.maximum(values(one, points), values(other, points))
        assert -2e-5 < both.min() < 0.02


MISTAKES = [
    (lambda: distal.mesh_gears(distal.Gear(1.0, 20), distal.Gear(2.0, 20)), "one module"),
    (lambda: distal.mesh_gears(distal.Gear(1.0, 12), distal.Rack()), "cut into the feet"),
    (lambda: distal.mesh_gears(distal.Gear(1.0, 55), distal.RingGear()), "10 teeth less"),
    (lambda: distal.mesh_gears(distal.Gear(helix=0.2), distal.Gear(helix=0.2)), "helix=-0.2"),
    (lambda: distal.mesh_gears(distal.Gear(), distal.Sphere()), "takes a Gear"),
    (lambda: distal.Gear(distal.time), "a plain number"),
    (lambda: distal.Gear(1.0, 3), "count must be 4 or more"),
    (lambda: distal.Gear(1.0, 20, backlash=1.7), "teeth come to points"),
    (lambda: distal.Gear(0.0), "module of Gear must be above 0"),
    (lambda: distal.Gear(1.0, 8.5), "teeth of Gear is a whole number"),
    (lambda: distal.Gear(helix=30), "between -60 and 60 degrees"),
    (lambda: distal.Rack(1.0, 5, pressure_angle=0.7), "come to points"),
]


@pytest.mark.parametrize(("make", "message"), MISTAKES)
def test_mistakes_are_named(make, message):
    with pytest.raises((ValueError, TypeError)) as caught:
        make()
    assert message in str(caught.value)
    assert "test_gears.py" in str(caught.value)
