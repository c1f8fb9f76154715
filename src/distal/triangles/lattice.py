"""The lattice of triangles of a picture: right triangles, halved at their longest side's middle.

Input: a picture's size, and which points of the lattice are used. Output: which triangles there
are. Points have whole coordinates; a picture is covered by square tiles of two triangles, whose
sides are a power of two. A point is used only if the two points are, whose triangles it halves; so
no side has a point inside (Evans, Kirkpatrick and Townsend 2001: right-triangulated networks).

A step of the lattice is (s, kind): kind 0 has two triangles in each square of side s, along a
diagonal that alternates; kind 1 has four, around the square's middle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Integers = NDArray[np.int64]
Corner = tuple[float, float]  # (y, x), in sides of the square
Corners = tuple[Corner, Corner, Corner]  # the longest side's ends, then the right angle
Step = tuple[int, int]

MOST_SIDE: Final = 4096
# The triangles of kind 0 by the parity of the square's column plus row, then by their number.
HALVES: Final[tuple[tuple[Corners, Corners], tuple[Corners, Corners]]] = (
    (((0, 0), (1, 1), (0, 1)), ((1, 1), (0, 0), (1, 0))),
    (((1, 0), (0, 1), (0, 0)), ((0, 1), (1, 0), (1, 1))),
)
# Those of kind 1: at the top, right, bottom and left.
QUARTERS: Final[tuple[Corners, ...]] = (
    ((0, 1), (0, 0), (0.5, 0.5)),
    ((1, 1), (0, 1), (0.5, 0.5)),
    ((1, 0), (1, 1), (0.5, 0.5)),
    ((0, 0), (1, 0), (0.5, 0.5)),
)
# The two triangles of kind 0 that a triangle of kind 1 is made of: row and column of their square
# among the four in the larger one, and their number.
PARTS: Final = (
    ((0, 0, 0), (0, 1, 0)),
    ((0, 1, 1), (1, 1, 0)),
    ((1, 1, 1), (1, 0, 1)),
    ((1, 0, 0), (0, 0, 1)),
)


@dataclass(frozen=True, slots=True)
class TriangleLattice:
    """The lattice of a picture.

    Attributes:
        width: Of the picture, in pixels.
        height: Of the picture, in pixels.
        side: The side of a tile, a power of two.
        rows: Height of all tiles.
        columns: Width of all tiles.
    """

    width: int
    height: int
    side: int
    rows: int
    columns: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of points."""
        return self.rows + 1, self.columns + 1

    def steps(self) -> Iterator[Step]:
        """Yield the steps from the tiles to squares of one pixel."""
        side = self.side
        while side > 1:
            yield side, 0
            yield side, 1
            side //= 2
        yield 1, 0


