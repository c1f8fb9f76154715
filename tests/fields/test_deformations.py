"""Deformed shapes hold the places that the deformation takes into them, and no others.

What keeps a deformed field's steps safe (the distance to a box or a drum around it) must neither
show nor hide anything. The maps are written down anew here: where a place was before.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from distal import Box, Rectangle
from distal.fields import extents
from distal.fields.guarantees import Bounds, Bounds2
from tests.fields.trees import Tree

SIZE, MIDDLE = np.array([0.9, 1.1, 0.5]), np.array([0.15, -0.2, 0.1])
CENTER, START, END = (
    np.array([0.7, 0.3, -0.2]),
    np.array([-0.4, 0.1, 0.2]),
    np.array([0.5, 0.6, 0.0]),
)
SHIFT = np.array([0.2, -0.3, 0.7])
Map = Callable[[np.ndarray], np.ndarray]


def turned(p: np.ndarray, angle: Any, first: int, second: int) -> np.ndarray:
    """Turned from the first axis toward the second."""
    q, c, s = p.copy(), np.cos(angle), np.sin(angle)
    q[:, first] = c * p[:, first] - s * p[:, second]
    q[:, second] = s * p[:, first] + c * p[:, second]
    return q


def along(p: np.ndarray) -> np.ndarray:
    """How far on the way from START to END, as a share."""
    way = END - START
    return np.clip((p - START) @ way / (way @ way), 0.0, 1.0)[:, None]


def narrowed(factor: float) -> Map:
    def before(p: np.ndarray) -> np.ndarray:
        scale = 1.0 + (factor - 1.0) * np.clip((p[:, 1] + 0.4) / 0.7, 0.0, 1.0)
        return p / np.stack([scale, np.ones(len(p)), scale], axis=1)

    return before


def drawn(strength: float) -> Map:
    def before(p: np.ndarray) -> np.ndarray:
        away = p - CENTER
        rest = np.maximum(1.0 - (away**2).sum(axis=1, keepdims=True) / 0.8**2, 0.0)
        return p + strength * rest**2 * away

    return before


def brim(p: np.ndarray) -> np.ndarray:
    t = np.clip((np.hypot(p[:, 0], p[:, 2]) - 0.2) / 0.4, 0.0, 1.0)
    return p - np.array([0.0, 0.6, 0.0]) * (t * t * (3.0 - 2.0 * t))[:, None]


def unwrapped(p: np.ndarray) -> np.ndarray:
    x = 0.8 * np.arctan2(p[:, 0], p[:, 2])
    return np.stack([x, p[:, 1], np.hypot(p[:, 0], p[:, 2]) - 0.8], axis=1)


def pulled(p: np.ndarray) -> np.ndarray:
    half = 0.5 * np.array([0.3, 0.0, 0.8])
    return p - np.clip(p, -half, half)


def turned_out(p: np.ndarray) -> np.ndarray:
    square = np.clip((p**2).sum(axis=1, keepdims=True), 0.6**2, 0.8**2)
    return p * 0.8**2 / square


CASES: dict[str, tuple[str, tuple[Any, ...], dict[str, Any], Map]] = {
    "twist": ("twist", (0.9,), {}, lambda p: turned(p, 0.9 * p[:, 1], 0, 2)),
    "bend": ("bend", (0.8,), {}, lambda p: turned(p, -0.8 * p[:, 0], 0, 1)),
    "bend linear": (
        "bend linear", (START, END, SHIFT), {"ease": 0}, lambda p: p - SHIFT * along(p)
    ),
    "bend radial": ("bend radial", (0.2, 0.6, 0.6), {"ease": 1}, brim),
    "taper": ("taper", (-0.4, 0.3, 0.4), {}, narrowed(0.4)),
    "taper wider": ("taper", (-0.4, 0.3, 1.7), {}, narrowed(1.7)),
    "attract": ("attract", (CENTER, 0.8, 0.9), {}, drawn(0.9)),
    "repel": ("repel", (CENTER, 0.8, 0.7), {}, drawn(-0.7)),
    "wrap": ("wrap", (0.8,), {}, unwrapped),
    "elongate": ("elongate", ((0.3, 0.0, 0.8),), {}, pulled),
    "sphere fold": ("sphere fold", (0.6, 0.8), {}, turned_out),
}  # fmt: skip


def same_places(deformed: Any, child: np.ndarray, points: np.ndarray) -> None:
    """Inside where the child is, and outside where it is not; on the surface either may be."""
    value = Tree(deformed.node).evaluate(points, "reference")[0]
    clear = np.abs(child) > 1e-6
    assert clear.sum() > 0.99 * len(points)
    assert (child < 0.0).sum() > 20
    np.testing.assert_array_equal((value < 0.0)[clear], (child < 0.0)[clear])


@pytest.mark.parametrize("case", CASES)
def test_a_deformed_box_is_where_the_map_says(case: str) -> None:
    name, args, numbers, before = CASES[case]
    deformed = Box(tuple(SIZE)).translate(*MIDDLE).apply(name, *args, **numbers)
    points = np.random.default_rng(4).uniform(-1.3, 1.3, (8000, 3))
    child = (np.abs(before(points) - MIDDLE) - 0.5 * SIZE).max(axis=1)
    same_places(deformed, child, points)


@pytest.mark.parametrize("case", ["bend", "elongate"])
def test_a_deformed_rectangle_is_where_the_map_says(case: str) -> None:
    def before(p: np.ndarray) -> np.ndarray:
        if case == "bend":
            return turned(p, -0.8 * p[:, 0], 0, 1)
        return p - np.clip(p, (-0.15, 0.0), (0.15, 0.0))

    args = {"bend": (0.8,), "elongate": ((0.3, 0.0),)}[case]
    child = Rectangle(tuple(SIZE[:2])).translate(*MIDDLE[:2])
    points = np.random.default_rng(4).uniform(-1.6, 1.6, (4000, 2))
    wanted = (np.abs(before(points) - MIDDLE[:2]) - 0.5 * SIZE[:2]).max(axis=1)
    same_places(child.apply(f"flat {case}", *args), wanted, points)


# Distances to boxes and drums, by the nearest point outside and the nearest side inside


@pytest.mark.parametrize("size", [3, 2])
def test_the_distance_to_a_box(size: int) -> None:
    low, high = np.array([-0.7, -0.2, 0.1])[:size], np.array([0.3, 0.9, 0.8])[:size]
    p = np.random.default_rng(6).uniform(-1.5, 1.5, (2000, size))
    outside = np.linalg.norm(p - np.clip(p, low, high), axis=1)
    inside = np.minimum(p - low, high - p).min(axis=1)
    wanted = np.where(outside > 0.0, outside, -inside)
    distance, box = [(extents.rectangle_distance, Bounds2), (extents.box_distance, Bounds)][
        size - 2
    ]
    found = distance(p, box(tuple(low), tuple(high)))
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    assert (wanted < 0.0).sum() > 20


def test_the_distance_to_a_drum_is_that_to_its_section() -> None:
    p = np.random.default_rng(7).uniform(-1.5, 1.5, (2000, 3))
    across = np.hypot(p[:, 0], p[:, 2])
    section = Bounds2((-0.6, -0.2), (0.6, 0.9))
    wanted = extents.rectangle_distance(np.stack([across, p[:, 1]], axis=1), section)
    found = extents.drum_distance(across, p[:, 1], 0.6, -0.2, 0.9)
    # The section's other side is the axis: inside, only the rim and the ends are near.
    np.testing.assert_allclose(found, wanted, atol=1e-12)
