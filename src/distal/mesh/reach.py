"""Creases that leave the cells of the mesh: cells that may reach into an empty one beside them.

Input: topology, points of cells and roots. Output: for each point the direction in which its cell
may be left. A crease can pass through a cell without a change of sign at its corners, where a
lattice sees nothing. Such a cell is given to one neighbour at most. Both together are convex, and
the mesh has nothing else there: points and faces may reach into it without triangles that
intersect.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import arithmetic
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import Lattice, keys_of, position
from distal.mesh.places import Roots, crease_points, wide_face_points
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.topology import Topology

# Points at creases that are farther from the surface than this, in cells, are looked at.
_OFF: Final = 1e-6
_OFF_IN_FACE: Final = 1e-3


def reached(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    creased: Integers,
) -> Integers:
    """Return the direction in which the cell of each point may be left, of shape (n, 3).

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: What belongs together.
        roots: The roots on its edges.
        places: The points, each in its own cell.
        creased: The points at creases.
    """
    points = topology.points
    found = np.zeros((len(points.region), 3), np.int64)
    free = np.zeros(len(points.region), np.bool_)
    free[creased] = ~points.shared[creased]
    off = kernels.call(arithmetic.distance_to_field, places[creased], types=[("p", VEC3)])
    rows = creased[(off > _OFF * lattice.step) & free[creased]]
    occupied = np.sort(keys_of(points.cell))
    given: set[int] = set()
    if len(rows):
        corner = points.cell[rows]
        low, high = lattice.places(corner - 1), lattice.places(corner + 2)
        wanted = crease_points(kernels, topology, roots, low, high, rows)
        ways = one_way(wanted < lattice.places(corner), wanted > lattice.places(corner + 1))
        keys = keys_of(corner + ways)
        possible = ways.any(axis=1) & (position(keys, occupied) < 0)
        for row, way, key in zip(rows[possible], ways[possible], keys[possible], strict=True):
            if int(key) not in given:
                given.add(int(key))
                found[row] = way
    _reach_by_faces(kernels, lattice, topology, roots, places, free, occupied, given, found)
    return found


def _reach_by_faces(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    free: Bools,
    occupied: Integers,
    given: set[int],
    found: Integers,
) -> None:
    """Let both cells of a face reach to the same side, where a crease passes beside the face.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: What belongs together.
        roots: The roots on its edges.
        places: The points, each in its own cell.
        free: Whether a point is at a crease, and alone in its cell.
        occupied: The keys of all cells that the surface passes through, sorted.
        given: The keys of the cells that are given to a neighbour; added to.
        found: The directions; changed.
    """
    segments, points = topology.segments, topology.points
    rows = np.flatnonzero(free[segments.lower] & free[segments.upper] & ~segments.paired)
    if not len(rows):
        return
    line = places[segments.lower[rows]], places[segments.upper[rows]]
    miss = kernels.call(arithmetic.middle_distance, *line, types=[("p", VEC3), ("q", VEC3)])
    rows = rows[miss > _OFF_IN_FACE * lattice.step]
    if not len(rows):
        return
    corner = segments.face[rows]
    side = 1 - np.eye(3, dtype=np.int64)[segments.axis[rows]]
    wanted = wide_face_points(kernels, lattice, topology, roots, rows)
    below = (wanted < lattice.places(corner)) & (side > 0)
    ways = one_way(below, (wanted > lattice.places(corner + side)) & (side > 0))
    ends = segments.lower[rows], segments.upper[rows]
    keys = [keys_of(points.cell[end] + ways) for end in ends]
    empty = [position(key, occupied) < 0 for key in keys]
    for i in np.flatnonzero(ways.any(axis=1) & empty[0] & empty[1]):
        both = [(int(end[i]), int(key[i])) for end, key in zip(ends, keys, strict=True)]
        if all(_may_reach(point, key, ways[i], given, found) for point, key in both):
            for point, key in both:
                given.add(key)
                found[point] = ways[i]


def _may_reach(point: int, key: int, way: Integers, given: set[int], found: Integers) -> bool:
    """Return whether a point's cell may reach into an empty cell.

    Args:
        point: The point.
        key: The empty cell.
        way: Where it is.
        given: The cells that are given to a neighbour.
        found: The directions so far.
    """
    if found[point].any():
        return bool((found[point] == way).all())
    return key not in given


def one_way(
    below: Bools,
    above: Bools,
) -> Integers:
    """Return the direction in which a place is outside; 0 if it is outside in several.

    Args:
        below: Whether it is below along each axis.
        above: Whether it is above.
    """
    ways: Integers = above.astype(np.int64) - below.astype(np.int64)
    ways[np.abs(ways).sum(axis=1) != 1] = 0
    return ways
