"""The programs of pieces as the steps of an accumulator with a small stack.

Input: the operands that are left in each piece. Output: steps, equal programs once.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.scene.lowering.pieces.cell_programs import CellPrograms, ranges
from distal.scene.lowering.pieces.operands import CHAIN, CHANGE, LEAF, Flags, OperandTree, Whole


class StepMode(IntEnum):
    """What a step does with the accumulator, of the value of a leaf or of what was put aside."""

    LOAD = 0
    PUSH = 1  # put the accumulator aside, then load
    JOIN = 2  # join a leaf to the accumulator
    POP = 3  # join the accumulator to what was put aside last
    ONE = 4  # change the accumulator


@dataclass(frozen=True, slots=True)
class EmittedPrograms:
    """Programs.

    Attributes:
        steps: (mode, leaf, join) of each step (n, 3), one program after the other. The leaf is -1
            where there is none. That of a complement is the leaf whose *material* its faces show;
            -1 for that of the accumulator.
        start: The first step of each program.
        count: How many steps each has.
        program: The program of each piece.
        depth: How many values are put aside at once, at most.
    """

    steps: NDArray[np.int32]
    start: Whole
    count: Whole
    program: Whole
    depth: int

    @property
    def has_others(self) -> bool:
        """Whether some steps do something else than to load or join a leaf."""
        mode = self.steps[:, 0]
        return bool(((mode != StepMode.LOAD) & (mode != StepMode.JOIN)).any())


def emitted(cells: CellPrograms, tree: OperandTree) -> EmittedPrograms:
    """Return the programs of cells.

    Args:
        cells: The cells.
        tree: The operands.
    """
    parts = _parts(cells, tree)
    cell, last, sub, mode, leaf, join = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    order = np.lexsort((sub, last, cell))
    steps = np.stack([mode[order], leaf[order], join[order]], axis=1).astype(np.int32)
    count = np.bincount(cell, minlength=len(cells))
    start = np.cumsum(count) - count
    steps[start, 0] = StepMode.LOAD
    aside = (steps[:, 0] == StepMode.PUSH).astype(np.int64) - (steps[:, 0] == StepMode.POP)
    depth = int(np.cumsum(aside).max(initial=0))
    return _shared(steps, start, count, depth)


def _parts(cells: CellPrograms, tree: OperandTree) -> list[tuple[Whole, ...]]:
    """Return the steps in any order: columns of cell, place, order at the place, and the step."""
    found: list[tuple[Whole, ...]] = []
    numbers = cells.cells()
    tops = _tops(cells, tree)
    singles = _singles(cells, tree)
    for level, entries in enumerate(cells.levels):
        node = entries.node
        first, sign = _members(cells, tree, level)
        begins, join = tops[level]
        complement = tree.complement
        steps: tuple[tuple[int, Flags, Any, Any, Any], ...] = (
            # A leaf; a change; what is subtracted, alone; an operand that is no leaf.
            (0, (tree.kind[node] == LEAF) & begins, StepMode.PUSH, tree.leaf[node], -1),
            (0, (tree.kind[node] == LEAF) & ~begins, StepMode.JOIN, tree.leaf[node], join),
            (0, tree.kind[node] == CHANGE, StepMode.ONE, -1, tree.own_join[node]),
            (1, first & (sign < 0.0), StepMode.ONE, tree.shown[node], complement),
            (2, ~first & ~singles[level], StepMode.POP, -1, tree.join[node]),
        )
        for order, chosen, *step in steps:
            at = np.flatnonzero(chosen)
            columns = (numbers[level], tree.last[node], order, *step)
            found.append(tuple(np.broadcast_to(c, len(node))[at] for c in columns))
    return found


def _members(
    cells: CellPrograms, tree: OperandTree, level: int
) -> tuple[Flags, NDArray[np.float64]]:
    """Return whether entries are the first below a node, and the sign with which it takes them."""
    entries = cells.levels[level]
    first = np.ones(len(entries.node), bool)
    if level == 0:
        return first, np.ones(len(first))
    first[1:] = entries.parent[1:] != entries.parent[:-1]
    parent = tree.parent[entries.node]
    return first, tree.turn[parent] * tree.member_turn[entries.node]


def _singles(cells: CellPrograms, tree: OperandTree) -> list[Flags]:
    """Return which entries are the value of one leaf, unchanged, level by level."""
    found: list[Flags] = []
    below = np.zeros(0, bool)
    for level in range(len(cells.levels) - 1, -1, -1):
        entries = cells.levels[level]
        is_single = tree.kind[entries.node] == LEAF
        alone = np.flatnonzero((tree.kind[entries.node] == CHAIN) & (entries.count == 1))
        is_single[alone] = below[entries.start[alone]]
        found.append(is_single)
        _, sign = _members(cells, tree, level)
        below = is_single & (sign > 0.0)
    return found[::-1]


def _tops(cells: CellPrograms, tree: OperandTree) -> list[tuple[Flags, Whole]]:
    """Return how the value of a leaf is taken that comes up to a node unchanged.

    For each level: whether it begins a value of its own, and else how it is joined.
    """
    found: list[tuple[Flags, Whole]] = []
    singles = _singles(cells, tree)
    for level, entries in enumerate(cells.levels):
        first, sign = _members(cells, tree, level)
        begins, join = first.copy(), tree.join[entries.node].copy()
        if level:
            # Alone below a node that is one leaf: what that node is.
            above = entries.parent
            alone = (cells.levels[level - 1].count[above] == 1) & singles[level - 1][above]
            alone &= (sign > 0.0) & (tree.kind[cells.levels[level - 1].node[above]] == CHAIN)
            begins = np.where(alone, found[-1][0][above], begins)
            join = np.where(alone, found[-1][1][above], join)
        found.append((begins, join))
    return found


def _shared(steps: NDArray[np.int32], start: Whole, count: Whole, depth: int) -> EmittedPrograms:
    """Return programs, equal ones once."""
    known: dict[bytes, int] = {}
    first: list[int] = []
    program = np.empty(len(start), np.int64)
    data = steps.tobytes()
    size = steps.shape[1] * steps.itemsize
    for i, (begin, many) in enumerate(zip(start.tolist(), count.tolist(), strict=True)):
        program[i] = known.setdefault(data[begin * size : (begin + many) * size], len(known))
        if program[i] == len(first):
            first.append(i)
    counts = count[first]
    whole = steps[ranges(start[first], counts)]
    return EmittedPrograms(whole, np.cumsum(counts) - counts, counts, program, depth)
