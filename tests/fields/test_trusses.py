"""Lattices and trusses of bars, against all bars around a point."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from distal import CompileError, HexagonalLattice, Isotruss


def from_bar(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    way = high - low
    share = np.clip(((points - low) @ way) / (way @ way), 0.0, 1.0)
    return np.linalg.norm(points - low - share[:, None] * way, axis=1)


def all_bars(points: np.ndarray, bars) -> np.ndarray:
    return np.min([from_bar(points, np.array(a), np.array(b)) for a, b in bars], axis=0)


def isotruss_bars(major: float, height: float, count: int, bays: int):
    def at(k, j):
        a = 2.0 * np.pi * k / count
        return major * np.cos(a), j * height, major * np.sin(a)

    for k, j in product(range(count), range(-bays, bays)):
        yield at(k, j), at(k + 2, j + 1)
        yield at(k, j), at(k - 2, j + 1)
    inner = major * np.cos(2.0 * np.pi / count) / np.cos(np.pi / count)
    for k in range(count):
        a = 2.0 * np.pi * (k + 0.5) / count
        x, z = inner * np.cos(a), inner * np.sin(a)
        yield (x, -2.0 * bays * height, z), (x, 2.0 * bays * height, z)


@pytest.mark.parametrize("count", [5, 6, 8, 12, 24])
@pytest.mark.parametrize("height", [0.25, 0.6, 1.5, 4.0])
def test_an_isotruss_is_the_nearest_of_all_its_bars(count, height):
    made = Isotruss(1.0, height, 0.02, count)
    rng = np.random.default_rng(count)
    points = rng.uniform((-1.6, -height, -1.6), (1.6, height, 1.6), (1500, 3))
    true = all_bars(points, isotruss_bars(1.0, height, count, max(4, round(3.0 / height)))) - 0.02
    assert np.abs(made(points) - true).max() < 1e-6


def test_an_isotruss_has_no_end_along_y():
    made = Isotruss(1.0, 0.5, 0.05, 6)
    assert made.bounds() == ((-1.05, -np.inf, -1.05), (1.05, np.inf, 1.05))
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (500, 3))
    assert np.abs(made(points) - made(points + np.array((0.0, 5.0, 0.0)))).max() < 1e-6


def test_a_hexagonal_lattice_is_the_nearest_of_all_its_bars():
    size, height = 0.8, 0.5
    made = HexagonalLattice(size, height, 0.03)
    side = size / np.sqrt(3.0)
    corners = [(side * np.cos(np.pi * k / 3), side * np.sin(np.pi * k / 3)) for k in range(6)]
    bars = []
    for i, j, level in product(range(-3, 4), range(-3, 4), range(-2, 3)):
        # Middles of the hexagons: along z, and at 60 degrees to it.
        x, z = 0.5 * np.sqrt(3.0) * size * i, size * (j + 0.5 * i)
        for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
            y = level * height
            bars.append(((x + a, y, z + b), (x + c, y, z + d)))
            bars.append(((x + a, y, z + b), (x + a, y + height, z + b)))
    points = np.random.default_rng(2).uniform(-0.7, 0.7, (800, 3))
    true = all_bars(points, bars) - 0.03
    assert np.abs(made(points) - true).max() < 1e-6


def test_bars_that_are_too_thick_or_too_steep_are_refused():
    with pytest.raises(CompileError, match="count must be from 5 to 24"):
        Isotruss(count=4)
    with pytest.raises(CompileError, match=r"height must be from 0\.25 to 4 times major"):
        Isotruss(major=0.1, height=0.6, radius=0.01)
    with pytest.raises(CompileError, match="radius must be at most 1/8 of major and of h"):
        Isotruss(radius=0.2)
    with pytest.raises(CompileError, match=r"radius must be at most 0\.15 of cell_size and of"):
        HexagonalLattice(radius=0.2)
