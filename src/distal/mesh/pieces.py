"""Measure how far triangles are from the surface and how much it turns in them, in pieces.

Input: triangles, and into how many pieces along each side each is cut. Output: distances of first
order, shares of an angle. Does not depend on how triangles were made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import itemgetter
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC3, Type
from distal.mesh import face_arithmetic
from distal.mesh.kernels import FieldKernels
from distal.mesh.parallel import ROWS_AT_ONCE, parallel_map, slices_of
from distal.mesh.solid import Floats, Integers

_CORNERS: Final[list[tuple[str, Type]]] = [(name, VEC3) for name in "abc"]
_LIMITS: Final[list[tuple[str, Type]]] = [
    (name, FLOAT) for name in ("pieces", "angle", "least_radius")
]
# The surface may turn by any angle where its radius is below so many tolerances. A plate of 200 has
# a tolerance of .4 by default, turned by 45 degrees of .57: the radius of a hole of 2.2 is 1.9 of
# these.
LEAST_RADIUS: Final = 1.5
# What is measured is right within a few percent: cells are not divided for as little.
_SLACK: Final = 1.15  # of the square
# A triangle that is closer to the surface than this share of the tolerance, for each unit of the
# angle squared, turns by less: a third of the height of a chord at the least radius.
_FLAT: Final = 0.5


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

    def measure(group: _Group) -> tuple[float, float, tuple[float, float, float]]:
        count, some = group
        a, b, c = _corners(points, triangles[some], count)
        found = kernels.call(face_arithmetic.largest_miss, a, b, c, types=_CORNERS)
        largest[some] = found[:, 0].reshape(len(some), -1).max(axis=1)
        at = int(np.argmax(found[:, 0]))
        x, y, z = ((a[at] + b[at] + c[at]) / 3.0).tolist()
        return float(found[:, 1].sum()), float(found[at, 0]), (x, y, z)

    measured = parallel_map(measure, _groups(counts), watch)
    total = sum(part for part, _, _ in measured)
    _, _, place = max(measured, key=itemgetter(1))  # of equal ones the first
    return PieceDistances(largest, total / float((counts**2).sum()), place)


def turns(
    kernels: FieldKernels,
    points: Floats,
    triangles: Integers,
    counts: Integers,
    distance: Floats,
    tolerance: float,
    angle: float,
) -> Floats:
    """Return how much the surface turns within triangles, as shares of what it may, squared.

    The square falls as a distance does where cells become smaller.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        counts: How many pieces there are along each side of a triangle.
        distance: How far each triangle is from the surface, at most.
        tolerance: How far it may be.
        angle: How much the surface may turn, in radians; infinite for any angle.
    """
    found = np.zeros(len(triangles))
    bent = np.flatnonzero(distance > _FLAT * angle**2 * tolerance)

    def measure(group: _Group) -> None:
        count, some = group
        rows = bent[some]
        a, b, c = _corners(points, triangles[rows], count)
        limits = (count, angle, LEAST_RADIUS * tolerance)
        columns = (np.full(len(a), limit) for limit in limits)
        function = face_arithmetic.turn_in_triangle
        shares = kernels.call(function, a, b, c, *columns, types=[*_CORNERS, *_LIMITS])
        largest = shares.reshape(len(rows), -1).max(axis=1)
        found[rows] = np.where(largest > _SLACK, largest, np.minimum(largest, 1.0))

    parallel_map(measure, _groups(counts[bent]))
    return found


_Group = tuple[int, Integers]


def _groups(counts: Integers) -> list[_Group]:
    """Return the rows of triangles of as many pieces each, a few at a time, and this number."""
    groups = []
    for count in np.flatnonzero(np.bincount(counts)):
        rows = np.flatnonzero(counts == count)
        at_once = max(1, ROWS_AT_ONCE // int(count) ** 2)
        groups += [(int(count), rows[some]) for some in slices_of(len(rows), at_once)]
    return groups


def _corners(points: Floats, triangles: Integers, count: int) -> list[Floats]:
    """Return the corners of the pieces of triangles, those of one triangle in a row."""
    corners = points[triangles]
    if count == 1:
        return [corners[:, i] for i in range(3)]
    shares = _pieces(count)
    return [(shares[:, i] @ corners).reshape(-1, 3) for i in range(3)]


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
