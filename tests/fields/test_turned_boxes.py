"""Boxes of what is turned, combined and turned again: true, and as tight as if turned once."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from distal.scene.objects.shapes import Box, Cylinder, Sphere

TURN = math.pi / 4.0
PAIR = Box(10, 2, 3) | Box(2, 8, 2).translate(3, 1, 0)


def box_of(shape):
    return np.array(shape.bounds())


def turned(points, *turns):
    """Points after turns (axis, angle)."""
    found = np.array(points, float)
    for axis, angle in turns:
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        a, b = found[:, i].copy(), found[:, j].copy()
        found[:, i] = math.cos(angle) * a - math.sin(angle) * b
        found[:, j] = math.sin(angle) * a + math.cos(angle) * b
    return found


def corners_of(size, middle=(0, 0, 0)):
    signs = itertools.product((-0.5, 0.5), repeat=3)
    return [tuple(m + s * a for m, s, a in zip(middle, sign, size, strict=True)) for sign in signs]


def test_a_box_turned_there_and_back_is_as_large_as_before():
    shape = Box(10, 10, 4).rotate(z=TURN).rotate(z=-TURN)
    assert np.allclose(box_of(shape), [(-5, -5, -2), (5, 5, 2)], atol=1e-5)


@pytest.mark.parametrize("angle", [0.3, TURN, 1.2, 2.5])
def test_turned_unions_have_the_box_of_their_corners(angle):
    shape = PAIR.rotate(x=angle).translate(0, 7, 0).rotate(y=0.4)
    corners = [*corners_of((10, 2, 3)), *corners_of((2, 8, 2), (3, 1, 0))]
    once = np.add(turned(corners, ("x", angle)), (0, 7, 0))
    twice = turned(once, ("y", 0.4))
    expected = [twice.min(axis=0), twice.max(axis=0)]
    assert np.allclose(box_of(shape), expected, atol=1e-4)


def test_a_scale_below_a_turn_counts():
    shape = (Box(2, 4, 6) | Box(1, 1, 1)).scale(2.5).translate(1, 0, 0).rotate(z=TURN)
    corners = turned(corners_of((5, 10, 15), (1, 0, 0)), ("z", TURN))
    expected = [corners.min(axis=0), corners.max(axis=0)]
    assert np.allclose(box_of(shape), expected, atol=1e-4)


def test_differences_and_intersections_below_turns_stay_as_small_as_they_are():
    half = Box(10, 4, 4) & Box(10, 4, 4).rotate(z=2.0).rotate(z=-2.0).translate(5, 0, 0)
    less = Box(10, 4, 4) - Sphere(3).translate(5, 0, 0)
    for shape, low_x in ((half, 0.0), (less, -5.0)):
        found = box_of(shape.rotate(y=1.0).rotate(y=-1.0))
        assert np.allclose(found, [(low_x, -2, -2), (5, 2, 2)], atol=1e-4)


def test_turned_intersections_are_cut_along_their_own_axes_and_along_those_above():
    square = Box(2, 2, 2).rotate(z=TURN)  # reaches 1.41 along x, and is cut there by the slab
    slab = Box(1, 10, 10)
    for _ in range(6):  # more than are asked for along two sets of axes: still no larger
        shape = (square & slab).rotate(y=0.5)
        corners = turned(corners_of((1.0, 2.0 * math.sqrt(2.0), 2.0)), ("y", 0.5))
        assert np.allclose(box_of(shape), [corners.min(axis=0), corners.max(axis=0)], atol=1e-4)
        square = square.rotate(y=0.5).rotate(y=-0.5) & Box(9, 9, 9)


def test_a_turned_rounded_box_is_rounded_once():
    shape = Box(10, 10, 4).round(1.0).rotate(z=TURN)
    reach = 5.0 * math.sqrt(2.0) + 1.0
    assert np.allclose(box_of(shape), [(-reach, -reach, -3), (reach, reach, 3)], atol=1e-4)


def test_a_scale_above_a_round_enlarges_it_too():
    shape = Box(10, 10, 4).round(1.0).rotate(z=TURN).scale(3.0)
    reach = 3.0 * (5.0 * math.sqrt(2.0) + 1.0)
    assert np.allclose(box_of(shape), [(-reach, -reach, -9), (reach, reach, 9)], atol=1e-4)


def test_what_no_box_along_other_axes_is_known_of_is_turned_as_a_box():
    twisted = Box(4, 10, 4).twist(0.2)
    once = box_of(twisted.rotate(z=TURN))
    assert np.allclose(box_of((twisted | Sphere(0.1)).rotate(z=TURN)), once, atol=1e-4)


def test_endless_sides_stay_endless():
    low, high = box_of((Box(2, math.inf, 2) | Sphere(0.5)).rotate(y=TURN).rotate(y=-TURN))
    assert np.isinf([low[1], high[1]]).all()
    assert np.allclose([low[[0, 2]], high[[0, 2]]], [(-1, -1), (1, 1)], atol=1e-4)


@pytest.mark.parametrize("seed", range(24))
def test_random_turned_trees_are_within_their_boxes(seed):
    rng = np.random.default_rng(seed)

    def part():
        size, kind = rng.uniform(0.3, 2.0, 3), rng.integers(3)
        made = (Box(*size), Cylinder(size[0], size[1]), Sphere(size[0]))[kind]
        return moved(made)

    def moved(made):
        axis = "xyz"[rng.integers(3)]
        made = made.translate(*rng.uniform(-1, 1, 3)).rotate(**{axis: rng.uniform(-3, 3)})
        return made.scale(rng.uniform(0.5, 2.0)) if rng.random() < 0.3 else made

    def joined(a, b):
        if rng.random() < 0.2:
            return a.union(b, smooth=0.2)
        return (a | b, a - b, (a | b).round(0.1), (a & b) | a)[rng.integers(4)]

    shape = part()
    for _ in range(4):
        shape = moved(joined(shape, part()))
    low, high = box_of(shape)
    points = rng.uniform(low - 1.0, high + 1.0, (40_000, 3))
    inside = points[np.asarray(shape(points)) <= 0.0]
    assert len(inside) > 20
    assert (inside >= low - 1e-4).all() and (inside <= high + 1e-4).all()
