"""Statistics of samples: chi-square by cells of the square, and of the sphere."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from distal.scene.checks import furnace

# The deviation of a chi-square, in standard deviations of a normal variable, at which a test fails:
# 4.5 is passed by chance once in 300,000 tests. All seeds are fixed.
SURPRISING = 4.5


def deviation(counts: Any, expected: Any) -> float:
    """How far counts are from those expected, in standard deviations (``furnace.deviation``)."""
    counts, expected = np.ravel(counts).astype(float), np.ravel(expected).astype(float)
    outside = counts[expected <= 1e-9].sum()
    assert outside <= 1e-3 * counts.sum(), "samples where none are expected"
    return furnace.deviation(counts, expected)


def grid(count: int) -> Any:
    """The middles of ``count`` squared cells of the unit square."""
    middles = (np.arange(count) + 0.5) / count
    return np.stack(np.meshgrid(middles, middles, indexing="ij"), -1).reshape(-1, 2)


def directions_of(cells: Any) -> Any:
    """Directions at places (height, turn) of the sphere's area-true map, about z."""
    z = 2 * cells[:, 0] - 1
    around = 2 * math.pi * cells[:, 1]
    level = np.sqrt(np.maximum(1 - z * z, 0))
    return np.stack([level * np.cos(around), level * np.sin(around), z], 1).astype(np.float32)


def places_of(directions: Any) -> Any:
    """The inverse of ``directions_of``."""
    directions = np.asarray(directions, float)
    turn = np.arctan2(directions[:, 1], directions[:, 0]) / (2 * math.pi) % 1.0
    return np.stack([np.clip(0.5 + 0.5 * directions[:, 2], 0, 1 - 1e-12), turn], 1)


def counted(places: Any, rows: int, columns: int) -> Any:
    """How many places of the unit square are in each cell."""
    row = np.minimum((places[:, 0] * rows).astype(int), rows - 1)
    column = np.minimum((places[:, 1] * columns).astype(int), columns - 1)
    return np.bincount(row * columns + column, minlength=rows * columns)


def expected_in_cells(density: Any, rows: int, columns: int, fine: int = 24) -> Any:
    """The integral of a density over each cell of the sphere's map, by fine cells.

    Args:
        density: A function of directions (n, 3), by solid angle about z.
        rows: Cells by height.
        columns: Cells by turn.
        fine: Places of each cell along each side.
    """
    height = (np.arange(rows * fine) + 0.5) / (rows * fine)
    turn = (np.arange(columns * fine) + 0.5) / (columns * fine)
    cells = np.stack(np.meshgrid(height, turn, indexing="ij"), -1).reshape(-1, 2)
    values = np.asarray(density(directions_of(cells)), float)
    values = values.reshape(rows, fine, columns, fine).mean((1, 3))
    return values.ravel() * 4 * math.pi / (rows * columns)
