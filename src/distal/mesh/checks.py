"""Count what a mesh must not have: open edges, pinched points, triangles that intersect.

Input: points and triangles. Output: counts. Edges and points are compared as integers. Pairs of
triangles that vector code cannot separate are compared exactly, with integers of any length.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, Final

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.accuracy import runs
from distal.mesh.exact import intersect
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.polygons.whole_numbers import numbers_in, sorted_keys

_PAIRS_AT_ONCE: Final = 1 << 18
# The shortest cubes, as a share of the mesh: their numbers have 21 bits.
_SHORTEST: Final = 1e-6
# About as many cubes for each triangle.
_CUBES: Final = 4.0


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
    # Around a point, each triangle leads from one neighbor to the next: follow all rings at once.
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
    return len(intersecting_pairs((points,), triangles, None, watch))


def intersecting_pairs(
    roundings: Sequence[Floats],
    triangles: Integers,
    some: Bools | None = None,
    watch: Callable[[float], None] | None = None,
    faces: Integers | None = None,
) -> Integers:
    """Return the pairs of triangles that meet where they have no point or side in common, (k, 2).

    Args:
        roundings: The points, each of shape (n, 3); a pair that meets in one of them is found.
        triangles: Of shape (m, 3).
        some: Pairs without one of these triangles are not looked at; None for all.
        watch: Called now and then.
        faces: Triangles with the same number from 0 are known to be apart.
    """
    found = []
    for first, second in close_pairs(roundings, triangles, some):
        if watch is not None:
            watch(1.0)
        if faces is not None:
            unknown = (faces[first] != faces[second]) | (faces[first] < 0)
            first, second = first[unknown], second[unknown]
        one, other, shared = _aligned(triangles[first], triangles[second])
        for points in roundings:
            unsure = np.flatnonzero(~_apart(points, one, other, shared))
            for row in unsure.tolist():
                corners = points[one[row]].tolist(), points[other[row]].tolist()
                if intersect(*corners, int(shared[row])):
                    found.append((first[row], second[row]))
    return np.array(found, np.int64).reshape(-1, 2)


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


def close_pairs(
    roundings: Sequence[Floats], triangles: Integers, some: Bools | None = None
) -> Iterator[tuple[Integers, Integers]]:
    """Yield pairs of triangles whose boxes overlap, each pair once.

    Triangles are put into grids of cubes of 1, 2, 4, ... lengths, each into the one whose cubes are
    as long as its box or longer, and compared with those of this grid and of finer ones.

    Args:
        roundings: The points, each of shape (n, 3); a box holds a triangle in all of them.
        triangles: Of shape (m, 3).
        some: Pairs without one of these triangles are left out; None for all.
    """
    if not len(triangles):
        return
    corners = [points.T[:, triangles[:, i]] for points in roundings for i in range(3)]
    boxes = _Boxes(reduce(np.minimum, corners), reduce(np.maximum, corners))
    sizes = (boxes.high - boxes.low).max(axis=0)
    extent = float((boxes.high.max(axis=1) - boxes.low.min(axis=1)).max())
    shortest = max(float(np.median(sizes)), _SHORTEST * extent, 1e-300)
    level = np.ceil(np.log2(np.maximum(sizes / shortest, 1.0))).astype(np.int64)
    for number in numbers_in(level).tolist():
        side = shortest * 2.0**number
        own, finer = np.flatnonzero(level == number), np.flatnonzero(level <= number)
        if some is None:
            yield from boxes.pairs(own, finer, side, level)
            continue
        yield from boxes.pairs(own, finer[some[finer]], side, level)
        # Those that have no such pair yet: the other one is not among ``some``.
        yield from boxes.pairs(own[some[own]], finer[~some[finer]], side, level)


@dataclass(frozen=True, slots=True)
class _Boxes:
    """The boxes of triangles.

    Attributes:
        low: The lowest corner of each, of shape (3, m).
        high: The highest.
    """

    low: Floats
    high: Floats

    def pairs(
        self, own: Integers, finer: Integers, side: float, level: Integers
    ) -> Iterator[tuple[Integers, Integers]]:
        """Yield the pairs of two sets of triangles whose boxes overlap.

        Args:
            own: The triangles of one grid.
            finer: Those of this grid and of finer ones.
            side: The length of the grid's cubes.
            level: The grid of each triangle.
        """
        if not len(own) or not len(finer):
            return
        base = self.low.min(axis=1)
        side = self._finer_side(own, finer, side, int(level[own[0]]))
        rows, keys = self._cubes(own, side, base)
        order = np.argsort(keys, kind="stable")
        rows, keys = rows[order], keys[order]
        others, asked = self._cubes(finer, side, base)
        begin = np.searchsorted(keys, asked)
        count = np.searchsorted(keys, asked, side="right") - begin
        busy = np.flatnonzero(count)
        total = np.cumsum(count[busy])
        last = int(total[-1]) if len(total) else 0
        ends = np.searchsorted(total, np.arange(_PAIRS_AT_ONCE, last, _PAIRS_AT_ONCE))
        for part in np.split(busy, ends):
            which, at = runs(part, begin[part], count[part])
            a, b, cube = others[which], rows[at], asked[which]
            keep = np.flatnonzero((level[a] < level[b]) | (a < b))
            a, b, cube = a[keep], b[keep], cube[keep]
            for low, high in zip(self.low, self.high, strict=True):
                keep = np.flatnonzero((low[a] <= high[b]) & (low[b] <= high[a]))
                a, b, cube = a[keep], b[keep], cube[keep]
            # A pair in several cubes counts in the first one that it shares.
            corner = np.maximum(self.low[:, a], self.low[:, b]) - base[:, None]
            keep = np.flatnonzero(_keys(np.floor(corner / side).astype(np.int64)) == cube)
            if len(keep):
                yield a[keep], b[keep]

    def _finer_side(self, own: Integers, finer: Integers, side: float, most: int) -> float:
        """Return a length of cubes that leaves fewer pairs: few large triangles meet all others.

        It is halved until there are more than a few cubes for each triangle.

        Args:
            own: The triangles of one grid.
            finer: Those that they are compared with.
            side: The length of the grid's cubes.
            most: How often it is halved at most.
        """
        both = np.concatenate([own, finer])
        base = self.low.min(axis=1)[:, None]
        low, high = self.low[:, both] - base, self.high[:, both] - base
        for _ in range(most):
            half = 0.5 * side
            spans = np.floor(high / half) - np.floor(low / half) + 1.0
            if spans.prod(axis=0).sum() > _CUBES * len(both):
                break
            side = half
        return side

    def _cubes(self, some: Integers, side: float, base: Floats) -> tuple[Integers, Integers]:
        """Return triangles with the key of each cube that their boxes are in."""
        base = base[:, None]
        first = np.floor((self.low[:, some] - base) / side).astype(np.int64)
        spans = np.floor((self.high[:, some] - base) / side).astype(np.int64) - first + 1
        rows, number = runs(np.arange(len(some)), np.zeros(len(some), np.int64), spans.prod(axis=0))
        across, up = spans[1:, rows]
        offset = np.stack([number // (across * up), number // up % across, number % up])
        return some[rows], _keys(first[:, rows] + offset)


def _keys(cells: Integers) -> Integers:
    """Return one number for each cube, of shape (3, n)."""
    found: Integers = (cells[0] << 42) | (cells[1] << 21) | cells[2]
    return found


def meeting_triangles(
    points: Floats,
    triangles: Integers,
    some: Bools,
    watch: Callable[[float], None],
    faces: Integers | None = None,
) -> Integers:
    """Return the triangles of pairs that intersect, in 64 or in 32 bits, one of which is given.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        some: The triangles that are looked at.
        watch: Called now and then.
        faces: Triangles with the same number from 0 are known to be apart.
    """
    if not some.any():
        return np.empty(0, np.int64)
    single = points.astype(np.float32).astype(np.float64)
    found: Integers = np.unique(intersecting_pairs((points, single), triangles, some, watch, faces))
    return found
