"""The smallest edges of cells of several sizes that change sign, and the cells around them.

Input: the cells of a tree and the values at their corners. Output: rows of edges, each with its
ends, the values there and the four cells around it, and the cells that are missing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.mesh.cell_tree import HALVES, CornerValues, Leaves, differences
from distal.mesh.lattice import keys_of, position
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tables import EDGES, is_crossed
from distal.mesh.topology import BELOW, IN_CELL
from distal.polygons.whole_numbers import numbers_in, sorted_keys

_CROSSED: Final = np.array([[is_crossed(mask, edge) for edge in range(12)] for mask in range(256)])
_AXIS: Final = np.array([axis for axis, _ in EDGES])
_START: Final = HALVES[[start for _, start in EDGES]]
_ENDS: Final = np.array([(start, start | 1 << axis) for axis, start in EDGES])
# Which of the four cells around its edge a cell is, for each of its edges.
_NUMBER: Final = np.array(
    [int(np.flatnonzero(IN_CELL[axis] == e)[0]) for e, (axis, _) in enumerate(EDGES)]
)
_BELOW: Final = np.array(BELOW)


@dataclass(frozen=True, slots=True)
class CrossedEdges:
    """The smallest edges with a change of sign, in the order of their keys.

    Attributes:
        axis: The axis of each.
        level: The level of the smallest cells around it.
        start: Its lower end, in units.
        first: The value there.
        second: That at the upper end.
        around: The four leaves around it; -1 for one that is missing.
        of_leaf: The edges of each leaf of its own level, of shape (leaves, 12); -1 for none.
    """

    axis: Integers
    level: Integers
    start: Integers
    first: Floats
    second: Floats
    around: Integers
    of_leaf: Integers


def _moved(start: Integers, axis: Integers, number: Integers, side: Integers | int) -> Integers:
    """Return places in the cells around edges, from the edges' lower ends.

    Args:
        start: The lower ends; copied.
        axis: The axes.
        number: Which of the four cells each is.
        side: How far it is moved into a cell that is below.
    """
    found, rows = start.copy(), np.arange(len(start))
    found[rows, (axis + 1) % 3] -= _BELOW[number, 0] * side
    found[rows, (axis + 2) % 3] -= _BELOW[number, 1] * side
    return found


def masks_of(corners: Floats) -> Integers:
    """Return which corners of cells are inside, as bits, from the values there."""
    return np.packbits(corners < 0.0, axis=1, bitorder="little")[:, 0].astype(np.int64)


def _halved(leaves: Leaves, start: Integers, axis: Integers, level: Integers) -> Bools:
    """Return which edges a smaller cell halves: those with a divided cell of their own size."""
    found = np.zeros(len(start), np.bool_)
    for number in numbers_in(level):
        divided = leaves.divided[number] if number < len(leaves.divided) else level[:0]
        rows = np.flatnonzero(level == number)
        keys = keys_of(start[rows] // (leaves.unit >> int(number)))
        for below in range(4):
            ways = _moved(
                np.zeros((len(rows), 3), np.int64), axis[rows], np.full(len(rows), below), 1
            )
            found[rows] |= position(keys + differences(ways), divided) >= 0
    return found


def crossed_edges(leaves: Leaves, values: CornerValues, whole: Bools) -> CrossedEdges:
    """Return the smallest edges that change sign.

    Args:
        leaves: The leaves.
        values: The values at corners.
        whole: Which of them have no halved edge.
    """
    corners = values.of(leaves)
    leaf, edge = np.nonzero(_CROSSED[masks_of(corners)])
    axis, level = _AXIS[edge], leaves.level[leaf]
    start = leaves.corner[leaf] + _START[edge] * leaves.size[leaf, None]
    rows = np.flatnonzero(~whole[leaf])
    rows = rows[_halved(leaves, start[rows], axis[rows], level[rows])]
    if len(rows):
        kept = np.ones(len(leaf), np.bool_)
        kept[rows] = False
        leaf, edge, axis, level, start = (x[kept] for x in (leaf, edge, axis, level, start))
    # A key has the lower end in 57 bits, the axis in 2 and the level in 4.
    shifted = start + 1
    keys = (shifted[:, 0] << 38) | (shifted[:, 1] << 19) | shifted[:, 2]
    keys = (keys << 6) | (axis << 4) | level
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    is_first = np.concatenate([np.ones(min(len(keys), 1), np.bool_), keys[1:] != keys[:-1]])
    number = np.cumsum(is_first) - 1
    first = order[is_first]
    around = np.full((len(first), 4), -1, np.int64)
    around[number, _NUMBER[edge[order]]] = leaf[order]
    of_leaf: Any = np.full((len(corners), 12), -1, np.int32)
    of_leaf[leaf[order], edge[order]] = number
    start, axis, level = start[first], axis[first], level[first]
    row, which = np.nonzero(around < 0)
    side = leaves.unit >> level[row]
    around[row, which] = leaves.at(_moved(start[row], axis[row], which, side), level[row] - 1)
    ends = _ENDS[edge[first]]
    one, other = (corners[leaf[first], ends[:, i]] for i in range(2))
    return CrossedEdges(axis, level, start, one, other, around, of_leaf)


def missing_cells(leaves: Leaves, edges: CrossedEdges) -> Integers:
    """Return the keys of the cells of the base level that are beside edges without a leaf."""
    row, which = np.nonzero(edges.around < 0)
    place = _moved(edges.start[row], edges.axis[row], which, 1)
    return sorted_keys(keys_of(place // (leaves.unit >> leaves.base)))


def renumbered(edges: CrossedEdges, kept: Bools, leaves: int) -> tuple[CrossedEdges, Integers]:
    """Return some edges, and the leaves around them, which get the numbers from 0.

    Args:
        edges: The edges.
        kept: Which of them are kept.
        leaves: How many leaves there are.
    """
    around = edges.around
    numbers = np.full(len(kept) + 1, -1, np.int64)
    if not kept.all():
        around = around[kept]
        numbers[:-1][kept] = np.arange(len(around))
    else:
        numbers[:-1] = np.arange(len(around))
    touched = np.zeros(leaves, np.bool_)
    touched[around.reshape(-1)] = True
    rows = np.flatnonzero(touched)
    renumber = np.cumsum(touched) - 1
    of_leaf = numbers[edges.of_leaf[rows]]
    some = slice(None) if kept.all() else kept
    edges = CrossedEdges(
        edges.axis[some],
        edges.level[some],
        edges.start[some],
        edges.first[some],
        edges.second[some],
        renumber[around],
        of_leaf,
    )
    return edges, rows
