"""Which cells of several sizes belong together.

Input: the cells of a tree. Output: the same rows as ``topology`` makes of equal cells, or cells
that must be divided too. Does not depend on where anything is but for the signs at corners.

Cells that share a corner differ by at most one level. A cell that is smaller than none of its
neighbors has the components of the table. A larger one has the edges and faces of its neighbors
on its boundary; the surface must meet it in one loop of segments: a cone from a point inside a
convex cell over such a loop does not meet itself, so neighbors of unequal size stay closed. A cell
with several loops is divided, until none is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh.cell_tree import CornerValues, Divided, Leaves, widened
from distal.mesh.lattice import position
from distal.mesh.leaf_edges import CrossedEdges, crossed_edges, masks_of, missing_cells, renumbered
from distal.mesh.solid import Bools, Integers
from distal.mesh.tables import cell_tables
from distal.mesh.topology import IN_CELL, EdgeRows, PointRows, SegmentRows, Topology
from distal.polygons.whole_numbers import sorted_keys

# Which of the four cells around an edge is below and which above each of its four sides.
_LOWER: Final = np.array((0, 1, 3, 0))
_UPPER: Final = np.array((1, 2, 2, 3))


@dataclass(frozen=True, slots=True)
class ToDivide:
    """Leaves that must be divided before there is a topology, and cells that are missing.

    Attributes:
        leaves: The keys of leaves, by level.
        missing: The keys of cells of the base level.
    """

    leaves: Divided
    missing: Integers


@dataclass(frozen=True, slots=True)
class _Crossings:
    """Where edges meet faces: one row for each edge and each of its sides that is a face.

    Attributes:
        edge: The edge.
        side: Which of its four sides.
        face: The number of the face.
        count: How many edges of each face are crossed.
        first: The first row of each face.
        last: The last.
        corner: Its lowest corner.
        axis: The axis that it is perpendicular to.
        level: That of the smaller of its two leaves.
        lower: The leaf below it.
        upper: The leaf above.
        one_side: Whether both of its two edges are halves of the same side.
    """

    edge: Integers
    side: Integers
    face: Integers
    count: Integers
    first: Integers
    last: Integers
    corner: Integers
    axis: Integers
    level: Integers
    lower: Integers
    upper: Integers
    one_side: Bools


def _crossings(leaves: Leaves, edges: CrossedEdges, whole: Bools) -> _Crossings:
    lower, upper = edges.around[:, _LOWER], edges.around[:, _UPPER]
    edge, side = np.nonzero(lower != upper)
    low, high = lower[edge, side], upper[edge, side]
    axis = (edges.axis[edge] + 1 + side % 2) % 3
    below = leaves.level[low] >= leaves.level[high]
    # A face is the upper face of the leaf below it, or the lower one of a smaller leaf above it.
    number = np.where(below, low, high) * 6 + axis * 2 + below
    uses = np.bincount(number, minlength=6 * len(leaves.level))
    present = uses > 0
    face = (np.cumsum(present) - 1)[number]
    count = uses[present]
    rows = np.arange(len(edge))
    first, last = np.empty(len(count), np.int64), np.empty(len(count), np.int64)
    first[face[::-1]] = rows[::-1]
    last[face] = rows
    axis, low, high = axis[first], low[first], high[first]
    smaller = np.where(below[first], low, high)
    corner = leaves.corner[smaller]
    every = np.arange(len(count))
    corner[every, axis] = edges.start[edge[first], axis]
    # Two edges on one straight line: the same axis, and the same place along the third axis.
    one_side = np.zeros(len(count), np.bool_)
    some = np.flatnonzero((count == 2) & ~(whole[low] & whole[high]))
    a, b = edge[first[some]], edge[last[some]]
    third = 3 - axis[some] - edges.axis[a]
    along = edges.axis[a] == edges.axis[b]
    one_side[some] = along & (edges.start[a, third] == edges.start[b, third])
    level = leaves.level[smaller]
    return _Crossings(
        edge, side, face, count, first, last, corner, axis, level, low, high, one_side
    )


def _refused(leaves: Leaves, found: _Crossings, whole: Bools) -> tuple[Bools, Integers]:
    """Return the faces whose segments are not simple, and the leaves to divide for that."""
    ends = np.stack([found.lower, found.upper], axis=1)
    ambiguous = (found.count > 2) & ~whole[ends].all(axis=1)
    # An odd number of edges: one of them is not known.
    faces = found.one_side | ambiguous | (found.count == 3)
    rows = np.flatnonzero(found.one_side | ambiguous)
    ends = ends[rows]
    # Those with halved edges; on one straight side, the larger leaves.
    larger = leaves.level[ends] == leaves.level[ends].min(axis=1, keepdims=True)
    wrong = np.where(found.one_side[rows, None], larger, ~whole[ends])
    return faces, sorted_keys(ends[wrong])


def _cases(
    values: CornerValues,
    leaves: Leaves,
    found: _Crossings,
    refused: Bools,
    mask: Integers,
    whole: Bools,
) -> Integers:
    """Return the case of each leaf.

    Args:
        values: Evaluates the shape.
        leaves: The leaves.
        found: Where edges meet faces.
        refused: The faces whose segments are not simple.
        mask: The corners of each leaf that are inside.
        whole: Which leaves have no halved edges.
    """
    tables = cell_tables()
    case: Integers = np.where(whole, tables.case[mask, 0], 0)
    rows = np.flatnonzero((found.count > 2) & ~refused)
    joined = np.zeros(len(found.count), np.bool_)
    if not len(rows):
        return case
    size = (leaves.unit >> found.level[rows])[:, None]
    middles = found.corner[rows] + 0.5 * size * (1.0 - np.eye(3)[found.axis[rows]])
    joined[rows] = values.at(middles) < 0.0
    while True:
        faces = np.zeros(len(mask), np.int64)
        some = np.flatnonzero(joined)
        np.bitwise_or.at(faces, found.lower[some], 2 << 2 * found.axis[some])
        np.bitwise_or.at(faces, found.upper[some], 1 << 2 * found.axis[some])
        case = np.where(whole, tables.case[mask, faces], 0)
        wrong = whole & ~tables.separable[case]
        if not wrong.any():
            return case
        joined &= ~(wrong[found.lower] | wrong[found.upper])


def _several_loops(
    count: int, around: Integers, pairs: Integers, ends: Integers, whole: Bools
) -> Integers:
    """Return the larger leaves that the surface meets in several loops.

    Args:
        count: How many leaves there are.
        around: The leaves around each edge.
        pairs: The two edges of each segment.
        ends: Its two leaves.
        whole: Which leaves have no halved edges.
    """
    edges = np.int64(len(around))
    row, number = np.nonzero(~whole[around])
    nodes = sorted_keys(around[row, number] * edges + row)
    label = np.arange(len(nodes))
    segment, which = np.nonzero(~whole[ends])
    leaf = ends[segment, which]
    one, other = (position(leaf * edges + pairs[segment, i], nodes) for i in (0, 1))
    while True:
        least = np.minimum(label[one], label[other])
        after = label.copy()
        np.minimum.at(after, one, least)
        np.minimum.at(after, other, least)
        # A label is a node too: its own label is smaller, or the same.
        after = after[after]
        if (after == label).all():
            break
        label = after
    own = nodes[sorted_keys(label)] // edges
    loops = np.bincount(own, minlength=count)
    found: Integers = np.flatnonzero(loops > 1)
    return found


def _segment_pairs(
    found: _Crossings, refused: Bools, case: Integers, of_leaf: Integers
) -> tuple[Integers, Integers, Integers]:
    """Return the face, and the two edges of each segment, but for refused faces."""
    segments = np.where(refused, 0, np.minimum(found.count - 1, 2))
    face = np.repeat(np.arange(len(segments)), segments)
    begin = np.cumsum(segments) - segments
    one, other = np.empty(len(face), np.int64), np.empty(len(face), np.int64)
    two = np.flatnonzero(segments == 1)
    one[begin[two]] = found.edge[found.first[two]]
    other[begin[two]] = found.edge[found.last[two]]
    four = np.flatnonzero(segments == 2)
    lower = found.lower[four]
    numbers = cell_tables().segments[case[lower], found.axis[four]]
    for i in range(2):
        one[begin[four] + i] = of_leaf[lower, numbers[:, i, 0]]
        other[begin[four] + i] = of_leaf[lower, numbers[:, i, 1]]
    return face, one, other


@dataclass(frozen=True, slots=True)
class _MetLeaves:
    """Leaves that the surface meets, and how.

    Attributes:
        leaves: The leaves, each beside a crossed edge.
        rows: Their numbers among all leaves.
        edges: The crossed edges whose four leaves are there.
        whole: Which leaves have no halved edges.
        case: Their cases.
        crossings: Where edges meet faces.
        segments: The face, and the two edges of each segment.
        wrong: The leaves that must be divided.
    """

    leaves: Leaves
    rows: Integers
    edges: CrossedEdges
    whole: Bools
    case: Integers
    crossings: _Crossings
    segments: tuple[Integers, Integers, Integers]
    wrong: Integers

    def to_divide(self, wrong: Integers) -> ToDivide:
        """Return leaves that must be divided, with their keys."""
        level, key = self.leaves.level[wrong], self.leaves.key[wrong]
        levels = range(self.leaves.unit.bit_length() - 1)
        return ToDivide(tuple(key[level == number] for number in levels), key[:0])


def _met(values: CornerValues, leaves: Leaves, edges: CrossedEdges, whole: Bools) -> _MetLeaves:
    """Return how the surface meets leaves.

    Args:
        values: The values at corners.
        leaves: The leaves.
        edges: The crossed edges; those with a leaf that is missing are left out.
        whole: Which leaves have no halved edges.
    """
    kept: Bools = np.asarray((edges.around >= 0).all(axis=1))
    edges, rows = renumbered(edges, kept, len(leaves.level))
    leaves, whole = leaves.some(rows), whole[rows]
    mask = masks_of(values.of(leaves))
    found = _crossings(leaves, edges, whole)
    refused, wrong = _refused(leaves, found, whole)
    case = _cases(values, leaves, found, refused, mask, whole)
    face, one, other = _segment_pairs(found, refused, case, edges.of_leaf)
    ends = np.stack([found.lower[face], found.upper[face]], axis=1)
    pairs = np.stack([one, other], axis=1)
    several = _several_loops(len(mask), edges.around, pairs, ends, whole)
    wrong = sorted_keys(np.concatenate([wrong, several]))
    return _MetLeaves(leaves, rows, edges, whole, case, found, (face, one, other), wrong)


def topology_of_leaves(values: CornerValues, leaves: Leaves) -> Topology | ToDivide:
    """Return the topology of the surface in leaves, or what must be divided first.

    Args:
        values: The values at corners.
        leaves: The leaves.

    Raises:
        MeshProblem: A value is no number.
    """
    whole = leaves.whole()
    edges = crossed_edges(leaves, values, whole)
    if (edges.around < 0).any():
        return ToDivide((), missing_cells(leaves, edges))
    met = _met(values, leaves, edges, whole)
    return met.to_divide(met.wrong) if len(met.wrong) else _joined(met)


def to_divide(values: CornerValues, leaves: Leaves, inner: Bools) -> Divided:
    """Return the keys of leaves that must be divided, by level, where not all leaves are known.

    Args:
        values: The values at corners.
        leaves: The leaves that are known.
        inner: Those whose neighbors are known; only they are looked at.

    Raises:
        MeshProblem: A value is no number.
    """
    whole = leaves.whole()
    met = _met(values, leaves, crossed_edges(leaves, values, whole), whole)
    return met.to_divide(met.wrong[inner[met.rows[met.wrong]]]).leaves


def part_of_topology(values: CornerValues, leaves: Leaves, inner: Bools) -> tuple[Topology, Bools]:
    """Return the topology where not all leaves are known, and which edges are as in the whole.

    Args:
        values: The values at corners.
        leaves: The leaves that are known.
        inner: Those whose neighbors are known.

    Raises:
        MeshProblem: A value is no number.
    """
    whole = leaves.whole()
    met = _met(values, leaves, crossed_edges(leaves, values, whole), whole)
    certain: Bools = np.asarray(inner[met.rows][met.edges.around].all(axis=1))
    return _joined(met), certain


def _joined(met: _MetLeaves) -> Topology:
    """Return the rows of the topology."""
    leaves, edges, whole, case = met.leaves, met.edges, met.whole, met.case
    found = met.crossings
    tables, around = cell_tables(), edges.around
    count = np.where(whole, tables.components[case], 1)
    first = np.cumsum(count) - count
    component = tables.component[case[around], IN_CELL[edges.axis]]
    at = first[around] + np.where(whole[around], component, 0)
    leaf = np.repeat(np.arange(len(count)), count)
    nth = np.arange(len(leaf)) - np.repeat(first, count)
    used = np.bincount(at.reshape(-1), minlength=len(leaf)) > 0
    if not used.all():
        # At the rim of what is known, edges of some components are not.
        leaf, nth, at = leaf[used], nth[used], (np.cumsum(used) - 1)[at]
    face, one, other = met.segments
    sides = np.full((len(around), 4), -1, np.int64)
    which = np.full((len(around), 4), -1, np.int64)
    which[found.edge, found.side] = found.face
    numbers = np.arange(len(face))
    points = []
    for edge in (one, other):
        side = (which[edge] == face[:, None]).argmax(axis=1)
        sides[edge, side] = numbers
        points.append((at[edge, _LOWER[side]], at[edge, _UPPER[side]]))
    segments = SegmentRows(
        axis=found.axis[face],
        face=found.corner[face],
        size=leaves.unit >> found.level[face],
        lower=points[0][0],
        upper=points[0][1],
        edge_a=one,
        edge_b=other,
        paired=found.count[face] > 2,
    )
    rows = EdgeRows(
        edges.axis,
        edges.start,
        leaves.unit >> edges.level,
        at,
        sides,
        edges.first,
        edges.second,
    )
    uses = sorted_keys(((at << 32) | np.arange(len(at))[:, None]).reshape(-1))
    of_point = np.bincount(uses >> 32, minlength=len(leaf))
    points_of = PointRows(
        cell=leaves.corner[leaf],
        size=leaves.size[leaf],
        region=np.where(whole[leaf], tables.regions[case[leaf], nth], 255),
        shared=(count[leaf] > 1) & whole[leaf],
        edges=uses & 0xFFFFFFFF,
        first=np.cumsum(of_point) - of_point,
    )
    unit = leaves.unit >> leaves.base
    return Topology(rows, points_of, segments, len(count), unit, _closed(leaves), _larger(leaves))


def _closed(leaves: Leaves) -> Integers:
    """Return the keys of the cells of the base level that are divided, and of those beside them."""
    if leaves.base >= len(leaves.divided):
        return np.empty(0, np.int64)
    return widened(leaves.divided[leaves.base])


def _larger(leaves: Leaves) -> Divided:
    """Return the keys of leaves that are larger than cells of the base level, by their level."""
    return tuple(leaves.key[leaves.of_level(level)] for level in range(leaves.base))
