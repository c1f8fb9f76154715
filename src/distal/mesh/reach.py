"""Creases that leave the cells of the mesh: cells that may reach into an empty one beside them.

Input: topology, points of cells and roots. Output: for each point the direction in which its cell
may be left. A crease can pass through a cell without a change of sign at its corners, where a
lattice sees nothing. Such a cell is given to one neighbor at most. Both together are convex, and
the mesh has nothing else there: points and faces may reach into it without triangles that
intersect.

Which neighbor gets a cell depends on directions alone, not on the order of points: a page, whose
points have another order, gives the same cells.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import arithmetic, face_arithmetic
from distal.mesh.cell_tree import AROUND
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice, keys_of, position
from distal.mesh.places import Roots, crease_points, margin_of, off_surface, wide_face_points
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.topology import Topology
from distal.polygons.whole_numbers import sorted_keys


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
    points, unit = topology.points, topology.unit
    free = np.zeros(len(points.region), np.bool_)
    undivided = position(keys_of(points.cell[creased] // unit), topology.closed) < 0
    undivided &= points.size[creased] == unit
    undivided[undivided] = _beside_equal(topology, points.cell[creased[undivided]] // unit)
    free[creased] = ~points.shared[creased] & undivided
    rows = off_surface(kernels, lattice, places, creased)
    rows = rows[free[rows]]
    given = _Given(topology)
    if len(rows):
        given.add(rows[:, None], _ways_of_points(kernels, lattice, topology, roots, rows))
    segments = topology.segments
    rows = np.flatnonzero(free[segments.lower] & free[segments.upper] & ~segments.paired)
    line = places[segments.lower[rows]], places[segments.upper[rows]]
    miss = kernels.call(face_arithmetic.middle_distance, *line, types=[("p", VEC3), ("q", VEC3)])
    rows = rows[miss > arithmetic.OFF_FACE * unit * lattice.step]
    if len(rows):
        # Both cells of a face reach to the same side, where a crease passes beside the face.
        both = np.stack([segments.lower[rows], segments.upper[rows]], axis=1)
        given.add(both, _ways_of_faces(kernels, lattice, topology, roots, rows))
    return given.ways


def _ways_of_points(
    kernels: FieldKernels, lattice: Lattice, topology: Topology, roots: Roots, rows: Integers
) -> Integers:
    """Return the codes of the directions in which points should leave their cells.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its points.
        roots: The roots on its edges.
        rows: The points.
    """
    corner, unit = topology.points.cell[rows], topology.unit
    low, high = lattice.places(corner - unit), lattice.places(corner + 2 * unit)
    wanted = crease_points(kernels, topology, roots, low, high, rows)
    return _codes(lattice, wanted, corner, corner + unit)


def _ways_of_faces(
    kernels: FieldKernels, lattice: Lattice, topology: Topology, roots: Roots, rows: Integers
) -> Integers:
    """Return the codes of the directions in which points of segments should leave their faces.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: Its segments.
        roots: The roots on its edges.
        rows: The segments.
    """
    corner, unit = topology.segments.face[rows], topology.unit
    wanted = wide_face_points(kernels, lattice, topology, roots, rows)
    normal = unit * np.eye(3, dtype=np.int64)[topology.segments.axis[rows]]
    return _codes(lattice, wanted, corner - normal, corner + unit)


def _codes(lattice: Lattice, wanted: Floats, low: Integers, high: Integers) -> Integers:
    """Return the codes of the directions in which places are outside of boxes.

    Args:
        lattice: The lattice.
        wanted: The places.
        low: The lowest lattice point of each box.
        high: The highest.
    """
    margin = margin_of(lattice)
    box = lattice.places(low - margin), lattice.places(high + margin)
    codes: Integers = rows_of(face_arithmetic.way_out, wanted, *box).astype(np.int64)
    return codes


def _beside_equal(topology: Topology, cells: Integers) -> Bools:
    """Return which cells share no corner with a larger one."""
    found = np.ones(len(cells), np.bool_)
    for number, keys in enumerate(reversed(topology.larger)):
        if not len(keys):
            continue
        for way in AROUND:
            found &= position(keys_of((cells + way) >> number + 1), keys) < 0
    return found


class _Given:
    """The empty cells that are given to points.

    Attributes:
        ways: The direction in which the cell of each point may be left, of shape (n, 3).
    """

    def __init__(self, topology: Topology) -> None:
        self._cell = topology.points.cell // topology.unit
        self.ways: Integers = np.zeros_like(self._cell)
        self._taken = sorted_keys(np.concatenate([keys_of(self._cell), topology.closed]))
        self._topology = topology

    def add(self, points: Integers, codes: Integers) -> None:
        """Give each group of points the cells in a direction, if all of them may have it.

        Within one direction no two points want the same cell: groups have no order.

        Args:
            points: The points of each group, of shape (n, m).
            codes: The code of each group's direction; 0 for none.
        """
        for code in _CODES:
            way = np.zeros(3, np.int64)
            way[abs(code) - 1] = np.sign(code)
            groups = points[codes == code]
            each = groups.reshape(-1)
            keys = keys_of(self._cell[each] + way)
            is_free = ~self.ways[each].any(axis=1) & (position(keys, self._taken) < 0)
            is_free[is_free] = _beside_equal(self._topology, (self._cell[each] + way)[is_free])
            has_it = (self.ways[each] == way).all(axis=1)
            chosen = groups[(is_free | has_it).reshape(groups.shape).all(axis=1)].reshape(-1)
            self.ways[chosen] = way
            given = keys_of(self._cell[chosen] + way)
            self._taken = sorted_keys(np.concatenate([self._taken, given]))


_CODES: Final = (-3, -2, -1, 1, 2, 3)
