"""Mirrors: the part that is shown is the shape's own, and the whole does not change with the group.

Both together say all: every place is taken into the part by some of the mirrors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from distal import Box
from tests.fields.trees import Tree

NORMAL, OFFSET = np.array([0.6, -0.48, 0.64]), 0.2
SECTOR = 2.0 * np.pi / 5.0


def mirror(normal: Any) -> np.ndarray:
    """The matrix of a mirror through the origin."""
    n = np.asarray(normal, np.float64) / np.linalg.norm(normal)
    return np.eye(3) - 2.0 * np.outer(n, n)


def angle(p: np.ndarray) -> np.ndarray:
    """About y, from x toward -z."""
    return np.arctan2(-p[:, 2], p[:, 0])


HALF_SECTOR = (np.sin(0.5 * SECTOR), 0.0, np.cos(0.5 * SECTOR))
CASES: dict[str, tuple[tuple[Any, ...], list[np.ndarray], Callable[[np.ndarray], Any]]] = {
    "mirror": ((tuple(NORMAL), OFFSET), [mirror(NORMAL)], lambda p: p @ NORMAL > OFFSET),
    "symmetry": (
        (True, False, True),
        [mirror((1, 0, 0)), mirror((0, 0, 1))],
        lambda p: (p[:, 0] > 0.0) & (p[:, 2] > 0.0),
    ),
    "mirror diagonal": ((), [mirror((1, 0, -1))], lambda p: p[:, 0] > p[:, 2]),
    "mirror octant": (
        (),
        [mirror((1, 0, 0)), mirror((0, 0, 1)), mirror((1, 0, -1))],
        lambda p: (p[:, 0] > p[:, 2]) & (p[:, 2] > 0.0),
    ),
    "kaleidoscope": (
        (5,),
        [mirror((0, 0, 1)), mirror(HALF_SECTOR)],
        lambda p: (angle(p) > 0.0) & (angle(p) < 0.5 * SECTOR),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_part_is_shown_in_all_mirrors(name: str) -> None:
    args, mirrors, shown = CASES[name]
    child = Box((0.9, 1.1, 0.5)).rotate(x=0.4).translate(0.5, -0.2, -0.3)
    points = np.random.default_rng(2).uniform(-1.5, 1.5, (1500, 3))

    def value(shape: Any, at: np.ndarray) -> np.ndarray:
        return Tree(shape.node).evaluate(at, "reference")[0]

    whole = child.apply(name, *args)
    part = points[shown(points)]
    assert len(part) > 50
    np.testing.assert_allclose(value(whole, part), value(child, part), atol=1e-6)
    here = value(whole, points)
    fixed = OFFSET * NORMAL if name == "mirror" else np.zeros(3)  # a place on all planes
    for matrix in mirrors:
        there = (points - fixed) @ matrix.T + fixed
        np.testing.assert_allclose(value(whole, there), here, atol=1e-6)