def lattice_of(width: int, height: int) -> TriangleLattice:
    """Return the lattice of a picture of so many pixels."""
    side = 1 << max(1, (min(width, height) - 1).bit_length())
    return TriangleLattice(width, height, side, -(-height // side) * side, -(-width // side) * side)


def parity(rows: int, columns: int) -> Integers:
    """Return the parity of each square's row plus column."""
    return np.add.outer(np.arange(rows), np.arange(columns)) % 2


def quarters_of(halves: Bools) -> Bools:
    """Return for each triangle of kind 1 the value of the one of kind 0 that it is half of."""
    odd = parity(*halves.shape[:2]) == 1
    upper, lower = halves[..., 0], halves[..., 1]
    return np.stack([upper, np.where(odd, lower, upper), lower, np.where(odd, upper, lower)], -1)


def halves_from(quarters: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return for each triangle of kind 0 the sum of the values of its two halves."""
    odd = parity(*quarters.shape[:2]) == 1
    top, right, bottom, left = (quarters[..., k] for k in range(4))
    second = np.stack([np.where(odd, left, right), np.where(odd, right, left)], -1)
    total: NDArray[np.float64] = np.stack([top, bottom], -1) + second
    return total


def spread(quarters: Bools) -> Bools:
    """Return for each triangle of kind 0 of half the side whether its parent is set."""
    rows, columns, _ = quarters.shape
    found = np.zeros((2 * rows, 2 * columns, 2), bool)
    for k, parts in enumerate(PARTS):
        for row, column, number in parts:
            found[row::2, column::2, number] = quarters[..., k]
    return found


def side_points(used: Bools, side: int) -> Bools:
    """Return for each triangle of kind 1 whether the middle of its longest side is used."""
    half = side // 2
    top, bottom = used[:-1:side, half::side], used[side::side, half::side]
    left, right = used[half::side, :-1:side], used[half::side, side::side]
    return np.stack([top, right, bottom, left], -1)


def points_of(lattice: TriangleLattice, split: dict[Step, Bools]) -> Bools:
    """Return the points that halve all triangles that are to be halved, and those they need.

    Args:
        lattice: The lattice.
        split: For each step, which triangles are to be halved.
    """
    used = np.zeros(lattice.shape, bool)
    used[:: lattice.side, :: lattice.side] = True
    reached = np.ones((lattice.rows // lattice.side, lattice.columns // lattice.side, 2), bool)
    side = lattice.side
    while side > 1:
        half = side // 2
        halved = reached & split[side, 0]
        used[half::side, half::side] |= halved.any(-1)
        again = quarters_of(halved) & split[side, 1]
        used[:-1:side, half::side] |= again[..., 0]
        used[half::side, side::side] |= again[..., 1]
        used[side::side, half::side] |= again[..., 2]
        used[half::side, :-1:side] |= again[..., 3]
        reached, side = spread(again), half
    _add_needed(lattice, used)
    return used


def _add_needed(lattice: TriangleLattice, used: Bools) -> None:
    """Use the points without which the triangles would not be there that used points halve."""
    side = 2
    while side <= lattice.side:
        half = side // 2
        centers = used[half::side, half::side]
        centers |= side_points(used, side).any(-1)
        if side < lattice.side:
            # The corners of a square that are off its diagonal.
            for row, column in np.ndindex(2, 2):
                needed = centers[row::2, column::2]
                for down, right in np.ndindex(2, 2):
                    if (row + column + down + right) % 2:
                        view = used[
                            (row + down) * side :: 2 * side, (column + right) * side :: 2 * side
                        ]
                        view[: needed.shape[0], : needed.shape[1]] |= needed
        side *= 2


@dataclass(frozen=True, slots=True)
class LeafTriangles:
    """Triangles of one form that are not halved.

    Attributes:
        side: The side of their squares.
        kind: 0 or 1.
        number: The number of their form.
        form: Their corners in the square.
        rows: Row of each one's square.
        columns: Column of each one's square.
        points: Numbers of each one's corners, of shape (n, 3).
    """

    side: int
    kind: int
    number: int
    form: Corners
    rows: Integers
    columns: Integers
    points: Integers


def leaves_of(lattice: TriangleLattice, used: Bools) -> list[LeafTriangles]:
    """Return the triangles of a set of points, without those outside of the picture."""
    found: list[LeafTriangles] = []
    reached = np.ones((lattice.rows // lattice.side, lattice.columns // lattice.side, 2), bool)
    side = lattice.side
    while side > 1:
        half = side // 2
        centers = used[half::side, half::side, None]
        for odd in (0, 1):
            here = (reached & ~centers) & (parity(*reached.shape[:2]) == odd)[..., None]
            found += _leaves(lattice, side, 0, HALVES[odd], here)
        inside = quarters_of(reached & centers)
        middles = side_points(used, side)
        found += _leaves(lattice, side, 1, QUARTERS, inside & ~middles)
        reached, side = spread(inside & middles), half
    for odd in (0, 1):
        here = reached & (parity(*reached.shape[:2]) == odd)[..., None]
        found += _leaves(lattice, 1, 0, HALVES[odd], here)
    return found


def _leaves(
    lattice: TriangleLattice, side: int, kind: int, forms: tuple[Corners, ...], chosen: Bools
) -> Iterator[LeafTriangles]:
    inside = _inside(lattice, side, chosen.shape)
    for number, form in enumerate(forms):
        rows, columns = np.nonzero(chosen[..., number] & inside)
        if len(rows):
            corners = [
                (rows * side + int(y * side)) * lattice.shape[1] + columns * side + int(x * side)
                for y, x in form
            ]
            points = np.stack(corners, 1)
            yield LeafTriangles(side, kind, number, form, rows, columns, points)


def _inside(lattice: TriangleLattice, side: int, shape: tuple[int, ...]) -> Bools:
    """Return which squares have a pixel of the picture."""
    rows, columns = np.arange(shape[0]) * side, np.arange(shape[1]) * side
    return np.logical_and.outer(rows < lattice.height, columns < lattice.width)


@dataclass(frozen=True, slots=True)
class MiddlePoints:
    """Points of one step that may be used, in the order of the file.

    Attributes:
        side: The distance of such points.
        level: The number of the step.
        kind: 0 for middles of squares, 1 for middles of their sides.
        places: (row, column) of each, like all others.
        ends: The two ends of the side that it halves.
        parents: The two points that it needs; the same one twice at the lattice's border.
    """

    side: int
    level: int
    kind: int
    places: tuple[Integers, Integers]
    ends: tuple[tuple[Integers, Integers], tuple[Integers, Integers]]
    parents: tuple[tuple[Integers, Integers], tuple[Integers, Integers]]


def candidates(lattice: TriangleLattice, used: Bools) -> Iterator[MiddlePoints]:
    """Yield all points that may be used, by step; those of later steps depend on ``used``."""
    rows, columns = lattice.shape
    for level, (side, kind) in enumerate(lattice.steps()):
        half = side // 2
        if kind == 0 and side > 1:
            y, x = np.mgrid[half:rows:side, half:columns:side]
            way = np.where((y // side + x // side) % 2 == 0, half, -half)
            ends = (y - half, x - way), (y + half, x + way)
            parents = (y - half, x + way), (y + half, x - way)
            yield _candidates(used, side, level, 0, (y, x), ends, parents)
        elif kind == 1:
            y, x = np.mgrid[0:rows:side, half:columns:side]
            above, below = (
                np.where(y == 0, half, y - half),
                np.where(y == rows - 1, y - half, y + half),
            )
            ends = (y, x - half), (y, x + half)
            yield _candidates(used, side, level, 1, (y, x), ends, ((above, x), (below, x)))
            y, x = np.mgrid[half:rows:side, 0:columns:side]
            left = np.where(x == 0, half, x - half)
            right = np.where(x == columns - 1, x - half, x + half)
            ends = (y - half, x), (y + half, x)
            yield _candidates(used, side, level, 1, (y, x), ends, ((y, left), (y, right)))


def _candidates(
    used: Bools,
    side: int,
    level: int,
    kind: int,
    places: tuple[Integers, Integers],
    ends: tuple[tuple[Integers, Integers], tuple[Integers, Integers]],
    parents: tuple[tuple[Integers, Integers], tuple[Integers, Integers]],
) -> MiddlePoints:
    able = used[parents[0]] & used[parents[1]]

    def kept(pair: tuple[Integers, Integers]) -> tuple[Integers, Integers]:
        return pair[0][able], pair[1][able]

    (a, b), (c, d) = ends, parents
    return MiddlePoints(side, level, kind, kept(places), (kept(a), kept(b)), (kept(c), kept(d)))
