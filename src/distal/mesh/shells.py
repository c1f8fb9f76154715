"""The topology of a mesh: how many pieces it has, how many holes through them, how many voids.

Input: closed triangles. Output: counts. Does not depend on a shape.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Floats, Integers
from distal.polygons.whole_numbers import sorted_keys


@dataclass(frozen=True, slots=True)
class Shells:
    """The closed surfaces of a mesh.

    Attributes:
        pieces: How many of them are around material: parts that do not touch each other.
        holes: How many holes lead through (the genus of all surfaces together): 1 for a ring.
        voids: How many of them are around a closed hollow.
    """

    pieces: int
    holes: int
    voids: int


def shells_of(points: Floats, triangles: Integers) -> Shells:
    """Return the counts of a closed mesh; points that no triangle has do not count.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3), counter-clockwise seen from outside.
    """
    shell = _shell_of_points(len(points), triangles)
    of_triangle = shell[triangles[:, 0]]
    used = np.zeros(len(points), np.bool_)
    used[triangles] = True
    count = int(of_triangle.max()) + 1 if len(of_triangle) else 0
    # Each edge has two triangles, so there are three edges for two triangles.
    faces = np.bincount(of_triangle, minlength=count)
    corners = np.bincount(shell[used], minlength=count)
    genus = 1 - (corners - faces // 2) // 2
    middle = points[used].mean(axis=0) if count else np.zeros(3)
    a, b, c = (points[triangles[:, i]] - middle for i in range(3))
    volumes = rows_of(triangle_arithmetic.moments, a, b, c)[0] if count else np.empty(0)
    volume = np.bincount(of_triangle, weights=volumes, minlength=count)
    there = faces > 0
    voids = int((volume[there] < 0.0).sum())
    return Shells(int(there.sum()) - voids, int(genus[there].sum()), voids)


def _shell_of_points(count: int, triangles: Integers) -> Integers:
    """Return a number for each point, the same for points that triangles connect."""
    ends = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    low, high = ends.min(axis=1), ends.max(axis=1)
    keys = sorted_keys((low << 32) | high)
    low, high = keys >> 32, keys & 0xFFFFFFFF
    found = np.arange(count)
    while True:
        # The larger of two numbers that are connected becomes the smaller one, all at once.
        a, b = found[low], found[high]
        apart = np.flatnonzero(a != b)
        if not len(apart):
            return found
        low, high = low[apart], high[apart]
        np.minimum.at(found, np.maximum(a, b)[apart], np.minimum(a, b)[apart])
        while (found[found] != found).any():
            found = found[found]
