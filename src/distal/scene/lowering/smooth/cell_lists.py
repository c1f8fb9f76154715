"""Lists of members for many cells, as arrays, and the buffer that ``render.smooth_cells`` reads.

Input: cells by their places in a grid, lists of members. Output: halves of cells, batches, arrays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

Whole = NDArray[np.int64]

# Cells of a block along an axis.
WIDTH: Final = 4
# The most entries of lists for which 64-bit numbers are computed at once.
ENTRIES_AT_ONCE: Final = 1_000_000
# The eight parts of a cell that is halved along three axes.
HALVES: Final = np.array(list(product((0, 1), repeat=3)))


@dataclass(frozen=True, slots=True)
class CellLists:
    """Cells of one size and the members that matter in them, in the order of the union.

    Attributes:
        places: The number of each cell along each axis (n, 3).
        start: Where the list of each cell starts in ``members``, and the end (n + 1,).
        members: The lists.
    """

    places: Whole
    start: Whole
    members: NDArray[np.int32]

    def chosen(self, cells: Whole) -> CellLists:
        """Return some of the cells."""
        count = np.diff(self.start)[cells]
        start = np.concatenate([[0], np.cumsum(count)])
        members = np.empty(start[-1], np.int32)
        for run in _runs(start):
            entries = self._entries(cells[run], count[run])
            members[start[run.start] : start[run.stop]] = self.members[entries]
        return CellLists(self.places[cells], start, members)

    def _entries(self, cells: Whole, count: Whole) -> Whole:
        """Return the places of the lists of some cells, one after the other."""
        start = np.concatenate([[0], np.cumsum(count)])
        entries: Whole = np.arange(start[-1]) + np.repeat(self.start[cells] - start[:-1], count)
        return entries

    def batches(self, most: int) -> Iterator[Whole]:
        """Yield the cells in batches of lists of similar lengths, with ``most`` entries each."""
        count = np.diff(self.start)
        order = np.argsort(count, kind="stable")
        end = len(order)
        while end > 0:
            begin = max(end - max(most // max(int(count[order[end - 1]]), 1), 1), 0)
            # A list shorter than half of the longest comes into another batch.
            half = np.searchsorted(count[order], count[order[end - 1]] / 2)
            begin = max(begin, min(int(half), end - 1))
            yield order[begin:end]
            end = begin

    def padded(self, cells: Whole) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """Return the lists of some cells as rows of one array, and which entries are members."""
        count = np.diff(self.start)[cells]
        mask = np.arange(int(count.max())) < count[:, None]
        members = np.zeros(mask.shape, np.int32)
        members[mask] = self.members[self._entries(cells, count)]
        return members, mask

    @staticmethod
    def merged(made: Sequence[tuple[Whole, CellLists]]) -> CellLists:
        """Return the cells of several batches in their first order.

        Args:
            made: The number of each cell, and the cells, for each batch.
        """
        if not made:
            return CellLists(np.zeros((0, 3), int), np.zeros(1, int), np.zeros(0, np.int32))
        number = np.concatenate([cells for cells, _ in made])
        places = np.concatenate([lists.places for _, lists in made])
        count = np.concatenate([np.diff(lists.start) for _, lists in made])
        members = np.concatenate([lists.members for _, lists in made])
        whole = CellLists(places, np.concatenate([[0], np.cumsum(count)]), members)
        return whole.chosen(np.argsort(number))


def _runs(start: Whole) -> Iterator[slice]:
    """Yield runs of cells, each with about ``ENTRIES_AT_ONCE`` entries at most."""
    begin = 0
    while begin < len(start) - 1:
        end = int(np.searchsorted(start, start[begin] + ENTRIES_AT_ONCE, side="right")) - 1
        end = max(end, begin + 1)
        yield slice(begin, end)
        begin = end


@dataclass(frozen=True, slots=True)
class PackedCells:
    """The buffer of a grid.

    Attributes:
        cells: The buffer (``render.smooth_cells``).
        all: The place of the list of all members.
    """

    cells: NDArray[np.int32]
    all: int


def packed_cells(
    blocks: CellLists, cells: CellLists, counts: Sequence[int], rows: Whole
) -> PackedCells:
    """Return the buffer of a grid.

    Args:
        blocks: All blocks.
        cells: The cells of the blocks that are divided.
        counts: The number of blocks along each axis.
        rows: The number of each member's row.
    """
    lists = CellLists.merged(
        [
            (np.arange(len(blocks.places)), blocks),
            (len(blocks.places) + np.arange(len(cells.places)), cells),
        ]
    )
    listed, which = _distinct(lists)
    sides = np.array([1, counts[0], counts[0] * counts[1]])
    of_block = blocks.places @ sides
    in_block = (cells.places // WIDTH) @ sides
    divided = np.unique(in_block)
    head = len(of_block) + WIDTH**3 * len(divided)
    count = np.diff(listed.start)
    # Each list has its count before it.
    place = head + listed.start[:-1] + np.arange(len(count))
    tops = np.empty(len(of_block), int)
    tops[of_block] = place[which[: len(of_block)]]
    begin = len(of_block) + WIDTH**3 * np.arange(len(divided))
    tops[divided] = -1 - begin
    inner = np.empty(WIDTH**3 * len(divided), int)
    within = (cells.places % WIDTH) @ np.array([1, WIDTH, WIDTH**2])
    at = WIDTH**3 * np.searchsorted(divided, in_block) + within
    inner[at] = place[which[len(of_block) :]]
    every = np.concatenate([[len(rows)], rows])
    lines = np.insert(rows.astype(np.int32)[listed.members], listed.start[:-1], count)
    whole = np.concatenate([tops, inner, lines, every])
    return PackedCells(whole.astype(np.int32), len(whole) - len(every))


def _distinct(lists: CellLists) -> tuple[CellLists, Whole]:
    """Return lists without repetition, and which of them each cell has."""
    most = int(lists.members.max()) + 1
    marks = np.random.default_rng(0).integers(1, 2**62, most, dtype=np.int64)
    key = np.zeros(len(lists.places), np.int64)
    for run in _runs(lists.start):
        start = lists.start[run.start : run.stop + 1]
        sums = np.concatenate([[0], np.cumsum(marks[lists.members[start[0] : start[-1]]])])
        key[run] = np.diff(sums[start - start[0]])
    _, first, which = np.unique(key, return_index=True, return_inverse=True)
    # Equal sums of other lists are as good as impossible; the lists decide.
    alike = lists.chosen(first[which])
    if len(alike.members) != len(lists.members) or (alike.members != lists.members).any():
        return lists, np.arange(len(lists.places))
    return lists.chosen(first), which
