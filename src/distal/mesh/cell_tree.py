"""Cells of several sizes: which there are, and how they are found.

Input: cells of a lattice, and which cells are divided into eight, level by level. Output: the
cells that are not divided, sorted, and the values at their corners, each computed once. Does not
depend on which of them belong together: that is in ``leaves``.

Level 0 has the largest cells. Samples are taken at the corners of cells of the *base* level: cells
of lower levels are joined from these, cells of higher levels are halves of these.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh.arithmetic import distance_value
from distal.mesh.bricks import check_numbers
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import Lattice, ancestors, cells_of_keys, keys_of, position
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tables import CORNERS
from distal.polygons.whole_numbers import numbers_in, sorted_keys

MOST_LEVELS: Final = 7  # below the base level
# A key has 19 bits for each coordinate.
MOST_UNITS: Final = 2**19 - 4
HALVES: Final = np.array(CORNERS, np.int64)
AROUND: Final = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)], np.int64
)
# The cells that share a face or an edge with a cell.
_BESIDE: Final = AROUND[(AROUND != 0).any(axis=1) & (AROUND == 0).any(axis=1)]


def differences(ways: Integers) -> Integers:
    """Return what is added to a cell's key for each way from it."""
    found: Integers = (ways[:, 0] << 42) + (ways[:, 1] << 21) + ways[:, 2]
    return found


def widened(keys: Integers, rings: int = 1) -> Integers:
    """Return cells and those that share a corner with them, by their keys."""
    found = keys
    for _ in range(rings):
        for way in np.eye(3, dtype=np.int64):
            step = differences(way[None])[0]
            found = sorted_keys(np.concatenate([found - step, found, found + step]))
    return found


def halves_of(keys: Integers) -> Integers:
    """Return the eight halves of cells, by their keys, not sorted."""
    return keys_of((cells_of_keys(keys)[:, None] * 2 + HALVES[None]).reshape(-1, 3))


Divided = tuple[Integers, ...]


def balanced(divided: Iterable[Integers]) -> Divided:
    """Return the cells to divide so that cells that share a corner differ by one level at most.

    Args:
        divided: The keys of the cells that are divided at each level.
    """
    found = [sorted_keys(keys) for keys in divided]
    for level in range(len(found) - 1, 0, -1):
        cells = cells_of_keys(found[level])
        # The cells around one have two parents along each axis.
        parents = keys_of(cells >> 1)
        for axis in range(3):
            step = differences(np.eye(3, dtype=np.int64)[axis][None])[0]
            side = np.where(cells[:, axis] & 1, step, -step)
            cells = cells.repeat(2, axis=0)
            parents = np.stack([parents, parents + side], axis=1).reshape(-1)
        found[level - 1] = sorted_keys(np.concatenate([found[level - 1], parents]))
    return tuple(found)


def together(divided: Divided, more: Divided) -> Divided:
    """Return the cells of either, by level; both are sorted."""
    both = zip(divided, more, strict=True)
    return tuple(a if not len(b) else sorted_keys(np.concatenate([a, b])) for a, b in both)


