"""Make the triangles of a mesh: two or more around each edge that crosses the surface.

Input: topology, points of cells, roots. Output: all points, and triangles that are
counter-clockwise seen from outside.

The four points around an edge make two triangles, if a diagonal meets the triangle of the edge and
a third point. Otherwise, and where the line between two neighbours leaves their face or misses the
surface, the triangles are a fan about the edge's root, with points on its faces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import arithmetic, triangle_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice
from distal.mesh.places import Roots, common_reach, face_points, margin_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.topology import Topology

# Below this difference of two diagonals' errors, in cells, the rounder triangles are preferred.
_TIE: Final = 1e-3
_NEITHER: Final = 2
_LINE: Final = [("p", VEC3), ("q", VEC3)]


@dataclass(frozen=True, slots=True)
class Triangles:
    """Points and triangles.

    Attributes:
        points: Of shape (n, 3): points in cells, then points on faces, then roots.
        triangles: Of shape (m, 3), sorted by the edge of the lattice that they are around.
        edge: This edge, of shape (m,).
        fans: How many edges have a fan.
        face_points: How many points are on faces.
    """

    points: Floats
    triangles: Integers
    edge: Integers
    fans: int
    face_points: int


def triangulated(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    reach: Integers,
    inside_first: Bools,
    tolerance: float,
) -> Triangles:
    """Return the triangles.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: What belongs together.
        roots: The roots on edges.
        places: The points in cells.
        reach: The directions in which their cells may be left.
        inside_first: Whether the lower end of each edge is inside.
        tolerance: How far lines between points may be from the surface, in scene units.
    """
    opened = _open_segments(kernels, lattice, topology, places, reach, tolerance)
    on_faces = np.flatnonzero(opened)
    extra = face_points(kernels, lattice, topology, roots, reach, on_faces)
    of_segment = np.full(len(opened), -1, np.int64)
    of_segment[on_faces] = len(places) + np.arange(len(on_faces))
    sides = of_segment[topology.edges.segments]
    plain = np.flatnonzero((sides < 0).all(axis=1))
    diagonal = np.full(len(sides), _NEITHER)
    diagonal[plain] = _diagonals(kernels, lattice, topology, places, plain, tolerance)
    fans = np.flatnonzero(diagonal == _NEITHER)
    of_edge = np.full(len(sides), -1, np.int64)
    of_edge[fans] = len(places) + len(extra) + np.arange(len(fans))
    points = np.concatenate([places, extra, roots.kept[fans]])
    triangles, edge = _assembled(topology.edges.around, sides, of_edge, diagonal, inside_first)
    return Triangles(points, triangles, edge, len(fans), len(extra))


def _open_segments(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    places: Floats,
    reach: Integers,
    tolerance: float,
) -> Bools:
    """Return which segments need a point on their face."""
    segments, points = topology.segments, topology.points
    several = points.shared[segments.lower] | points.shared[segments.upper] | segments.paired
    turned = (segments.axis[:, None] + np.arange(3)) % 3
    corner = lattice.places(segments.face)

    def relative(which: Integers) -> Floats:
        return np.take_along_axis(places[which] - corner, turned, axis=1) / lattice.step

    ways = common_reach(topology, reach, np.arange(len(several)))
    ways = np.take_along_axis(ways, turned, axis=1)
    margin = margin_of(lattice)
    passes = rows_of(
        arithmetic.passes_face,
        relative(segments.lower),
        relative(segments.upper),
        margin + np.minimum(ways, 0),
        1.0 - margin + np.maximum(ways, 0),
    )
    opened = several | ~passes
    rest = np.flatnonzero(~opened)
    ends = places[segments.lower[rest]], places[segments.upper[rest]]
    misses = kernels.call(arithmetic.middle_distance, *ends, types=_LINE)
    opened[rest] = misses > tolerance
    found: Bools = opened
    return found


def _diagonals(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    places: Floats,
    rows: Integers,
    tolerance: float,
) -> Integers:
    """Return the diagonal of the four points around each edge: 0, 1, or 2 for neither.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its edges.
        places: The points in cells.
        rows: The edges.
        tolerance: How far the middle of a diagonal may be from the surface.
    """
    if not len(rows):
        return np.empty(0, np.int64)
    edges = topology.edges
    corners = places[edges.around[rows]]
    turned = (edges.axis[rows][:, None] + np.arange(3)) % 3
    start = lattice.places(edges.start[rows])
    near = np.take_along_axis(corners - start[:, None], turned[:, None], axis=2) / lattice.step
    margin = np.full(len(rows), margin_of(lattice))
    fits = np.zeros((len(rows), 3))
    misses = np.full((len(rows), 3), np.inf)
    for which in range(2):
        p, q, third, fourth = (near[:, (which + i) % 4] for i in (0, 2, 1, 3))
        fits[:, which] = rows_of(arithmetic.diagonal_fits, p, q, third, fourth, margin)
        fitting = np.flatnonzero(fits[:, which])
        ends = corners[fitting, which], corners[fitting, which + 2]
        misses[fitting, which] = kernels.call(arithmetic.middle_distance, *ends, types=_LINE)
    found: Integers = rows_of(
        triangle_arithmetic.chosen_diagonal,
        corners,
        fits,
        np.minimum(misses, 1e300),
        np.full(len(rows), tolerance),
        np.full(len(rows), _TIE * lattice.step),
    ).astype(np.int64)
    return found


def _assembled(
    around: Integers,
    sides: Integers,
    of_edge: Integers,
    diagonal: Integers,
    inside_first: Bools,
) -> tuple[Integers, Integers]:
    """Return the triangles, counter-clockwise seen from outside, and the edge of each.

    Args:
        around: The four points around each edge.
        sides: The point on each of its four faces; -1 for none.
        of_edge: The point at its root; -1 for edges without a fan.
        diagonal: Which diagonal splits the four points.
        inside_first: Whether the lower end of each edge is inside.
    """
    made = []
    for which, corners in ((0, ((0, 1, 2), (0, 2, 3))), (1, ((1, 2, 3), (1, 3, 0)))):
        rows = np.flatnonzero(diagonal == which)
        made += [(rows, around[rows][:, corner]) for corner in corners]
    fans = np.flatnonzero(diagonal == _NEITHER)
    for side in range(4):
        first, second = around[fans, side], around[fans, (side + 1) % 4]
        root, middle = of_edge[fans], sides[fans, side]
        straight = middle < 0
        made.append((fans[straight], np.stack([first, second, root], axis=1)[straight]))
        bent = ~straight
        made.append((fans[bent], np.stack([first, middle, root], axis=1)[bent]))
        made.append((fans[bent], np.stack([middle, second, root], axis=1)[bent]))
    edge = np.concatenate([rows for rows, _ in made])
    triangles = np.concatenate([corners for _, corners in made])
    turned = ~inside_first[edge]
    triangles[turned] = triangles[turned][:, ::-1]
    # Triangles of one edge are beside each other, which keeps neighbours close in memory.
    order = np.argsort(edge, kind="stable")
    return triangles[order], edge[order]
