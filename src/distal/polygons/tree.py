"""A tree over the triangles of a mesh, for winding numbers.

Input: corners. Output: the triangles in the order of the tree, and the arrays that
``arithmetic.winding_number`` reads. The nodes are in the order of a walk, so that a walk needs no
stack: the next node, or the one after the subtree.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

_LEAF: Final = 8  # triangles
_CHILDREN: Final = 8
_BITS: Final = 10  # of each coordinate in the order of triangles


def tree_buffers(corners: Sequence[NDArray[np.float32]]) -> dict[str, NDArray[Any]]:
    """Return the buffers of a tree, by the names in ``arithmetic``.

    Args:
        corners: The first, second and third corner of each triangle, three times (m, 3).
    """
    whole = np.stack(corners, axis=1)
    ordered = whole[_order(whole)].astype(np.float64)
    normals = 0.5 * np.cross(ordered[:, 1] - ordered[:, 0], ordered[:, 2] - ordered[:, 0])
    areas = np.sqrt((normals * normals).sum(axis=1))
    middles = ordered.mean(axis=1)
    low, high = ordered.min(axis=1), ordered.max(axis=1)
    firsts = [np.arange(0, len(ordered), _LEAF)]
    while len(firsts[-1]) > 1:
        firsts.append(firsts[-1][::_CHILDREN])
    places = _walk([len(first) for first in firsts])
    count = sum(map(len, firsts))
    balls, sums = np.zeros((count, 4), np.float32), np.zeros((count, 3), np.float32)
    following, begins, ends = (np.zeros(count, np.int32) for _ in range(3))
    for level, first in enumerate(firsts):
        place, size = places[level]
        total = np.add.reduceat(areas, first)
        weighted = np.add.reduceat(middles * areas[:, None], first)
        center = weighted / np.where(total > 0.0, total, 1.0)[:, None]
        below = np.minimum.reduceat(low, first)
        above = np.maximum.reduceat(high, first)
        center = np.where(total[:, None] > 0.0, center, 0.5 * (below + above))
        reach = np.maximum(center - below, above - center)
        balls[place] = np.column_stack([center, np.sqrt((reach * reach).sum(axis=1))])
        sums[place] = np.add.reduceat(normals, first)
        following[place] = place + size
        if level == 0:
            begins[place] = first
            ends[place] = np.minimum(first + _LEAF, len(ordered))
    following[following == count] = -1
    single = ordered.astype(np.float32)
    return {
        "FIRST": np.ascontiguousarray(single[:, 0]),
        "SECOND": np.ascontiguousarray(single[:, 1]),
        "THIRD": np.ascontiguousarray(single[:, 2]),
        "BALLS": balls,
        "AREAS": sums,
        "FOLLOWING": following,
        "BEGINS": begins,
        "ENDS": ends,
    }


def _walk(counts: list[int]) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Return the place of each node in the order of the walk, and the size of its subtree.

    Args:
        counts: The number of nodes of each level, leaves first.
    """
    sizes = [np.ones(counts[0], np.int64)]
    for count in counts[1:]:
        starts = np.arange(count) * _CHILDREN
        sizes.append(1 + np.add.reduceat(sizes[-1], starts))
    places = [np.zeros(1, np.int64)]
    for level in range(len(counts) - 2, -1, -1):
        size = sizes[level]
        before = np.cumsum(size) - size
        parents = np.arange(len(size)) // _CHILDREN
        places.append(places[-1][parents] + 1 + before - before[parents * _CHILDREN])
    return list(zip(reversed(places), sizes, strict=True))


def _order(corners: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return the triangles in the order of a curve that keeps near ones together (Morton)."""
    middles = corners.mean(axis=1)
    low = middles.min(axis=0)
    extent = max(float((middles.max(axis=0) - low).max()), 1e-30)
    cells = ((middles - low) * ((1 << _BITS) - 1) / extent).astype(np.uint64)
    keys = np.zeros(len(corners), np.uint64)
    for bit in range(_BITS):
        for axis in range(3):
            digit = cells[:, axis] >> np.uint64(bit) & np.uint64(1)
            keys |= digit << np.uint64(3 * bit + axis)
    return np.argsort(keys)
