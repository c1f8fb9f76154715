"""The triangles around points of a closed mesh, and points that move onto a neighbor.

Input: triangles. Output: rows of whole numbers. Does not depend on where points are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh.accuracy import runs
from distal.mesh.solid import Bools, Floats, Integers
from distal.polygons.whole_numbers import stable_order

# A point with more neighbors is moved onto some of them only: pairs grow as the square.
_MOST_TARGETS: Final = 32


@dataclass(frozen=True, slots=True)
class Stars:
    """The triangles around some points, those of the first point first.

    Attributes:
        owner: Which of the points.
        triangle: The triangle.
        after: Its corner after the point.
        before: Its corner before the point.
    """

    owner: Integers
    triangle: Integers
    after: Integers
    before: Integers

    def pairs(self) -> tuple[Integers, Integers]:
        """Return rows with each row of the same point: all rows, some of points with many."""
        count = np.bincount(self.owner)
        first = np.cumsum(count) - count
        number = np.arange(len(self.owner)) - first[self.owner]
        some = np.flatnonzero(number % -(-count // _MOST_TARGETS)[self.owner] == 0)
        return runs(some, first[self.owner[some]], count[self.owner[some]])

    def across(self) -> Integers:
        """Return for each row the one on the other side of the line to its corner ``after``."""
        size = np.int64(max(int(self.after.max(initial=0)), int(self.before.max(initial=0))) + 1)
        found = np.empty(len(self.owner), np.int64)
        here = np.argsort(self.owner * size + self.after)
        found[here] = np.argsort(self.owner * size + self.before)
        return found


class StarFinder:
    """Finds the triangles around points.

    Args:
        triangles: Of shape (m, 3), closed.
        count: How many points there are.
    """

    def __init__(self, triangles: Integers, count: int) -> None:
        corners = triangles.reshape(-1)
        self._triangles = triangles
        self._halves = stable_order(corners)
        self.count = np.bincount(corners, minlength=count)
        self._first = np.cumsum(self.count) - self.count

    def of(self, points: Integers) -> Stars:
        """Return the triangles around some points."""
        owner, row = runs(np.arange(len(points)), self._first[points], self.count[points])
        half = self._halves[row]
        triangle, corner = np.divmod(half, 3)
        after, before = (self._triangles[triangle, (corner + i) % 3] for i in (1, 2))
        return Stars(owner, triangle, after, before)

    def largest(self, values: Floats) -> Floats:
        """Return for each point the largest value of itself and its neighbors."""
        used = np.flatnonzero(self.count)
        found = values.copy()
        largest = values[self._triangles].max(axis=1)[self._halves // 3]
        found[used] = np.maximum.reduceat(largest, self._first[used])
        return found

    def is_joined_by_two(self, stars: Stars, rows: Integers) -> Bools:
        """Return whether a point and its neighbor have two neighbors in common, and no more.

        Then the mesh stays a manifold where the point moves onto the neighbor.

        Args:
            stars: The triangles around the points.
            rows: Rows of it: the point, and its neighbor ``after``.
        """
        size = np.int64(len(self.count))
        own = np.unique(stars.owner * size + stars.after)
        others = self.of(stars.after[rows])
        keys = stars.owner[rows][others.owner] * size + others.after
        at = np.minimum(np.searchsorted(own, keys), len(own) - 1)
        common = np.bincount(others.owner, own[at] == keys, len(rows))
        found: Bools = common == 2
        return found


def without_twins(stars: Stars, chosen: Integers, count: int) -> Bools:
    """Return which points may move at the same time: no two of them make the same line.

    No two of the points are neighbors.

    Args:
        stars: The triangles around the points.
        chosen: The corner that each of them moves onto; -1 for none.
        count: How many points the mesh has.
    """
    moves = chosen >= 0
    onto = chosen[stars.owner]
    made = moves[stars.owner] & (stars.after != onto)
    ends = np.stack([onto[made], stars.after[made]], axis=1)
    keys = ends.min(axis=1) * np.int64(count) + ends.max(axis=1)
    order = stable_of(keys)
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    moves[stars.owner[made][order[same + 1]]] = False
    return moves


def stable_of(keys: Integers) -> Integers:
    """Return the order that sorts keys; equal ones keep their order."""
    return np.argsort(keys, kind="stable")


def moved(triangles: Integers, stars: Stars, points: Integers, chosen: Integers) -> Integers:
    """Return the triangles after some points have moved onto neighbors.

    Args:
        triangles: Of shape (m, 3).
        stars: The triangles around the points.
        points: The points.
        chosen: The corner that each of them moves onto; -1 for those that stay.
    """
    found = triangles.copy()
    rows = chosen[stars.owner] >= 0
    triangle, onto = stars.triangle[rows], chosen[stars.owner[rows]]
    own = found[triangle] == points[stars.owner[rows]][:, None]
    found[triangle] = np.where(own, onto[:, None], found[triangle])
    return found


def is_proper(triangles: Integers) -> Bools:
    """Return which triangles have three different corners."""
    a, b, c = triangles.T
    found: Bools = (a != b) & (b != c) & (c != a)
    return found
