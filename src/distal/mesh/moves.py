"""Moves of points onto neighbors, kept so that they can be taken back.

Input: the triangles around points before they moved, and the triangles that are to be as they were.
Output: the mesh, with the moves taken back that changed these, and later ones that stand on them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from distal.mesh.solid import Bools, Floats, Integers


class Moving(Protocol):
    """A mesh whose points move: see ``Collapsing``."""

    triangles: Integers
    nearest: Integers
    away: Floats
    is_left: Bools
    log: list[Moves]


@dataclass(frozen=True, slots=True)
class Followed:
    """Places that are followed, as they were before a point moved.

    Attributes:
        place: The points of the first mesh.
        owner: Which of the points that moved changed what is nearest to them.
        nearest: The triangle that was nearest.
        away: How far it was.
    """

    place: Integers
    owner: Integers
    nearest: Integers
    away: Floats

    @staticmethod
    def none() -> Followed:
        """Return no places."""
        empty = np.empty(0, np.int64)
        return Followed(empty, empty, empty, np.empty(0))

    def some(self, rows: Bools) -> Followed:
        """Return some of them."""
        return Followed(self.place[rows], self.owner[rows], self.nearest[rows], self.away[rows])


@dataclass(frozen=True, slots=True)
class Moves:
    """Points that moved at the same time: none changed a triangle that another one changed.

    Attributes:
        count: One more than the largest number of a point.
        owner: For each triangle around them, the number of its point.
        triangle: The triangle.
        before: Its corners before.
        followed: What was nearest to places.
    """

    count: int
    owner: Integers
    triangle: Integers
    before: Integers
    followed: Followed

    @staticmethod
    def of(
        moves: Bools, owner: Integers, triangle: Integers, before: Integers, followed: Followed
    ) -> Moves:
        """Return the moves of those points that move; arguments are the attributes, for all."""
        rows = moves[owner]
        return Moves(len(moves), owner[rows], triangle[rows], before[rows], followed)

    def owners(self, is_one: Bools) -> Bools:
        """Return which points changed one of some triangles."""
        found = np.zeros(self.count, np.bool_)
        found[self.owner[is_one[self.triangle]]] = True
        return found

    def without(self, mesh: Moving, back: Bools) -> Moves:
        """Take some moves back, and return the others.

        Args:
            mesh: The mesh after these moves; changed in place.
            back: The points that go back.
        """
        rows, places = back[self.owner], back[self.followed.owner]
        mesh.triangles[self.triangle[rows]] = self.before[rows]
        mesh.is_left[self.triangle[rows]] = True
        was = self.followed.some(places)
        mesh.nearest[was.place], mesh.away[was.place] = was.nearest, was.away
        rest = self.owner[~rows], self.triangle[~rows], self.before[~rows]
        return Moves(self.count, *rest, self.followed.some(~places))


def take_back(mesh: Moving, triangles: Integers, depth: int) -> Bools:
    """Take the last moves back that changed some triangles; return which triangles change.

    Args:
        mesh: The mesh; changed in place.
        triangles: The triangles.
        depth: How many moves of each are taken back, at least.
    """
    since = _rounds(mesh.log, triangles, depth, len(mesh.triangles))
    backs = []
    for number, moves in enumerate(mesh.log):
        back = moves.owners(since <= number)
        changed = moves.triangle[back[moves.owner]]
        since[changed] = np.minimum(since[changed], number)
        backs.append(back)
    for number in reversed(range(len(backs))):
        mesh.log[number] = mesh.log[number].without(mesh, backs[number])
    found: Bools = since < len(mesh.log)
    return found


def _rounds(log: Sequence[Moves], triangles: Integers, depth: int, count: int) -> Integers:
    """Return the round of each triangle from which on moves are taken back; else one after all.

    Args:
        log: The moves.
        triangles: The triangles that are to change.
        depth: How many moves of each are taken back, at least.
        count: How many triangles there are.
    """
    found, left = np.full(count, len(log)), np.zeros(count, np.int64)
    left[triangles] = depth
    for number in reversed(range(len(log))):
        changed = log[number].triangle
        changed = changed[left[changed] > 0]
        found[changed] = number
        left[changed] -= 1
    return found
