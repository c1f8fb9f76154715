"""Where the points of a mesh are: roots on edges, points in cells, points on faces.

Input: topology, a lattice and a shape's kernels. Output: places. Every point stays within a convex
part of its cell: that keeps the triangles from intersecting.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC3, Array
from distal.mesh import arithmetic
from distal.mesh.bricks import SurfaceBricks
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice
from distal.mesh.solid import Floats, Integers
from distal.mesh.tables import cell_tables
from distal.mesh.topology import Bools, Topology

_SMALLEST_MARGIN: Final = 1e-4
# Points are kept this many units in the last place of 32 bits away from sides of cells.
_ULPS: Final = 8.0
_ULP: Final = 2.0**-23
_AT_ONCE: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class Roots:
    """The points at which edges cross the surface.

    Attributes:
        places: Of shape (n, 3).
        slopes: The gradients there, of shape (n, 3).
        kept: The places, at least the margin away from the ends of the edges.
    """

    places: Floats
    slopes: Floats
    kept: Floats


def margin_of(lattice: Lattice) -> float:
    """Return how far from its cell's sides a point must be, in cells."""
    far = lattice.places(lattice.extent * 8)
    size = float(max(np.abs(lattice.origin).max(), np.abs(far).max()))
    return max(_SMALLEST_MARGIN, _ULPS * _ULP * size / lattice.step)


def roots_of(
    kernels: FieldKernels, lattice: Lattice, topology: Topology, found: SurfaceBricks
) -> Roots:
    """Return the roots on all edges.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its edges.
        found: The values at their ends.
    """
    edges = topology.edges
    start = lattice.places(edges.start)
    way = np.zeros_like(start)
    way[np.arange(len(way)), edges.axis] = lattice.step
    first = np.concatenate([e.first for e in found.edges])
    second = np.concatenate([e.second for e in found.edges])
    types = [("start", VEC3), ("way", VEC3), ("first", FLOAT), ("second", FLOAT)]
    share, slopes = kernels.call(arithmetic.root_on_edge, start, way, first, second, types=types)
    margin = margin_of(lattice)
    kept = np.clip(share, margin, 1.0 - margin)
    return Roots(start + way * share[:, None], slopes, start + way * kept[:, None])


def cell_points(
    kernels: FieldKernels, lattice: Lattice, topology: Topology, roots: Roots
) -> tuple[Floats, Bools]:
    """Return the points of cells, and which of them are at a crease.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its points.
        roots: The roots on its edges.
    """
    points = topology.points
    count = len(points.mask)
    if not count:
        return np.empty((0, 3)), np.empty(0, np.bool_)
    uses = np.diff(points.first, append=len(points.edges))
    mean = np.add.reduceat(roots.kept[points.edges], points.first) / uses[:, None]
    normals = rows_of(arithmetic.unit_or_zero, roots.slopes)[points.edges]
    owner = np.repeat(np.arange(count), uses)
    average = rows_of(arithmetic.unit_or_zero, np.add.reduceat(normals, points.first))
    cosine = rows_of(arithmetic.cosine, normals, average[owner])
    creased = np.minimum.reduceat(cosine, points.first) < arithmetic.CREASE_COSINE
    margin = margin_of(lattice)
    low = lattice.places(points.cell + margin)
    high = lattice.places(points.cell + (1.0 - margin))
    found = np.empty((count, 3))
    smooth = np.flatnonzero(~creased)
    found[smooth] = kernels.call(
        arithmetic.smooth_point,
        mean[smooth],
        low[smooth],
        high[smooth],
        types=[("mean", VEC3), ("low", VEC3), ("high", VEC3)],
    )
    for rows in pieces(np.flatnonzero(creased)):
        found[rows] = _creases(kernels, topology, roots, mean, low, high, rows)
    shared = np.flatnonzero(points.shared)
    if len(shared):
        found[shared] = _in_regions(lattice, topology, mean, found, margin, shared)
    return found, creased


def pieces(rows: Integers) -> list[Integers]:
    """Return rows in pieces that need little memory."""
    return [rows[i : i + _AT_ONCE] for i in range(0, len(rows), _AT_ONCE)]


def _creases(
    kernels: FieldKernels,
    topology: Topology,
    roots: Roots,
    mean: Floats,
    low: Floats,
    high: Floats,
    rows: Integers,
) -> Floats:
    """Return the points of cells at creases.

    Args:
        kernels: The shape.
        topology: Its points.
        roots: The roots on its edges.
        mean: The mean root of each point's edges.
        low: The lowest place of each point.
        high: The highest.
        rows: The points to compute.
    """
    points = topology.points
    uses = np.diff(points.first, append=len(points.edges))[rows]
    slot = np.arange(12)[None]
    used = slot < uses[:, None]
    edge = points.edges[np.where(used, points.first[rows][:, None] + slot, 0)]
    vectors = Array(VEC3, 12)
    types = [("points", vectors), ("slopes", vectors), ("weights", Array(FLOAT, 12))]
    types += [("middle", VEC3), ("low", VEC3), ("high", VEC3)]
    found: Floats = kernels.call(
        arithmetic.crease_point,
        roots.places[edge],
        roots.slopes[edge],
        used.astype(np.float64),
        mean[rows],
        low[rows],
        high[rows],
        types=types,
    )
    return found


def _in_regions(
    lattice: Lattice,
    topology: Topology,
    mean: Floats,
    found: Floats,
    margin: float,
    rows: Integers,
) -> Floats:
    """Return points of cells with several components, each within its component's region.

    Args:
        lattice: The lattice.
        topology: Its points.
        mean: The mean root of each point's edges, which is inside of the region.
        found: The place that each point should have.
        margin: The share of the way that is kept free.
        rows: The points to compute.
    """
    points = topology.points
    planes = cell_tables().planes[points.mask[rows], points.component[rows]]
    result: Floats = rows_of(
        arithmetic.kept_in_region,
        mean[rows],
        found[rows],
        lattice.places(points.cell[rows]),
        np.full(len(rows), lattice.step),
        planes,
        np.full(len(rows), max(0.02, margin)),
    )
    return result


def face_points(
    kernels: FieldKernels, lattice: Lattice, topology: Topology, roots: Roots, rows: Integers
) -> Floats:
    """Return points on faces, one for each given segment.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its segments.
        roots: The roots on its edges.
        rows: The segments.
    """
    segments, points = topology.segments, topology.points
    a, b = segments.edge_a[rows], segments.edge_b[rows]
    found = (roots.kept[a] + roots.kept[b]) / 2.0
    # Where the face or one of its cells belongs to several components, the point stays on the
    # line between the roots.
    several = points.shared[segments.lower[rows]] | points.shared[segments.upper[rows]]
    free = np.flatnonzero(~(several | segments.paired[rows]))
    for some in pieces(free):
        chosen = rows[some]
        normal = np.eye(3)[segments.axis[chosen]]
        margin = margin_of(lattice) * (1.0 - normal)
        corner = segments.face[chosen]
        found[some] = kernels.call(
            arithmetic.face_point,
            roots.kept[a[some]],
            roots.kept[b[some]],
            roots.slopes[a[some]],
            roots.slopes[b[some]],
            normal,
            lattice.places(corner + margin),
            lattice.places(corner + (1.0 - normal) - margin),
            types=[(name, VEC3) for name in _FACE_COLUMNS],
        )
    return found


_FACE_COLUMNS: Final = ("a", "b", "slope_a", "slope_b", "normal", "low", "high")
