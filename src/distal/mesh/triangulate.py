"""Make the triangles of a mesh: one or more around each edge that crosses the surface.

Input: topology, points of cells, roots. Output: all points, and triangles that are
counter-clockwise seen from outside.

The four points around an edge make two triangles, if a diagonal meets the triangle of the edge and
a third point. Three points, around an edge in the middle of a larger cell's face, make one, if it
meets the edge. Otherwise, and where the line between two neighbors leaves their face or misses the
surface, the triangles are a fan about the edge's root, with points on its faces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import face_arithmetic, triangle_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice
from distal.mesh.parallel import parallel_map, pieces
from distal.mesh.places import Roots, common_reach, face_points, margins_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.topology import Topology
from distal.polygons.whole_numbers import stable_order

# Below this difference of two diagonals' errors, in cells, the rounder triangles are preferred.
TIE: Final = 1e-3
_NEITHER: Final = 2
_ONE: Final = 3  # one triangle, of three points
_NO_FACE: Final = -2  # between two points of the same cell, instead of the number of a point
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
    segments = topology.edges.segments
    sides = np.where(segments < 0, _NO_FACE, of_segment[segments])
    plain = np.flatnonzero((sides == -1).all(axis=1))
    diagonal = np.full(len(sides), _NEITHER)

    def choose(rows: Integers) -> None:
        diagonal[rows] = _diagonals(kernels, lattice, topology, roots, places, rows, tolerance)

    parallel_map(choose, pieces(plain))
    straight = ((sides == -1) | (sides == _NO_FACE)).all(axis=1)
    three = np.flatnonzero(straight & ((sides == _NO_FACE).sum(axis=1) == 1))
    for rows in pieces(three):
        fits = _single_fits(lattice, topology, roots, places, sides, rows, tolerance)
        diagonal[rows[fits]] = _ONE
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
    opened = points.shared[segments.lower] | points.shared[segments.upper] | segments.paired

    def open_(rows: Integers) -> None:
        passes = _pass_their_faces(lattice, topology, places, reach, rows)
        opened[rows[~passes]] = True
        rest = rows[passes]
        ends = places[segments.lower[rest]], places[segments.upper[rest]]
        opened[rest] = kernels.call(face_arithmetic.middle_distance, *ends, types=_LINE) > tolerance

    parallel_map(open_, pieces(np.flatnonzero(~opened)))
    found: Bools = opened
    return found


def _pass_their_faces(
    lattice: Lattice, topology: Topology, places: Floats, reach: Integers, rows: Integers
) -> Bools:
    """Return which lines between the two points of segments pass through the segments' faces."""
    segments = topology.segments
    turned = (segments.axis[rows, None] + np.arange(3)) % 3
    corner = lattice.places(segments.face[rows])
    side = lattice.step * segments.size[rows, None]

    def relative(which: Integers) -> Floats:
        return np.take_along_axis(places[which[rows]] - corner, turned, axis=1) / side

    ways = np.take_along_axis(common_reach(topology, reach, rows), turned, axis=1)
    # Points are often kept at the margin: with half of it, rounding does not decide.
    margin = 0.5 * margins_of(lattice, segments.size[rows])[:, None]
    found: Bools = rows_of(
        face_arithmetic.passes_face,
        relative(segments.lower),
        relative(segments.upper),
        margin + np.minimum(ways, 0),
        1.0 - margin + np.maximum(ways, 0),
    )
    return found


