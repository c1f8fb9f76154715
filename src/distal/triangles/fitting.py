"""Pixels of given triangles, and the values of points that give the smallest squared error.

Input: triangles with their cuts, and pixels. Output: for each pixel the points and weights that
give it; values of points by the method of conjugate gradients.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.triangles.lattice import Bools, Integers, LeafTriangles, TriangleLattice
from distal.triangles.shapes import shape_of

Values = NDArray[np.float64]

# Points that few pixels see keep near the value they had.
_KEPT: Final = 0.02
_ITERATIONS: Final = 25
_DONE: Final = 1e-6  # of the first residual's square


@dataclass(frozen=True, slots=True)
class PixelWeights:
    """What each pixel shows.

    Attributes:
        points: Numbers of three points for each pixel, of shape (pixels, 3), row by row.
        weights: Their weights.
    """

    points: NDArray[np.int32]
    weights: NDArray[np.float32]

    def shown(self, values: Values) -> NDArray[np.float32]:
        """Return the pixels that values of points give, of shape (pixels, 3)."""
        found = np.zeros((len(self.points), 3), np.float32)
        for k in range(3):
            found += self.weights[:, k, None] * values[self.points[:, k]].astype(np.float32)
        return found


def weights_of(
    lattice: TriangleLattice, leaves: list[LeafTriangles], cuts: list[Integers]
) -> PixelWeights:
    """Return the weights of all pixels.

    Args:
        lattice: The lattice.
        leaves: All triangles.
        cuts: The number of each one's cut, -1 for none.
    """
    count = lattice.width * lattice.height
    points, weights = np.zeros((count, 3), np.int32), np.zeros((count, 3), np.float32)
    for each, chosen in zip(leaves, cuts, strict=True):
        shape = shape_of(each.form, each.side, each.kind)
        row, column = np.divmod(shape.pixels, each.side)
        y, x = (each.rows * each.side)[:, None] + row, (each.columns * each.side)[:, None] + column
        inside = (y < lattice.height) & (x < lattice.width)
        pixels = (y * lattice.width + x)[inside]
        many = (len(each.rows), len(row), 3)
        points[pixels] = np.broadcast_to(each.points[:, None], many)[inside]
        weights[pixels] = shape.weights[chosen + 1][inside]
    return PixelWeights(points, weights)


def fitted(seen: PixelWeights, pixels: NDArray[np.float32], start: Values, used: Bools) -> Values:
    """Return the values of points with the smallest squared error.

    Args:
        seen: The weights of all pixels.
        pixels: Of shape (pixels, 3).
        start: Values to begin with.
        used: Which points are used.
    """
    ids = np.flatnonzero(used.ravel())
    number = np.zeros(used.size, np.int64)
    number[ids] = np.arange(len(ids))
    points, weights = number[seen.points], seen.weights.astype(float)
    flat, count = points.ravel(), len(ids)

    def gathered(values: Values) -> Values:
        return np.bincount(flat, (weights * values[:, None]).ravel(), count).astype(float)

    scale = np.bincount(flat, np.square(weights).ravel(), count) + _KEPT
    found = start.copy()
    for channel in range(3):
        x = start[ids, channel]
        residual = gathered(pixels[:, channel] - (weights * x[points]).sum(1))
        along = residual / scale
        size = limit = float(residual @ along)
        direction = along
        for _ in range(_ITERATIONS):
            if size <= _DONE * limit or size == 0.0:
                break
            applied = gathered((weights * direction[points]).sum(1)) + _KEPT * direction
            step = size / float(direction @ applied)
            x = x + step * direction
            residual = residual - step * applied
            along = residual / scale
            before, size = size, float(residual @ along)
            direction = along + (size / before) * direction
        found[ids, channel] = x
    return found
