"""Bricks: boxes side by side, each with the short program of the values within it.

Input: a program, the boxes and slopes of its leaves, a function that returns distances to leaves.
Output: a grid around the solid, and the program of each of its bricks. It has the values of the
whole program everywhere in the brick, up to rounding. So any point can be asked for its value, also
inside of the solid; pieces (``builder``) have the surface only.

A brick is divided until its program has few leaves or it is small. Away from the surface, where few
points are, programs may be longer and bricks are larger.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
from distal.scene.lowering.pieces.emission import EmittedPrograms, emitted
from distal.scene.lowering.pieces.joins import ValueJoin
from distal.scene.lowering.pieces.operands import Flags, Floats, OperandTree, Whole, operand_tree
from distal.scene.lowering.pieces.programs import PieceProgram


@dataclass(frozen=True, slots=True)
class BrickLimits:
    """When bricks are not divided any more.

    Attributes:
        leaves: Programs of so many leaves are short enough.
        smallest: The longest side of bricks that are small enough, as a fraction of the whole's.
        far: A brick is away from the surface if that is farther than so many times its radius.
        far_leaves: Programs of so many leaves are short enough away from the surface.
        far_smallest: As ``smallest``, away from the surface.
        around: How far bricks reach beyond the box of the solid, as a fraction of its longest side.
        values: After so many distances to leaves no more bricks are divided.
    """

    leaves: int = 8
    smallest: float = 1.0 / 32.0
    far: float = 1.0
    far_leaves: int = 24
    far_smallest: float = 1.0 / 16.0
    around: float = 1.0 / 16.0
    values: int = 4_000_000


@dataclass(frozen=True, slots=True)
class BrickPrograms:
    """A grid of bricks.

    Attributes:
        low: The low corner of the grid.
        high: The high corner.
        counts: How many bricks lie along each axis.
        solid_low: The low corner of the box around the solid.
        solid_high: The high corner.
        growth: The growth of the sides of that box (``fields.guarantees``).
        program: The program of each brick, x fastest, then y.
        programs: The programs.
        joins: How steps join values.
        whole: The program of the whole.
    """

    low: Floats
    high: Floats
    counts: tuple[int, int, int]
    solid_low: Floats
    solid_high: Floats
    growth: float
    program: Whole
    programs: EmittedPrograms
    joins: Sequence[ValueJoin]
    whole: int

    @property
    def share(self) -> float:
        """The number of steps in a brick, on average, for each of the program of the whole."""
        count = self.programs.count
        return float(count[self.program].mean() / count[self.whole])


def build_bricks(
    program: PieceProgram,
    low: Floats,
    high: Floats,
    slopes: Floats,
    distances: LeafDistances,
    limits: BrickLimits = BrickLimits(),
    growths: Floats | None = None,
) -> BrickPrograms:
    """Return the bricks of a program; arguments as for ``builder.build``.

    Raises:
        ValueError: The solid has no finite box.
    """
    growths = np.ones(len(low)) if growths is None else growths
    tree = operand_tree(program, slopes, growths)
    bulges = bulges_of(tree)
    bricks = _BrickDivision(tree, whole_cell(tree, low, high, bulges), limits)
    return bricks.divided(CellPruning(tree, bulges, distances, bricks.farthest))


class _BrickDivision:
    """Bricks under construction.

    Attributes:
        farthest: The largest coordinate.
    """

    def __init__(self, tree: OperandTree, solid: CellPrograms, limits: BrickLimits) -> None:
        self._tree = tree
        self._solid = solid
        self._size = float((solid.high - solid.low).max())
        around = limits.around * self._size
        low, high = solid.low - around, solid.high + around
        self.farthest = float(np.maximum(np.abs(low), np.abs(high)).max())
        self._whole = solid.taken(np.array([0]), low, high, np.array([0]))
        self._limits = limits

    def divided(self, pruning: CellPruning) -> BrickPrograms:
        """Return the bricks."""
        batch, is_far = self._whole, np.array([False])
        # The number of leaves of the boxes around, when their radius was twice as large.
        around = np.full((1, HALVINGS), np.inf)
        done: list[CellPrograms] = []
        while len(batch):
            count = batch.leaf_counts(self._tree)
            divides = self._divides(batch, is_far, count)
            divides &= shortens(self._tree, batch, count, around)
            if pruning.asked + 2 * count[divides].sum() > self._limits.values:
                divides[:] = False
            rest, cells = np.flatnonzero(~divides), np.flatnonzero(divides)
            done.append(batch.taken(rest, batch.low[rest], batch.high[rest], batch.place[rest]))
            around = counts_around(around, count, cells)
            batch = self._halved(batch, cells)
            if len(batch):
                values, reach = pruning.values(batch)
                root, near = values[0], self._limits.far * self._tree.slope[0] * reach
                is_far = (root.low > near) | (root.high < -near)
                batch = pruning.pruned(batch, values, np.ones(len(batch), bool))
        return self._finished(joined_cells(done))

    def _divides(self, batch: CellPrograms, is_far: Flags, count: Whole) -> Flags:
        """Return which bricks are divided because they are large and have many leaves."""
        limits = self._limits
        leaves = np.where(is_far, limits.far_leaves, limits.leaves)
        smallest = np.where(is_far, limits.far_smallest, limits.smallest) * self._size
        found: Flags = (count > leaves) & ((batch.high - batch.low).max(axis=1) > smallest)
        return found

    def _halved(self, batch: CellPrograms, cells: Whole) -> CellPrograms:
        axis = np.argmax(batch.high[cells] - batch.low[cells], axis=1)
        return batch.halved(cells, axis, np.zeros(2 * len(cells), np.int64))

    def _finished(self, boxes: CellPrograms) -> BrickPrograms:
        """Return the grid of boxes that are side by side."""
        whole = self._whole
        programs = emitted(joined_cells([boxes, whole]), self._tree)
        sides = whole.high[0] - whole.low[0]
        halvings = np.round(np.log2(sides / (boxes.high - boxes.low)).max(axis=0))
        counts = (2**halvings).astype(np.int64)
        first, end = (
            np.round((c - whole.low[0]) / sides * counts).astype(np.int64)
            for c in (boxes.low, boxes.high)
        )
        along = end - first
        of = np.repeat(np.arange(len(boxes)), along.prod(axis=1))
        number = ranges(np.zeros(len(boxes), np.int64), along.prod(axis=1))
        x, rest = number % along[of, 0], number // along[of, 0]
        y, z = rest % along[of, 1], rest // along[of, 1]
        i, j, k = (first[of] + np.stack([x, y, z], axis=1)).T
        program = np.empty(counts.prod(), np.int64)
        program[i + counts[0] * (j + counts[1] * k)] = programs.program[of]
        return BrickPrograms(
            low=whole.low[0],
            high=whole.high[0],
            counts=tuple(counts.tolist()),
            solid_low=self._solid.low[0],
            solid_high=self._solid.high[0],
            growth=float(self._tree.growth[0]),
            program=program,
            programs=programs,
            joins=self._tree.joins,
            whole=int(programs.program[-1]),
        )
