"""The grid of a large smooth union: which members matter in which cell.

Input: the members, in the order in which they are joined. Output: a ``MemberGrid``, or why there is
none. Cells are divided in halves, from a few large ones to the smallest; each takes the list of the
cell that it is a part of, without the members that ``pruning`` finds to be without effect.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.fields.guarantees import ENDLESS
from distal.lang.resources import Buffer
from distal.lang.runtime_access import executor
from distal.scene.lowering.parts.kinds import PartKind, kinds_of
from distal.scene.lowering.parts.rows import row_data
from distal.scene.lowering.smooth.cell_lists import HALVES, WIDTH, CellLists, packed_cells
from distal.scene.lowering.smooth.cells import INFINITE, KINDS, MOST_KINDS, MemberGrid
from distal.scene.lowering.smooth.chain import Link, width_of
from distal.scene.lowering.smooth.members import BoundsOfKind, DistanceOfKind
from distal.scene.lowering.smooth.pruning import Joins, kept_members
from distal.scene.tree.arguments import slots_of

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

REPEATED: Final = "a shape of it depends on the cell of a repetition"
STEEP: Final = "a shape of it has no bound on its slope"

# The space around the union that the grid covers, as a part of its longest side.
MARGIN: Final = 0.1
# How many of the smallest cells there are, times the square root of the number of members; and at
# most.
CELLS_PER_ROOT: Final = 8000
MOST_CELLS: Final = 128**3
# The most blocks along an axis; a block is 4 cells wide.
MOST_BLOCKS: Final = 128
# A block whose list is no longer is not divided into cells.
SHORT: Final = 2
# The most pairs of a cell and a member that are computed for the cells of blocks: where members lie
# dense within the width of their blends, lists are long, and the longest stay those of blocks.
MOST_PAIRS: Final = 48_000_000
# The most pairs of a block and a member: where lists stay long, blocks are larger.
MOST_BLOCK_PAIRS: Final = 16_000_000
# Cells of the first level along the longest axis, at most.
FIRST: Final = 4
# How much larger a cell counts than it is, for the rounding of 32-bit places.
OF_SIZE: Final = 1e-3
OF_PLACE: Final = 4e-6
# The most pairs of a cell and a member that are computed at once.
AT_ONCE: Final = 1_000_000


@dataclass(frozen=True, slots=True)
class Members:
    """The members of a smooth union as arrays, in the order in which they are joined.

    Attributes:
        kinds: The kinds of members.
        functions: The distance of each kind, and its arguments: arrays, one row for each member.
        kind: The number of each member's kind.
        ordinal: The number of each member among those of its kind.
        places: The first vec4 of each member's row.
        rows: The rows.
    """

    kinds: Sequence[PartKind]
    functions: Sequence[tuple[DistanceOfKind, Sequence[Floats]]]
    kind: Whole
    ordinal: Whole
    places: Whole
    rows: Floats

    def distances(self, points: Floats, which: NDArray[np.int32]) -> Floats:
        """Return the distances of points (n, 3) to members (n,)."""
        found = np.empty(len(points))
        of = self.kind[which]
        for k, (function, columns) in enumerate(self.functions):
            chosen = slice(None) if len(self.kinds) == 1 else np.flatnonzero(of == k)
            ordinal = self.ordinal[which[chosen]]
            if len(ordinal):
                args = (points[chosen], *(column[ordinal] for column in columns))
                found[chosen] = executor().call(function, args, {}, device="reference")
        return found


@dataclass(frozen=True, slots=True)
class MemberBounds:
    """The bounds of all members: corners (n, 3) in any order, slope, growth, side growth."""

    low: Floats
    high: Floats
    slope: float
    growth: float
    side_growth: float


def grid_of(links: Sequence[Link]) -> MemberGrid | str:
    """Return the grid of a smooth union, or why it has none."""
    made = [link.member for link in links]
    kinds = kinds_of(made)
    if len(kinds) > MOST_KINDS:
        return KINDS
    names = {slot.name for kind in kinds for f in kind.node.functions() for slot in slots_of(f)}
    if "cell" in names:
        return REPEATED
    bounds = _bounds_of(kinds)
    widths = np.array([width_of(link) for link in links])
    growth = bounds.side_growth * widths.max()
    low, high = bounds.low.min(axis=0) - growth, bounds.high.max(axis=0) + growth
    if not max(np.abs(low).max(), np.abs(high).max()) < ENDLESS:
        return INFINITE
    if not bounds.slope < ENDLESS:
        return STEEP
    order = {id(member): i for i, member in enumerate(made)}
    rows, row_places = row_data(kinds, ())
    chain = np.array([order[id(m)] for kind in kinds for m in kind.members])
    kind = np.repeat(np.arange(len(kinds)), [len(k.members) for k in kinds])
    ordinal = np.concatenate([np.arange(len(k.members)) for k in kinds])
    sorting = np.argsort(chain)
    functions = [(f, f.arguments()) for f in map(DistanceOfKind, kinds)]
    members = Members(kinds, functions, kind[sorting], ordinal[sorting], row_places[sorting], rows)
    joins = Joins(links, widths, bounds.slope)
    return _Building(members, joins, low, high).grid(bounds)


def _bounds_of(kinds: Sequence[PartKind]) -> MemberBounds:
    lows, highs, numbers = [], [], []
    for kind in kinds:
        function = BoundsOfKind(kind)
        found = executor().call(function, tuple(function.arguments()), {}, device="reference")
        low, high, *rest = (np.asarray(part, np.float64) for part in found)
        lows.append(np.broadcast_to(low, (len(kind.members), 3)))
        highs.append(np.broadcast_to(high, (len(kind.members), 3)))
        numbers.append([float(part.max()) for part in rest])
    slope, growth, side_growth = np.max(numbers, axis=0).tolist()
    return MemberBounds(np.concatenate(lows), np.concatenate(highs), slope, growth, side_growth)


def _worth_dividing(count: Whole) -> Whole:
    """Return the blocks that are divided into cells, from the lengths of their lists."""
    order = np.argsort(count, kind="stable")
    pairs = WIDTH**3 * np.cumsum(count[order])
    chosen: Whole = np.sort(order[(pairs <= MOST_PAIRS) & (count[order] > SHORT)])
    return chosen


class _Building:
    """The division of a box into cells with lists of members."""

    def __init__(self, members: Members, joins: Joins, low: Floats, high: Floats) -> None:
        self._members = members
        self._joins = joins
        self._box = low, high
        side = float((high - low).max())
        around = MARGIN * side + OF_PLACE * float(max(np.abs(low).max(), np.abs(high).max()))
        low, high = low - around, high + around
        wanted = min(CELLS_PER_ROOT * math.sqrt(len(members.kind)), MOST_CELLS)
        size = float(np.prod(high - low) / wanted) ** (1 / 3)
        size = max(size, float((high - low).max()) / (4 * MOST_BLOCKS))
        self._size = size
        self._blocks = np.ceil((high - low) / (4 * size)).astype(int)
        middle = 0.5 * (low + high)
        self._low = middle - 2 * size * self._blocks
        self._high = middle + 2 * size * self._blocks
        self._rounding = OF_PLACE * float(max(np.abs(self._low).max(), np.abs(self._high).max()))

    def grid(self, bounds: MemberBounds) -> MemberGrid:
        """Return the grid."""
        blocks = self._blocks_with_lists()
        count = np.diff(blocks.start)
        long = _worth_dividing(count)
        cells = self._divided(self._divided(blocks.chosen(long), -1), -2)
        members = self._members
        packed = packed_cells(blocks, cells, tuple(self._blocks.tolist()), members.places)
        lengths = np.concatenate([np.diff(cells.start), np.delete(count, long)])
        low, high = (tuple(map(float, corner)) for corner in self._box)
        nx, ny, nz = map(int, self._blocks)
        return MemberGrid(
            members.kinds,
            Buffer(members.rows),
            Buffer(packed.cells),
            tuple(map(float, self._low)),
            tuple(map(float, self._high)),
            (nx, ny, nz),
            1.0 / self._size,
            packed.all,
            (low, high),
            bounds.slope,
            (bounds.growth, bounds.side_growth),
            len(lengths),
            int(lengths.max()),
            float(lengths.mean()),
        )

    def _blocks_with_lists(self) -> CellLists:
        """Return all blocks; they are parts of a few large cells, which begin with all members."""
        level = max(math.ceil(math.log2(max(self._blocks.max() / FIRST, 1))), 0)
        places = np.array(list(product(*(range(n) for n in self._counts(level)))))
        every = np.arange(len(self._members.kind), dtype=np.int32)
        start = len(every) * np.arange(len(places) + 1)
        lists = CellLists(places, start, np.tile(every, len(places)))
        made = []
        for cells in lists.batches(AT_ONCE):
            made.append((cells, self._pruned(lists.places[cells], *lists.padded(cells), level)))
        lists = CellLists.merged(made)
        growth = 1.0  # of the pairs by one division, as in the one before
        for below in reversed(range(level)):
            if growth * len(lists.members) > MOST_BLOCK_PAIRS:
                self._enlarge(2 ** (below + 1))
                break
            halves = self._divided(lists, below)
            growth, lists = len(halves.members) / max(len(lists.members), 1), halves
        return lists

    def _enlarge(self, times: int) -> None:
        """Make blocks and cells larger; the lower corner of the grid stays."""
        self._blocks = np.ceil(self._blocks / times).astype(int)
        self._size *= times
        self._high = self._low + 4 * self._size * self._blocks

    def _divided(self, lists: CellLists, level: int) -> CellLists:
        """Return the halves of cells, with their own lists; a level is that of the result."""
        made: list[tuple[Whole, CellLists]] = []
        for cells in lists.batches(AT_ONCE // len(HALVES)):
            places = (2 * lists.places[cells][:, None] + HALVES).reshape(-1, 3)
            inside = np.flatnonzero((places < self._counts(level)).all(axis=1))
            members, mask = lists.padded(cells)
            of = inside // len(HALVES)
            number = len(HALVES) * cells[of] + inside % len(HALVES)
            made.append((number, self._pruned(places[inside], members[of], mask[of], level)))
        return CellLists.merged(made)

    def _counts(self, level: int) -> Whole:
        """Return how many cells of a level there are along each axis; a block is of level 0."""
        counts: Whole = np.ceil(self._blocks / 2.0**level).astype(int)
        return counts

    def _pruned(
        self, places: Whole, members: NDArray[np.int32], mask: NDArray[np.bool_], level: int
    ) -> CellLists:
        """Return cells with the members that matter in them.

        Args:
            places: The number of each cell along each axis.
            members: A list for each cell that has these members, in its row.
            mask: Which entries are members.
            level: How many times a block must be doubled to be as large as a cell.
        """
        size = 4 * self._size * 2.0**level
        reach = 0.5 * math.sqrt(3.0) * size * (1.0 + OF_SIZE) + self._rounding
        middles = self._low + (places + 0.5) * size
        points = np.repeat(middles, mask.sum(axis=1), axis=0)
        d = np.zeros(members.shape)
        d[mask] = self._members.distances(points, members[mask])
        keep = kept_members(self._joins, members, mask, d, reach)
        start = np.concatenate([[0], np.cumsum(keep.sum(axis=1))])
        return CellLists(places, start, members[keep])
