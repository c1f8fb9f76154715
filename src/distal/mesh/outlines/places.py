"""Where the pieces of an edge are: their roots on the lattice, and a point in each cell.

Input: pieces. Output: places. The lines from a piece's roots to its point stay in a convex part of
the plane that no other piece enters, so loops do not cross:

- the cell, for a piece that is alone there;
- the triangle at the corner that is cut off, for one of two pieces;
- the cell and an empty cell beside it, where a corner of the shape is there; only one piece may
  reach into an empty cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC2, Type
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.outlines.arithmetic import (
    POINT_MARGIN,
    cell_point,
    distance_to_line,
    kept_in_region,
    root_on_edge,
)
from distal.mesh.outlines.loops import Pieces, ends_of_sides
from distal.mesh.outlines.tiles import (
    CORNERS,
    Bools,
    EdgeCells,
    Floats,
    Integers,
    TileLattice,
    keys_of,
    known,
)

_ROOT: Final[list[tuple[str, Type]]] = [
    ("start", VEC2),
    ("way", VEC2),
    ("first", FLOAT),
    ("second", FLOAT),
]
_POINT: Final[list[tuple[str, Type]]] = [
    ("a", VEC2),
    ("b", VEC2),
    ("slope_a", VEC2),
    ("slope_b", VEC2),
]
# A corner that is farther from the edge than this share of a cell is no corner.
_NEAR: Final = 1e-3


@dataclass(frozen=True, slots=True)
class Places:
    """The places of pieces.

    Attributes:
        roots: Where each piece enters its cell, of shape (n, 2).
        points: The point of each piece in its cell, of shape (n, 2).
        corners: Which points are corners of the shape.
        cut: How far each corner of the shape is from its point, since it is beyond its region.
        steepest: The largest gradient at a root.
        steepest_at: Where it is.
    """

    roots: Floats
    points: Floats
    corners: Bools
    cut: Floats
    steepest: float
    steepest_at: Floats


def places_of(
    kernels: FieldKernels, lattice: TileLattice, found: EdgeCells, pieces: Pieces
) -> Places:
    """Return the places of pieces.

    Args:
        kernels: The shape.
        lattice: The lattice.
        found: The cells with a change of sign.
        pieces: The pieces of the edge.
    """
    begin, end = (lattice.places(points) for points in ends_of_sides(found, pieces))
    rows = np.arange(len(pieces.cell))
    values = found.values[pieces.cell]
    first, second = values[rows, pieces.start], values[rows, (pieces.start + 1) % 4]
    roots, slopes = kernels.call(root_on_edge, begin, end - begin, first, second, types=_ROOT)
    slopes = np.where(np.isfinite(slopes), slopes, 0.0)
    after = pieces.following
    targets, corner, off = kernels.call(
        cell_point, roots, roots[after], slopes, slopes[after], types=_POINT
    )
    inner = (roots + roots[after]) * 0.5
    targets = np.where(np.isfinite(targets), targets, inner)
    on_edge = (corner > 0.5) & (off < _NEAR * lattice.step)
    low, high = _regions(lattice, found, pieces, targets, on_edge)
    normal, offset = _lines(lattice, found, pieces)
    points, moved = rows_of(kept_in_region, inner, targets, low, high, normal, offset)
    lengths = np.sqrt(np.einsum("ij,ij->i", slopes, slopes))
    steepest = int(np.argmax(lengths))
    return Places(
        roots=roots,
        points=points,
        corners=on_edge & (moved == 0.0),
        cut=np.where(on_edge, moved, 0.0),
        steepest=float(lengths[steepest]),
        steepest_at=roots[steepest],
    )


def _regions(
    lattice: TileLattice, found: EdgeCells, pieces: Pieces, targets: Floats, on_edge: Bools
) -> tuple[Floats, Floats]:
    """Return the box in which each point must stay: its cell, or also an empty one beside it.

    Args:
        lattice: The lattice.
        found: The cells with a change of sign.
        pieces: The pieces of the edge.
        targets: The points that are wanted.
        on_edge: Which of them are corners of the shape.
    """
    cells = found.cells[pieces.cell]
    low, high = cells.astype(np.float64), cells + 1.0
    wanted = np.floor((targets - lattice.origin) / lattice.step)
    wanted = np.clip(wanted, cells - 2, cells + 2).astype(np.int64)
    beside = np.abs(wanted - cells).sum(axis=1) == 1
    reaching = np.flatnonzero(beside & on_edge & (pieces.cut < 0))
    keys = keys_of(wanted[reaching])
    reaching = reaching[~known(keys, keys_of(found.cells))]
    _, unique = np.unique(keys_of(wanted[reaching]), return_index=True)
    reaching = reaching[unique]
    low[reaching] = np.minimum(low[reaching], wanted[reaching])
    high[reaching] = np.maximum(high[reaching], wanted[reaching] + 1.0)
    return lattice.places(low + POINT_MARGIN), lattice.places(high - POINT_MARGIN)


def _lines(lattice: TileLattice, found: EdgeCells, pieces: Pieces) -> tuple[Floats, Floats]:
    """Return the diagonal that ends the region of a piece that cuts off a corner.

    Args:
        lattice: The lattice.
        found: The cells with a change of sign.
        pieces: The pieces of the edge.
    """
    cutting = pieces.cut >= 0
    corner = CORNERS[pieces.cut]
    normal = np.where(cutting[:, None], 1.0 - 2.0 * corner, 0.0)
    place = lattice.places(found.cells[pieces.cell] + corner)
    offset = np.einsum("ij,ij->i", normal, place) + lattice.step * (1.0 - POINT_MARGIN)
    return normal, offset


def nearby(
    lattice: TileLattice, found: EdgeCells, pieces: Pieces, places: Places, tips: Floats
) -> Floats:
    """Return the distance of points to the pieces in the cells around them; infinite without any.

    Args:
        lattice: The lattice.
        found: The cells with a change of sign.
        pieces: The pieces of the edge.
        places: Their places.
        tips: The points, of shape (n, 2).
    """
    nearest = np.full(len(tips), np.inf)
    keys = keys_of(found.cells)[pieces.cell]
    middle = np.floor((tips - lattice.origin) / lattice.step).astype(np.int64)
    for number in range(18):
        wanted = keys_of(middle + np.array((number % 3 - 1, number // 3 % 3 - 1)))
        piece = np.searchsorted(keys, wanted) + number // 9
        there = np.flatnonzero(keys[np.minimum(piece, len(keys) - 1)] == wanted)
        there = there[piece[there] < len(keys)]
        if not len(there):
            continue
        at, point = piece[there], places.points[piece[there]]
        for root in (places.roots[at], places.roots[pieces.following[at]]):
            away = rows_of(distance_to_line, tips[there], root, point)
            nearest[there] = np.minimum(nearest[there], away)
    return nearest


def polylines(places: Places, loops: tuple[Integers, ...]) -> tuple[list[Floats], list[Bools]]:
    """Return the points of each loop, roots and points in turn, and which are corners.

    Args:
        places: The places of the pieces.
        loops: The pieces of each loop.
    """
    both = np.stack([places.roots, places.points], axis=1)
    corners = np.stack([np.zeros_like(places.corners), places.corners], axis=1)
    return (
        [both[loop].reshape(-1, 2) for loop in loops],
        [corners[loop].reshape(-1) for loop in loops],
    )
