"""How far an outline is from the edge of its shape, measured, and what it misses.

Input: polylines. Output: distances, in both directions, and places of parts that are too thin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC2, Type
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.outlines.arithmetic import (
    behind_thin,
    distance_on_line,
    distance_to_line,
    line_measures,
)
from distal.mesh.outlines.tiles import Floats, Integers, values_at

_SHARES: Final = (0.0, 0.25, 0.5, 0.75)
_LINE: Final[list[tuple[str, Type]]] = [("a", VEC2), ("b", VEC2), ("share", FLOAT)]


@dataclass(frozen=True, slots=True)
class OutlineAccuracy:
    """How far an outline and the edge of its shape are apart.

    Attributes:
        largest: The largest distance that was measured.
        place: Where it is.
    """

    largest: float
    place: tuple[float, ...]

    def or_worse(self, other: OutlineAccuracy) -> OutlineAccuracy:
        """Return the one with the larger distance."""
        return other if other.largest > self.largest else self


def along_lines(kernels: FieldKernels, a: Floats, b: Floats, counts: Integers) -> OutlineAccuracy:
    """Return the largest distance from lines to the edge of the shape.

    Args:
        kernels: The shape.
        a: The start of each line.
        b: Its end.
        counts: How many quarters of a line are sampled at once: four samples for each.
    """
    line = np.repeat(np.arange(len(a)), counts)
    number = np.arange(len(line)) - np.repeat(np.cumsum(counts) - counts, counts)
    rows = np.repeat(line, len(_SHARES))
    shares = (number[:, None] + np.array(_SHARES)).reshape(-1) / counts[rows]
    away = kernels.call(distance_on_line, a[rows], b[rows], shares, types=_LINE)
    away = np.where(np.isfinite(away), away, np.inf)
    worst = int(np.argmax(away))
    place = a[rows[worst]] + (b - a)[rows[worst]] * shares[worst]
    return OutlineAccuracy(float(away[worst]), tuple(place.tolist()))


def from_points(points: Floats, a: Floats, b: Floats) -> OutlineAccuracy:
    """Return the largest distance from points of the edge to their lines.

    Args:
        points: Points of the edge.
        a: The start of the line of each.
        b: Its end.
    """
    away = rows_of(distance_to_line, points, a, b)
    worst = int(np.argmax(away))
    return OutlineAccuracy(float(away[worst]), tuple(points[worst].tolist()))


def thin_places(kernels: FieldKernels, suspected: Floats, step: float) -> Floats:
    """Return points of edges that pass between the points of the lattice, of shape (n, 2).

    Args:
        kernels: The shape.
        suspected: Points close to an edge that changes no sign near them.
        step: The length of a cell.
    """
    if not len(suspected):
        return suspected
    given = suspected, np.full(len(suspected), step)
    types: list[tuple[str, Type]] = [("p", VEC2), ("step", FLOAT)]
    found, away, behind = kernels.call(behind_thin, *given, types=types)
    # A value of 0 without a change of sign behind it, as between two shapes that touch, is no edge.
    thin = (values_at(kernels, suspected) < 0.0) != (behind < 0.0)
    thin &= np.isfinite(found).all(axis=1) & (away < step)
    places: Floats = found[thin]
    return places


def area_and_length(loops: list[Floats]) -> tuple[float, float]:
    """Return the area inside polylines, whose holes are clockwise, and their length."""
    middle = np.concatenate(loops).mean(axis=0)
    a = np.concatenate(loops) - middle
    b = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops]) - middle
    area, length = rows_of(line_measures, a, b).sum(axis=0).tolist()
    return area, length
