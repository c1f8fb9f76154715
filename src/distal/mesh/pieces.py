"""Measure how far triangles are from the surface, large ones in pieces.

Input: triangles, and into how many pieces along each side each is cut. Output: distances of first
order. Does not depend on how triangles were made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import face_arithmetic
from distal.mesh.kernels import FieldKernels
from distal.mesh.parallel import ROWS_AT_ONCE, parallel_map, slices_of
from distal.mesh.solid import Floats, Integers


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
    groups = []
    for count in np.flatnonzero(np.bincount(counts)):
        rows = np.flatnonzero(counts == count)
        at_once = max(1, ROWS_AT_ONCE // int(count) ** 2)
        groups += [(int(count), rows[some]) for some in slices_of(len(rows), at_once)]

    def measure(group: tuple[int, Integers]) -> tuple[float, float, tuple[float, float, float]]:
        count, some = group
        a, b, c = (points[triangles[some, i]] for i in range(3))
        if count > 1:
            shares = _pieces(count)
            corners = np.stack([a, b, c], axis=1)
            a, b, c = ((shares[:, i] @ corners).reshape(-1, 3) for i in range(3))
        types = [(name, VEC3) for name in "abc"]
        found = kernels.call(face_arithmetic.largest_miss, a, b, c, types=types)
        largest[some] = found[:, 0].reshape(len(some), -1).max(axis=1)
        at = int(np.argmax(found[:, 0]))
        x, y, z = ((a[at] + b[at] + c[at]) / 3.0).tolist()
        return float(found[:, 1].sum()), float(found[at, 0]), (x, y, z)

    measured = parallel_map(measure, groups, watch)
    total = sum(part for part, _, _ in measured)
    _, _, place = max(measured, key=itemgetter(1))  # of equal ones the first
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
