"""Count what a mesh must not have: open edges, pinched points, triangles that intersect.

Input: points and triangles. Output: counts. Edges and points are compared as integers. Pairs of
triangles that vector code cannot separate are compared exactly, with integers of any length.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.exact import intersect
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Floats, Integers
from distal.polygons.whole_numbers import sorted_keys

_PAIRS_AT_ONCE: Final = 1 << 18


def checked(
    points: Floats, triangles: Integers, watch: Callable[[float], None] | None = None
) -> dict[str, int]:
    """Return how many faults of each kind a mesh has.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        watch: Called now and then, with a share that is not known: 1.
    """
    return {
        "open_edges": open_edges(triangles),
        "pinched_points": pinched_points(triangles, len(points)),
        "intersections": intersections(points, triangles, watch),
    }


def open_edges(triangles: Integers) -> int:
    """Return how many edges do not have one triangle on each side, with opposite directions."""
    if not len(triangles):
        return 0
    count = int(triangles.max()) + 1
    first = triangles.reshape(-1)
    second = np.roll(triangles, -1, axis=1).reshape(-1)
    ways, uses = np.unique(first * count + second, return_counts=True)
    back = ways % count * count + ways // count
    at = np.minimum(np.searchsorted(ways, back), len(ways) - 1)
    return int(((ways[at] != back) | (uses != 1)).sum())


def pinched_points(triangles: Integers, count: int) -> int:
    """Return how many points have triangles that are not one ring around the point."""
    corner = triangles.reshape(-1)
    following = np.roll(triangles, -1, axis=1).reshape(-1)
    before = np.roll(triangles, 1, axis=1).reshape(-1)
    # Around a point, each triangle leads from one neighbour to the next: follow all rings at once.
    size = np.int64(count)
    keys = corner * size + following
    order = np.argsort(keys, kind="stable")
    target = np.searchsorted(keys[order], corner * size + before)
    target = order[np.minimum(target, len(order) - 1)]
    smallest = np.arange(len(corner))
    while True:  # pointer doubling: every ring gets the number of its first triangle
        lower = np.minimum(smallest, smallest[target])
        target = target[target]
        if (lower == smallest).all():
            break
        smallest = lower
    rings = sorted_keys(corner * np.int64(len(corner)) + smallest) // len(corner)
    return int((np.bincount(rings, minlength=count) > 1).sum())


def intersections(
    points: Floats, triangles: Integers, watch: Callable[[float], None] | None = None
) -> int:
    """Return how many pairs of triangles meet where they have no point or side in common.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        watch: Called now and then.
    """
    found = 0
    for first, second in close_pairs(points, triangles):
        if watch is not None:
            watch(1.0)
        one, other, shared = _aligned(triangles[first], triangles[second])
        apart = _apart(points, one, other, shared)
        for a, b, count in zip(one[~apart], other[~apart], shared[~apart], strict=True):
            found += intersect(points[a].tolist(), points[b].tolist(), int(count))
    return found


def _apart(points: Floats, one: Integers, other: Integers, shared: Integers) -> Any:
    """Return which pairs are certainly apart; those that share a side are never."""
    apart = np.zeros(len(one), np.bool_)
    simple = np.flatnonzero(shared < 2)
    if len(simple):
        corners = [points[each[simple, i]] for each in (one, other) for i in range(3)]
        apart[simple] = rows_of(triangle_arithmetic.are_apart, *corners, shared[simple] == 1)
    flat = np.flatnonzero(shared == 2)
    if len(flat):
        # Two triangles with a common side meet only if one is folded onto the other.
        corners = [points[one[flat, i]] for i in range(3)]
        apart[flat] = rows_of(triangle_arithmetic.is_unfolded, *corners, points[other[flat, 2]])
    return apart


def _aligned(one: Integers, other: Integers) -> tuple[Integers, Integers, Integers]:
    """Return triangles with the corners that they share first, and how many these are."""
    same = one[:, :, None] == other[:, None, :]
    shared = same.sum(axis=(1, 2))
    own = np.argsort(~same.any(axis=2), axis=1, kind="stable")
    one = np.take_along_axis(one, own, axis=1)
    place = (other[:, :, None] == one[:, None, :]) * np.array([3, 2, 1])
    rank = np.argsort(-place.max(axis=2), axis=1, kind="stable")
    return one, np.take_along_axis(other, rank, axis=1), shared


def close_pairs(points: Floats, triangles: Integers) -> Any:
    """Yield pairs of triangles whose boxes overlap, each pair once.

    Triangles are put into a grid of cubes, as long as most triangles are.
    """
    corners = points[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    size = max(float(np.quantile((high - low).max(axis=1), 0.95)), 1e-300)
    base = low.min(axis=0)
    first = np.floor((low - base) / size).astype(np.int64)
    last = np.floor((high - base) / size).astype(np.int64)
    spans = last - first + 1
    cubes = spans.prod(axis=1)
    owner = np.repeat(np.arange(len(triangles)), cubes)
    within = np.arange(int(cubes.sum())) - np.repeat(np.cumsum(cubes) - cubes, cubes)
    across = spans[owner]
    cell = first[owner] + np.stack(
        [
            within // (across[:, 1] * across[:, 2]),
            within // across[:, 2] % across[:, 1],
            within % across[:, 2],
        ],
        axis=1,
    )
    keys = (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]
    order = np.argsort(keys, kind="stable")
    keys, owner = keys[order], owner[order]
    for gap in range(1, len(owner)):
        same = np.flatnonzero(keys[gap:] == keys[:-gap])
        if not len(same):
            return
        for start in range(0, len(same), _PAIRS_AT_ONCE):
            rows = same[start : start + _PAIRS_AT_ONCE]
            a, b = owner[rows], owner[rows + gap]
            meet = (low[a] <= high[b]).all(axis=1) & (low[b] <= high[a]).all(axis=1)
            # A pair in several cubes counts in the first one that it shares.
            shared = np.maximum(first[a], first[b])
            key = (shared[:, 0] << 42) | (shared[:, 1] << 21) | shared[:, 2]
            meet &= key == keys[rows]
            if meet.any():
                yield a[meet], b[meet]
