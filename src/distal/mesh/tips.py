"""Where the surface ends beyond the cells of a mesh: tips that are too thin for their cells.

Input: topology, points of cells and roots. Output: places of the surface. A tip that is narrower
than its cell changes no sign at the cell's corners; the point below it stays in its own cell, close
to the tip's side and far from its end.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import arithmetic, triangle_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice
from distal.mesh.places import Roots, crease_points, off_surface
from distal.mesh.solid import Floats, Integers
from distal.mesh.topology import Topology

# How many cells beyond its own a tip is looked for: a cone's, down to a half angle of 2 degrees.
_CELLS: Final = 16
# A place counts as one of the surface if its value is this share of its distance at most.
_ON_SURFACE: Final = 0.02
# By which share of its length a place is moved from a tip's end to the point below it.
_INWARDS: Final = 0.01


def tips_beyond(
    kernels: FieldKernels,
    lattice: Lattice,
    topology: Topology,
    roots: Roots,
    places: Floats,
    creased: Integers,
    tolerance: float,
) -> tuple[Floats, Floats]:
    """Return places where planes through a cell's roots meet on the surface, but not in the cell.

    Args:
        kernels: The shape.
        lattice: The lattice.
        topology: What belongs together.
        roots: The roots on its edges.
        places: The points, each in its own cell.
        creased: The points at creases.
        tolerance: How far the mesh may be from the surface; what is closer counts for nothing.

    Returns:
        The places, of shape (n, 3), and how far they are from the points of their cells.
    """
    rows = off_surface(kernels, lattice, places, creased)
    if not len(rows):
        return np.empty((0, 3)), np.empty(0)
    cells, size = topology.points.cell[rows], topology.points.size[rows, None]
    low = lattice.places(cells - _CELLS * size)
    high = lattice.places(cells + (_CELLS + 1) * size)
    found = crease_points(kernels, topology, roots, low, high, rows)
    away = rows_of(triangle_arithmetic.between, found, places[rows])
    off = kernels.call(arithmetic.distance_to_field, found, types=[("p", VEC3)])
    is_tip = (away > tolerance) & (off < _ON_SURFACE * away)
    # Inside of the tip: its end may be on the side of a cell that it is not in.
    inside = found + _INWARDS * (places[rows] - found)
    return inside[is_tip], away[is_tip]
