"""Points that cut an edge or a corner are moved onto the surface, so that they lie in its faces.

Input: a closed mesh, its shape, and how far points are off the surface. Output: points. Where
triangles would turn over, meet or be farther from the surface than the tolerance, points stay.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import arithmetic, triangle_arithmetic
from distal.mesh.checks import meeting_triangles
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.pieces import distances
from distal.mesh.solid import Bools, Floats, Integers

_MOST_REPEATS: Final = 4
# Points move by at most so many times as far as they are off the surface.
_REACH: Final = 2.0
# How far a triangle may turn: 60 degrees.
_COSINE: Final = 0.5


def with_points_on_surface(
    kernels: FieldKernels,
    points: Floats,
    triangles: Integers,
    off: Floats,
    *,
    close: float,
    tolerance: float,
    watch: Callable[[float], None],
) -> Floats:
    """Return the points, those that are off the surface on it where that is possible.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        off: How far the first points are off the surface.
        close: Points that are closer stay.
        tolerance: Points that are farther stay.
        watch: Called now and then.
    """
    some = np.flatnonzero((off > close) & (off <= tolerance))
    reach = _REACH * off[some][:, None]
    types = [(name, VEC3) for name in ("mean", "low", "high")]
    found = points.copy()
    for _ in range(_MOST_REPEATS):
        if not len(some):
            break
        old = points[some]
        found[some] = kernels.call(
            arithmetic.smooth_point, old, old - reach, old + reach, types=types
        )
        moved = np.zeros(len(points), np.bool_)
        moved[some] = True
        changed = moved[triangles].any(axis=1)
        bad = _bad(kernels, points, found, triangles, changed, tolerance)
        bad[meeting_triangles(found, triangles, changed, watch)] = True
        if not bad.any():
            return found
        moved[triangles[bad].reshape(-1)] = False
        found[some] = old
        reach, some = reach[moved[some]], some[moved[some]]
    return points


def _bad(
    kernels: FieldKernels,
    points: Floats,
    found: Floats,
    triangles: Integers,
    changed: Bools,
    tolerance: float,
) -> Bools:
    """Return which triangles turn too far or are too far from the surface."""
    rows = triangles[changed]
    normals = [
        rows_of(triangle_arithmetic.face, *(places[rows[:, i]] for i in range(3)))[1]
        for places in (points, found)
    ]
    turned = rows_of(arithmetic.cosine, *normals) < _COSINE
    far = distances(kernels, found, rows, np.full(len(rows), 2)).largest > tolerance
    bad = np.zeros(len(triangles), np.bool_)
    bad[changed] = turned | far
    return bad
