"""Places on the surface of a shape, for each of its leaves, copies included.

Input: a tree, the box around it and a length. Output: places where a leaf is 0, the shape is 0 and
changes its sign across: what other shapes swallow is not there, nor are faces in the middle of a
solid. Works for solids and for flat shapes.

Boxes are halved where leaf and shape can both be 0 by their slopes. Where a leaf turns back within
a box, as a bore or a sheet does that is thinner than it, the box is halved again: each copy and
each side has boxes of its own. A leaf of known width turns back in smaller boxes at knife edges
only, and these are no walls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh import arithmetic
from distal.mesh.bricks import Slopes
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.leaf_fields import FieldProbe, LeafFields
from distal.mesh.leaf_spacing import LEAST_WALL
from distal.mesh.outlines import arithmetic as flat_arithmetic
from distal.mesh.solid import Bools, Floats, Integers
from distal.scene.lowering.placed_leaves import PlacedLeaf

# How many boxes there are at least along the largest side.
LEAST_BOXES: Final = 24
# The most rows of a leaf and a box that are looked at below this size.
_MOST_ROWS: Final = 300_000
# The surface must change its sign within this share of the tolerance: walls and gaps that are
# thinner count as none, as for the spacing.
ACROSS: Final = LEAST_WALL
# A place is this close to the surface, as a share of the tolerance.
_CLOSE: Final = 0.02
# Boxes are not halved below this share of the tolerance.
_LEAST_SIDE: Final = 0.05
_STEEP: Final = 1e6  # a slope above it says nothing
# The values on both sides are at least this share of the distance between.
_CLEAR: Final = 0.05
_NEWTON_STEPS: Final = 3
_TURNS: Final = 2  # how often a place that is beside the shape's surface is moved along the leaf
_BACK: Final = -0.75  # the cosine between normals below which a leaf turns back
# Boxes are halved to this share of a leaf's width, where it is known; each side has its own then.
_OF_WIDTH: Final = 0.5
_SHIFT: Final = (0.0131, 0.0173, 0.0157)  # keeps middles of boxes off axes of symmetry


@dataclass(frozen=True, slots=True)
class LeafRows:
    """Rows of a leaf and a box, sorted by leaf, with a place on the surface.

    Attributes:
        leaf: The number of the leaf.
        cell: The box, in units of its own side.
        side: The side of the box.
        place: The place.
        outward: The normal of the shape there, of length 1.
    """

    leaf: Integers
    cell: Integers
    side: Floats
    place: Floats
    outward: Floats

    def some(self, rows: Integers | Bools) -> LeafRows:
        """Return some of the rows, in their order."""
        leaf, cell, side = self.leaf[rows], self.cell[rows], self.side[rows]
        return LeafRows(leaf, cell, side, self.place[rows], self.outward[rows])

    def __len__(self) -> int:
        return len(self.leaf)


@dataclass(slots=True)
class _Level:
    """Boxes of one size, each with a leaf that can be 0 in it.

    Attributes:
        leaf: The number of the leaf, sorted.
        cell: The box.
        parent: A number that the halves of one box share.
        side: Their side.
    """

    leaf: Integers
    cell: Integers
    parent: Integers
    side: float


class LeafSearch:
    """Finds the places of the leaves of a shape.

    Attributes:
        leaves: The leaves.
        unchecked: Those that are estimates, or of too many kinds: their surface is not known.
        coarse: The numbers of leaves that are thinner than the boxes that were looked at.
    """

    def __init__(
        self, kernels: FieldKernels, low: Floats, high: Floats, slopes: Slopes, tolerance: float
    ) -> None:
        """Prepare a search.

        Args:
            kernels: The shape.
            low: The low corner of its box.
            high: The high corner.
            slopes: How fast its values change.
            tolerance: The tolerance of the mesh or the outline.
        """
        node = kernels.node
        self._fields = LeafFields(kernels)
        self._shape = FieldProbe(kernels)
        self._slopes = slopes
        self.leaves: tuple[PlacedLeaf, ...] = self._fields.leaves
        estimates = (leaf for leaf in self.leaves if leaf.leaf.estimate)
        self.unchecked = tuple(dict.fromkeys((*estimates, *self._fields.unseen)))
        self.coarse: set[int] = set()
        self._low, self._high = low, high
        size = float((high - low).max())
        self._across = ACROSS * tolerance
        self._close = _CLOSE * tolerance
        self._least = _LEAST_SIDE * tolerance
        self._root = 1.1 * size
        self._origin = (low + high - self._root) / 2.0 - size * np.array(_SHIFT[: len(low)])
        self._first = size / LEAST_BOXES
        numbers = self._fields.numbers
        self._enough = np.where(numbers.known, _OF_WIDTH * numbers.width, 0.0)
        self._rows = 0
        self._halves = np.indices((2,) * len(low)).reshape(len(low), -1).T
        self._radius = 0.5 * np.sqrt(len(low)) * 1.000001
        self._step_along = flat_arithmetic.step_along if node.flat else arithmetic.step_along

    def places(self) -> LeafRows:
        """Return places of all leaves."""
        count = len(self.leaves)
        solid = [not leaf.leaf.estimate for leaf in self.leaves]
        leaf = np.flatnonzero(np.array(solid, np.bool_))
        cell = np.zeros((len(leaf), len(self._low)), np.int64)
        level = self._near(_Level(leaf, cell, np.arange(count)[leaf], self._root))
        while level.side > self._first and len(level.leaf):
            level = self._near(self._halved(level))
        return self._searched(level)

    def finer(self, rows: LeafRows) -> LeafRows:
        """Return places in the halves of boxes.

        Args:
            rows: The rows of the boxes.
        """
        found = []
        self._rows = 0
        for side in np.unique(rows.side):
            some = rows.some(rows.side == side)
            level = _Level(some.leaf, some.cell, np.arange(len(some)), float(side))
            found.append(self._searched(self._near(self._halved(level))))
        return joined(found, len(self._low))

    def _searched(self, level: _Level) -> LeafRows:
        """Return places in boxes, and in their halves where leaves are thinner than boxes."""
        found = []
        while len(level.leaf):
            rows, real, thin = self._examined(level)
            self._rows += len(level.leaf)
            more = self._parted(level, thin)
            found.append(rows.some(~more[real]))
            inner = _Level(level.leaf[more], level.cell[more], level.parent[more], level.side)
            level = self._near(self._halved(inner))
        return joined(found, len(self._low))

    def _parted(self, level: _Level, thin: Bools) -> Bools:
        """Return which boxes are halved: those beside thin ones too, if all are not too many."""
        parted = np.zeros(int(level.parent.max()) + 1, np.bool_)
        if level.side / 2.0 < self._least:
            return parted[level.parent]
        parted[level.parent[thin]] = True
        more: Bools = parted[level.parent]
        if self._rows + more.sum() * len(self._halves) > _MOST_ROWS:
            self.coarse.update(level.leaf[more].tolist())
            more[:] = False
        return more

    def _halved(self, level: _Level) -> _Level:
        count = len(self._halves)
        cell = (level.cell[:, None] * 2 + self._halves[None]).reshape(-1, level.cell.shape[1])
        parent = np.repeat(np.arange(len(level.leaf)), count)
        return _Level(np.repeat(level.leaf, count), cell, parent, level.side / 2.0)

    def _near(self, level: _Level) -> _Level:
        """Return the boxes in which leaf and shape can both be 0."""
        numbers = self._fields.numbers
        low = self._origin + level.cell * level.side
        keep = (low <= np.minimum(numbers.high[level.leaf], self._high)).all(axis=1)
        keep &= (low + level.side >= np.maximum(numbers.low[level.leaf], self._low)).all(axis=1)
        leaf, cell, parent = level.leaf[keep], level.cell[keep], level.parent[keep]
        radius = self._radius * level.side
        middle = self._origin + (cell + 0.5) * level.side
        values = self._fields.values(leaf, middle)
        slope, divisor = numbers.slope[leaf], numbers.divisor[leaf]
        keep = _reached(values, slope, divisor, radius)
        leaf, cell, parent, middle = leaf[keep], cell[keep], parent[keep], middle[keep]
        values = self._shape.values(middle)
        keep = _reached(values, self._slopes.slope, self._slopes.divisor, radius)
        return _Level(leaf[keep], cell[keep], parent[keep], level.side)

    def _examined(self, level: _Level) -> tuple[LeafRows, Integers, Bools]:
        """Return places, their boxes, and in which boxes a leaf turns back or stays unclear."""
        side, leaf = level.side, level.leaf
        middle = self._origin + (level.cell + 0.5) * side
        place, away, normal = self._on_leaf(leaf, middle, middle, side)
        distance, across = self._shape.distances(place, side)
        for _ in range(_TURNS):
            off = (np.abs(distance) > self._close) & (np.abs(distance) < 4.0 * side)
            rows = np.flatnonzero(off)
            if not len(rows):
                break
            given = (distance[rows], across[rows], normal[rows])
            step = rows_of(self._step_along, *given, np.full(len(rows), 2.0 * self._close))
            start = place[rows] + np.clip(step, -2.0 * side, 2.0 * side)
            moved = self._on_leaf(leaf[rows], start, middle[rows], side)
            place[rows], away[rows], normal[rows] = moved
            distance[rows], across[rows] = self._shape.distances(place[rows], side)
        near = (np.abs(place - middle) <= side).all(axis=1)
        on_leaf = np.abs(away) < 0.1 * self._close
        thin = near & ~on_leaf
        real = np.flatnonzero(near & on_leaf & (np.abs(distance) < self._close))
        way = self._across * normal[real]
        ahead = self._shape.values(place[real] + way)
        behind = self._shape.values(place[real] - way)
        # At the rim of a face inside of a solid both are 0 but for rounding.
        clear = np.minimum(np.abs(ahead), np.abs(behind)) > _CLEAR * self._across
        crossed = clear & (ahead * behind < 0.0)
        real = real[crossed]
        for share in (0.5, -0.5):
            beyond = place[real] + share * side * normal[real]
            _, there = self._fields.distances(leaf[real], beyond, side)
            thin[real] |= np.einsum("ij,ij->i", there, normal[real]) < _BACK
        thin &= side > self._enough[leaf]
        outward = normal[real] * np.sign(ahead[crossed])[:, None]
        sides = np.full(len(real), side)
        return LeafRows(leaf[real], level.cell[real], sides, place[real], outward), real, thin

    def _on_leaf(
        self, leaf: Integers, start: Floats, middle: Floats, side: float
    ) -> tuple[Floats, Floats, Floats]:
        """Return places on leaves near others, how far they are from them, and normals there."""
        place = start
        for _ in range(_NEWTON_STEPS):
            away, normal = self._fields.distances(leaf, place, side)
            step = np.clip(away, -2.0 * side, 2.0 * side)[:, None] * normal
            place = np.clip(place - step, middle - 2.0 * side, middle + 2.0 * side)
        return place, *self._fields.distances(leaf, place, side)


def joined(parts: list[LeafRows], dimensions: int) -> LeafRows:
    """Return rows as one, sorted by leaf."""
    none = np.empty((0, dimensions))
    empty = LeafRows(
        np.empty(0, np.int64), np.empty((0, dimensions), np.int64), np.empty(0), none, none
    )
    every = [empty, *parts]
    names = ("leaf", "cell", "side", "place", "outward")
    whole = LeafRows(*(np.concatenate([getattr(part, n) for part in every]) for n in names))
    return whole.some(np.argsort(whole.leaf, kind="stable"))


def _reached(
    values: Floats, slope: Floats | float, divisor: Floats | float, radius: float
) -> Bools:
    """Return where a field can be 0 within a radius, by its slope."""
    reach = np.where(values > 0.0, np.minimum(divisor, slope), slope)
    usable = (reach > 0.0) & (reach < _STEEP)
    found: Bools = ~usable | (np.abs(values) <= reach * radius)
    return found
