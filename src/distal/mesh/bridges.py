"""Find where a mesh joins two surfaces: a cell had both of them, and one point for the two.

Input: a mesh and the shape's kernels. Output: points that stand between two surfaces, in a gap or
in a wall, far from both for the size of their cell. The tolerance says nothing of them: a gap that
is narrower than the tolerance is a gap too.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from distal.ir.types import VEC3
from distal.mesh.arithmetic import distance_value
from distal.mesh.extract import Extracted
from distal.mesh.kernels import FieldKernels
from distal.mesh.solid import Bools, Floats

# How far from the surface such a point is at least, as a share of its cell.
_OFF: Final = 0.03
# Where the other surface is looked for: from the point away from the nearer one, in its cells.
_AHEAD: Final = np.arange(1, 9) / 8.0


class Bridges(NamedTuple):
    """Points of a mesh between two surfaces.

    Attributes:
        place: Where they are, of shape (n, 3).
        gap: How far the surfaces are apart there, at least.
    """

    place: Floats
    gap: Floats


def bridges_of(kernels: FieldKernels, found: Extracted, least: float) -> Bridges:
    """Return the points of a mesh that stand between two surfaces.

    Args:
        kernels: The shape.
        found: The mesh.
        least: Gaps and walls that are thinner are not looked for, in scene units.
    """
    made, topology, off = found.made, found.topology, found.misses.points
    side = np.zeros(len(made.points))
    of_edge = found.step * topology.edges.size / topology.unit
    np.maximum.at(side, made.triangles, of_edge[made.edge][:, None])
    rows = np.flatnonzero((off > _OFF * side) & (2.0 * off > least))
    rows = rows[_are_between(kernels, made.points[rows], found.normals[rows], side[rows])]
    return Bridges(made.points[rows], 2.0 * off[rows])


def _are_between(kernels: FieldKernels, points: Floats, normals: Floats, reach: Floats) -> Bools:
    """Return which points have a surface before them, away from the one that is nearest.

    Args:
        kernels: The shape.
        points: The points.
        normals: The normals there.
        reach: How far the other surface is at most.
    """

    def value(places: Floats) -> Floats:
        result: Floats = kernels.call(distance_value, places, types=[("p", VEC3)])
        return result

    if not len(points):
        return np.zeros(0, np.bool_)
    sign = np.sign(value(points))
    way = (sign * reach)[:, None] * normals
    ahead = points[:, None] + _AHEAD[:, None] * way[:, None]
    beyond = value(ahead.reshape(-1, 3)).reshape(len(points), -1) * sign[:, None]
    found: Bools = np.any(beyond < 0.0, axis=1)
    return found