@dataclass(frozen=True, slots=True)
class Leaves:
    """Cells that are not divided, sorted by level and then by key.

    Attributes:
        corner: The lowest corner of each, of shape (n, 3), in units of the smallest possible cell.
        level: How often a cell of level 0 was halved to make it.
        key: Its key among the cells of its level.
        unit: The side of a cell of level 0.
        base: The level whose corners are sampled.
        divided: The keys of the cells that are divided, by level, sorted.
    """

    corner: Integers
    level: Integers
    key: Integers
    unit: int
    base: int
    divided: Divided

    @property
    def size(self) -> Integers:
        """The side of each."""
        found: Integers = self.unit >> self.level
        return found

    def some(self, rows: Integers | Bools) -> Leaves:
        """Return some of the leaves, in their order."""
        columns = (self.corner[rows], self.level[rows], self.key[rows])
        return Leaves(*columns, self.unit, self.base, self.divided)

    def of_level(self, level: int) -> slice:
        """Return the rows of a level."""
        first, last = np.searchsorted(self.level, (level, level + 1))
        return slice(int(first), int(last))

    def at(self, corner: Integers, level: Integers) -> Integers:
        """Return the leaf of each level that contains a place; -1 for none.

        Args:
            corner: The places, in units.
            level: The levels.
        """
        found = np.full(len(corner), -1, np.int64)
        for number in numbers_in(level):
            rows = np.flatnonzero(level == number)
            some = self.of_level(int(number))
            size = self.unit >> int(number) if number >= 0 else 0
            if some.start < some.stop:
                at = position(keys_of(corner[rows] // size), self.key[some])
                found[rows] = np.where(at < 0, -1, at + some.start)
        return found

    def whole(self) -> Bools:
        """Return which have no edge that a smaller cell halves."""
        found = np.ones(len(self.level), np.bool_)
        steps = differences(_BESIDE)
        for level, divided in enumerate(self.divided):
            some = self.of_level(level)
            keys = self.key[some]
            if not len(divided) or not len(keys):
                continue
            if len(keys) < len(divided):
                beside = np.zeros(len(keys), np.bool_)
                for step in steps:
                    beside |= position(keys + step, divided) >= 0
                found[some] = ~beside
            else:
                around = sorted_keys((divided[:, None] + steps[None]).reshape(-1))
                found[some] = position(keys, around) < 0
        return found

    def near(self, changed: Divided, rings: int) -> Bools:
        """Return which are inside of cells or beside them, at most some cells of each level away.

        Args:
            changed: The keys of cells, by level.
            rings: How many cells away.
        """
        around = ringed(changed, rings)
        found = np.zeros(len(self.level), np.bool_)
        for level in numbers_in(self.level):
            some = self.of_level(int(level))
            found[some] = _are_within(self.key[some], int(level), around)
        return found


def ringed(changed: Divided, rings: int) -> Divided:
    """Return cells and those that are at most some cells of their level away, by level."""
    return tuple(widened(keys, rings) if len(keys) else keys for keys in changed)


def leaves_of(
    cells: Integers, divided: Divided, levels: int, base: int, around: Divided | None = None
) -> Leaves:
    """Return the cells that are not divided.

    Below the base level all halves of a cell are there; above it those that contain a cell.

    Args:
        cells: The keys of the cells of the base level that the surface may pass through, sorted.
        divided: The keys of the cells that are divided at each level; balanced.
        levels: How often cells may be halved.
        base: The level whose corners are sampled.
        around: The keys of cells, by level: only what is in one, or has one in it, is returned.
    """
    unit = 1 << levels
    cells = _of_base(cells, divided[base] if base < len(divided) else cells[:0], base, around)
    none = np.empty(0, np.int64)
    of_level = [sorted_keys(ancestors(cells, base - level)) for level in range(base)]
    candidates = [*of_level, cells][0]
    keys, numbers = [], []
    for level in range(levels + 1):
        if around is not None:
            candidates = candidates[_are_within(candidates, level, around)]
        those = divided[level] if level < len(divided) else none
        is_parted = position(candidates, those) >= 0
        whole, parted = candidates[~is_parted], candidates[is_parted]
        keys.append(whole)
        numbers.append(np.full(len(whole), level))
        if not len(parted):
            break
        if level < base:
            possible = of_level[level + 1] if level + 1 < base else cells
            candidates = possible[position(ancestors(possible, 1), parted) >= 0]
        else:
            candidates = np.sort(halves_of(parted))
    key, level_of = np.concatenate(keys), np.concatenate(numbers)
    corner = cells_of_keys(key) * (unit >> level_of)[:, None]
    return Leaves(corner, level_of, key, unit, base, divided)


def _of_base(
    cells: Integers, divided: Integers, base: int, around: Divided | None = None
) -> Integers:
    """Return the cells of the base level, with those beside divided ones, sorted.

    Args:
        cells: The keys of those that the surface may pass through, sorted.
        divided: The keys of those that are divided.
        base: The level.
        around: Only those in a cell of level 0 with one of these are needed, or around one.
    """
    if around is None:
        return sorted_keys(np.concatenate([cells, widened(divided)])) if len(divided) else cells
    largest = [ancestors(keys, level) for level, keys in enumerate(around)]
    region = sorted_keys(np.concatenate([*largest, cells[:0]]))
    own = cells[position(ancestors(cells, base), region) >= 0]
    beside = divided[position(ancestors(divided, base), widened(region)) >= 0]
    return sorted_keys(np.concatenate([own, widened(beside)]))


def _are_within(keys: Integers, level: int, around: Divided) -> Bools:
    """Return which cells of a level are in cells, or have one in them.

    Args:
        keys: The keys of the cells.
        level: Their level.
        around: The keys of the others, by level, sorted.
    """
    found = np.zeros(len(keys), np.bool_)
    for number, those in enumerate(around):
        if not len(those):
            continue
        if number <= level:
            found |= position(ancestors(keys, level - number), those) >= 0
        else:
            found |= position(keys, sorted_keys(ancestors(those, number - level))) >= 0
    return found


class CornerValues:
    """The values at the corners of cells; those of a cell are computed once.

    Values at a place are the same for each cell that has it as a corner, so signs agree.
    """

    def __init__(self, kernels: FieldKernels, lattice: Lattice) -> None:
        """Begin without values.

        Args:
            kernels: The shape.
            lattice: The lattice of units.
        """
        self.kernels = kernels
        self.lattice = lattice
        self._known: dict[int, tuple[Integers, Floats]] = {}

    def at(self, places: Integers | Floats) -> Floats:
        """Return the values at places.

        Args:
            places: Of shape (n, 3), in units.

        Raises:
            MeshProblem: One is no number.
        """
        where = self.lattice.places(places)
        values: Floats = self.kernels.call(distance_value, where, types=[("p", VEC3)])
        check_numbers(values, where)
        return values

    def of(self, leaves: Leaves) -> Floats:
        """Return the values at the corners of leaves, of shape (n, 8).

        Args:
            leaves: The leaves.

        Raises:
            MeshProblem: A value is no number.
        """
        found = np.empty((len(leaves.level), 8))
        if not len(found):
            return found
        unknown = []
        for level in range(int(leaves.level[0]), int(leaves.level[-1]) + 1):
            some = leaves.of_level(level)
            known = self._known.get(level)
            if known is None:
                unknown.append(np.arange(some.start, some.stop))
                continue
            at = position(leaves.key[some], known[0])
            found[some] = known[1][at]
            unknown.append(some.start + np.flatnonzero(at < 0))
        rows = np.concatenate(unknown)
        if len(rows):
            found[rows] = self._computed(leaves.some(rows))
            self._add(leaves.some(rows), found[rows])
        return found

    def _computed(self, leaves: Leaves) -> Floats:
        corners = leaves.corner[:, None] + HALVES[None] * leaves.size[:, None, None]
        keys, inverse = np.unique(keys_of(corners.reshape(-1, 3)), return_inverse=True)
        found: Floats = self.at(cells_of_keys(keys))[inverse].reshape(-1, 8)
        return found

    def _add(self, leaves: Leaves, values: Floats) -> None:
        for level in numbers_in(leaves.level):
            some = leaves.of_level(int(level))
            keys, found = leaves.key[some], values[some]
            known = self._known.get(int(level))
            if known is not None:
                keys = np.concatenate([known[0], keys])
                # Two sorted runs: a stable sort merges them.
                order = np.argsort(keys, kind="stable")
                keys, found = keys[order], np.concatenate([known[1], found])[order]
            self._known[int(level)] = keys, found
