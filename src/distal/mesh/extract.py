"""Extract the mesh of a shape at one spacing.

Input: a shape's kernels, its box and the length of a cell. Output: triangles, their accuracy and
what they miss. ``spacing`` chooses the length of a cell.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from distal.mesh.accuracy import (
    Accuracy,
    CutCorner,
    Misses,
    lost_places,
    measured,
    split_lost,
    worst_corner,
)
from distal.mesh.bricks import Slopes, SurfaceBricks, surface_bricks
from distal.mesh.cell_tree import CornerValues, balanced
from distal.mesh.element_grid import to_triangles
from distal.mesh.joining import JOINED_LEVELS
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import BRICK, DIGIT_OF_FILES, Lattice, cells_of_keys, keys_of
from distal.mesh.leaf_spacing import LeafSpacing, NeededCells
from distal.mesh.places import cell_points, margin_of, move_beyond, roots_of
from distal.mesh.problems import MeshProblem
from distal.mesh.reach import reached
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tips import tips_beyond
from distal.mesh.topology import Topology, topology_of
from distal.mesh.tree_topology import MOST_MARGIN, Tree, levels_of, of_units, topology_of_tree
from distal.mesh.triangulate import Triangles, triangulated

# The share of the work that each stage takes, measured on solids of the gallery.
_SAMPLED: Final = 0.35
_ROOTS: Final = 0.45
_POINTS: Final = 0.6
_TRIANGLES: Final = 0.85
_SLOPE_ROUNDING: Final = 1.001
# Cells are joined if there are this many times as many as blocks of eight that stay separate.
_MOST_SEPARATE: Final = 5


@dataclass(frozen=True, slots=True)
class Extent:
    """Where a shape is, and how fast its values change.

    Attributes:
        low: The lowest corner of its box.
        high: The highest corner.
        slopes: How fast its values change.
        measured: The largest side of the solid itself, if that is less; None if it is not measured.
    """

    low: Floats
    high: Floats
    slopes: Slopes
    measured: float | None = None

    @property
    def size(self) -> float:
        """The largest side of the box, or of the solid."""
        return self.measured or float((self.high - self.low).max())


@dataclass(frozen=True, slots=True)
class LookedAt:
    """What equal cells have seen.

    Attributes:
        step: The length of a cell, in scene units.
        sampled: How many bricks were sampled.
        surface: The cells that the surface passes through.
        suspected: Points of the surface that they do not see.
        needed: The cells that the leaves of the shape need; None if they were not asked.
    """

    step: float
    sampled: int
    surface: Integers
    suspected: Floats
    needed: NeededCells | None


@dataclass(frozen=True, slots=True)
class Extracted:
    """A mesh at one spacing.

    Attributes:
        step: The length of a cell, in scene units.
        cells: How many cells the surface passes through.
        sampled: How many bricks were sampled.
        made: The triangles.
        normals: The normals at their points.
        accuracy: How far the triangles are from the surface.
        creases: How many points are at creases.
        shared: How many points are in cells with several.
        lost: Points of the surface where the mesh has none, of shape (n, 3).
        corner: The corner that is cut most.
        steepest: The largest gradient at a root, for each unit of the slope that is declared.
        steepest_at: Where it is.
        lattice: The lattice whose units the topology counts in.
        topology: What belongs together.
        misses: The distances one by one.
        looked_at: What equal cells have seen.
        tree: The cells, if they are not equal.
        nearest: How far each is from the nearest point of the mesh; infinite if there is none.
    """

    step: float
    cells: int
    sampled: int
    made: Triangles
    normals: Floats
    accuracy: Accuracy
    creases: int
    shared: int
    lost: Floats
    corner: CutCorner
    steepest: float
    steepest_at: Floats
    lattice: Lattice
    topology: Topology
    misses: Misses
    looked_at: LookedAt
    nearest: Floats
    tree: Tree | None = None

    @property
    def levels(self) -> list[int]:
        """How many points are in cells of each level: undivided ones, halves, and so on."""
        sizes = self.topology.points.size
        level = np.log2(self.topology.unit / sizes[sizes <= self.topology.unit]).astype(np.int64)
        counts: list[int] = np.bincount(level, minlength=1).tolist()
        return counts

    @property
    def joined(self) -> list[int]:
        """How many points are in cells of twice the length of undivided ones, four times, eight."""
        sizes = self.topology.points.size
        level = np.log2(sizes[sizes > self.topology.unit] / self.topology.unit).astype(np.int64)
        counts: list[int] = np.bincount(level)[1:].tolist()
        return counts

    @property
    def error(self) -> float:
        """The largest distance, measured both ways."""
        return max(self.accuracy.largest, self.accuracy.from_surface)

    def with_suspected(self, rows: Bools) -> Extracted:
        """Return the mesh with some of the places that its samples do not see."""
        looked_at = replace(self.looked_at, suspected=self.looked_at.suspected[rows])
        return replace(self, looked_at=looked_at, nearest=self.nearest[rows])

    def excess(self, tolerance: float) -> float:
        """Return the largest distance, or turn as a distance (``Misses.excess``)."""
        return max(self.error, float(self.misses.excess(tolerance).max()))

    @property
    def divisible(self) -> bool:
        """Whether its undivided cells can be halved."""
        tree = self.tree
        return levels_of(self.lattice) > 0 if tree is None else tree.levels > tree.base

    @property
    def exceeds_slope(self) -> bool:
        """Whether the declared slope is wrong."""
        return self.steepest > _SLOPE_ROUNDING


@dataclass(frozen=True, slots=True)
class Nothing:
    """No mesh: no sign changes at this spacing.

    Attributes:
        step: The length of a cell, in scene units.
        sampled: How many bricks were sampled.
        lost: Points of a surface that is thinner than a cell.
    """

    step: float
    sampled: int
    lost: Floats


def extracted(
    kernels: FieldKernels,
    extent: Extent,
    step: float,
    tolerance: float,
    most: int,
    watch: Callable[[float], None],
    joined: float | None = None,
    digit: float = DIGIT_OF_FILES,
    leaves: LeafSpacing | None = None,
    angle: float = math.inf,
) -> Extracted | Nothing:
    """Return the mesh at one spacing.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        step: The length of a cell, in scene units.
        tolerance: How far lines between points may be from the surface, in scene units.
        most: The most bricks.
        watch: Called with the share of the work that is done.
        joined: Cells are joined where the surface moves by less, in scene units; None for equal
            cells.
        digit: The rounding of places, as a share.
        leaves: The spacing that the shape's leaves need; None for that of the lattice alone.
        angle: How much the surface may turn within a triangle, in radians.

    Raises:
        MeshProblem: The shape cannot be meshed.
    """
    lattice = Lattice.over(extent.low, extent.high, step, digit)
    if margin_of(lattice) > MOST_MARGIN:
        raise MeshProblem("too far", tuple(extent.low))
    found = surface_bricks(
        kernels, lattice, extent.slopes, most, lambda share: watch(_SAMPLED * share), joined
    )
    suspected = lost_places(kernels, found.lost, step, extent.size)
    levels = levels_of(lattice)
    needed = None if leaves is None else leaves.needed(lattice, found.near, levels)
    halves = () if needed is None else needed.divided
    if not len(found.bricks) and not halves:
        return Nothing(step, found.sampled, suspected)
    surface = _surface_cells(found)
    looked_at = LookedAt(step, found.sampled, surface, suspected, needed)
    joins = joined is not None and levels > 0
    joins = joins and len(found.separate[-1]) * _MOST_SEPARATE < len(surface)
    if joins or halves:
        if joins:
            tree = _joined_tree(kernels, lattice, found, surface)
        else:
            tree = Tree.of_equal_cells(kernels, lattice, keys_of(surface))
        topology, tree = topology_of_tree(tree.with_halves(halves))
        if not len(topology.segments.axis):
            return Nothing(step, found.sampled, suspected)
        units = tree.values.lattice
        made = completed(kernels, extent, units, topology, looked_at, tolerance, watch, angle)
        return replace(made, tree=tree)
    topology = topology_of(kernels, lattice, found)
    del found  # samples and masks are not needed any more
    return completed(kernels, extent, lattice, topology, looked_at, tolerance, watch, angle)


def _surface_cells(found: SurfaceBricks) -> Integers:
    """Return the cells that the surface passes through, in the order of their keys."""
    brick, *local = np.nonzero((found.masks != 0) & (found.masks != 255))
    keys = keys_of(found.bricks[brick] * BRICK + np.stack(local, axis=1))
    return cells_of_keys(np.sort(keys))


def _joined_tree(
    kernels: FieldKernels, lattice: Lattice, found: SurfaceBricks, surface: Integers
) -> Tree:
    """Return a tree of cells that are joined where their samples allow it.

    Args:
        kernels: The shape.
        lattice: The lattice.
        found: Its bricks.
        surface: The cells that the surface passes through.
    """
    levels = levels_of(lattice)
    values = CornerValues(kernels, of_units(lattice, levels))
    parted = [*found.separate, *(found.separate[0][:0] for _ in range(levels))]
    return Tree(values, keys_of(surface), balanced(parted), JOINED_LEVELS)


def completed(
    kernels: FieldKernels,
    extent: Extent,
    lattice: Lattice,
    topology: Topology,
    looked_at: LookedAt,
    tolerance: float,
    watch: Callable[[float], None],
    angle: float = math.inf,
) -> Extracted:
    """Return the mesh of a topology.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        lattice: The lattice whose units the topology counts in.
        topology: What belongs together.
        looked_at: What equal cells have seen.
        tolerance: How far lines between points may be from the surface, in scene units.
        watch: Called with the share of the work that is done.
        angle: How much the surface may turn within a triangle, in radians.
    """
    roots = roots_of(kernels, lattice, topology)
    watch(_ROOTS)
    places, creased = cell_points(kernels, lattice, topology, roots)
    at_creases = np.flatnonzero(creased)
    reach = reached(kernels, lattice, topology, roots, places, at_creases)
    move_beyond(kernels, lattice, topology, roots, places, reach)
    watch(_POINTS)
    inside_first = topology.edges.first < 0.0
    made = triangulated(kernels, lattice, topology, roots, places, reach, inside_first, tolerance)
    watch(_TRIANGLES)
    limits = tolerance, angle
    accuracy, normals, misses = measured(kernels, made, roots, topology, lattice.step, *limits)
    suspected, surface = looked_at.suspected, looked_at.surface
    lost, nearest = split_lost(lattice, topology, places, suspected, surface)
    tips, away = tips_beyond(kernels, lattice, topology, roots, places, at_creases, tolerance)
    suspected, nearest = np.concatenate([suspected, tips]), np.concatenate([nearest, away])
    # Corners between samples are as far away as the mesh is, not as its points are.
    nearest = to_triangles(made.points[made.triangles], suspected, nearest, tolerance)
    lengths = np.sqrt(np.einsum("ij,ij->i", roots.slopes, roots.slopes))
    steepest = int(np.argmax(lengths))
    return Extracted(
        step=looked_at.step,
        cells=topology.cells,
        sampled=looked_at.sampled,
        made=made,
        normals=normals,
        accuracy=accuracy,
        creases=int(creased.sum()),
        shared=int(topology.points.shared.sum()),
        lost=lost,
        corner=worst_corner(suspected, nearest),
        steepest=float(lengths[steepest]) / extent.slopes.slope,
        steepest_at=roots.places[steepest],
        lattice=lattice,
        topology=topology,
        misses=misses,
        looked_at=replace(looked_at, suspected=suspected),
        nearest=nearest,
    )
