"""Solids with soft edges at all exponents: roots of sums of powers, taken with no overflow here."""

from __future__ import annotations

import itertools
from typing import Final

import numpy as np
import pytest

import distal

GOLDEN: Final = (1 + 5**0.5) / 2
CUBE: Final = np.array([(1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)]) / 3**0.5


def cyclic(short, long):
    """The axes (0, short, long) and (0, short, -long), of length 1, and their permutations."""
    axes = [np.roll((0, short, sign * long), n) for sign, n in itertools.product((1, -1), range(3))]
    return np.array(axes) / np.hypot(short, long)


FACES: Final = np.concatenate([CUBE, cyclic(GOLDEN, 1 / GOLDEN)])  # of an icosahedron
VERTICES: Final = cyclic(1, GOLDEN)
# The distance of a truncated octahedron's squares, for hexagons at 1.
SQUARES: Final = 2 / 3**0.5
AXES: Final = {
    "SmoothOctahedron": CUBE,
    "SmoothDodecahedron": VERTICES,
    "SmoothIcosahedron": FACES,
    "SmoothTruncatedOctahedron": np.concatenate([CUBE, np.eye(3) / SQUARES]),
}


def expected(axes, points, exponent):
    """The field of radius 0: the root of the mean power, without overflow."""
    parts = np.abs(points @ axes.T)
    largest = parts.max(axis=1)
    weight = (axes**2).sum() / 3
    rest = ((parts / largest[:, None]) ** exponent).sum(axis=1) / weight
    return largest * rest ** (1 / exponent)


@pytest.mark.parametrize("name", AXES)
def test_any_exponent_gives_the_root_of_the_sum_of_powers(name):
    rng = np.random.default_rng(5)
    points = rng.normal(size=(400, 3)) * 10 ** rng.uniform(-3, 3, (400, 1))
    points[:3] = np.eye(3)
    solid = getattr(distal, name)
    for exponent in (2.0, 24.0, 96.0, 300.0, 2000.0):
        shape = solid(inradius=0.5, exponent=exponent)
        size = np.linalg.norm(points, axis=1) + 0.5
        off = np.abs(shape(points) + 0.5 - expected(AXES[name], points, exponent)) / size
        assert off.max() < 1e-13
        off = np.abs(shape(points.astype(np.float32)) - shape(points)) / size
        assert off.max() < 1e-6
        slopes = np.linalg.norm(shape.gradient(points), axis=1)
        assert slopes.min() > 0.5
        assert slopes.max() < 1 + 1e-9
