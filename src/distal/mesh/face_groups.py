"""Groups of triangles that are parts of one flat face.

Input: a closed mesh, and for each triangle a number that those of a group must have in common.
Output: the group of each triangle, and the normals of the groups. Does not depend on shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh import flat_arithmetic, triangle_arithmetic
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Bools, Floats, Integers

# Triangles that bend less at each side may be a bent face as a whole: so many faces are taken off.
_MOST_FACES: Final = 8


@dataclass(frozen=True, slots=True)
class FaceGroups:
    """Flat faces of a mesh.

    Attributes:
        of: The face of each triangle; -1 for none.
        normals: Of shape (k, 3).
    """

    of: Integers
    normals: Floats


def mates_of(triangles: Integers) -> Integers:
    """Return for each side of each triangle, (3 m,), the same side of its neighbor.

    Args:
        triangles: Of shape (m, 3), closed: each side is there once in each direction.
    """
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    size = np.int64(triangles.max(initial=0) + 1)
    order = np.argsort(np.minimum(start, end) * size + np.maximum(start, end), kind="stable")
    mates = np.empty(len(order), np.int64)
    mates[order[0::2]], mates[order[1::2]] = order[1::2], order[0::2]
    return mates


def face_groups(
    points: Floats, triangles: Integers, labels: Integers | None, close: float
) -> FaceGroups:
    """Return the flat faces of a closed mesh that have several triangles.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        labels: Triangles of a face have the same number; those below 0 are in none. None for all
            the same.
        close: How far corners may be from the plane of their face.
    """
    one, other = _flat_sides(points, triangles, labels, close)
    groups = np.full(len(triangles), -1, np.int64)
    normals: list[Floats] = []
    count = 0
    for number in range(_MOST_FACES):
        rows, which = np.unique(np.concatenate([one, other]), return_inverse=True)
        if not len(rows):
            break
        whole = _components(len(rows), *which.reshape(2, -1))
        inside, planes = _beside_plane(points, triangles[rows], whole, close, seeds=number > 0)
        # What is beside the plane may be in several pieces: the largest is the face.
        within = inside[which.reshape(2, -1)].all(axis=0)
        part = _components(len(rows), *which.reshape(2, -1)[:, within])
        chosen, face = _largest_parts(whole, part, inside)
        groups[rows[chosen]] = count + face[chosen]
        normals.append(planes)
        count += len(planes)
        rest = (groups[one] < 0) & (groups[other] < 0)
        one, other = one[rest], other[rest]
    found = np.concatenate(normals) if normals else np.empty((0, 3))
    return FaceGroups(groups, found)


def _flat_sides(
    points: Floats, triangles: Integers, labels: Integers | None, close: float
) -> tuple[Integers, Integers]:
    """Return the pairs of neighbors that are in one plane."""
    mates = mates_of(triangles)
    half = np.flatnonzero(np.arange(len(mates)) < mates)
    one, other = half // 3, mates[half] // 3
    if labels is not None:
        same = (labels[one] == labels[other]) & (labels[one] >= 0)
        half, one, other = half[same], one[same], other[same]
    side = half % 3
    corners = [points[triangles[one, (side + i) % 3]] for i in range(3)]
    last = points[triangles[other, (mates[half] % 3 + 2) % 3]]
    flat = rows_of(flat_arithmetic.is_flat, *corners, last, np.full(len(half), close))
    return one[flat], other[flat]


def _components(count: int, one: Integers, other: Integers) -> Integers:
    """Return for each of some things the lowest number among those that it is connected with."""
    lowest = np.arange(count)
    while True:
        low = np.minimum(lowest[one], lowest[other])
        below = lowest.copy()
        np.minimum.at(below, lowest[one], low)
        np.minimum.at(below, lowest[other], low)
        while (below[below] != below).any():
            below = below[below]
        if (below == lowest).all():
            return lowest
        lowest = below


def _beside_plane(
    points: Floats, triangles: Integers, whole: Integers, close: float, *, seeds: bool
) -> tuple[Bools, Floats]:
    """Return which triangles are in the plane of their component, and the planes' normals.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        whole: The component of each.
        close: How far corners may be from the plane.
        seeds: Whether the plane is that of the largest triangle, and not the mean of all.
    """
    corners = [points[triangles[:, i]] for i in range(3)]
    areas, normals = rows_of(triangle_arithmetic.face, *corners)
    ids, which = np.unique(whole, return_inverse=True)
    order = np.lexsort((-areas, which))
    largest = order[np.flatnonzero(np.diff(which[order], prepend=-1))]
    if seeds:
        areas = np.bincount(largest, areas[largest], len(areas))
    total = np.stack([np.bincount(which, areas * normals[:, i], len(ids)) for i in range(3)], 1)
    middles = rows_of(triangle_arithmetic.middle, *corners)
    weight = np.bincount(which, areas, len(ids))
    sums = [np.bincount(which, areas * middles[:, i], len(ids)) for i in range(3)]
    center = np.stack(sums, 1) / np.maximum(weight, 1e-300)[:, None]
    total = rows_of(flat_arithmetic.unit, total)
    off = rows_of(flat_arithmetic.from_plane, *corners, center[which], total[which])
    inside: Bools = off <= close
    if not seeds:
        # All or none: otherwise the plane is that of the largest triangle, in the next round.
        inside = (np.bincount(which, ~inside, len(ids)) == 0)[which]
    return inside, total


def _largest_parts(whole: Integers, part: Integers, inside: Bools) -> tuple[Bools, Integers]:
    """Return which triangles are in the largest part of their component, and the component.

    Args:
        whole: The component of each triangle.
        part: The part of it that the triangle is in.
        inside: Whether the triangle is beside the plane.
    """
    _, face = np.unique(whole, return_inverse=True)
    counts = np.bincount(part, inside, len(part))
    best = np.zeros(int(face.max()) + 1)
    np.maximum.at(best, face, counts[part])
    # Of equally large ones, the one with the lowest number.
    first = np.full(len(best), len(part))
    is_best = inside & (counts[part] == best[face]) & (counts[part] > 1)
    np.minimum.at(first, face[is_best], part[is_best])
    return is_best & (part == first[face]), face
