"""Which pieces of the edge each cell has, and how they join to closed loops.

Input: cells with the values at their corners. Output: pieces, each with the piece that follows it.
All is integers; the arithmetic that is needed is a value at the middle of ambiguous cells.

A piece leads through one cell, from the side where it enters to the side where it leaves, with the
inside at its left. A cell has one piece, or two if its opposite corners are equal; then the value
at its middle decides which corners are joined.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines.tiles import CORNERS, EdgeCells, Integers, TileLattice, values_at
from distal.mesh.problems import MeshProblem

# Where each side of a cell begins, and whether it is vertical: its key in the lattice.
_SIDES: Final = np.array([(0, 0, 0), (1, 0, 1), (0, 1, 0), (0, 0, 1)], np.int64)
_DOUBLE: Final = (0b0101, 0b1010)


@dataclass(frozen=True, slots=True)
class Pieces:
    """Pieces of the edge; each enters its cell at another place than all others.

    Attributes:
        cell: The row of its cell in the cells.
        start: The number of the side where it enters, 0 to 3.
        following: The piece that it leads to.
        cut: The corner of the cell that it cuts off, if the cell has two pieces; else -1.
        loops: The pieces of each loop, in order.
    """

    cell: Integers
    start: Integers
    following: Integers
    cut: Integers
    loops: tuple[Integers, ...]


def pieces_of(kernels: FieldKernels, lattice: TileLattice, found: EdgeCells) -> Pieces:
    """Return the pieces of the edge, and their loops.

    Args:
        kernels: The shape.
        lattice: The lattice.
        found: The cells with a change of sign.

    Raises:
        MeshProblem: A value is not a number, or a piece leads out of the lattice.
    """
    inside = found.values < 0.0
    leaves = inside & ~np.roll(inside, -1, axis=1)
    mask = (inside << np.arange(4)).sum(axis=1)
    double = np.isin(mask, _DOUBLE)
    joined = np.zeros(len(mask), np.bool_)
    if double.any():
        middles = lattice.places(found.cells[double] + 0.5)
        joined[double] = values_at(kernels, middles) < 0.0
    cell, start = np.nonzero(leaves)
    enters = ~inside & np.roll(inside, -1, axis=1)
    end = np.argmax(enters, axis=1)[cell]
    # Inside corners that are joined leave outside ones to be cut off, and the reverse.
    end = np.where(double[cell], (start + np.where(joined[cell], 1, 3)) % 4, end)
    cut = np.where(double[cell], np.where(joined[cell], end, start), -1)
    starts, ends = _keys(found.cells[cell], start), _keys(found.cells[cell], end)
    order = np.argsort(starts, kind="stable")
    at = np.minimum(np.searchsorted(starts[order], ends), len(order) - 1)
    following = order[at]
    astray = np.flatnonzero(starts[following] != ends)
    if len(astray):
        raise MeshProblem("leaves its box", tuple(lattice.places(found.cells[cell[astray[0]]])))
    return Pieces(cell, start, following, cut, _loops(following))


def ends_of_sides(found: EdgeCells, pieces: Pieces) -> tuple[Integers, Integers]:
    """Return the lattice points at both ends of the sides where pieces enter."""
    cells = found.cells[pieces.cell]
    return cells + CORNERS[pieces.start], cells + CORNERS[(pieces.start + 1) % 4]


def _keys(cells: Integers, side: Integers) -> Integers:
    """Return a number for each side of a cell, the same for both of its cells."""
    x, y = (cells + _SIDES[side, :2] + 1).T
    keys: Integers = ((x << 31) | y) << 1 | _SIDES[side, 2]
    return keys


def _loops(following: Integers) -> tuple[Integers, ...]:
    """Return the cycles of a permutation, each from its smallest number."""
    rest = following.tolist()
    loops = []
    for first in range(len(rest)):
        if rest[first] < 0:
            continue
        loop, at = [], first
        while rest[at] >= 0:
            loop.append(at)
            rest[at], at = -1, rest[at]
        loops.append(np.array(loop, np.int64))
    return tuple(loops)
