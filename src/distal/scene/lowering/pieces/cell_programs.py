"""The programs of many cells, as arrays: what is left of the operands in each.

Input: operands. Output: for a batch of cells, the nodes of each that are left, level by level of
the tree, the boxes of their programs, and selections of cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from distal.fields.guarantees import ENDLESS
from distal.scene.lowering.pieces.operands import CHANGE, LEAF, Flags, Floats, OperandTree, Whole

ENDLESS_SOLID: Final = "the solid has no finite box"
# A box has half the radius after so many halvings.
HALVINGS: Final = 3
# Boxes narrower than a blend are divided further if that has left fewer leaves than this share.
SHORTER: Final = 0.6


@dataclass(frozen=True, slots=True)
class CellEntries:
    """The nodes on one level of the trees of many cells, cell by cell, in their order.

    Attributes:
        node: The node (n,).
        parent: The place of the entry above on the level above; on the first level the cell.
        count: How many entries are below each, on the next level.
    """

    node: Whole
    parent: Whole
    count: Whole

    @property
    def start(self) -> Whole:
        """Where the entries below each start on the next level."""
        start: Whole = np.cumsum(self.count) - self.count
        return start


@dataclass(frozen=True, slots=True)
class CellPrograms:
    """Cells and their programs.

    Attributes:
        low: The low corners (n, 3).
        high: The high corners.
        is_cut: Whether the cell ends the solid of its program.
        place: The number of each cell's box.
        levels: The entries, level by level; the first has one for each cell.
    """

    low: Floats
    high: Floats
    is_cut: Flags
    place: Whole
    levels: Sequence[CellEntries]

    def __len__(self) -> int:
        return len(self.low)

    @staticmethod
    def whole(tree: OperandTree, low: Floats, high: Floats) -> CellPrograms:
        """Return one cell with the whole program."""
        levels = []
        above = np.array([-1])
        for level in range(int(tree.level.max()) + 1):
            node = np.flatnonzero(tree.level == level)
            parent = np.searchsorted(above, tree.parent[node])
            levels.append((node, parent))
            above = node
        return CellPrograms(
            low[None], high[None], np.array([False]), np.array([0]), _counted(levels)
        )

    def taken(self, cells: Whole, low: Floats, high: Floats, place: Whole) -> CellPrograms:
        """Return some of the cells, also several times, with other corners and places."""
        levels = []
        chosen = cells
        parent = np.arange(len(cells))
        for entries in self.levels:
            levels.append((entries.node[chosen], parent))
            count = entries.count[chosen]
            parent = np.repeat(np.arange(len(chosen)), count)
            chosen = ranges(entries.start[chosen], count)
        return CellPrograms(low, high, self.is_cut[cells], place, _counted(levels))

    def halved(self, cells: Whole, axis: Whole, place: Whole) -> CellPrograms:
        """Return both halves of some of the cells, the lower ones first.

        Args:
            cells: The cells.
            axis: The axis along which each is halved.
            place: The numbers of the boxes of the halves.
        """
        low, high = self.low[cells], self.high[cells]
        number = np.arange(len(cells))
        middle = 0.5 * (low[number, axis] + high[number, axis])
        lows, highs = np.repeat(low, 2, axis=0), np.repeat(high, 2, axis=0)
        highs[2 * number, axis] = middle
        lows[2 * number + 1, axis] = middle
        halves = self.taken(np.repeat(cells, 2), lows, highs, place)
        return replace(halves, is_cut=np.ones(len(halves), bool))

    def kept(self, keep: Sequence[Flags]) -> CellPrograms:
        """Return the cells without some of their entries, and without what is below those.

        Args:
            keep: For each level, whether each entry is kept. A cell is dropped with its first.
        """
        levels = []
        number = np.arange(len(self))
        alive = np.ones(len(self), bool)
        for entries, own in zip(self.levels, keep, strict=True):
            alive = own & alive[entries.parent]
            levels.append((entries.node[alive], number[entries.parent[alive]]))
            number = np.cumsum(alive) - 1
        cells = keep[0]
        # On the first level the parent is the cell.
        first = levels[0][0]
        levels[0] = (first, np.arange(len(first)))
        return CellPrograms(
            self.low[cells],
            self.high[cells],
            self.is_cut[cells],
            self.place[cells],
            _counted(levels),
        )

    def cells(self) -> list[Whole]:
        """Return the cell of each entry, level by level."""
        found: list[Whole] = []
        above = np.arange(len(self))
        for entries in self.levels:
            above = above[entries.parent]
            found.append(above)
        return found

    def leaf_counts(self, tree: OperandTree) -> Whole:
        """Return the number of leaves of each cell's program."""
        count = np.zeros(len(self), np.int64)
        for entries, cell in zip(self.levels, self.cells(), strict=True):
            leaves = cell[tree.kind[entries.node] == LEAF]
            count += np.bincount(leaves, minlength=len(self))
        return count

    def boxes(self, tree: OperandTree, low: Floats, high: Floats, bulges: Floats) -> list[Floats]:
        """Return the boxes of the entries' solids, level by level: low corners, then high ones.

        Unions have the box around their operands, grown by what their blend adds; intersections
        what all boxes share; what is subtracted, or a complement, has an infinite box. A box may
        end before it begins: nothing is in it, unless what is above moves it outwards.

        Args:
            tree: The operands.
            low: The low corners of the leaves.
            high: The high corners of the leaves.
            bulges: How far the blend of each chain adds at most, for two operands, three ...
                (nodes, counts).
        """
        found: list[Floats] = []
        below = np.zeros((0, 6))
        below_node = np.zeros(0, np.int64)
        for entries in reversed(self.levels):
            node = entries.node
            box = np.empty((len(node), 6))
            kind = tree.kind[node]
            leaves = np.flatnonzero(kind == LEAF)
            box[leaves, :3] = low[tree.leaf[node[leaves]]]
            box[leaves, 3:] = -high[tree.leaf[node[leaves]]]  # the hull is a minimum of both
            inner = np.flatnonzero(entries.count)
            if len(inner):
                start = entries.start[inner]
                # What is subtracted does not end the solid.
                sign = tree.turn[tree.parent[below_node]] * tree.member_turn[below_node]
                below[sign < 0.0] = -np.inf
                hull = np.minimum.reduceat(below, start)
                shared = np.maximum.reduceat(below, start)
                box[inner] = np.where(tree.is_open[node[inner], None], hull, shared)
                out = _moved_out(tree, node[inner], entries.count[inner], bulges)
                box[inner] -= out[:, None]
            found.append(box)
            below, below_node = box.copy(), node
        return found[::-1]


