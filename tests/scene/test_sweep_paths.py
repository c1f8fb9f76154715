"""Paths of sweeps: points that repeat, closed paths, paths that turn back on themselves."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, CompileError, Curve, Rectangle
from distal.scene.checks.validation import check

BENT = np.array([(0, 0, 0), (2, 0, 0), (2.3, 1, 0.4), (1, 2, -0.3), (-0.5, 1, 0.3)])
RANDOM = np.random.default_rng(5)


def with_repeats(path: np.ndarray) -> np.ndarray:
    """Repeat some points a few times, now and then changed by as much as rounding does."""
    rows = np.repeat(path, RANDOM.integers(1, 4, len(path)), axis=0)
    return rows + np.where(RANDOM.random(rows.shape) < 0.3, 1e-7, 0.0)


@pytest.mark.parametrize(
    "path",
    [
        [(0, 0, -1), (0, 0, 0), (0, 0, 0), (0, 0, 1)],
        [(0, 0, -1), (0, 0, -1), (0, 0, 1)],
        [(0, 0, -1), (0, 0, 1), (0, 0, 1)],
    ],
)
def test_a_straight_path_with_a_repeated_point_is_a_bar(path):
    bar, swept = Box(1, 1, 2), Rectangle(1, 1).sweep(path)
    p = RANDOM.uniform(-3, 3, (4000, 3))
    assert (np.sign(swept(p)) == np.sign(bar(p))).all()
    assert swept(np.array([[-3.0, 0, 0], [-3, 0, -1], [-3, 0, 1]])) == pytest.approx(2.5)
    assert swept.bounds() == Rectangle(1, 1).sweep([(0, 0, -1), (0, 0, 1)]).bounds()


def test_repeated_points_of_a_bent_path_change_nothing():
    p = RANDOM.uniform(-2, 4, (2000, 3))
    once = Rectangle(0.2, 0.3).sweep(BENT)(p)
    for path in (with_repeats(BENT) for _ in range(6)):
        assert np.abs(Rectangle(0.2, 0.3).sweep(path)(p) - once).max() < 2e-6


def test_a_closed_path_is_a_frame_without_ends():
    corners = [(0, 0, 0), (4, 0, 0), (4, 0, 4), (0, 0, 4)]
    p = RANDOM.uniform(-1, 5, (8000, 3)) * (1.0, 0.2, 1.0)
    away = np.abs(np.abs(p[:, ::2] - 2.0).max(axis=1) - 2.0) - 0.2
    inside = np.maximum(away, np.abs(p[:, 1]) - 0.1) < 0.0
    for first in range(4):
        order = [*corners[first:], *corners[: first + 1]]
        frame = Rectangle(0.4, 0.2).sweep([*order[:2], *order[1:], order[-1]])
        assert ((frame(p) < 0.0) == inside).all()
        assert frame((-0.15, 0.0, -0.15)) == pytest.approx(-0.05)  # a mitre, also at the seam
        assert frame.slope == pytest.approx(1.0)


def test_a_formula_that_stands_still_for_a_while_is_swept():
    halting = Curve.from_function(lambda t: (min(t, 1.0) + max(t - 2.0, 0.0), 0, 0), 0, 3)
    p = RANDOM.uniform((-0.5, -1, -1), (2.5, 1, 1), (500, 3))
    bar = Box(2, 0.4, 0.4).translate(1, 0, 0)
    assert (np.sign(halting.sweep(Rectangle(0.4, 0.4))(p)) == np.sign(bar(p))).all()


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ([(1, 2, 3)] * 4, "this path has no length: its 4 points are all (1, 2, 3)"),
        ([(1, 2, 3)], "this path has no length: its only point is (1, 2, 3)"),
        (
            [(0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 0), (0.5, 0, 0)],
            "this path turns by 180 degrees at point 2, (1, 0, 0); at most 157 are possible",
        ),
        (
            [(0, 0, 0), (1, 0, 0), (0, 0, 0)],
            "this path turns by 180 degrees at point 1, (1, 0, 0); at most 157 are possible",
        ),
        (
            [(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1), (0, 0, 0)],
            "closed path does not meet itself: it comes back turned by -60 degrees",
        ),
    ],
)
def test_a_path_that_cannot_be_swept_is_refused(path, message):
    with pytest.raises(CompileError) as error:
        Rectangle(0.2, 0.1).sweep(path)
    assert message in str(error.value) and "test_sweep_paths.py" in str(error.value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Box(1, 1, 1).translate(-3, 0, 0).symmetry("x"), "is empty: its box has no volume"),
        (lambda: Rectangle(1, 1).translate(-3, 0).revolve(), "is empty: its box has no volume"),
        (lambda: Box(1, 1, 1) & Box(1, 1, 1).translate(9, 0, 0), "is empty: its box has no volume"),
        (lambda: Rectangle(1, 1).translate(-3, 0).symmetry("x"), "is empty: its box has no area"),
    ],
)
def test_a_check_says_what_keeps_nothing(make, message):
    said = [f.diagnostic.message for f in check(make()).findings]
    assert any(message in text for text in said)
    assert not any("is empty" in f.diagnostic.message for f in check(Box(1, 1, 1)).findings)
