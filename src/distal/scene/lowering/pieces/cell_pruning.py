"""Which operands matter in a cell.

Input: the programs of cells, the distances of their middles to their leaves. Output: the programs
without the operands that cannot change the surface in the cell.

**Up.** A node's values in a cell of radius R lie in an interval: for a leaf of slope L the value in
the middle, v, plus and minus L R; for a minimum the least ends of its operands' intervals; for a
blend also at most its bulge below that, and at most L R from its own value in the middle. A leaf
that moves has two values there, the least and the largest at any time; a blend of it has none,
and neither has one whose size changes: its width and its bulge are the largest.

**Down.** A node has a band of values that matter: at the root those within a margin of the surface.
The rule of all that follows: *an operand may be replaced by another whose values, clamped to its
band, are the same.* Then the node's values, clamped to its own band, are the same. Of a minimum of
operands with intervals [l, h] and the band [low, high], values above ``top = min(high, least h)``
never are the minimum, or are outside of the band, so that operands have the band [low, top], and
one with l > top is dropped. If the least h is below the band, so is the minimum, and one operand is
enough. A maximum is a minimum with turned signs, and so are a difference's first operand and a
complement. A shift shifts the band; a shell |v - s| - t needs |v - s| <= high + t.

**Blends** of width w are the minimum where two values differ by w or more, and are nowhere steeper
than their operands. For two operands, one above top + w has no effect: if the other is lower by w
or more, the blend is the other; if not, the other is above top too, and the blend is at least
(a + b - w) / 2 > top. That is exact. In a chain of equal blends each could widen the band once
more; instead it is widened once, by 2 w (``WIDENING``). What is dropped then changes what is joined
before by at most w / 4 (quadratic), and each blend that brings the value down to the band passes on
a share of that, at most .086 for each w that the value falls: the error that one operand makes is
at most .0034 w, that of all dropped operands together about .04 w. Of all families the circular one
passes on most: .01 w and .072 w. Blends whose share does not fall (``ValueJoin.settles``) are
joined two by two.

**Materials.** In a difference only the cutter may bound the surface while the first operand shows
its material there. If that shows one material the emitted complement names a leaf with it
(``OperandTree.shown``); else it stays (``must_stay``), and then *all* its values matter.

Source: Barbier et al., "Lipschitz Pruning: Hierarchical Simplification of Primitive-Based SDFs",
Eurographics 2025, for the intervals and the difference of two operands; the bands are our own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np

from distal.lang.runtime_access import executor
from distal.scene.lowering.parts.box_tree import OF_PLACE
from distal.scene.lowering.pieces.cell_programs import CellEntries, CellPrograms
from distal.scene.lowering.pieces.joins import JoinCode, ValueJoin
from distal.scene.lowering.pieces.operands import CHAIN, LEAF, Flags, Floats, OperandTree, Whole

# The least and the largest distances of points (n, 3) to leaves (n,) at all times: floats (n,).
LeafDistances: TypeAlias = Callable[[Floats, Whole], tuple[Floats, Floats]]

# What the middle of a cell is away from its corners, more than computed, for rounding.
OF_REACH: Final = 5e-4
# Blends of more operands than this add as much as a whole width.
MOST_BULGES: Final = 32
# By how many widths the band of a chain of more than two operands is widened.
WIDENING: Final = 2.0
# How much operands beyond twice the width may change a blend, in widths.
MOST_BEYOND: Final = 0.08


@dataclass(slots=True)
class EntryIntervals:
    """The values of the entries of one level.

    Attributes:
        middle: In the middle of the cell; NaN if it moves.
        low: The low ends of their intervals.
        high: The high ends.
    """

    middle: Floats
    low: Floats
    high: Floats

    def turned(self, sign: Floats) -> EntryIntervals:
        """Return the values times signs."""
        low = np.where(sign < 0.0, -self.high, self.low)
        return EntryIntervals(sign * self.middle, low, np.where(sign < 0.0, -self.low, self.high))

    def chosen(self, entries: Whole) -> EntryIntervals:
        """Return the values of some of the entries."""
        return EntryIntervals(self.middle[entries], self.low[entries], self.high[entries])


class CellPruning:
    """Prunes the programs of cells.

    Attributes:
        asked: How many distances to leaves were asked for.
    """

    def __init__(
        self,
        tree: OperandTree,
        bulges: Floats,
        distances: LeafDistances,
        farthest: float,
        margin: float = np.inf,
    ) -> None:
        """Prepare the operands.

        Args:
            tree: The operands.
            bulges: How far each chain's blend is below the least of 0, 1, 2 ... equal values.
            distances: Returns the distances of points to leaves, each to its own, from and to.
            farthest: The largest coordinate, for rounding.
            margin: How far from the surface values matter. If all do, nothing is dropped that has
                an effect anywhere, also in chains of blends.
        """
        self._tree = tree
        self._distances = distances
        self._farthest = farthest
        self._margin = margin
        self._bulges = bulges
        self.asked = 0

    def pruned(
        self, cells: CellPrograms, values: Sequence[EntryIntervals], chosen: Flags
    ) -> CellPrograms:
        """Return some of the cells, with what matters there.

        Args:
            cells: The cells.
            values: The values in them (``values``).
            chosen: Which of them are kept.
        """
        keep = [chosen]
        low, high = np.full(len(cells), -self._margin), np.full(len(cells), self._margin)
        for i, entries in enumerate(cells.levels[:-1]):
            below = cells.levels[i + 1]
            kept, low, high = self._below(entries, below, values[i + 1], low, high)
            keep.append(kept)
        return cells.kept(keep)

    # Up

    def values(self, cells: CellPrograms) -> tuple[list[EntryIntervals], Floats]:
        """Return the values in cells, level by level, and the radius of each cell.

        Those on the first level are the values of the tree.
        """
        reach = 0.5 * np.sqrt(((cells.high - cells.low) ** 2).sum(axis=1)) * (1.0 + OF_REACH)
        reach += OF_PLACE * self._farthest
        return self._values(cells, self._leaf_distances(cells), reach), reach

    def _leaf_distances(self, cells: CellPrograms) -> list[tuple[Floats, Floats]]:
        """Return the distances of the cells' middles to their leaves, level by level."""
        middle = 0.5 * (cells.low + cells.high)
        points, leaves, counts = [], [], []
        for entries, cell in zip(cells.levels, cells.cells(), strict=True):
            chosen = self._tree.kind[entries.node] == LEAF
            points.append(middle[cell[chosen]])
            leaves.append(self._tree.leaf[entries.node[chosen]])
            counts.append(len(leaves[-1]))
        self.asked += sum(counts)
        low, high = (
            np.split(end, np.cumsum(counts)[:-1])
            for end in self._distances(np.concatenate(points), np.concatenate(leaves))
        )
        return list(zip(low, high, strict=True))

    def _values(
        self,
        cells: CellPrograms,
        distances: Sequence[tuple[Floats, Floats]],
        reach: Floats,
    ) -> list[EntryIntervals]:
        tree, found = self._tree, list[EntryIntervals]()
        numbers = cells.cells()
        for i in range(len(cells.levels) - 1, -1, -1):
            entries = cells.levels[i]
            node = entries.node
            around = tree.slope[node] * reach[numbers[i]]
            values = EntryIntervals(*(np.empty(len(node)) for _ in range(3)))
            leaves = tree.kind[node] == LEAF
            low, high = distances[i]
            values.middle[leaves] = np.where(low == high, low, np.nan)
            values.low[leaves] = low - around[leaves]
            values.high[leaves] = high + around[leaves]
            inner = np.flatnonzero(entries.count)
            if len(inner):
                below = cells.levels[i + 1]
                joined = self._joined(entries, inner, below, found[-1], around[inner])
                values.middle[inner] = joined.middle
                values.low[inner], values.high[inner] = joined.low, joined.high
            found.append(values)
        return found[::-1]

    def _joined(
        self,
        entries: CellEntries,
        inner: Whole,
        below: CellEntries,
        operands: EntryIntervals,
        around: Floats,
    ) -> EntryIntervals:
        """Return the values of nodes with operands.

        Args:
            entries: The entries of a level.
            inner: Those with operands.
            below: The operands.
            operands: Their values.
            around: By how much the value of each node changes in its cell at most.
        """
        tree = self._tree
        node, start = entries.node[inner], entries.start[inner]
        turned = operands.turned(tree.member_turn[below.node])
        least = EntryIntervals(
            *(np.minimum.reduceat(v, start) for v in (turned.middle, turned.low, turned.high))
        )
        many = entries.count[inner] > 1
        for join in np.unique(tree.own_join[node[(tree.width[node] > 0.0) & many]]).tolist():
            chosen = np.flatnonzero((tree.own_join[node] == join) & many)
            count = entries.count[inner][chosen]
            last = self._bulges.shape[1] - 1
            least.low[chosen] -= self._bulges[node[chosen], np.minimum(count, last)]
            if tree.joins[join].moving is not None:
                least.middle[chosen] = np.nan
            is_still = ~np.isnan(least.middle[chosen])
            chosen, count = chosen[is_still], count[is_still]
            if not len(chosen):
                continue
            self._blend(tree.joins[join], count, chosen, start, turned, least)
            reach = around[chosen] + MOST_BEYOND * tree.width[node[chosen]]
            low, high = least.middle[chosen] - reach, least.middle[chosen] + reach
            least.low[chosen] = np.maximum(least.low[chosen], low)
            least.high[chosen] = np.minimum(least.high[chosen], high)
        found = least.turned(tree.turn[node])
        shift, half = tree.shift[node], tree.half[node]
        for values in (found.middle, found.low, found.high):
            values -= shift
        shells = np.flatnonzero(half >= 0.0)
        if len(shells):
            low, high = found.low[shells], found.high[shells]
            found.low[shells] = np.maximum(np.maximum(low, -high), 0.0) - half[shells]
            found.high[shells] = np.maximum(-low, high) - half[shells]
            found.middle[shells] = np.abs(found.middle[shells]) - half[shells]
        return found

    def _blend(
        self,
        join: ValueJoin,
        size: Whole,
        chosen: Whole,
        start: Whole,
        turned: EntryIntervals,
        least: EntryIntervals,
    ) -> None:
        """Put the blended values of some chains in place of the least of their operands.

        Only operands within twice the width of the least are joined.

        Args:
            join: How the chains join.
            size: How many operands each has.
            chosen: Which of the nodes they are.
            start: Where the operands of each start.
            turned: The values of the operands, with their signs in the chain.
            least: The least values of each; the middle values change.
        """
        chain = np.repeat(np.arange(len(chosen)), size)
        ends = np.cumsum(size)
        entry = np.arange(int(ends[-1])) + np.repeat(start[chosen] - (ends - size), size)
        value = turned.middle[entry]
        near = value <= least.middle[chosen][chain] + WIDENING * join.width
        value, chain = value[near], chain[near]
        number = np.bincount(chain, minlength=len(chosen))
        first = np.cumsum(number) - number
        joined = value[first]
        for i in range(1, int(number.max())):
            here = np.flatnonzero(number > i)
            joined[here] = blended(join, joined[here], value[first[here] + i])
        least.middle[chosen] = joined

    # Down

    def _below(
        self,
        entries: CellEntries,
        below: CellEntries,
        operands: EntryIntervals,
        low: Floats,
        high: Floats,
    ) -> tuple[Flags, Floats, Floats]:
        """Return which operands are kept, and their bands.

        Args:
            entries: The entries of a level.
            below: The operands.
            operands: Their values.
            low: The least value of each entry that matters.
            high: The largest.
        """
        tree = self._tree
        inner = np.flatnonzero(entries.count)
        if not len(inner):
            return np.zeros(0, bool), np.zeros(0), np.zeros(0)
        node, count, start = entries.node[inner], entries.count[inner], entries.start[inner]
        low, high = self._inside(node, low[inner], high[inner])
        of = np.repeat(np.arange(len(inner)), count)
        sign = tree.member_turn[below.node]
        turned = operands.turned(sign)
        most = np.minimum.reduceat(turned.high, start)
        width = tree.width[node]
        is_long = (count > 2) & (width > 0.0)
        is_exact = self._margin == np.inf
        beyond = np.where(is_long, np.inf if is_exact else WIDENING * width, width)
        top = np.minimum(high, most)
        keep = turned.low <= (top + beyond)[of]
        if is_exact:
            chains = np.flatnonzero(is_long[of])
            if len(chains):
                place = chains - start[of[chains]]
                keep[chains] &= self._effective(node, of[chains], place, turned.chosen(chains))
        best = _first_least(turned.high, most, of, start)
        keep &= (most >= low)[of]  # below the band one is enough
        none = np.add.reduceat(keep.astype(np.int64), start) == 0
        keep[best[none]] = True
        kept = np.add.reduceat(keep.astype(np.int64), start)
        band_low = low[of]
        band_high = np.maximum(top + np.where(kept > 1, beyond, 0.0), low)[of]
        stays = np.flatnonzero(tree.must_stay[below.node])
        stays = stays[kept[of[stays]] - keep[stays] > 0]  # where others are kept
        keep[stays] = True
        band_low[stays], band_high[stays] = turned.low[stays], turned.high[stays]
        own = sign < 0.0
        return (
            keep,
            np.where(own, -band_high, band_low),
            np.where(own, -band_low, band_high),
        )

    def _effective(self, node: Whole, of: Whole, place: Whole, operands: EntryIntervals) -> Flags:
        """Return which operands of chains have an effect on what is joined before, and after.

        What is joined before is at most the least of its operands, and below it by its bulge. An
        operand that is farther by the width has no effect on it; if it is nearer by as much, what
        is joined before has none.

        Args:
            node: The chains.
            of: The chain of each operand.
            place: Its place in the chain.
            operands: The values of the operands, with their signs in the chain.
        """
        width = self._tree.width[node[of]]
        last = self._bulges.shape[1] - 1
        bulge = self._bulges[node[of], np.minimum(place, last)]
        least_high = np.append(np.inf, running_least(operands.high, of)[:-1])
        least_low = np.append(np.inf, running_least(operands.low, of)[:-1])
        later = place > 0
        keep = ~later | (operands.low < least_high + width)
        replaces = later & (operands.high <= least_low - bulge - width)
        first = np.flatnonzero(~later)
        since = np.maximum.reduceat(np.where(replaces, place, 0), first)
        return keep & (place >= np.repeat(since, np.diff(np.append(first, len(place)))))

    def _inside(self, node: Whole, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Return the bands of values below the signs and changes of nodes."""
        tree = self._tree
        shell = tree.half[node] >= 0.0
        across = np.maximum(high + tree.half[node], 0.0)
        low = np.where(shell, -across, low) + tree.shift[node]
        high = np.where(shell, across, high) + tree.shift[node]
        turn = tree.turn[node] < 0.0
        return np.where(turn, -high, low), np.where(turn, -low, high)


def running_least(values: Floats, group: Whole) -> Floats:
    """Return the least of each value and of those before it in its group.

    Args:
        values: The values, group by group.
        group: The number of each value's group, in rising order.
    """
    is_finite = np.isfinite(values)
    low = values.min(initial=0.0, where=is_finite) - 1.0
    high = values.max(initial=0.0, where=is_finite) + 1.0
    # Each group is below those before it.
    below = group * (high - low + 1.0)
    found: Floats = np.minimum.accumulate(np.clip(values, low, high) - below) + below
    found[found >= high - 0.5] = np.inf
    found[found <= low + 0.5] = -np.inf
    return found


def _first_least(values: Floats, least: Floats, of: Whole, start: Whole) -> Whole:
    """Return the place of the first least value of each group."""
    at = np.flatnonzero(values == least[of])
    group = of[at]
    _, first = np.unique(group, return_index=True)
    found: Whole = at[first]
    return found


def blended(join: ValueJoin, a: Floats, b: Floats) -> Floats:
    """Return the blend of two values, with their signs in a chain: as a union."""
    above = join.code is not JoinCode.UNION
    first = -a if above else a
    second = -b if join.code is JoinCode.INTERSECTION else b
    given: dict[str, Any] = {"a": first, "b": second, **dict(join.numbers)}
    function = join.rule.combine
    assert function is not None
    found = np.asarray(executor().call(function, (), given, device="reference"), np.float64)
    return -found if above else found


def bulges_of(tree: OperandTree) -> Floats:
    """Return how far the blend of each node is below n equal values, for n from 0.

    Of values that are all 0 or more the blend is at least that, because it never falls where a
    value grows.
    """
    count = min(int(np.bincount(tree.parent[1:]).max(initial=0)), MOST_BULGES)
    found = np.zeros((len(tree.kind), count + 2))
    chains = np.flatnonzero((tree.kind == CHAIN) & (tree.width > 0.0))
    for join in np.unique(tree.own_join[chains]).tolist():
        chosen = chains[tree.own_join[chains] == join]
        value = np.zeros(1)
        for n in range(2, count + 1):
            value = blended(tree.joins[join], value, np.zeros(1))
            found[chosen, n] = -value[0]
        found[chosen, count + 1] = tree.width[chosen]
    return found
