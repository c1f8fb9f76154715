"""Which cells, points and edges of a mesh belong together.

Input: the bricks of a surface, and the shape where a face is ambiguous. Output: integers: the four
points around each edge, the edges around each point, and the segments of the surface on faces. Does
not depend on where anything is. Cells of several sizes are in ``leaves``; both give the same rows,
whose places and sizes are in units of the lattice that they are made for.

The cells around an edge are numbered 0 to 3 around it, counter-clockwise seen against the edge's
axis: below in both of the next two axes (u, v), then above in u, then above in both, then above
in v. Side ``i`` of an edge is the face between the cells ``i`` and ``i + 1``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh.arithmetic import distance_value
from distal.mesh.bricks import SurfaceBricks
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import BRICK, Lattice, keys_of, position
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tables import EDGES, cell_tables
from distal.polygons.whole_numbers import stable_order

_BRICK_BITS: Final = BRICK.bit_length() - 1
# Whether each of the four cells around an edge is below it in u, and in v.
BELOW: Final = ((1, 1), (0, 1), (0, 0), (1, 0))


def _edge_in_cell(axis: int, number: int) -> int:
    """Return which of a cell's edges an edge is, for one of the four cells around it."""
    below_u, below_v = BELOW[number]
    return EDGES.index((axis, below_u << (axis + 1) % 3 | below_v << (axis + 2) % 3))


def _side(normal: int, edge: int) -> int:
    """Return which side of an edge a face of one of its cells is, by the face's normal."""
    axis, corner = EDGES[edge]
    u, v = (axis + 1) % 3, (axis + 2) % 3
    if normal == u:
        return 0 if corner >> v & 1 else 2
    return 3 if corner >> u & 1 else 1


IN_CELL: Final = np.array([[_edge_in_cell(a, n) for n in range(4)] for a in range(3)])
_SIDES: Final = np.array(
    [[_side(n, e) if EDGES[e][0] != n else -1 for e in range(12)] for n in range(3)]
)
# The edge that an edge of the upper face is in the next cell.
_IN_NEXT: Final = np.array(
    [[EDGES.index((a, c & ~(1 << n))) if a != n else -1 for a, c in EDGES] for n in range(3)]
)


def neighbor_tables() -> tuple[Integers, ...]:
    """Return the tables of cells around edges and beside faces, for pages.

    They are, for each axis: for the four cells around an edge whether it is below them in u and v;
    which of their edges it is; which side of an edge a face is, by its normal; the edge that an
    edge of the upper face is in the next cell.
    """
    return np.array(BELOW, np.int64), IN_CELL, _SIDES, _IN_NEXT


@dataclass(frozen=True, slots=True)
class EdgeRows:
    """The edges with a change of sign.

    Attributes:
        axis: The axis of each edge, of shape (n,).
        start: The lattice point at the lower end, of shape (n, 3).
        size: Its length.
        around: The points of the four cells around each edge, of shape (n, 4). Two may be of the
            same cell, where the edge is in the middle of a large cell's face.
        segments: The segment on each of the four sides, of shape (n, 4); -1 between two points of
            the same cell.
        first: The value of the field at the lower end.
        second: That at the upper end.
    """

    axis: Integers
    start: Integers
    size: Integers
    around: Integers
    segments: Integers
    first: Floats
    second: Floats


@dataclass(frozen=True, slots=True)
class PointRows:
    """The points in cells: one for each component.

    Attributes:
        cell: The lattice point at the lowest corner of its cell, of shape (n, 3).
        size: The side of its cell.
        region: The corners at the ends of its component's edges, as bits.
        shared: Whether the cell has several components.
        edges: The edges of all points, one point after the other.
        first: Where the edges of each point begin in ``edges``.
    """

    cell: Integers
    size: Integers
    region: Integers
    shared: Bools
    edges: Integers
    first: Integers


@dataclass(frozen=True, slots=True)
class SegmentRows:
    """The segments of the surface on faces; each joins two edges and two points.

    Attributes:
        axis: The axis that the face is perpendicular to.
        face: The lattice point at the face's lowest corner, of shape (n, 3).
        size: The side of the face.
        lower: The point in the cell below the face.
        upper: The point in the cell above it.
        edge_a: One edge at which the segment ends.
        edge_b: The other.
        paired: Whether the face has two segments.
    """

    axis: Integers
    face: Integers
    size: Integers
    lower: Integers
    upper: Integers
    edge_a: Integers
    edge_b: Integers
    paired: Bools


