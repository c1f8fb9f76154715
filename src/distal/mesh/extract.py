"""Extract the mesh of a shape at one spacing.

Input: a shape's kernels, its box and the length of a cell. Output: triangles, their accuracy and
what they miss. ``spacing`` chooses the length of a cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh.accuracy import Accuracy, CutCorner, lost_places, measured, split_lost
from distal.mesh.bricks import Slopes, surface_bricks
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import Lattice
from distal.mesh.places import cell_points, move_beyond, roots_of
from distal.mesh.reach import reached
from distal.mesh.solid import Floats
from distal.mesh.topology import topology_of
from distal.mesh.triangulate import Triangles, triangulated

# The share of the work that each stage takes, measured on solids of the gallery.
_SAMPLED: Final = 0.35
_ROOTS: Final = 0.45
_POINTS: Final = 0.6
_TRIANGLES: Final = 0.85
_SLOPE_ROUNDING: Final = 1.001


@dataclass(frozen=True, slots=True)
class Extent:
    """Where a shape is, and how fast its values change.

    Attributes:
        low: The lowest corner of its box.
        high: The highest corner.
        slopes: How fast its values change.
    """

    low: Floats
    high: Floats
    slopes: Slopes

    @property
    def size(self) -> float:
        """The largest side of the box."""
        return float((self.high - self.low).max())


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
) -> Extracted | Nothing:
    """Return the mesh at one spacing.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        step: The length of a cell, in scene units.
        tolerance: How far lines between points may be from the surface, in scene units.
        most: The most bricks.
        watch: Called with the share of the work that is done.

    Raises:
        MeshProblem: The shape cannot be meshed.
    """
    lattice = Lattice.over(extent.low, extent.high, step)
    found = surface_bricks(
        kernels, lattice, extent.slopes, most, lambda share: watch(_SAMPLED * share)
    )
    suspected = lost_places(kernels, found.lost, step)
    if not len(found.bricks):
        return Nothing(step, found.sampled, suspected)
    topology = topology_of(kernels, lattice, found)
    roots = roots_of(kernels, lattice, topology, found)
    watch(_ROOTS)
    places, creased = cell_points(kernels, lattice, topology, roots)
    at_creases = np.flatnonzero(creased)
    reach = reached(kernels, lattice, topology, roots, places, at_creases)
    move_beyond(kernels, lattice, topology, roots, places, reach)
    watch(_POINTS)
    inside_first = np.concatenate([edges.first for edges in found.edges]) < 0.0
    made = triangulated(kernels, lattice, topology, roots, places, reach, inside_first, tolerance)
    watch(_TRIANGLES)
    accuracy, normals = measured(kernels, made, roots, topology, step)
    lost, corner = split_lost(lattice, topology, places, suspected)
    lengths = np.sqrt(np.einsum("ij,ij->i", roots.slopes, roots.slopes))
    steepest = int(np.argmax(lengths))
    return Extracted(
        step=step,
        cells=topology.cells,
        sampled=found.sampled,
        made=made,
        normals=normals,
        accuracy=accuracy,
        creases=int(creased.sum()),
        shared=int(topology.points.shared.sum()),
        lost=lost,
        corner=corner,
        steepest=float(lengths[steepest]) / extent.slopes.slope,
        steepest_at=roots.places[steepest],
    )
