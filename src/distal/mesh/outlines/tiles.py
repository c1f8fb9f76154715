"""Find the cells of a lattice that the edge of a flat shape passes through.

Input: a shape's kernels, its box and the length of a cell. Output: cells with the values at their
corners. Blocks are dropped where the shape's slope says that there is no edge. A slope that is
wrong can lose a separate part, but opens no loop: where the sign changes on a tile's side, the tile
beside it is sampled too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from distal.ir.types import VEC2
from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines.arithmetic import distance_value
from distal.mesh.problems import MeshProblem

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]
Watch = Callable[[float], None]

TILE: Final = 8  # cells along each side of a tile
TILES_AT_ONCE: Final = 4096
# The lattice begins and ends this many cells beyond the box. Sides of shapes are often at round
# numbers; these shares keep them away from lines of the lattice.
BEFORE: Final = 1.37
BEYOND: Final = 1.11
# The corners of a cell, counter-clockwise; edge number i joins corner i with the next one.
CORNERS: Final = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.int64)
_HALF_DIAGONAL: Final = 0.5 * float(np.sqrt(2.0))


@dataclass(frozen=True, slots=True)
class FlatExtent:
    """Where a shape is, and how fast its values change.

    Attributes:
        low: The lowest corner of its box.
        high: The highest corner.
        slope: Lipschitz bound (slope): a bound on |gradient| everywhere.
        divisor: A positive value divided by it is at most the distance to the shape.
    """

    low: Floats
    high: Floats
    slope: float
    divisor: float

    @property
    def size(self) -> float:
        """The largest side of the box."""
        return float((self.high - self.low).max())


@dataclass(frozen=True, slots=True)
class TileLattice:
    """A lattice of square cells over a box.

    Attributes:
        origin: The lowest lattice point.
        step: The length of a cell, in scene units.
        extent: How many tiles there are along each axis.
    """

    origin: Floats
    step: float
    extent: Integers

    @staticmethod
    def over(extent: FlatExtent, step: float) -> TileLattice:
        """Return the lattice over a shape's box."""
        origin = extent.low - BEFORE * step
        cells = (extent.high + BEYOND * step - origin) / step
        return TileLattice(origin, step, np.ceil(cells / TILE).astype(np.int64))

    def places(self, points: npt.NDArray[Any]) -> Floats:
        """Return the places of lattice points; shares of a cell are allowed."""
        return self.origin + np.asarray(points, np.float64) * self.step

    def contains(self, tiles: Integers) -> Bools:
        """Return which tiles belong to the lattice."""
        found: Bools = np.all((tiles >= 0) & (tiles < self.extent), axis=1)
        return found


@dataclass(frozen=True, slots=True)
class EdgeCells:
    """The cells whose corners differ in sign, in the order of their keys.

    Attributes:
        cells: Their places, of shape (n, 2), in cells.
        values: The values at their corners, of shape (n, 4).
        sampled: How many tiles were sampled.
        suspected: Points close to an edge that changes no sign near them, of shape (n, 2).
    """

    cells: Integers
    values: Floats
    sampled: int
    suspected: Floats


def keys_of(places: Integers) -> Integers:
    """Return a number for each cell or tile, in the order of x, then y."""
    keys: Integers = ((places[:, 0] + 1) << 31) | (places[:, 1] + 1)
    return keys


def known(keys: Integers, sorted_keys: Integers) -> Bools:
    """Return which keys a sorted list has."""
    if not len(sorted_keys):
        return np.zeros(len(keys), np.bool_)
    at = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
    found: Bools = sorted_keys[at] == keys
    return found


def values_at(kernels: FieldKernels, places: Floats) -> Floats:
    """Return the shape's values.

    Raises:
        MeshProblem: One is no finite number.
    """
    values: Floats = kernels.call(distance_value, places, types=[("p", VEC2)])
    if not np.isfinite(values).all():
        raise MeshProblem("no number", tuple(places[int(np.argmin(np.isfinite(values)))]))
    return values


