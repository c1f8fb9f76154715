"""Where the points of a mesh are: roots on edges, points in cells, points on faces.

Input: topology, a lattice and a shape's kernels. Output: places. Every point stays within a convex
part of its cell: that keeps the triangles from intersecting.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC3, Array, Type
from distal.mesh import arithmetic, face_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import BRICK, DIGIT_OF_FILES, Lattice
from distal.mesh.parallel import parallel_map, pieces, slices_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tables import cell_tables
from distal.mesh.topology import Topology

SMALLEST_MARGIN: Final = 1e-4
# Points are kept this far away from sides of cells: 8 units in the last place of 32 bits.
SIDE_MARGIN: Final = 8.0 * DIGIT_OF_FILES
# The share of the way that is kept free in front of the planes around a region.
REGION_MARGIN: Final = 0.02
_MOST_ROOTS: Final = 12  # of one point at a crease


@dataclass(frozen=True, slots=True)
class Roots:
    """The points at which edges cross the surface.

    Attributes:
        places: Of shape (n, 3).
        slopes: The gradients there, of shape (n, 3).
        kept: The places, at least the margin away from the ends of the edges.
        means: The mean of these over the edges of each point, of shape (points, 3).
    """

    places: Floats
    slopes: Floats
    kept: Floats
    means: Floats


def margins_of(lattice: Lattice, size: Integers) -> Floats:
    """Return how far from its cell's sides a point must be, as a share of the cell.

    Args:
        lattice: The lattice.
        size: The sides of cells, in units of the lattice.
    """
    far = lattice.places(lattice.extent * BRICK)
    largest = float(max(np.abs(lattice.origin).max(), np.abs(far).max()))
    rounding = SIDE_MARGIN * (lattice.digit / DIGIT_OF_FILES) * largest
    found: Floats = np.maximum(SMALLEST_MARGIN, rounding / (lattice.step * size))
    return found


def margin_of(lattice: Lattice) -> float:
    """Return the margin of a cell of the size of a unit."""
    return float(margins_of(lattice, np.ones(1, np.int64))[0])


def roots_of(kernels: FieldKernels, lattice: Lattice, topology: Topology) -> Roots:
    """Return the roots on all edges.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its edges.
    """
    edges = topology.edges
    start = lattice.places(edges.start)
    way = np.zeros_like(start)
    way[np.arange(len(way)), edges.axis] = lattice.step * edges.size
    columns = (start, way, edges.first, edges.second)
    share, slopes = kernels.call(arithmetic.root_on_edge, *columns, types=_ROOT_COLUMNS)
    margin = margins_of(lattice, edges.size)
    kept = start + way * np.clip(share, margin, 1.0 - margin)[:, None]
    points = topology.points
    uses = np.diff(points.first, append=len(points.edges))
    means = np.add.reduceat(kept[points.edges], points.first) / uses[:, None]
    return Roots(start + way * share[:, None], slopes, kept, means)


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
    count = len(points.region)
    mean = roots.means
    at_crease = partial(_creased, topology, roots)
    creased = np.concatenate(parallel_map(at_crease, slices_of(count)))
    margin = margins_of(lattice, points.size)[:, None]
    size = points.size[:, None]
    low = lattice.places(points.cell + margin * size)
    high = lattice.places(points.cell + (1.0 - margin) * size)
    found = np.empty((count, 3))

    def place(smooth: Integers) -> None:
        columns = mean[smooth], low[smooth], high[smooth]
        found[smooth] = kernels.call(arithmetic.smooth_point, *columns, types=_SMOOTH_COLUMNS)

    parallel_map(place, pieces(np.flatnonzero(~creased)))
    rows = np.flatnonzero(creased)
    found[rows] = crease_points(kernels, topology, roots, low[rows], high[rows], rows)
    shared = np.flatnonzero(points.shared)
    if len(shared):
        found[shared] = _in_regions(lattice, topology, mean, found, shared)
    return found, creased


def _creased(topology: Topology, roots: Roots, rows: slice) -> Bools:
    """Return which points are at a crease: the normals at the roots of each differ.

    Args:
        topology: What belongs together.
        roots: The roots.
        rows: The points.
    """
    points, start, end = topology.points, rows.start, rows.stop
    stop = points.first[end] if end < len(points.first) else len(points.edges)
    first = points.first[start:end] - points.first[start]
    uses = np.diff(points.first[start:end], append=stop)
    edges = points.edges[points.first[start] : stop]
    normals = rows_of(arithmetic.unit_or_zero, roots.slopes[edges])
    average = rows_of(arithmetic.unit_or_zero, np.add.reduceat(normals, first))
    cosine = rows_of(arithmetic.cosine, normals, np.repeat(average, uses, axis=0))
    found: Bools = np.minimum.reduceat(cosine, first) < arithmetic.CREASE_COSINE
    return found


def crease_points(
    kernels: FieldKernels,
    topology: Topology,
    roots: Roots,
    low: Floats,
    high: Floats,
    rows: Integers,
) -> Floats:
    """Return points at creases.

    Args:
        kernels: The shape.
        topology: Its points.
        roots: The roots on its edges.
        low: The lowest place of each of these points.
        high: The highest.
        rows: The points.
    """
    points = topology.points
    found = np.empty((len(rows), 3))
    edges_of = np.diff(points.first, append=len(points.edges))
    slot = np.arange(_MOST_ROOTS)[None]

    def place(some: slice) -> None:
        chosen = rows[some]
        uses = edges_of[chosen]
        used = slot < uses[:, None]
        # A cell beside smaller ones can have more: evenly chosen ones say enough of its planes.
        nth = slot * np.maximum(uses[:, None], _MOST_ROOTS) // _MOST_ROOTS
        edge = points.edges[np.where(used, points.first[chosen][:, None] + nth, 0)]
        found[some] = kernels.call(
            arithmetic.crease_point,
            roots.places[edge],
            roots.slopes[edge],
            used.astype(np.float64),
            roots.means[chosen],
            low[some],
            high[some],
            types=_CREASE_COLUMNS,
        )

    parallel_map(place, slices_of(len(rows)))
    return found


def off_surface(
    kernels: FieldKernels, lattice: Lattice, places: Floats, rows: Integers
) -> Integers:
    """Return which points are farther from the surface than rounding takes them.

    Args:
        kernels: The shape.
        lattice: The lattice.
        places: The places of all points.
        rows: The points to look at.
    """
    off = kernels.call(arithmetic.distance_to_field, places[rows], types=[("p", VEC3)])
    found: Integers = rows[off > margin_of(lattice) * lattice.step]
    return found


def move_beyond(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    reach: Integers,
) -> None:
    """Move points at creases into the empty cells that they may reach, if that is clearly nearer.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its points.
        roots: The roots on its edges.
        places: The places of all points; changed.
        reach: The directions in which cells may be left.
    """
    rows = np.flatnonzero(reach.any(axis=1))
    if not len(rows):
        return
    cells, ways = topology.points.cell[rows], reach[rows]
    size = topology.points.size[rows]
    margin = margins_of(lattice, size)[:, None]
    low = lattice.places(cells + (margin + np.minimum(ways, 0)) * size[:, None])
    high = lattice.places(cells + ((1.0 - margin) + np.maximum(ways, 0)) * size[:, None])
    moved = crease_points(kernels, topology, roots, low, high, rows)
    after = kernels.call(arithmetic.distance_to_field, moved, types=[("p", VEC3)])
    before = kernels.call(arithmetic.distance_to_field, places[rows], types=[("p", VEC3)])
    # Where a crease is in the cell too, rounding does not decide.
    nearer = after < before - margin_of(lattice) * lattice.step
    places[rows[nearer]] = moved[nearer]


def _in_regions(
    lattice: Lattice,
    topology: Topology,
    mean: Floats,
    found: Floats,
    rows: Integers,
) -> Floats:
    """Return points of cells with several components, each within its component's region.

    Args:
        lattice: The lattice.
        topology: Its points.
        mean: The mean root of each point's edges, which is inside of the region.
        found: The place that each point should have.
        rows: The points to compute.
    """
    points = topology.points
    planes = cell_tables().planes[points.region[rows]]
    result: Floats = rows_of(
        arithmetic.kept_in_region,
        mean[rows],
        found[rows],
        lattice.places(points.cell[rows]),
        lattice.step * points.size[rows],
        planes,
        np.maximum(REGION_MARGIN, margins_of(lattice, points.size[rows])),
    )
    return result


def common_reach(topology: Topology, reach: Integers, rows: Integers) -> Integers:
    """Return the direction in which both cells of each segment's face may be left, beside the face.

    Args:
        topology: Its segments.
        reach: The directions in which cells may be left.
        rows: The segments.
    """
    segments = topology.segments
    one, other = reach[segments.lower[rows]], reach[segments.upper[rows]]
    beside = np.take_along_axis(one, segments.axis[rows][:, None], axis=1)[:, 0] == 0
    return np.where(((one == other).all(axis=1) & beside)[:, None], one, 0)


def face_points(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    reach: Integers,
    rows: Integers,
) -> Floats:
    """Return points on faces, one for each given segment.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its segments.
        roots: The roots on its edges.
        reach: The directions in which cells may be left.
        rows: The segments.
    """
    segments, points = topology.segments, topology.points
    found = (roots.kept[segments.edge_a[rows]] + roots.kept[segments.edge_b[rows]]) / 2.0
    # Where the face or one of its cells belongs to several components, the point stays on the
    # line between the roots.
    several = points.shared[segments.lower[rows]] | points.shared[segments.upper[rows]]
    free = np.flatnonzero(~(several | segments.paired[rows]))
    chosen = rows[free]
    side = 1.0 - np.eye(3)[segments.axis[chosen]]
    ways = common_reach(topology, reach, chosen)
    size = segments.size[chosen]
    margin = margins_of(lattice, size)[:, None] * side
    corner = segments.face[chosen]
    low = lattice.places(corner + (margin + np.minimum(ways, 0)) * size[:, None])
    high = lattice.places(corner + (side - margin + np.maximum(ways, 0)) * size[:, None])
    found[free] = _in_faces(kernels, topology, roots, low, high, chosen)
    return found


def wide_face_points(
    kernels: FieldKernels, lattice: Lattice, topology: Topology, roots: Roots, rows: Integers
) -> Floats:
    """Return points in the planes of faces, up to one cell beside them; as ``face_points``.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its segments.
        roots: The roots on its edges.
        rows: The segments.
    """
    segments = topology.segments
    side = (1.0 - np.eye(3)[segments.axis[rows]]) * segments.size[rows, None]
    low = lattice.places(segments.face[rows] - side)
    high = lattice.places(segments.face[rows] + 2.0 * side)
    return _in_faces(kernels, topology, roots, low, high, rows)


def _in_faces(
    kernels: FieldKernels,
    topology: Topology,
    roots: Roots,
    low: Floats,
    high: Floats,
    rows: Integers,
) -> Floats:
    """Return points in the planes of faces.

    Args:
        kernels: The shape.
        topology: Its segments.
        roots: The roots on its edges.
        low: The lowest place of each of these points.
        high: The highest.
        rows: The segments.
    """
    segments = topology.segments
    found = np.empty((len(rows), 3))

    def place(some: slice) -> None:
        chosen = rows[some]
        a, b = segments.edge_a[chosen], segments.edge_b[chosen]
        found[some] = kernels.call(
            face_arithmetic.face_point,
            roots.kept[a],
            roots.kept[b],
            roots.slopes[a],
            roots.slopes[b],
            np.eye(3)[segments.axis[chosen]],
            low[some],
            high[some],
            types=[(name, VEC3) for name in _FACE_COLUMNS],
        )

    parallel_map(place, slices_of(len(rows)))
    return found


_ROOT_COLUMNS: Final[list[tuple[str, Type]]] = [
    ("start", VEC3),
    ("way", VEC3),
    ("first", FLOAT),
    ("second", FLOAT),
]
_SMOOTH_COLUMNS: Final = [(name, VEC3) for name in ("mean", "low", "high")]
_FACE_COLUMNS: Final = ("a", "b", "slope_a", "slope_b", "normal", "low", "high")
_CREASE_COLUMNS: Final[list[tuple[str, Type]]] = [
    ("points", Array(VEC3, _MOST_ROOTS)),
    ("slopes", Array(VEC3, _MOST_ROOTS)),
    ("weights", Array(FLOAT, _MOST_ROOTS)),
    *((name, VEC3) for name in ("middle", "low", "high")),
]
