"""Normals of the corners of triangles: those of points, but at edges each side has its own.

Input: points, triangles and normals of points. Output: normals of corners. Does not depend on
formats.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.runtime_access import executor
from distal.mesh import triangle_arithmetic
from distal.mesh.files import shading_arithmetic

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]

# At a point with more triangles than this each has its own normal: pairs grow as the square.
_MOST_AROUND: Final = 64
# Triangles that are less round, along creases, face anywhere: they take a neighbor's direction.
_THIN: Final = 1e-3
# Normals that differ by less are one.
_SAME: Final = 1e-5


def normals_with_edges(
    points: Floats, triangles: Integers, normals: Floats
) -> tuple[Floats, Integers]:
    """Return different normals, and the one of each corner of each triangle, (m, 3).

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        normals: Those of points, of shape (n, 3).
    """
    found = corner_normals(points, triangles, normals).reshape(-1, 3)
    at = triangles.reshape(-1)
    sharp = np.flatnonzero((np.abs(found - normals[at]) > _SAME).any(axis=1))
    if not len(sharp):
        return normals, triangles
    rows = np.column_stack([at[sharp], np.rint(found[sharp] / _SAME).astype(np.int64)])
    _, first, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    of = at.copy()
    of[sharp] = len(normals) + which.reshape(-1)
    used, of = np.unique(of, return_inverse=True)
    return np.concatenate([normals, found[sharp[first]]])[used], of.reshape(-1, 3)


def corner_normals(points: Floats, triangles: Integers, normals: Floats | None) -> Floats:
    """Return a normal for each corner of each triangle, of shape (m, 3, 3).

    It is the point's, unless one of the triangles around the point faces another way; then it is
    the mean of the triangles that face as this one does.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        normals: Of shape (n, 3), or None if they are not known.
    """
    corners = [points[triangles[:, i]] for i in range(3)]
    areas, faces = _rows(triangle_arithmetic.face, *corners)
    thin = np.flatnonzero(_rows(triangle_arithmetic.roundness, *corners) < _THIN)
    at = triangles.reshape(-1)
    faces[thin] = faces[_largest_at(at, areas)[triangles[thin, 0]]]
    of = np.repeat(np.arange(len(triangles)), 3)
    found: Floats = faces[of] if normals is None else normals[at]
    sharp = np.ones(len(points), np.bool_)
    if normals is not None:
        smooth = _rows(shading_arithmetic.is_smooth, faces[of], found)
        sharp = np.bincount(at, ~smooth, len(points)) > 0
    _join(found, at, of, sharp, faces, areas)
    return found.reshape(-1, 3, 3)


def _rows(function: Any, *columns: Any) -> Any:
    return executor().call(function, columns, {})


def _largest_at(at: Integers, areas: Floats) -> Integers:
    """Return the largest triangle at each point, from the point of each corner."""
    found = np.zeros(int(at.max(initial=-1)) + 1, np.int64)
    of = np.repeat(np.arange(len(areas)), 3)
    order = np.argsort(areas[of], kind="stable")
    found[at[order]] = of[order]
    return found


def _join(
    found: Floats, at: Integers, of: Integers, sharp: Bools, faces: Floats, areas: Floats
) -> None:
    """Set the normals of corners at edges to means of triangles.

    Args:
        found: The normal of each corner, changed in place.
        at: The point of each corner.
        of: The triangle of each corner.
        sharp: The points at edges.
        faces: The normal of each triangle.
        areas: Its area.
    """
    corners = np.flatnonzero(sharp[at])
    found[corners] = faces[of[corners]]
    corners = corners[np.argsort(at[corners], kind="stable")]
    _, begins, counts = np.unique(at[corners], return_index=True, return_counts=True)
    few = np.repeat(counts <= _MOST_AROUND, counts)
    begin, count = np.repeat(begins, counts)[few], np.repeat(counts, counts)[few]
    # Each corner of a point with each corner of this point.
    one = np.repeat(np.flatnonzero(few), count)
    if not len(one):
        return
    other = np.arange(len(one)) - np.repeat(np.cumsum(count) - count - begin, count)
    first, second = of[corners[one]], of[corners[other]]
    shares = _rows(shading_arithmetic.joined, faces[first], faces[second], areas[second])
    sums = [np.bincount(one, shares[:, axis], len(corners)) for axis in range(3)]
    chosen = corners[few]
    total = np.stack(sums, axis=1)[few]
    found[chosen] = _rows(shading_arithmetic.unit, total, faces[of[chosen]])
