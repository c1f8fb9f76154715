"""Pieces: boxes with short programs, whose union is the solid of a program.

Input: a program, the boxes and slopes of its leaves, a function that returns distances to leaves.
Output: a tree of boxes, parents first, each of the last with the program of what matters in it. The
solid is the union of the solids of these programs, each within its own box; boxes that lie within
the solid are left out.

A box is divided until its program has few leaves or it is small. The members of a hard union are
divided as in ``parts.box_tree``; other programs keep only what matters in each half of their box
(``cell_pruning``). At last boxes are put together again where that makes rays cheaper: the cost of
a box is its area times the boxes, visits and leaves within.

All boxes of a level are divided together, as arrays.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from distal.scene.lowering.parts.box_tree import OF_PLACE, OF_SIZE, sorted_within
from distal.scene.lowering.pieces.box_order import BoxNodes, PieceTree, surface
from distal.scene.lowering.pieces.cell_programs import (
    HALVINGS,
    CellPrograms,
    counts_around,
    joined_cells,
    ranges,
    shortens,
    whole_cell,
)
from distal.scene.lowering.pieces.cell_pruning import CellPruning, LeafDistances, bulges_of
from distal.scene.lowering.pieces.emission import emitted
from distal.scene.lowering.pieces.operands import (
    CHAIN,
    Flags,
    Floats,
    OperandTree,
    Whole,
    operand_tree,
)
from distal.scene.lowering.pieces.programs import PieceProgram

# Members of a union that overlap are divided nevertheless from this number on.
MANY_MEMBERS: Final = 64
MOST_OVERLAP: Final = 1.6
MOST_LEVELS: Final = 64


@dataclass(frozen=True, slots=True)
class PieceLimits:
    """When boxes are not divided any more, and what they cost.

    Attributes:
        leaves: Programs of so many leaves are short enough.
        smallest: The longest side of boxes that are small enough, as a fraction of the whole's.
        margin: How far from the surface values are those of the tree, as a fraction of the whole's
            longest side.
        box: The cost of a box, for each unit of area.
        visit: The cost of the visit of a piece.
        leaf: The cost of a leaf of its program.
        values: After so many distances to leaves no more boxes are halved, so that dense blends do
            not take minutes.
        interior: Whether boxes within the solid are pieces, too.
    """

    leaves: int = 4
    smallest: float = 1.0 / 64.0
    margin: float = 5e-4
    box: float = 1.0
    visit: float = 24.0
    leaf: float = 18.0
    values: int = 10_000_000
    interior: bool = False


def build(
    program: PieceProgram,
    low: Floats,
    high: Floats,
    slopes: Floats,
    distances: LeafDistances,
    limits: PieceLimits = PieceLimits(),
    growths: Floats | None = None,
) -> PieceTree:
    """Return the pieces of a program.

    Args:
        program: The program.
        low: The low corners of the boxes of its leaves (n, 3); infinite sides are
            ``UNBOUNDED``.
        high: The high corners.
        slopes: Lipschitz bounds (slopes) of the leaves (n,).
        distances: Returns the distances of points to leaves, each to its own.
        limits: When to stop.
        growths: How fast the sides of the boxes grow with the level (``fields.guarantees``) (n,);
            None: by 1.

    Raises:
        ValueError: The solid has no finite box.
    """
    growths = np.ones(len(low)) if growths is None else growths
    tree = operand_tree(program, slopes, growths)
    margin = OF_SIZE * (high - low) + OF_PLACE * np.maximum(np.abs(low), np.abs(high))
    return _Division(tree, low - margin, high + margin, distances, limits).pieces()


class _Division:
    """The division of a box into pieces."""

    def __init__(
        self,
        tree: OperandTree,
        low: Floats,
        high: Floats,
        distances: LeafDistances,
        limits: PieceLimits,
    ) -> None:
        self._tree = tree
        self._low, self._high = low, high
        self._limits = limits
        self._bulges = bulges_of(tree)
        self._first = whole_cell(tree, low, high, self._bulges)
        farthest = float(np.maximum(np.abs(self._first.low), np.abs(self._first.high)).max())
        self._size = float((self._first.high - self._first.low).max())
        self._margin = limits.margin * self._size
        self._pruning = CellPruning(tree, self._bulges, distances, farthest, self._margin)
        self._is_union = tree.kind[0] == CHAIN and tree.is_open[0] and tree.width[0] == 0.0
        self._nodes = BoxNodes()
        self._batches: list[CellPrograms] = []

    def pieces(self) -> PieceTree:
        """Return the pieces."""
        nodes = self._nodes
        batch, is_inside = self._first, np.array([False])
        around = np.full((1, HALVINGS), np.inf)  # as for ``shortens``
        nodes.added(1)
        while len(batch):
            batch, chosen, members = self._clipped(batch)
            is_inside, around = is_inside[chosen], around[chosen]
            count = batch.leaf_counts(self._tree)
            nodes.fill(batch.place, batch.low, batch.high, self._costs(batch, count), batch.is_cut)
            self._batches.append(batch)
            if len(self._batches) == MOST_LEVELS:
                break
            size = (batch.high - batch.low).max(axis=1, initial=0.0)
            smallest = self._limits.smallest * self._size
            is_divided = (count > self._limits.leaves) & (size >= smallest) & (size > 0.0)
            is_divided &= self._pruning.asked < self._limits.values
            is_divided &= shortens(self._tree, batch, count, around)
            parted, by_member = self._parted(batch, members)
            cells = np.flatnonzero(is_divided & ~by_member & ~is_inside)
            halves, chosen, is_inside = self._halved(batch, cells)
            is_inside = np.concatenate([np.zeros(len(parted), bool), is_inside])
            around = counts_around(around, count, cells)[chosen]
            around = np.concatenate([np.full((len(parted), HALVINGS), np.inf), around])
            batch = joined_cells([parted, halves])
        return self._tree_of_pieces()

    def _costs(self, batch: CellPrograms, count: Whole) -> Floats:
        limits = self._limits
        of_piece = limits.box + limits.visit + limits.leaf * count
        return surface(batch.low, batch.high) * of_piece

    def _clipped(self, batch: CellPrograms) -> tuple[CellPrograms, Flags, tuple[Floats, Floats]]:
        """Return the cells within the boxes of their programs, and which of them have anything.

        Members of a hard union without a box in the cell are dropped; the boxes of the others come
        last.
        """
        boxes = batch.boxes(self._tree, self._low, self._high, self._bulges)
        low = np.maximum(batch.low, boxes[0][:, :3])
        high = np.minimum(batch.high, -boxes[0][:, 3:])
        keep: list[Flags] = [np.ones(len(e.node), bool) for e in batch.levels]
        keep[0] = np.all(low <= high, axis=1)
        members = np.zeros((0, 3)), np.zeros((0, 3))
        if self._is_union:
            cell = batch.levels[1].parent
            members = (
                np.maximum(batch.low[cell], boxes[1][:, :3]),
                np.minimum(batch.high[cell], -boxes[1][:, 3:]),
            )
            keep[1] = np.all(members[0] <= members[1], axis=1)
            keep[0] &= np.bincount(cell[keep[1]], minlength=len(batch)) > 0
            chosen = keep[1] & keep[0][cell]
            members = members[0][chosen], members[1][chosen]
        return replace(batch, low=low, high=high).kept(keep), keep[0], members

    def _parted(
        self, batch: CellPrograms, members: tuple[Floats, Floats]
    ) -> tuple[CellPrograms, Flags]:
        """Return the halves of the members of unions, and which cells are divided by members.

        Args:
            batch: The cells.
            members: The corners of the boxes of all members, within their cells.
        """
        none = np.zeros(0, np.int64)
        nothing = batch.taken(none, batch.low[:0], batch.high[:0], none)
        count = batch.levels[0].count
        several = np.flatnonzero(count > 1)
        if not self._is_union or not len(several):
            return nothing, np.zeros(len(batch), bool)
        number = count[several]
        entry = ranges(batch.levels[0].start[several], number)
        halves = _MemberHalves.of(members[0][entry], members[1][entry], number)
        area = surface(halves.low, halves.high).reshape(-1, 2).sum(axis=1)
        own = surface(batch.low[several], batch.high[several])
        parts = (area < MOST_OVERLAP * own) | (number > MANY_MEMBERS)
        cells, pairs = several[parts], np.repeat(parts, 2)
        place = self._nodes.divided(batch.place[cells], halves.axis[parts])
        twice = batch.taken(np.repeat(cells, 2), halves.low[pairs], halves.high[pairs], place)
        # Each half keeps its own members.
        in_upper = np.zeros(len(batch.levels[1].node), bool)
        in_upper[entry] = halves.is_upper
        starts = np.repeat(batch.levels[0].start[cells], 2)
        source = ranges(starts, np.repeat(count[cells], 2))
        side = np.tile([False, True], len(cells))
        keep: list[Flags] = [np.ones(len(e.node), bool) for e in twice.levels]
        keep[1] = in_upper[source] == side[twice.levels[1].parent]
        by_member = np.zeros(len(batch), bool)
        by_member[cells] = True
        return twice.kept(keep), by_member

    def _halved(self, batch: CellPrograms, cells: Whole) -> tuple[CellPrograms, Flags, Flags]:
        """Return the halves of cells that have a part of the surface, with what matters there.

        Returns:
            The halves; which of both halves of each cell they are; which of them are inside.
        """
        axis = np.argmax(batch.high[cells] - batch.low[cells], axis=1)
        halves = batch.halved(cells, axis, self._nodes.divided(batch.place[cells], axis))
        if not len(halves):
            return halves, np.zeros(0, bool), np.zeros(0, bool)
        values, _ = self._pruning.values(halves)
        is_inside = values[0].high < -self._margin
        chosen = (values[0].low <= self._margin) & (self._limits.interior | ~is_inside)
        return self._pruning.pruned(halves, values, chosen), chosen, is_inside[chosen]

    def _tree_of_pieces(self) -> PieceTree:
        """Return the tree of boxes that is cheapest, and the programs of its pieces."""
        order = self._nodes.order(self._limits.box)
        first = np.cumsum([0, *map(len, self._batches)])
        at = np.concatenate([batch.place for batch in self._batches])
        where = np.empty(self._nodes.count, np.int64)
        where[at] = np.arange(len(at))
        entry = where[order.pieces]
        number = np.searchsorted(first, entry, side="right") - 1
        none = np.zeros(0, np.int64)
        first_batch = self._batches[0]
        parts = [first_batch.taken(none, first_batch.low[:0], first_batch.high[:0], none)]
        places = [none]
        for i, batch in enumerate(self._batches):
            chosen = np.flatnonzero(number == i)
            if len(chosen):
                cells = entry[chosen] - first[i]
                parts.append(batch.taken(cells, batch.low[cells], batch.high[cells], chosen))
                places.append(chosen)
        # The last program is that of the whole tree.
        whole = self._first
        parts.append(whole.taken(np.array([0]), whole.low, whole.high, np.array([0])))
        places.append(np.array([len(order.pieces)]))
        programs = emitted(joined_cells(parts), self._tree)
        program = np.empty(len(order.pieces) + 1, np.int64)
        program[np.concatenate(places)] = programs.program
        return order.tree(programs, program, self._tree.joins)


@dataclass(frozen=True, slots=True)
class _MemberHalves:
    """The halves of the members of several unions.

    Attributes:
        low: The low corners of the boxes around both halves of each union, the lower half first.
        high: The high corners.
        axis: The axis of each union along which its members are divided.
        is_upper: Whether each member is in the upper half.
    """

    low: Floats
    high: Floats
    axis: Whole
    is_upper: Flags

    @staticmethod
    def of(low: Floats, high: Floats, count: Whole) -> _MemberHalves:
        """Return the halves.

        Args:
            low: The low corners of the members, union by union.
            high: The high corners.
            count: How many members each union has; at least two.
        """
        first = np.cumsum(count) - count
        half = count - count // 2
        order, axis = sorted_within(0.5 * (low + high), first, count)
        begins = np.stack([first, first + half], axis=1).ravel()
        is_upper = np.empty(len(low), bool)
        is_upper[order] = np.arange(len(low)) >= np.repeat(first + half, count)
        return _MemberHalves(
            np.minimum.reduceat(low[order], begins),
            np.maximum.reduceat(high[order], begins),
            axis,
            is_upper,
        )