def _moved_out(tree: OperandTree, node: Whole, count: Whole, bulges: Floats) -> Floats:
    """Return how far the box of an inner node is outside of those of its operands."""
    change = np.maximum(tree.shift[node] + np.maximum(tree.half[node], 0.0), 0.0)
    last = bulges.shape[1] - 1
    bulge = np.where(tree.is_open[node], bulges[node, np.minimum(count, last)], 0.0)
    moved: Floats = np.where(tree.kind[node] == CHANGE, change, bulge) * tree.growth[node]
    return moved


def whole_cell(tree: OperandTree, low: Floats, high: Floats, bulges: Floats) -> CellPrograms:
    """Return the box of the whole solid as a cell with the whole program.

    Args:
        tree: The operands.
        low: The low corners of the boxes of the leaves (n, 3).
        high: The high corners.
        bulges: ``cell_pruning.bulges_of`` the operands.

    Raises:
        ValueError: The solid has no finite box.
    """
    whole = CellPrograms.whole(tree, np.full(3, -np.inf), np.full(3, np.inf))
    (box,) = whole.boxes(tree, low, high, bulges)[0]
    if not (np.abs(box) < ENDLESS).all():
        raise ValueError(ENDLESS_SOLID)
    return whole.taken(np.array([0]), box[None, :3], -box[None, 3:], np.array([0]))


def shortens(tree: OperandTree, batch: CellPrograms, count: Whole, around: Floats) -> Flags:
    """Return in which cells smaller ones may have fewer leaves.

    Where blends are wider than a cell, all their shapes matter in smaller ones, too.

    Args:
        tree: The operands.
        batch: The cells.
        count: How many leaves each has.
        around: Those of the boxes around each, the largest first, when they had twice the radius
            and less (n, ``HALVINGS``); infinite for none.
    """
    width = np.zeros(len(batch))
    for entries, cell in zip(batch.levels, batch.cells(), strict=True):
        blends = np.flatnonzero(entries.count > 1)
        np.maximum.at(width, cell[blends], tree.width[entries.node[blends]])
    across = tree.slope[0] * np.sqrt(((batch.high - batch.low) ** 2).sum(axis=1))
    found: Flags = (across > width) | (count < SHORTER * around[:, 0])
    return found


def counts_around(around: Floats, count: Whole, cells: Whole) -> Floats:
    """Return ``around`` of ``shortens`` for both halves of some cells."""
    return np.repeat(np.column_stack([around[cells, 1:], count[cells]]), 2, axis=0)


def joined_cells(batches: Sequence[CellPrograms]) -> CellPrograms:
    """Return the cells of several batches, one after the other."""
    batches = [batch for batch in batches if len(batch)] or batches[:1]
    if len(batches) == 1:
        return batches[0]
    depth = max(len(batch.levels) for batch in batches)
    levels = []
    for level in range(depth):
        nodes, parents = [], []
        offset = 0
        for batch in batches:
            if level < len(batch.levels):
                nodes.append(batch.levels[level].node)
                parents.append(batch.levels[level].parent + offset)
            above = len(batch) if level == 0 else _length(batch, level - 1)
            offset += above
        levels.append((np.concatenate(nodes), np.concatenate(parents)))
    low, high, is_cut, place = (
        np.concatenate([getattr(batch, name) for batch in batches])
        for name in ("low", "high", "is_cut", "place")
    )
    return CellPrograms(low, high, is_cut, place, _counted(levels))


def _length(batch: CellPrograms, level: int) -> int:
    return len(batch.levels[level].node) if level < len(batch.levels) else 0


def _counted(levels: Sequence[tuple[Whole, Whole]]) -> list[CellEntries]:
    """Return entries with the numbers of those below them."""
    found: list[CellEntries] = []
    for i, (node, parent) in enumerate(levels):
        below = levels[i + 1][1] if i + 1 < len(levels) else np.zeros(0, np.int64)
        count = np.bincount(below, minlength=len(node))
        found.append(CellEntries(node, parent, count))
    return found


def ranges(start: Whole, count: Whole) -> Whole:
    """Return ``start, start + 1, ...`` for each start, ``count`` numbers each."""
    end = np.cumsum(count)
    total = int(end[-1]) if len(end) else 0
    found: Whole = np.arange(total) + np.repeat(start - (end - count), count)
    return found
