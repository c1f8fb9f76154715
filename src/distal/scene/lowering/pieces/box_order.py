"""The tree of boxes around pieces: which boxes stay, and their order.

Input: boxes, each divided into two or not, with the cost of its own program. Output: the boxes,
parents first, the lower of two children first along the axis of the division.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from distal.scene.lowering.pieces.emission import EmittedPrograms
from distal.scene.lowering.pieces.joins import ValueJoin
from distal.scene.lowering.pieces.operands import Flags, Floats, Whole


@dataclass(frozen=True, slots=True)
class PieceTree:
    """Pieces in a tree of boxes.

    Attributes:
        low: The low corners of the boxes (n, 3), in the order of the tree, parents first.
        high: The high corners.
        skip: The box that follows if a box is skipped (n,).
        axis: The axis along which the first of the two boxes in a box is the lower one (n,); -1 for
            a box with a piece.
        piece: The piece of a box, -1 for a box with others in it (n,). Pieces have the order of
            their boxes.
        box: The box of each piece (m,).
        is_cut: Whether the box of a piece ends the solid of its program (m,): the piece is the
            solid within the box. Other boxes hold the whole solid of their programs.
        program: The program of each piece (m,).
        programs: The programs.
        joins: How steps join values.
        whole: The program of the whole tree.
    """

    low: Floats
    high: Floats
    skip: Whole
    axis: Whole
    piece: Whole
    box: Whole
    is_cut: Flags
    program: Whole
    programs: EmittedPrograms
    joins: Sequence[ValueJoin]
    whole: int

    @property
    def share(self) -> float:
        """The number of steps in a piece, by area, for each of the program of the whole tree."""
        count = self.programs.count
        area = surface(self.low[self.box], self.high[self.box])
        return float((area * count[self.program]).sum() / (area.sum() * count[self.whole] or 1.0))

    def steps_of(self, piece: int) -> NDArray[np.int32]:
        """Return the steps of a piece: (mode, leaf, join) each."""
        program = self.program[piece]
        start = self.programs.start[program]
        return self.programs.steps[start : start + self.programs.count[program]]


def surface(low: Floats, high: Floats) -> Floats:
    """Return half of the surface of boxes."""
    x, y, z = (high - low).T
    half: Floats = x * y + y * z + z * x
    return half


class BoxNodes:
    """Boxes under construction: pairs of boxes in others, level by level.

    Attributes:
        count: The number of boxes.
    """

    def __init__(self) -> None:
        self.count = 0
        self._filled: list[tuple[Whole, Floats, Floats, Floats, Flags]] = []
        self._divided: list[tuple[Whole, Whole, Whole]] = []

    def added(self, count: int) -> Whole:
        """Return the numbers of new boxes."""
        self.count += count
        return np.arange(self.count - count, self.count)

    def divided(self, place: Whole, axis: Whole) -> Whole:
        """Return the numbers of two new boxes in each of some boxes, the lower ones first."""
        made = self.added(2 * len(place))
        self._divided.append((place, made[::2], axis))
        return made

    def fill(self, place: Whole, low: Floats, high: Floats, cost: Floats, is_cut: Flags) -> None:
        """Keep the boxes of a level that are not empty; ``cost`` is that of a single piece."""
        self._filled.append((place, low, high, cost, is_cut))

    def order(self, box_cost: float) -> BoxOrder:
        """Return the order of the boxes that make rays cheapest.

        Args:
            box_cost: The cost of a box, for each unit of area.
        """
        low, high = np.zeros((2, self.count, 3))
        cost = np.zeros(self.count)
        is_cut, exists = np.zeros((2, self.count), bool)
        child, axis = np.full((2, self.count), -1)
        for place, *parts in self._filled:
            low[place], high[place], cost[place], is_cut[place] = parts
            exists[place] = True
        for place, first, along in self._divided:
            child[place], axis[place] = first, along
        for place, *_ in reversed(self._filled):
            inner = place[child[place] >= 0]
            _collapse(inner, child, exists, (low, high), cost, box_cost)
        return _ordered(
            [place for place, *_ in self._filled], child, exists, low, high, axis, is_cut
        )


def _collapse(
    inner: Whole,
    child: Whole,
    exists: Flags,
    corners: tuple[Floats, Floats],
    cost: Floats,
    box_cost: float,
) -> None:
    """Replace the children of boxes by one piece where that is not more expensive; changes arrays.

    Args:
        inner: The boxes of a level with children.
        child: The first child of each box, -1 for none.
        exists: Whether a box has anything in it.
        corners: The corners.
        cost: The cost of a box and all in it; that of a single piece before.
        box_cost: The cost of a box for each unit of area.
    """
    low, high = corners
    first, second = child[inner], child[inner] + 1
    one, other = exists[first], exists[second]
    exists[inner] = one | other
    either = one | other
    inner, first, second = inner[either], first[either], second[either]
    one, other = one[either], other[either]
    lows = np.minimum(
        np.where(one[:, None], low[first], np.inf), np.where(other[:, None], low[second], np.inf)
    )
    highs = np.maximum(
        np.where(one[:, None], high[first], -np.inf),
        np.where(other[:, None], high[second], -np.inf),
    )
    parts = np.where(one, cost[first], 0.0) + np.where(other, cost[second], 0.0)
    parts += box_cost * surface(lows, highs)
    collapses = cost[inner] <= parts
    child[inner[collapses]] = -1
    stays = ~collapses
    low[inner[stays]], high[inner[stays]] = lows[stays], highs[stays]
    cost[inner[stays]] = parts[stays]


@dataclass(frozen=True, slots=True)
class BoxOrder:
    """The boxes that stay, in their order; as ``PieceTree``.

    Attributes:
        pieces: The number of the box of each piece before they were ordered.
    """

    low: Floats
    high: Floats
    skip: Whole
    axis: Whole
    is_cut: Flags
    pieces: Whole

    def tree(
        self, programs: EmittedPrograms, program: Whole, joins: Sequence[ValueJoin]
    ) -> PieceTree:
        """Return the tree with programs.

        Args:
            programs: The programs.
            program: The program of each piece, and that of the whole tree.
            joins: How they join values.
        """
        box = np.flatnonzero(self.axis < 0)
        piece = np.full(len(self.axis), -1)
        piece[box] = np.arange(len(box))
        corners = (self.low, self.high, self.skip, self.axis)
        own, whole = program[:-1], int(program[-1])
        return PieceTree(*corners, piece, box, self.is_cut[box], own, programs, joins, whole)


def _ordered(
    levels: Sequence[Whole],
    child: Whole,
    exists: Flags,
    low: Floats,
    high: Floats,
    axis: Whole,
    is_cut: Flags,
) -> BoxOrder:
    """Return the order of the boxes that stay; a box with one other in it is that other.

    Args:
        levels: The boxes, level by level.
        child: The first child of each.
        exists: Whether there is anything in it.
        low: The low corners.
        high: The high corners.
        axis: The axis of the division.
        is_cut: Whether it ends the solid of its program.
    """
    size = np.zeros(len(child), np.int64)
    both = np.zeros(len(child), bool)
    for level in reversed(levels):
        inner = level[(child[level] >= 0) & exists[level]]
        leaves = level[(child[level] < 0) & exists[level]]
        size[leaves] = 1
        first, second = child[inner], child[inner] + 1
        pair = exists[first] & exists[second]
        both[inner] = pair
        size[inner] = np.where(exists[first], size[first], 0) + pair
        size[inner] += np.where(exists[second], size[second], 0)
    place = np.full(len(child), -1)
    if exists[0]:
        place[0] = 0
    for level in levels:
        inner = level[(child[level] >= 0) & (place[level] >= 0)]
        first, second = child[inner], child[inner] + 1
        begin = place[inner] + both[inner]
        place[first] = np.where(exists[first], begin, -1)
        after = begin + np.where(exists[first], size[first], 0)
        place[second] = np.where(exists[second], after, -1)
    stays = np.flatnonzero((place >= 0) & (both | (child < 0)) & exists)
    number = np.empty(len(stays), np.int64)
    number[place[stays]] = stays
    axes = np.where(child[number] < 0, -1, axis[number])
    skip = np.arange(len(number)) + size[number]
    leaves = number[axes < 0]
    return BoxOrder(low[number], high[number], skip, axes, is_cut[number], leaves)
