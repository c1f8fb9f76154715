"""Measure how far triangles are from the surface, large ones in pieces.

Input: triangles, and into how many pieces along each side each is cut. Output: distances of first
order. Does not depend on how triangles were made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import face_arithmetic
from distal.mesh.kernels import FieldKernels
from distal.mesh.solid import Floats, Integers

_AT_ONCE: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class PieceDistances:
    """Distances of triangles from the surface.

    Attributes:
        largest: The largest distance of each triangle.
        mean: The mean of all pieces.
        place: The middle of the piece with the largest distance.
    """

    largest: Floats
    mean: float
    place: tuple[float, float, float]


def distances(
    kernels: FieldKernels,
    points: Floats,
    triangles: Integers,
    counts: Integers,
    watch: Callable[[float], None] = lambda share: None,
) -> PieceDistances:
    """Return how far triangles are from the surface, at seven points of each piece.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        counts: How many pieces there are along each side of a triangle.
        watch: Called now and then.
    """
    largest = np.empty(len(triangles))
    worst, total, place = -1.0, 0.0, (0.0, 0.0, 0.0)
    for count in np.flatnonzero(np.bincount(counts)):
        weights = _pieces(int(count))
        rows = np.flatnonzero(counts == count)
        size = max(1, _AT_ONCE // len(weights))
        for start in range(0, len(rows), size):
            some = rows[start : start + size]
            corners = points[triangles[some]]
            if count > 1:
                corners = (weights.reshape(-1, 3) @ corners).reshape(-1, 3, 3)
            a, b, c = (np.ascontiguousarray(corners[:, i]) for i in range(3))
            types = [(name, VEC3) for name in "abc"]
            found = kernels.call(face_arithmetic.largest_miss, a, b, c, types=types)
            largest[some] = found[:, 0].reshape(len(some), -1).max(axis=1)
            total += float(found[:, 1].sum())
            at = int(np.argmax(found[:, 0]))
            if found[at, 0] > worst:
                x, y, z = ((a[at] + b[at] + c[at]) / 3.0).tolist()
                worst, place = float(found[at, 0]), (x, y, z)
            watch(1.0)
    return PieceDistances(largest, total / float((counts**2).sum()), place)


def _pieces(count: int) -> Floats:
    """Return the corners of the pieces of a triangle, (count**2, 3, 3): shares of its corners."""
    found = []
    for i in range(count):
        for j in range(count - i):
            a, b, c = (i, j), (i + 1, j), (i, j + 1)
            found.append([a, b, c])
            if i + j < count - 1:
                found.append([b, (i + 1, j + 1), c])
    ends = np.array(found, np.float64) / count
    rest = 1.0 - ends.sum(axis=2, keepdims=True)
    return np.concatenate([rest, ends], axis=2)