@dataclass(frozen=True, slots=True)
class Topology:
    """The topology of a mesh before triangles are chosen.

    Attributes:
        edges: The edges with a change of sign.
        points: The points in cells.
        segments: The segments of the surface on faces.
        cells: How many cells the surface passes through.
        unit: The side of a cell that is not divided, in units of the lattice.
        closed: Keys of such cells, sorted, that no other cell may reach into, and that may not
            reach into others: those that are divided, and those beside them.
        larger: Keys of cells that are larger, sorted: first those of the largest size, each of the
            next ones of half of it, the last of two units.
    """

    edges: EdgeRows
    points: PointRows
    segments: SegmentRows
    cells: int
    unit: int = 1
    closed: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    larger: tuple[Integers, ...] = ()


class _SurfaceCells:
    """The cells with a change of sign, found by brick and place."""

    def __init__(self, found: SurfaceBricks) -> None:
        masks = found.masks.reshape(-1)
        active = np.flatnonzero((masks != 0) & (masks != 255))
        self.mask = masks[active].astype(np.int64)
        self.case = cell_tables().case[self.mask, 0]
        self.brick = active // BRICK**3
        self.local = np.stack(
            [active // BRICK**2 % BRICK, active // BRICK % BRICK, active % BRICK], axis=1
        )
        self.place = found.bricks[self.brick] * BRICK + self.local
        self._number = np.full(len(masks), -1, np.int32)
        self._number[active] = np.arange(len(active))
        self._bricks = found.bricks
        self._keys = keys_of(found.bricks)
        self._beside: dict[tuple[int, int, int], Integers] = {}

    def at(self, brick: Integers, local: Integers) -> Integers:
        """Return the numbers of cells, which may be in the bricks beside the given ones.

        Args:
            brick: The brick of each cell.
            local: Its place from the brick's corner; -1 to 8 along each axis.
        """
        step = local >> _BRICK_BITS
        inside = local & (BRICK - 1)
        code = (step[:, 0] + 1) * 9 + (step[:, 1] + 1) * 3 + step[:, 2] + 1
        home = brick.copy()
        for value in np.flatnonzero(np.bincount(code)):
            if value != 13:
                rows = code == value
                home[rows] = self._neighbor(int(value))[brick[rows]]
        flat = (home * BRICK + inside[:, 0]) * BRICK + inside[:, 1]
        found: Integers = self._number[flat * BRICK + inside[:, 2]].astype(np.int64)
        assert (home >= 0).all() and (found >= 0).all(), "a cell beside the surface is missing"
        return found

    def _neighbor(self, code: int) -> Integers:
        step = (code // 9 - 1, code // 3 % 3 - 1, code % 3 - 1)
        if step not in self._beside:
            keys = keys_of(self._bricks + np.array(step, np.int64))
            self._beside[step] = position(keys, self._keys)
        return self._beside[step]


def topology_of(kernels: FieldKernels, lattice: Lattice, found: SurfaceBricks) -> Topology:
    """Return the topology of the surface in its bricks.

    Args:
        kernels: The shape, which decides how ambiguous faces are.
        lattice: The lattice.
        found: The bricks.
    """
    tables = cell_tables()
    cells = _SurfaceCells(found)
    cells.case = _cases(kernels, lattice, cells)
    count = tables.components[cells.case]
    first = np.cumsum(count) - count
    axis = np.concatenate([np.full(len(e.brick), a, np.int8) for a, e in enumerate(found.edges)])
    brick = np.concatenate([e.brick for e in found.edges])
    local = np.concatenate([e.start for e in found.edges])
    around = np.empty((len(axis), 4), np.int64)
    of_cell: Any = np.full((len(cells.mask), 12), -1, np.int32)
    rows = np.arange(len(axis))
    for number, (below_u, below_v) in enumerate(BELOW):
        place = local.copy()
        place[rows, (axis + 1) % 3] -= below_u
        place[rows, (axis + 2) % 3] -= below_v
        cell = cells.at(brick, place)
        edge = IN_CELL[axis, number]
        of_cell[cell, edge] = rows
        around[:, number] = first[cell] + tables.component[cells.case[cell], edge]
    points = _points(cells, count, around)
    segments, sides = _segments(cells, first, of_cell, len(axis))
    start = found.bricks[brick] * BRICK + local
    first_value = np.concatenate([e.first for e in found.edges])
    second_value = np.concatenate([e.second for e in found.edges])
    edges = EdgeRows(axis, start, _ones(len(axis)), around, sides, first_value, second_value)
    return Topology(edges, points, segments, len(cells.mask))


def _cases(kernels: FieldKernels, lattice: Lattice, cells: _SurfaceCells) -> Integers:
    """Return the case of each cell.

    An ambiguous face is joined if its middle is inside. A cell whose components would not be
    separable has no joined face, which is always possible.

    Args:
        kernels: The shape.
        lattice: The lattice.
        cells: The cells.
    """
    tables = cell_tables()
    found: Integers = cells.case
    cell, axis = np.nonzero(tables.ambiguous[cells.mask])
    if not len(cell):
        return found
    step = np.eye(3, dtype=np.int64)[axis]
    upper = cells.at(cells.brick[cell], cells.local[cell] + step)
    middles = lattice.places(cells.place[cell] + 0.5 * (step + 1.0))
    joined = kernels.call(distance_value, middles, types=[("p", VEC3)]) < 0.0
    while True:
        faces = np.zeros(len(cells.mask), np.int64)
        np.bitwise_or.at(faces, cell[joined], 2 << 2 * axis[joined])
        np.bitwise_or.at(faces, upper[joined], 1 << 2 * axis[joined])
        found = tables.case[cells.mask, faces]
        wrong = ~tables.separable[found]
        if not wrong.any():
            return found
        joined &= ~(wrong[cell] | wrong[upper])


def _points(cells: _SurfaceCells, count: Integers, around: Integers) -> PointRows:
    cell = np.repeat(np.arange(len(count)), count)
    component = np.arange(len(cell)) - np.repeat(np.cumsum(count) - count, count)
    order = stable_order(around.reshape(-1))
    uses = np.bincount(around.reshape(-1), minlength=len(cell))
    return PointRows(
        cell=cells.place[cell],
        size=_ones(len(cell)),
        region=cell_tables().regions[cells.case[cell], component],
        shared=count[cell] > 1,
        edges=order // 4,
        first=np.cumsum(uses) - uses,
    )


def _segments(
    cells: _SurfaceCells, first: Integers, of_cell: Integers, edges: int
) -> tuple[SegmentRows, Integers]:
    """Return the segments, and for each edge those on its four sides.

    Args:
        cells: The cells.
        first: The first point of each cell.
        of_cell: The edges of each cell.
        edges: How many edges there are.
    """
    tables = cell_tables()
    sides: Integers = np.full((edges, 4), -1, np.int32)
    parts = []
    total = 0
    for axis in range(3):
        pairs = tables.segments[cells.case, axis]
        cell, row = np.nonzero(pairs[:, :, 0] >= 0)
        a, b = pairs[cell, row, 0], pairs[cell, row, 1]
        step = np.zeros(3, np.int64)
        step[axis] = 1
        upper = cells.at(cells.brick[cell], cells.local[cell] + step)
        edge_a, edge_b = of_cell[cell, a], of_cell[cell, b]
        numbers = total + np.arange(len(cell))
        sides[edge_a, _SIDES[axis, a]] = numbers
        sides[edge_b, _SIDES[axis, b]] = numbers
        total += len(cell)
        in_next = _IN_NEXT[axis, a]
        parts.append(
            (
                np.full(len(cell), axis, np.int8),
                (cells.place[cell] + step).astype(np.int32),
                first[cell] + tables.component[cells.case[cell], a],
                first[upper] + tables.component[cells.case[upper], in_next],
                edge_a,
                edge_b,
                pairs[cell, 1, 0] >= 0,
            )
        )
    axes, faces, *columns = (np.concatenate(column) for column in zip(*parts, strict=True))
    return SegmentRows(axes, faces, _ones(total), *columns), sides


def _ones(count: int) -> Integers:
    """Return the sizes of equal cells: one number, read as many times as asked."""
    return np.broadcast_to(np.int64(1), count)
