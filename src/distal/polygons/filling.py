"""Triangles that fill polygons, also concave ones, and those of strips.

Input: points and the corners of polygons. Output: corners of triangles. A polygon of n corners
becomes n - 2 triangles that use all of its corners, so that its neighbors' edges are met.

A polygon is seen along its normal by Newell's method, the mean of its corners' turns, which exists
for polygons that are not quite plane. First the fans are tried, about each corner of all polygons
at once; what no fan fills is cut into ears. Bridges to holes, points on straight edges and points
twice are allowed. A polygon that crosses itself is filled by some triangles between its corners.

Source: Meisters, Polygons have ears, 1975; Sutherland, Sproull and Schumacker, A characterization
of ten hidden-surface algorithms, 1974 (Newell's normal).
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.foreign_files import check_time
from distal.polygons.triangles import MeshSize

# The most fans that are tried for a polygon before it is cut into ears.
_MOST_FANS: Final = 12
# Areas, as a share of the square of a polygon's size, that count as 0.
_FLAT: Final = 1e-12

Integers = NDArray[np.int64]


def filled(points: NDArray[Any], counts: Integers, indices: Integers) -> Integers:
    """Return triangles that fill polygons, those of the first one first.

    Args:
        points: (n, 3); those that no polygon may name are not checked here.
        counts: The number of corners of each polygon; those with fewer than 3 are left out.
        indices: The corners of all polygons, one after the other.

    Raises:
        LoadError: They are too many.
    """
    with np.errstate(all="ignore"):  # ``checked`` finds what is not finite
        return _filled(points, counts, indices)


def _filled(points: NDArray[Any], counts: Integers, indices: Integers) -> Integers:
    pieces = np.maximum(counts - 2, 0)
    MeshSize(0, int(pieces.sum())).check()
    starts = np.cumsum(counts) - counts
    ends = np.cumsum(pieces)
    triangles = _fans(starts, counts, indices, np.zeros(len(counts), np.int64))
    open_rows = np.flatnonzero(counts > 3)
    # What names a missing point is refused later; until then it must not be looked up.
    if len(open_rows) and indices.min() >= 0 and indices.max() < len(points):
        open_rows = open_rows[~_fits(points, starts[open_rows], counts[open_rows], indices, 0)]
        for turn in range(1, _MOST_FANS):
            if not len(open_rows):
                break
            fits = _fits(points, starts[open_rows], counts[open_rows], indices, turn)
            _put(triangles, ends, open_rows[fits], starts, counts, indices, turn)
            open_rows = open_rows[~fits]
        for row in open_rows.tolist():
            check_time()
            corners = indices[starts[row] : starts[row] + counts[row]]
            cut = _ears(_seen(points[corners]))
            triangles[ends[row] - pieces[row] : ends[row]] = corners[cut]
    return triangles


def strips(counts: Integers, indices: Integers) -> Integers:
    """Return the triangles of strips; a negative index ends a strip within a list.

    Args:
        counts: The number of indices of each list.
        indices: Those of all lists, one after the other.
    """
    MeshSize(0, len(indices)).check()
    begins = np.zeros(len(indices) + 1, bool)
    begins[np.cumsum(counts)] = True
    begins[0] = True
    begins[1:] |= indices < 0
    is_end = indices < 0
    if len(indices) < 3:
        return np.zeros((0, 3), np.int64)
    # The place of each index in its strip: what follows an end is the first one.
    at = np.arange(len(indices))
    first = np.maximum.accumulate(np.where(begins[:-1], at + is_end, 0))
    place = (at - first)[2:]
    whole = (place >= 2) & ~is_end[2:]
    found = np.stack([indices[:-2], indices[1:-1], indices[2:]], axis=1)
    turned = place % 2 == 1
    found[turned] = found[turned][:, [1, 0, 2]]
    return found[whole]


def _fans(starts: Integers, counts: Integers, indices: Integers, turns: Integers) -> Integers:
    """Return a fan for each polygon, about the corner that ``turns`` names."""
    pieces = np.maximum(counts - 2, 0)
    which = np.repeat(np.arange(len(counts)), pieces)
    step = np.arange(len(which)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    first, turn, count = starts[which], turns[which], counts[which]
    places = [first + (turn + k) % count for k in (np.zeros_like(step), step + 1, step + 2)]
    found: Integers = indices[np.stack(places, axis=1)].reshape(-1, 3)
    return found


def _put(
    triangles: Integers,
    ends: Integers,
    rows: Integers,
    starts: Integers,
    counts: Integers,
    indices: Integers,
    turn: int,
) -> None:
    """Replace the triangles of some polygons by the fan about one of their corners."""
    pieces = counts[rows] - 2
    offset = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    places = np.repeat(ends[rows] - pieces, pieces) + offset
    turns = np.full(len(rows), turn)
    triangles[places] = _fans(starts[rows], counts[rows], indices, turns)


def _fits(
    points: NDArray[Any], starts: Integers, counts: Integers, indices: Integers, turn: int
) -> NDArray[np.bool_]:
    """Return which polygons are filled by the fan about one corner: no piece is turned around.

    A piece may be flat only if the polygon is: a flat one has no normal, which its edges need.
    """
    turns = np.full(len(starts), turn)
    fan = points[_fans(starts, counts, indices, turns)]
    along, across = fan[:, 1] - fan[:, 0], fan[:, 2] - fan[:, 0]
    normals = np.cross(along, across)
    which = np.repeat(np.arange(len(counts)), counts - 2)
    totals = np.stack([np.bincount(which, normals[:, i], len(counts)) for i in range(3)], axis=1)
    lengths = np.linalg.norm(totals, axis=1)
    areas = (normals * totals[which]).sum(axis=1)
    sizes = (along * along).sum(axis=1) + (across * across).sum(axis=1)
    is_wrong = areas <= _FLAT * sizes * lengths[which]
    wrong = np.bincount(which, is_wrong, len(counts)) > 0
    found: NDArray[np.bool_] = (~wrong & (turn < counts)) | ~(lengths > 0.0)
    return found


def _seen(corners: NDArray[Any]) -> NDArray[np.float64]:
    """Return the corners of a polygon in the plane of Newell's normal, (n, 2), of size 1."""
    places = corners - corners.mean(axis=0)
    normal = np.cross(places, np.roll(places, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    normal = normal / length if length > 0.0 else np.array((0.0, 0.0, 1.0))
    other = np.eye(3)[np.argmin(np.abs(normal))]
    right = np.cross(other, normal)
    right /= np.linalg.norm(right)
    flat = np.stack([places @ right, places @ np.cross(normal, right)], axis=1)
    size = float(np.abs(flat).max())
    found: NDArray[np.float64] = flat / size if size > 0.0 else flat
    return found


def _ears(places: NDArray[np.float64]) -> Integers:
    """Return triangles, (n - 2, 3), that fill a polygon in the plane which runs counterclockwise.

    Of the ears with the shortest diagonals the first one that is empty is cut off. If there is none
    (the polygon crosses itself), the one with the shortest diagonal of those that turn left is.
    """
    left = np.arange(len(places))
    found = np.empty((len(places) - 2, 3), np.int64)
    for row in range(len(found)):
        check_time()
        near = places[left]
        before, behind = np.roll(near, 1, axis=0), np.roll(near, -1, axis=0)
        turns = _cross(near - before, behind - before)
        diagonals = ((behind - before) ** 2).sum(axis=1)
        convex = np.flatnonzero(turns > _FLAT)
        order = convex[np.argsort(diagonals[convex], kind="stable")]
        ear = next((k for k in order.tolist() if _is_empty(near, k)), None)
        if ear is None:
            ear = int(order[0]) if len(order) else int(np.argmin(np.abs(turns)))
        found[row] = left[ear - 1], left[ear], left[(ear + 1) % len(left)]
        left = np.delete(left, ear)
    return found


def _is_empty(near: NDArray[np.float64], ear: int) -> bool:
    """Whether no other corner of a polygon lies in the triangle at one of its corners, or on it.

    Then no edge does either: it would have to cross a side of the triangle that is an edge itself.
    Points at the triangle's own corners are those of bridges, whose edges run outside of it.
    """
    ring = [ear - 1, ear, (ear + 1) % len(near)]
    a, b, c = near[ring]
    others = np.delete(near, ring, axis=0)
    inside = np.ones(len(others), bool)
    for begin, end in ((a, b), (b, c), (c, a)):
        inside &= (_cross(end - begin, others - begin) >= -_FLAT) & (others != begin).any(axis=1)
    return not inside.any()


def _cross(first: NDArray[np.float64], second: NDArray[np.float64]) -> Any:
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
