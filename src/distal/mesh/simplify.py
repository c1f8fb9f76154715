"""Fewer triangles within what is left of the tolerance.

Input: a mesh, its measured error and the tolerance. Output: a mesh with a part of the points, and
its error, measured again; the given mesh where the other is worse than the tolerance, or has a
fault. Needs the package manifold3d, which removes points where the surface moves by less than a
given distance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.mesh.checks import checked
from distal.mesh.kernels import FieldKernels
from distal.mesh.pieces import distances
from distal.mesh.solid import Floats, Integers
from distal.packages import imported

PACKAGE: Final = "manifold3d"
# Less than the whole of what is left: the error is measured at other points afterwards.
_SHARES: Final = (0.9, 0.45)
_AT_ONCE: Final = 1 << 16
# Colors that are kept apart: a point between two of them stays on their border.
_MOST_COLORS: Final = 64
_MOST_DIVISIONS: Final = 64


@dataclass(frozen=True, slots=True)
class Simplified:
    """A mesh with fewer triangles.

    Attributes:
        points: Which points of the mesh are left, in order.
        triangles: Of shape (n, 3): indices of these points.
        largest: The largest distance to the surface.
        mean: The mean distance.
        place: Where the largest one is.
        moved: How far the surface may have moved.
    """

    points: Integers
    triangles: Integers
    largest: float
    mean: float
    place: tuple[float, ...]
    moved: float


def simplified(
    kernels: FieldKernels,
    points: Floats,
    triangles: Integers,
    shades: Floats | None,
    *,
    error: float,
    tolerance: float,
    step: float,
    watch: Callable[[float], None],
) -> Simplified | None:
    """Return the mesh with fewer triangles; None if there is none within the tolerance.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        shades: The color of each triangle, whose borders stay; or None.
        error: The measured error of the mesh.
        tolerance: The error that is allowed.
        step: The length of a cell, within which the error is measured.
        watch: Called now and then.
    """
    for share in _SHARES:
        moved = share * (tolerance - error)
        if moved <= 0.0:
            return None
        found = _without_points(points, triangles, shades, moved)
        watch(1.0)
        if found is None or len(found[1]) >= len(triangles):
            continue
        kept, rows = found
        places = points[kept]
        single = places.astype(np.float32).astype(np.float64)
        if any(checked(places, rows).values()) or any(checked(single, rows).values()):
            continue
        largest, mean, place = _misses(kernels, places, rows, step, watch)
        if largest <= tolerance:
            return Simplified(kept, rows, largest, mean, place, moved)
    return None


def _without_points(
    points: Floats, triangles: Integers, shades: Floats | None, moved: float
) -> tuple[Integers, Integers] | None:
    """Return the points that stay, and triangles of them.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        shades: The color of each triangle, or None.
        moved: How far the surface may move.
    """
    manifold3d = imported(PACKAGE)
    order, runs = _runs(triangles, shades)
    given = manifold3d.Mesh64(
        vert_properties=np.array(points),  # it takes no read-only array
        tri_verts=triangles[order].astype(np.uint64),
        run_index=np.asarray([*(3 * runs), 3 * len(triangles)], np.uint64),
        run_original_id=np.asarray(
            manifold3d.Manifold.reserve_ids(len(runs)) + np.arange(len(runs)), np.uint32
        ),
    )
    solid = manifold3d.Manifold(given)
    if solid.status() != manifold3d.Error.NoError:
        return None
    made = solid.simplify(moved).to_mesh64()
    rows = np.asarray(made.tri_verts, np.int64)
    # Points are a part of the given ones: equal numbers name them. Borders of colors have several.
    return _named(points, np.asarray(made.vert_properties)[:, :3], rows)


def _runs(triangles: Integers, shades: Floats | None) -> tuple[Integers, Integers]:
    """Return an order of the triangles in which each color is one run, and where runs begin."""
    if shades is None:
        return np.arange(len(triangles)), np.zeros(1, np.int64)
    found, which = np.unique(np.round(shades, 6), axis=0, return_inverse=True)
    if len(found) > _MOST_COLORS:
        return np.arange(len(triangles)), np.zeros(1, np.int64)
    which = which.reshape(-1)
    order = np.argsort(which, kind="stable")
    return order, np.flatnonzero(np.diff(which[order], prepend=-1))


def _named(points: Floats, places: Floats, rows: Integers) -> tuple[Integers, Integers] | None:
    """Return which points are at some places, and triangles of them; None if one is not there."""
    own: Any = np.ascontiguousarray(points).view("V24").reshape(-1)
    order = np.argsort(own, kind="stable")
    wanted = np.ascontiguousarray(places).view("V24").reshape(-1)
    at = np.minimum(np.searchsorted(own[order], wanted), len(own) - 1)
    if (own[order[at]] != wanted).any():
        return None
    kept, corners = np.unique(order[at][rows], return_inverse=True)
    return kept, corners.reshape(-1, 3)


def _misses(
    kernels: FieldKernels,
    points: Floats,
    triangles: Integers,
    step: float,
    watch: Callable[[float], None],
) -> tuple[float, float, tuple[float, ...]]:
    """Return the largest distance of triangles to the surface, the mean, and the largest's place.

    Large triangles are divided into pieces about as long as a cell: the mean is that of pieces.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        step: The length of a cell.
        watch: Called now and then.
    """
    corners = points[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    counts = np.clip(np.ceil(sides / step), 1, _MOST_DIVISIONS).astype(np.int64)
    found = distances(kernels, points, triangles, counts, watch)
    return float(found.largest.max(initial=0.0)), found.mean, found.place
