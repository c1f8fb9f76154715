"""Wall thickness, gaps and the smallest feature of a solid: where a line along the normal is short.

Input: a shape's kernels and places on its surface. Output: the smallest width, where it is, and the
shape there. A width is the length of a line that leaves the surface along its normal, until it
meets a face that is at most 30 degrees from parallel: inwards it is the thickness of a wall,
outwards the width of a gap. The smallest of many lines are followed along the surface to where they
are least.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.ir.types import FLOAT, VEC3, Type
from distal.mesh import width_arithmetic
from distal.mesh.accuracy import NARROWEST
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.parts import part_at
from distal.mesh.solid import Floats

_FOLLOWED: Final = 64  # lines that are followed to a place where they are shorter
_ROUNDS: Final = 24
_MOST_LINES: Final = 200_000
# Directions in which a line's start is moved: the corners of a cube, across the normal.
_TURNS: Final = np.array(
    [(x, y, z) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) for z in (-1.0, 0.0, 1.0)]
)[[0, 1, 2, 3, 5, 9, 11, 15, 17, 21, 23, 24, 25, 26]]
_COLUMNS: Final[list[tuple[str, Type]]] = [
    ("p", VEC3),
    ("side", FLOAT),
    ("slope", FLOAT),
    ("least", FLOAT),
    ("most", FLOAT),
]


@dataclass(frozen=True, slots=True)
class Width:
    """A wall or a gap, in scene units.

    Attributes:
        value: The smallest width that was found. There may be a smaller one between the lines.
        error: How much it still changed in the last steps of the search.
        place: The place on the surface that the line begins at.
        opposite: The place where it ends.
        name: The shape at the place: the author's name for it, its kind and the line.
        line: The author's line; None if it is not known.
        apart: The distance between neighboring lines, about.
        unmeasured: The share of lines that could not be measured: at edges, and where a width is
            less than a millionth of the box.
    """

    value: float
    error: float
    place: tuple[float, ...]
    opposite: tuple[float, ...]
    name: str
    line: int | None
    apart: float
    unmeasured: float

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            name: list(value) if isinstance(value, tuple) else value
            for name in self.__slots__
            for value in (getattr(self, name),)
        }


@dataclass(frozen=True, slots=True)
class WidthSearch:
    """What is searched.

    Attributes:
        kernels: The shape.
        slope: A bound of its gradient.
        size: The largest side of its box.
    """

    kernels: FieldKernels
    slope: float
    size: float

    def smallest(self, places: Floats, apart: float, side: int) -> Width | None:
        """Return the smallest width of lines from places; None if no line meets anything.

        Args:
            places: Points near the surface, of shape (n, 3).
            apart: How far they are apart, about.
            side: -1 for walls, 1 for gaps.
        """
        places = places[:: -(-len(places) // _MOST_LINES)]
        widths, starts, normals = self._widths(places, side)
        known = widths > 0.0
        if not (known & (widths < 2.0 * self.size)).any():
            return None
        best = np.argsort(np.where(known, widths, np.inf), kind="stable")[:_FOLLOWED]
        widths, starts, normals = widths[best], starts[best], normals[best]
        error = 0.0
        for number in range(_ROUNDS):
            before = float(widths.min())
            self._follow(widths, starts, normals, apart * 0.7**number, side)
            error = before - float(widths.min())
        at = int(np.argmin(widths))
        return self._described(
            float(widths[at]),
            max(error, 1e-9 * self.size),
            starts[at],
            starts[at] + side * widths[at] * normals[at],
            apart,
            1.0 - float(known.mean()),
        )

    def _widths(self, places: Floats, side: int) -> tuple[Floats, Floats, Floats]:
        least = NARROWEST * self.size
        numbers = (np.full(len(places), x) for x in (side, self.slope, least, 2.0 * self.size))
        found: tuple[Floats, Floats, Floats] = self.kernels.call(
            width_arithmetic.width_at, places, *numbers, types=_COLUMNS
        )
        return found

    def _follow(
        self, widths: Floats, starts: Floats, normals: Floats, reach: float, side: int
    ) -> None:
        """Move the starts of lines along the surface to where they are shorter; changes them."""
        count, ways = len(widths), len(_TURNS)
        turns = np.tile(_TURNS, (count, 1))
        owner = np.repeat(np.arange(count), ways)
        steps = rows_of(width_arithmetic.across, normals[owner], turns, np.full(len(owner), reach))
        tried, moved, turned = self._widths(starts[owner] + steps, side)
        # A step that left the surface by far says nothing of the place beside it.
        off = np.abs(moved - starts[owner]).max(axis=1) > 2.0 * reach
        tried = np.where((tried > 0.0) & ~off, tried, np.inf).reshape(count, ways)
        which = tried.argmin(axis=1)
        rows = np.flatnonzero(tried[np.arange(count), which] < widths)
        chosen = rows * ways + which[rows]
        widths[rows] = tried[rows, which[rows]]
        starts[rows], normals[rows] = moved[chosen], turned[chosen]

    def _described(
        self,
        value: float,
        error: float,
        place: Floats,
        opposite: Floats,
        apart: float,
        unmeasured: float,
    ) -> Width:
        kernels = self.kernels
        part = part_at(kernels.node, place, kernels.params, kernels.time)
        ends = tuple(place.tolist()), tuple(opposite.tolist())
        return Width(value, error, *ends, part.text, part.line, apart, unmeasured)