def edge_cells(
    kernels: FieldKernels, lattice: TileLattice, extent: FlatExtent, most: int, watch: Watch
) -> EdgeCells:
    """Return the cells that the edge of a shape passes through.

    Args:
        kernels: The shape.
        lattice: The lattice.
        extent: The shape's box and slope.
        most: The most tiles.
        watch: Called with the share of the tiles that are sampled.

    Raises:
        MeshProblem: There are more; a value is not a number; or the edge leaves the lattice.
    """
    waiting = _descend(kernels, lattice, extent, most, watch)
    seen = np.sort(keys_of(waiting))
    parts = []
    while len(waiting):
        wanted = []
        for start in range(0, len(waiting), TILES_AT_ONCE):
            rows = waiting[start : start + TILES_AT_ONCE]
            values = _samples(kernels, lattice, rows)
            wanted.append(_neighbors(rows, values < 0.0))
            parts.append(_cells(lattice, extent, rows, values))
            watch(min(1.0, (start + TILES_AT_ONCE) / len(waiting)))
        beside = np.unique(np.concatenate(wanted), axis=0)
        waiting = beside[~known(keys_of(beside), seen)]
        outside = waiting[~lattice.contains(waiting)]
        if len(outside):
            raise MeshProblem("leaves its box", tuple(lattice.places((outside[0] + 0.5) * TILE)))
        seen = np.sort(np.concatenate([seen, keys_of(waiting)]))
        if len(seen) > most:
            raise MeshProblem("too many")
    if not parts:
        return EdgeCells(np.empty((0, 2), np.int64), np.empty((0, 4)), 0, np.empty((0, 2)))
    cells, values, suspected = (np.concatenate(each) for each in zip(*parts, strict=True))
    order = np.argsort(keys_of(cells), kind="stable")
    return EdgeCells(cells[order], values[order], len(seen), suspected)


def _descend(
    kernels: FieldKernels, lattice: TileLattice, extent: FlatExtent, most: int, watch: Watch
) -> Integers:
    """Return the tiles that the edge can pass through, of shape (n, 2).

    Args:
        kernels: The shape.
        lattice: The lattice.
        extent: The shape's box and slope.
        most: The most tiles.
        watch: Called now and then.

    Raises:
        MeshProblem: There are more.
    """
    levels = int(np.ceil(np.log2(max(int(lattice.extent.max()), 1))))
    blocks = np.zeros((1, 2), np.int64)
    for level in range(levels, -1, -1):
        if level < levels:
            blocks = (blocks[:, None] * 2 + CORNERS[None]).reshape(-1, 2)
        blocks = blocks[lattice.contains(blocks << level)]
        if len(blocks) > 4 * most:
            raise MeshProblem("too many")
        if not len(blocks):
            break
        side = (TILE << level) * lattice.step
        values = values_at(kernels, lattice.places((blocks + 0.5) * (TILE << level)))
        reach = np.where(values > 0.0, min(extent.divisor, extent.slope), extent.slope)
        blocks = blocks[np.abs(values) <= reach * (side * _HALF_DIAGONAL * 1.000001)]
        watch(0.0)
    if len(blocks) > most:
        raise MeshProblem("too many")
    return blocks


def _samples(kernels: FieldKernels, lattice: TileLattice, tiles: Integers) -> Floats:
    """Return the samples of tiles, of shape (n, 9, 9), indexed by x, then y.

    A point that two tiles share has the same place, hence the same value, in both.
    """
    across = np.arange(TILE + 1)
    local = np.stack(np.meshgrid(across, across, indexing="ij"), axis=-1)
    points = (tiles * TILE)[:, None, None, :] + local
    found = values_at(kernels, lattice.places(points.reshape(-1, 2)))
    return found.reshape(len(tiles), TILE + 1, TILE + 1)


def _neighbors(tiles: Integers, inside: Bools) -> Integers:
    """Return the tiles beside sides on which the sign changes."""
    found = []
    for axis in range(2):
        for at, way in ((0, -1), (TILE, 1)):
            side: Bools = inside.take(at, axis=1 + axis).reshape(len(tiles), -1)
            beside = tiles[side.any(axis=1) & ~side.all(axis=1)]
            beside[:, axis] += way
            found.append(beside)
    return np.concatenate(found)


def _cells(
    lattice: TileLattice, extent: FlatExtent, tiles: Integers, values: Floats
) -> tuple[Integers, Floats, Floats]:
    """Return cells with a change of sign, values at their corners, and suspected points."""
    corners = np.stack([values[:, x : x + TILE, y : y + TILE] for x, y in CORNERS], axis=-1)
    inside = (corners < 0.0).sum(axis=-1)
    crossed = (inside > 0) & (inside < 4)
    tile, x, y = np.nonzero(crossed)
    cells = tiles[tile] * TILE + np.stack([x, y], axis=1)
    # Only points within a tile are looked at: cells around the others are in several tiles.
    near = np.abs(values[:, 1:TILE, 1:TILE]) < 0.9 * lattice.step * extent.slope
    for x, y in CORNERS:
        near &= ~crossed[:, x : x + TILE - 1, y : y + TILE - 1]
    at, *local = np.nonzero(near)
    points = tiles[at] * TILE + np.stack(local, axis=1) + 1
    return cells, corners[tile, cells[:, 0] % TILE, cells[:, 1] % TILE], lattice.places(points)
