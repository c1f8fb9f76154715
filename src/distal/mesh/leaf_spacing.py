"""The spacing that the leaves of a tree need: by their widths, and by the walls between them.

Input: a shape's kernels, a lattice and its bricks near the surface. Output: the cells to divide,
before anything else is found out about them, so that no bore, slot, rib or floor lies between
samples.

Blocks are halved with the leaves whose surfaces can pass through them. A block is divided where one
of these is narrower than its side, and where two of them face each other: their normals are
opposite, and both faces are faces of the solid. Leaves stand by their nearest faces only, which may
hide another; so cells beside those of a wall are divided with them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from distal.mesh.bricks import Slopes
from distal.mesh.cell_tree import HALVES, widened
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import BRICK, Lattice, cells_of_keys, keys_of, position
from distal.mesh.leaf_fields import FieldProbe, LeafFields, LeafNumbers
from distal.mesh.problems import ThinWall
from distal.mesh.solid import Bools, Floats, Integers
from distal.polygons.whole_numbers import sorted_keys
from distal.scene.tree.node import Node

# The share of its thickness that finds a wall or a gap: every line of the lattice meets it.
WALL_SHARE: Final = 0.95
# Walls and gaps thinner than this share of the tolerance are not looked for.
LEAST_WALL: Final = 0.05
# How often a cell of the first spacing is halved at most.
MOST_HALVINGS: Final = 7
# The low ends of the edges of a cell along each axis, from its middle, in halves of its side.
_ENDS_OF_EDGES: Final = [
    np.insert(np.array([(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]), axis, -1.0, axis=1)
    for axis in range(3)
]
# Faces whose normals add up to less do not meet close by; where others meet within so many cells,
# there is an edge.
_PARALLEL: Final = 1e-3
_CELLS_TO_EDGE: Final = 3.0
_ALONG_AXIS: Final = 1.0 - 1e-9  # the largest component of a normal along an axis
_HALF_DIAGONAL: Final = 0.5 * float(np.sqrt(3.0)) * 1.000001
_ROUNDING: Final = 0.99999
_OPPOSITE: Final = -0.5  # the cosine below which two faces face each other
_COINCIDE: Final = 1e-6  # of a cell: two faces at one place are no wall
_REAL: Final = 0.25  # of a wall's thickness: how large the value may be on both of its faces
# How large it is at least between them, half of the thickness for a distance.
_BETWEEN: Final = 0.1
# Both faces of a wall are in the cell: this share of its side from the middle.
_WITHIN: Final = 0.55
# No more cells are divided because of leaves: the report says what is not found then. Walls that
# need more are refused: part of a wall is worse than none.
_MOST_DIVIDED: Final = 300_000
_MOST_AT_WALLS: Final = 200_000
# What a cell costs that is a leaf of a tree, and one that is sampled and may be joined.
_COST_OF_TREE: Final = 2.2
_COST_OF_SAMPLES: Final = 1.3
# No first spacing has more cells on the sides of the box.
_MOST_SAMPLED: Final = 400_000.0


@dataclass(frozen=True, slots=True)
class Blocks:
    """Cubic blocks of one size, with the leaves whose surfaces can pass through them.

    Attributes:
        cells: Their places, in blocks of their size, of shape (n, 3).
        size: Their side, in cells of the lattice.
        block: The block of each pair of a block and a leaf, in order.
        leaf: The leaf of each pair.
    """

    cells: Integers
    size: float
    block: Integers
    leaf: Integers

    def some(self, chosen: Bools) -> Blocks:
        """Return some of the blocks, with their pairs."""
        number = np.cumsum(chosen) - 1
        pairs = chosen[self.block]
        return Blocks(self.cells[chosen], self.size, number[self.block[pairs]], self.leaf[pairs])

    def pairs(self, chosen: Bools) -> Blocks:
        """Return all blocks, with some of the pairs."""
        return Blocks(self.cells, self.size, self.block[chosen], self.leaf[chosen])

    def halves(self) -> Blocks:
        """Return the eight halves of each block, with the leaves of their block."""
        count = np.bincount(self.block, minlength=len(self.cells)).repeat(8)
        first = np.searchsorted(self.block, np.arange(len(self.cells))).repeat(8)
        cells = (self.cells[:, None] * 2 + HALVES[None]).reshape(-1, 3)
        block = np.arange(len(cells)).repeat(count)
        within = np.arange(len(block)) - (np.cumsum(count) - count)[block]
        return Blocks(cells, self.size / 2.0, block, self.leaf[first[block] + within])

    @property
    def leaves_of(self) -> Integers:
        """How many leaves each block has."""
        return np.bincount(self.block, minlength=len(self.cells))


class _Walls(NamedTuple):
    """Walls and gaps in cells.

    Attributes:
        row: The row of a cell and a leaf whose face is one side of the wall.
        other: The row of the same cell and the leaf of the other side.
        gap: How thick the wall is.
        lost: Whether cells of this size may miss it: it is along no plane of the lattice, or an
            edge of the cell crosses it between corners of one sign.
    """

    row: Integers
    other: Integers
    gap: Floats
    lost: Bools


@dataclass(frozen=True, slots=True)
class NeededCells:
    """The cells that leaves need.

    Attributes:
        divided: The keys of the cells to divide: those of the lattice, their halves, and so on.
        sure_to: The side of the cells to which leaves, walls and gaps are found.
        unknown: The leaves whose widths are not known; they limit ``sure_to``.
        narrower: The leaves near what is narrower than the smallest cells.
    """

    divided: tuple[Integers, ...]
    sure_to: float
    unknown: tuple[Node, ...] = ()
    narrower: tuple[Node, ...] = ()


@dataclass(frozen=True)
class LeafSpacing:
    """The spacing that the leaves of a shape need.

    Attributes:
        kernels: The shape.
        slopes: How fast its values change.
        low: The lowest corner of its box.
        high: The highest.
        least: The smallest spacing that walls and gaps between leaves are looked for with.
    """

    kernels: FieldKernels
    slopes: Slopes
    low: Floats
    high: Floats
    least: float

    @cached_property
    def fields(self) -> LeafFields:
        """The fields of the leaves."""
        return LeafFields(self.kernels)

    @property
    def numbers(self) -> LeafNumbers:
        """Their numbers."""
        return self.fields.numbers

    @cached_property
    def areas(self) -> Floats:
        """About how large their surfaces are: the sides of their boxes."""
        high, low = np.minimum(self.numbers.high, self.high), np.maximum(self.numbers.low, self.low)
        x, y, z = np.maximum(high - low, 0.0).T
        found: Floats = 2.0 * (x * y + y * z + z * x)
        return found

    def aligned(self, step: float) -> float:
        """Return a first spacing, at most ``step``, for which dividing costs the least."""
        area, width = self.areas, self.numbers.width
        narrow = (width < step) & (area > 0.0) & (area <= _MOST_DIVIDED * width**2)
        if not narrow.any():
            return step
        tried = np.unique(width[narrow][:, None] * 2.0 ** np.arange(MOST_HALVINGS + 1))
        tried = np.append(tried[tried < step], step)
        # The whole is sampled at the first spacing; what is narrow is divided further.
        halvings = np.ceil(np.log2(tried[:, None] / width[None, narrow]) - 1e-9)
        smaller = tried[:, None] / 2.0 ** np.maximum(halvings, 0.0)
        divided = np.where(halvings > 0.0, area[narrow] / smaller**2, 0.0).sum(axis=1)
        x, y, z = self.high - self.low
        whole = np.maximum(2.0 * (x * y + y * z + z * x), area.max()) / tried**2
        cost = _COST_OF_TREE * divided + _COST_OF_SAMPLES * whole
        cost[(whole > _MOST_SAMPLED) & (tried < step)] = np.inf
        return float(tried[np.argmin(cost)])

    def needed(self, lattice: Lattice, bricks: Integers, levels: int) -> NeededCells:
        """Return the cells to divide, and what is found then.

        Args:
            lattice: The lattice.
            bricks: The bricks that were sampled, of shape (n, 3).
            levels: How often a cell can be halved.
        """
        finest = lattice.step * 0.5**levels
        width = np.where(self.numbers.width < finest * _ROUNDING, np.inf, self.numbers.width)
        blocks = self._in_bricks(lattice, bricks)
        while True:
            divided, rest = self._divided(lattice, blocks, width, levels)
            side = rest.size * lattice.step
            narrow = rest.leaf[width[rest.leaf] < side * _ROUNDING]
            if not len(narrow):
                break
            # Again, without the leaf that needs most: some of its cells would find nothing of it.
            width[np.argmax(np.bincount(narrow))], finest = np.inf, max(finest, side)
        leaves = self.fields.leaves
        lost = np.flatnonzero((width > self.numbers.width) & (self.areas > 0.0))
        narrower = np.unique(np.concatenate([rest.leaf, lost]))
        unknown = np.flatnonzero(~self.numbers.known)
        sure_to = max(self.least, side if len(rest.cells) else 0.0, finest if len(lost) else 0.0)
        return NeededCells(
            tuple(divided),
            max(sure_to, lattice.step) if len(unknown) else sure_to,
            tuple(leaves[i].leaf for i in unknown),
            tuple(leaves[i].leaf for i in narrower),
        )

    def _divided(
        self, lattice: Lattice, blocks: Blocks, width: Floats, levels: int
    ) -> tuple[list[Integers], Blocks]:
        """Return the keys of the cells to divide, by level, and those that the limits leave.

        Args:
            lattice: The lattice.
            blocks: Its bricks near the surface, with their leaves.
            width: The width of each leaf.
            levels: How often a cell can be halved.

        Raises:
            MeshProblem: A wall needs too many cells.
        """
        found: list[Integers] = []
        while len(blocks.cells):
            side = blocks.size * lattice.step
            blocks = self._near(lattice, blocks)
            several = blocks.leaves_of > 1
            narrow = np.zeros(len(blocks.cells), np.bool_)
            narrow[blocks.block[width[blocks.leaf] < side * _ROUNDING]] = True
            if blocks.size > 1.0:
                blocks = blocks.some(narrow | several).halves()
                continue
            if side > 2.0 * self.least:
                narrow |= self._beside_walls(lattice, blocks, several)
            blocks = blocks.some(narrow)
            if blocks.size <= 2.0**-levels or len(blocks.cells) > _MOST_DIVIDED:
                break
            found.append(np.sort(keys_of(blocks.cells)))
            blocks = blocks.halves()
        while found and not len(found[-1]):
            found.pop()
        return found, blocks

    def _in_bricks(self, lattice: Lattice, bricks: Integers) -> Blocks:
        """Return bricks with the leaves whose boxes they meet, found from the whole box down."""
        above = [bricks]
        while len(above[-1]) > 8:
            above.append(cells_of_keys(sorted_keys(keys_of(above[-1] >> 1))))
        first = above.pop()
        # A leaf alone is looked at where it is narrower than a brick.
        count = len(self.fields.leaves)
        if count == 1 and self.numbers.width[0] >= BRICK * lattice.step:
            count = 0
        blocks = Blocks(
            first,
            float(BRICK << len(above)),
            np.arange(len(first)).repeat(count),
            np.tile(np.arange(count), len(first)),
        )
        blocks = self._meeting(lattice, blocks)
        while above:
            known = np.sort(keys_of(above.pop()))
            blocks = blocks.halves()
            blocks = blocks.some(position(keys_of(blocks.cells), known) >= 0)
            blocks = self._meeting(lattice, blocks)
        return blocks

    def _meeting(self, lattice: Lattice, blocks: Blocks) -> Blocks:
        """Return the blocks with those of their leaves whose boxes they meet."""
        low = lattice.places(blocks.cells * blocks.size)[blocks.block]
        high = low + blocks.size * lattice.step
        met = (self.numbers.low[blocks.leaf] <= high) & (self.numbers.high[blocks.leaf] >= low)
        return blocks.pairs(np.all(met, axis=1))

    def _near(self, lattice: Lattice, blocks: Blocks) -> Blocks:
        """Return the blocks that the surface can pass through, with leaves that can, too."""
        blocks = self._meeting(lattice, blocks)
        radius = blocks.size * lattice.step * _HALF_DIAGONAL
        middles = lattice.places((blocks.cells + 0.5) * blocks.size)
        value = self.fields.values(blocks.leaf, middles[blocks.block])
        blocks = blocks.pairs(np.abs(value) <= self.numbers.slope[blocks.leaf] * radius)
        some = blocks.leaves_of > 0
        reach = max(self.slopes.slope, self.slopes.divisor) * radius
        some[some] = np.abs(self._value(middles[some])) <= reach
        return blocks.some(some)

    def _beside_walls(self, lattice: Lattice, blocks: Blocks, several: Bools) -> Bools:
        """Return which cells have a wall or a gap narrower than their side in them or beside.

        Raises:
            MeshProblem: They are too many.
        """
        middles = lattice.places((blocks.cells + 0.5) * blocks.size)
        some = blocks.pairs(several[blocks.block])
        walls = list(self._walls(some, middles, blocks.size * lattice.step))
        found, lost = (np.zeros(len(blocks.cells), np.bool_) for _ in range(2))
        for wall in walls:
            block = some.block[wall.row]
            found[block] = True
            lost[block[wall.lost]] = True
        # Walls along planes of the lattice are seen as they are.
        if not lost.any():
            return lost
        keys = keys_of(blocks.cells)
        found = position(keys, widened(np.sort(keys[found]))) >= 0
        if found.sum() > _MOST_AT_WALLS:
            wall = min(walls, key=lambda wall: float(wall.gap.min(initial=np.inf)))
            thin = int(np.argmin(wall.gap))
            one, other = (self.fields.leaves[some.leaf[k[thin]]] for k in (wall.row, wall.other))
            place = tuple(middles[some.block[wall.row[thin]]].tolist())
            raise ThinWall(place, float(wall.gap[thin]), (one, other))
        return found

    def _walls(self, some: Blocks, middles: Floats, side: float) -> Iterator[_Walls]:
        """Yield walls and gaps between two leaves in one cell that are narrower than its side.

        Args:
            some: Cells with their leaves.
            middles: Their middles, in scene units.
            side: Their side.
        """
        distance, normal = self.fields.distances(some.leaf, middles[some.block], side)
        for i, j in _facing(some, normal):
            gap = np.abs(distance[i] + distance[j])
            thin = (gap > _COINCIDE * side) & (WALL_SHARE * gap < side)
            thin &= WALL_SHARE * gap > self.least
            i, j, gap = i[thin], j[thin], gap[thin]
            block = some.block[i]
            real = np.ones(len(block), np.bool_)
            feet = [middles[block] - distance[k, None] * normal[k] for k in (i, j)]
            for foot in feet:
                real &= np.abs(foot - middles[block]).max(axis=1) <= _WITHIN * side
                real[real] = np.abs(self._value(foot[real])) <= _REAL * gap[real]
            # Beside an edge where two faces meet there is none.
            between = 0.5 * (feet[0] + feet[1])[real]
            real[real] = np.abs(self._value(between)) >= _BETWEEN * gap[real]
            i, j, gap, block = i[real], j[real], gap[real], block[real]
            middle, feet = 0.5 * (feet[0] + feet[1])[real], [foot[real] for foot in feet]
            leaves = (some.leaf[i], some.leaf[j])
            wide = ~self._at_edges(leaves, feet[0], middle, (normal[i], normal[j]), side, gap)
            i, j, gap = i[wide], j[wide], gap[wide]
            block, between = block[wide], middle[wide]
            tilted = np.zeros(len(i), np.bool_)
            for k in (i, j):  # the wall of a bore beside a plane is curved on one side
                tilted |= np.abs(normal[k]).max(axis=1) < _ALONG_AXIS
            lost = tilted | self._between_corners(middles[block], side, between, normal[i])
            yield _Walls(i, j, gap, lost)

    def _at_edges(
        self,
        leaves: tuple[Integers, Integers],
        foot: Floats,
        middle: Floats,
        normals: tuple[Floats, Floats],
        side: float,
        gap: Floats,
    ) -> Bools:
        """Return where two faces are those of a sharp edge close by: it is thin, but ends there.

        Args:
            leaves: The leaves of the two faces.
            foot: A place on the first face.
            middle: A place between the faces.
            normals: The normals of the faces.
            side: The side of the cell.
            gap: How far the faces are apart.
        """
        one, other = normals
        way = one + other
        length = np.linalg.norm(way, axis=1)
        meet = length > _PARALLEL
        way = np.divide(way, length[:, None], out=np.zeros_like(way), where=meet[:, None])
        rise = np.einsum("ij,ij->i", one, way)
        far = np.einsum("ij,ij->i", one, foot - middle)
        share = np.divide(far, rise, out=np.full(len(gap), np.inf), where=meet)
        found: Bools = np.abs(share) <= _CELLS_TO_EDGE * side
        edge = middle[found] + share[found, None] * way[found]
        # Both faces go there: one that is curved, such as that of a bore, may turn away before.
        off = [np.abs(self.fields.values(leaf[found], edge)) for leaf in leaves]
        found[found] = np.maximum(*off) <= _REAL * gap[found]
        return found

    def _between_corners(self, middle: Floats, side: float, place: Floats, normal: Floats) -> Bools:
        """Return which cells have an edge that a wall crosses between corners of one sign.

        Args:
            middle: The middles of the cells.
            side: Their side.
            place: A place in the middle of each wall.
            normal: The normal of its faces.
        """
        lost = np.zeros(len(middle), np.bool_)
        for axis in range(3):
            for ends in _ENDS_OF_EDGES[axis]:
                start = middle + ends * (0.5 * side)
                along = np.where(normal[:, axis] == 0.0, np.inf, normal[:, axis] * side)
                share = np.einsum("ij,ij->i", place - start, normal) / along
                rows = np.flatnonzero((share > 0.0) & (share < 1.0) & ~lost)
                a, b, at = start[rows], start[rows].copy(), start[rows].copy()
                b[:, axis] += side
                at[:, axis] += share[rows] * side
                inside = [self._value(places) < 0.0 for places in (a, at, b)]
                lost[rows] = (inside[0] != inside[1]) & (inside[2] != inside[1])
        return lost

    def _value(self, places: Floats) -> Floats:
        return FieldProbe(self.kernels).values(places) if len(places) else np.empty(0)


def _facing(blocks: Blocks, normal: Floats) -> Iterator[tuple[Integers, Integers]]:
    """Yield pairs of rows, of two leaves of one block whose faces face each other.

    Args:
        blocks: Blocks with their leaves.
        normal: The normal of each leaf's nearest face.
    """
    block = blocks.block
    for apart in range(1, int(blocks.leaves_of.max(initial=0))):
        i = np.flatnonzero(block[apart:] == block[:-apart])
        j = i + apart
        opposite = np.einsum("ij,ij->i", normal[i], normal[j]) < _OPPOSITE
        yield i[opposite], j[opposite]