def _diagonals(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    rows: Integers,
    tolerance: float,
) -> Integers:
    """Return the diagonal of the four points around each edge: 0, 1, or 2 for neither.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its edges.
        roots: The roots on them.
        places: The points in cells.
        rows: The edges.
        tolerance: How far the middle of a diagonal may be from the surface, and the edge's root
            from the triangles.
    """
    edges = topology.edges
    corners = places[edges.around[rows]]
    near = _along_edges(lattice, topology, corners, rows)
    margin = margins_of(lattice, edges.size[rows])
    fits = np.zeros((len(rows), 3))
    misses = np.full((len(rows), 3), np.inf)
    for which in range(2):
        p, q, third, fourth = (near[:, (which + i) % 4] for i in (0, 2, 1, 3))
        fits[:, which] = rows_of(face_arithmetic.diagonal_fits, p, q, third, fourth, margin)
        fitting = np.flatnonzero(fits[:, which])
        four = [corners[fitting, (which + i) % 4] for i in range(4)]
        miss = kernels.call(face_arithmetic.middle_distance, four[0], four[2], types=_LINE)
        root = roots.places[rows[fitting]]
        back = rows_of(triangle_arithmetic.distance_to_pair, root, *four)
        misses[fitting, which] = np.maximum(miss, back)
    found: Integers = rows_of(
        triangle_arithmetic.chosen_diagonal,
        corners,
        fits,
        np.minimum(misses, 1e300),
        np.full(len(rows), tolerance),
        TIE * lattice.step * edges.size[rows],
    ).astype(np.int64)
    return found


def _along_edges(lattice: Lattice, topology: Topology, corners: Floats, rows: Integers) -> Floats:
    """Return points around edges from the edges' lower ends, in their lengths, their axes first."""
    edges = topology.edges
    turned = (edges.axis[rows][:, None] + np.arange(3)) % 3
    start = lattice.places(edges.start[rows])
    near = np.take_along_axis(corners - start[:, None], turned[:, None], axis=2)
    near /= lattice.step * edges.size[rows, None, None]
    return near


def _three_points(around: Integers, sides: Integers) -> Integers:
    """Return the different points around edges with three cells, in order, of shape (n, 3)."""
    first = (sides == _NO_FACE).argmax(axis=1)
    return np.take_along_axis(around, (first[:, None] + np.arange(1, 4)) % 4, axis=1)


def _single_fits(
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    sides: Integers,
    rows: Integers,
    tolerance: float,
) -> Bools:
    """Return whether the three points around each edge make one triangle.

    Args:
        lattice: The lattice.
        topology: Its edges.
        roots: The roots on them.
        places: The points in cells.
        sides: The point on each of their four faces; -1 for none, -2 if there is no face.
        rows: The edges.
        tolerance: How far the edge's root may be from the triangle.
    """
    edges = topology.edges
    corners = places[_three_points(edges.around[rows], sides[rows])]
    near = _along_edges(lattice, topology, corners, rows)
    margin = margins_of(lattice, edges.size[rows])
    meets = rows_of(face_arithmetic.meets_edge, *np.moveaxis(near, 1, 0), margin).astype(np.bool_)
    of_corners = np.moveaxis(corners, 1, 0)
    back = rows_of(triangle_arithmetic.distance_to_triangle, roots.places[rows], *of_corners)
    found: Bools = meets & (back <= tolerance)
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
        sides: The point on each of its four faces; -1 for none, -2 if there is no face.
        of_edge: The point at its root; -1 for edges without a fan.
        diagonal: Which diagonal splits the four points, or that there is one triangle of three.
        inside_first: Whether the lower end of each edge is inside.
    """
    made = []
    for which, corners in ((0, ((0, 1, 2), (0, 2, 3))), (1, ((1, 2, 3), (1, 3, 0)))):
        rows = np.flatnonzero(diagonal == which)
        made += [(rows, around[rows][:, corner]) for corner in corners]
    single = np.flatnonzero(diagonal == _ONE)
    made.append((single, _three_points(around[single], sides[single])))
    fans = np.flatnonzero(diagonal == _NEITHER)
    for side in range(4):
        first, second = around[fans, side], around[fans, (side + 1) % 4]
        root, middle = of_edge[fans], sides[fans, side]
        straight = middle == -1
        made.append((fans[straight], np.stack([first, second, root], axis=1)[straight]))
        bent = middle >= 0
        made.append((fans[bent], np.stack([first, middle, root], axis=1)[bent]))
        made.append((fans[bent], np.stack([middle, second, root], axis=1)[bent]))
    edge = np.concatenate([rows for rows, _ in made])
    triangles = np.concatenate([corners for _, corners in made])
    turned = ~inside_first[edge]
    triangles[turned] = triangles[turned][:, ::-1]
    # Triangles of one edge are beside each other, which keeps neighbors close in memory.
    order = stable_order(edge)
    return triangles[order], edge[order]
