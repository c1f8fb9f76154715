"""Divide cells until the surface meets each in a way that has a topology.

Input: a tree of cells. Output: its topology, and the tree that it took. Does not depend on errors:
which cells are too large for a tolerance is decided in ``dividing``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import count
from typing import Final

import numpy as np

from distal.mesh.cell_tree import (
    MOST_LEVELS,
    MOST_UNITS,
    CornerValues,
    Divided,
    Leaves,
    balanced,
    differences,
    leaves_of,
    ringed,
    together,
)
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import BRICK, Lattice, position
from distal.mesh.leaves import part_of_topology, to_divide, topology_of_leaves
from distal.mesh.places import margin_of
from distal.mesh.solid import Bools, Integers
from distal.mesh.topology import Topology
from distal.polygons.whole_numbers import sorted_keys

# Points keep a margin in their cells for numbers of 32 bits; with a larger one nothing fits.
MOST_MARGIN: Final = 0.25
# Rings of cells beside what was divided: those whose topology can change, those whose triangles can
# change, and how many more these need.
_LOOKED_AT: Final = 1
_MEASURED: Final = 2
_NEEDED: Final = 3
# How often cells are divided one by one before those in rows with them are divided too, ever
# longer rows up to so many cells to each side.
_ONE_BY_ONE: Final = 40
_LONGEST_ROW: Final = 256


def levels_of(lattice: Lattice) -> int:
    """Return how often the cells of a lattice can be halved, for numbers of 32 bits."""
    levels = 0
    units = int(lattice.extent.max()) * BRICK
    while levels < MOST_LEVELS and units << levels + 1 < MOST_UNITS:
        if margin_of(of_units(lattice, levels + 1)) > MOST_MARGIN:
            break
        levels += 1
    return levels


def of_units(lattice: Lattice, levels: int) -> Lattice:
    """Return the lattice of cells that are halved some times."""
    step, extent = lattice.step / 2.0**levels, lattice.extent << levels
    return Lattice(lattice.origin, step, extent, lattice.digit)


@dataclass(frozen=True, slots=True)
class Tree:
    """Cells, and which of them are divided.

    Attributes:
        values: The values at corners; its lattice counts in units of the smallest possible cell.
        surface: The keys of the cells of the base level that the surface passes through, sorted.
        divided: The keys of the cells that are divided, by level.
        base: The level whose corners are sampled.
    """

    values: CornerValues
    surface: Integers
    divided: Divided
    base: int

    @property
    def levels(self) -> int:
        """How often a cell of level 0 can be halved."""
        return len(self.divided)

    @property
    def count(self) -> int:
        """How many leaves there are."""
        return len(leaves_of(self.surface, self.divided, self.levels, self.base).level)

    @staticmethod
    def of_equal_cells(kernels: FieldKernels, lattice: Lattice, surface: Integers) -> Tree:
        """Return a tree in which nothing is divided.

        Args:
            kernels: The shape.
            lattice: The lattice of the cells.
            surface: The keys of the cells that the surface passes through.
        """
        levels = levels_of(lattice)
        values = CornerValues(kernels, of_units(lattice, levels))
        return Tree(values, sorted_keys(surface), (surface[:0],) * levels, 0)

    def with_divided(self, more: Divided) -> Tree:
        """Return the tree in which more cells are divided, and what is needed for that.

        Args:
            more: The keys of the cells, by level.
        """
        return replace(self, divided=together(self.divided, balanced(more)))

    def with_halves(self, needed: Divided) -> Tree:
        """Return the tree in which some cells are divided that are not joined, and what they need.

        Args:
            needed: The keys of cells of the base level, of their halves, and so on.
        """
        if not needed:
            return self
        none = self.surface[:0]
        after = self.levels - self.base - len(needed)
        return self.with_divided((*(none,) * self.base, *needed, *(none,) * after))


def topology_of_tree(tree: Tree) -> tuple[Topology, Tree]:
    """Return the topology of a tree, and the tree with what had to be divided or added for it.

    Args:
        tree: The tree.

    Raises:
        MeshProblem: A value is no number.
    """
    while True:
        leaves = leaves_of(tree.surface, tree.divided, tree.levels, tree.base)
        made = topology_of_leaves(tree.values, leaves)
        if isinstance(made, Topology):
            return made, tree
        if len(made.missing):
            assert (position(made.missing, tree.surface) < 0).any(), "a cell is missing for ever"
            surface = sorted_keys(np.concatenate([tree.surface, made.missing]))
            tree = replace(tree, surface=surface)
        else:
            tree = settled(tree.with_divided(made.leaves), tree.divided)


def settled(tree: Tree, before: Divided) -> Tree:
    """Return a tree with what must be divided for a topology near cells that were divided.

    The rest did not change and is not looked at.

    Args:
        tree: The tree.
        before: The keys of the cells that were divided before, by level.

    Raises:
        MeshProblem: A value is no number.
    """
    for number in count():
        changed = changes(tree, before)
        leaves, inner = _near(tree, changed, _LOOKED_AT)
        wrong = to_divide(tree.values, leaves, inner)
        if not any(len(keys) for keys in wrong):
            break
        if number >= _ONE_BY_ONE:
            wrong = _with_rows(wrong, tree, min(2 << number - _ONE_BY_ONE, _LONGEST_ROW))
        before, tree = tree.divided, tree.with_divided(wrong)
    return tree


def _with_rows(wrong: Divided, tree: Tree, reach: int) -> Divided:
    """Return cells to divide and those in rows with them along x, y and z.

    Where a face of the solid is close to a plane of the lattice, each cell along its edge is found
    wrong only when the one beside it is divided.

    Args:
        wrong: The keys of the cells, by level.
        tree: The cells.
        reach: How many cells away.
    """
    leaves = leaves_of(tree.surface, tree.divided, tree.levels, tree.base)
    far = np.arange(-reach, reach + 1)
    steps = (differences(np.eye(3, dtype=np.int64))[:, None] * far).reshape(-1)
    found = []
    for level, keys in enumerate(wrong):
        own = leaves.key[leaves.of_level(level)]
        found.append(own[position(own, sorted_keys((keys[:, None] + steps).reshape(-1))) >= 0])
    return tuple(found)


def changes(tree: Tree, before: Divided) -> Divided:
    """Return the keys of cells that are divided and were not before, by level."""
    both = zip(tree.divided, before, strict=True)
    return tuple(keys[:0] if keys is old else keys[position(keys, old) < 0] for keys, old in both)


def topology_of_changes(tree: Tree, changed: Divided, most: float) -> tuple[Topology, Bools] | None:
    """Return the topology near cells that were divided, and which of its edges are certain.

    Args:
        tree: The tree, settled.
        changed: The keys of the cells, by level.
        most: If it takes more than this share of all leaves, there is none.

    Raises:
        MeshProblem: A value is no number.
    """
    leaves, inner = _near(tree, changed, _MEASURED)
    if len(leaves.level) > most * tree.count:
        return None
    return part_of_topology(tree.values, leaves, inner)


def _near(tree: Tree, changed: Divided, rings: int) -> tuple[Leaves, Bools]:
    """Return the leaves near cells, and which are as near as rings of cells."""
    around = ringed(changed, rings + _NEEDED)
    leaves = leaves_of(tree.surface, tree.divided, tree.levels, tree.base, around)
    return leaves, leaves.near(changed, rings)
