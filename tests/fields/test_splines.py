"""Splines against the parabolas that they are said to be: many points on them are the oracle."""

from __future__ import annotations

import numpy as np
import pytest

from distal import SplinePath

POINTS = np.array([(-1.0, -0.3), (-0.2, 0.6), (0.4, -0.5), (1.1, 0.2), (0.9, 0.9)])
T = np.linspace(0.0, 1.0, 400)[:, None]


def velocities(points: np.ndarray, closed: bool) -> np.ndarray:
    """Catmull and Rom: half the way between the neighbors; at an end, to the only one."""
    if closed:
        return 0.5 * (np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0))
    return np.gradient(points, axis=0)


def parabolas(points: np.ndarray, closed: bool) -> np.ndarray:
    """Two for each piece, with the velocities at its ends: their controls are a quarter away."""
    v = velocities(points, closed)
    found = []
    for i in range(len(points) if closed else len(points) - 1):
        j = (i + 1) % len(points)
        first, second = points[i] + 0.25 * v[i], points[j] - 0.25 * v[j]
        join = 0.5 * (first + second)
        for a, b, c in ((points[i], first, join), (join, second, points[j])):
            found.append((1 - T) ** 2 * a + 2 * T * (1 - T) * b + T**2 * c)
    return np.concatenate(found)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("count", [2, 3, 5])
def test_a_spline_is_its_parabolas(count: int, closed: bool) -> None:
    curve = parabolas(POINTS[:count], closed)
    spline = SplinePath([tuple(p) for p in POINTS[:count]], 0.125, closed=closed)
    places = np.random.default_rng(count).uniform(-1.6, 1.6, (300, 2))
    away = np.array([np.linalg.norm(curve - p, axis=1).min() for p in places])
    spacing = np.linalg.norm(curve[1:] - curve[:-1], axis=1).max()
    found = spline(places) + 0.125
    # The oracle is too far by no more than half its spacing, seen from the side.
    assert (found - away).max() <= 2e-6
    assert (away - found).max() <= spacing
    low, high = spline.bounds()  # in 32 bits
    assert (curve.min(axis=0) - 0.125 >= np.asarray(low)[:2] - 1e-6).all()
    assert (curve.max(axis=0) + 0.125 <= np.asarray(high)[:2] + 1e-6).all()
