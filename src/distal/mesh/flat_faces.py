"""Flat faces with few triangles: points inside of faces and of straight edges are taken out.

Input: a closed mesh and its flat faces. Output: triangles between some of its points, with the same
surface; those of no face stay as they are. A point is taken out by moving it onto a neighbor, where
all triangles around it keep their side; until one is possible, diagonals at the point are
flipped. Points without neighbors in common are taken out at the same time, in an order by chance
that is always the same. In the end diagonals are flipped until triangles are those of Delaunay.
Does not depend on shapes.

A point inside of a face can always be taken out: flips leave three triangles around it. So holes,
faces in one another and edges of any form need no polygons and no bridges between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh import flat_arithmetic
from distal.mesh.face_groups import FaceGroups
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.stars import StarFinder, Stars, is_proper, moved, without_twins

# Triangles are at least this many roundings of 32 bits high, where they were not lower before.
_ROUNDINGS: Final = 64.0
# Each round takes out about a seventh of the points that are left.
_MOST_ROUNDS: Final = 2000
# Corners of a quadrilateral are as good as on a circle.
_ROUNDER: Final = 1e-9
_MOST_FLIPS: Final = 400
_SEED: Final = 35


@dataclass(slots=True)
class _Faces:
    """A mesh whose faces lose points.

    Attributes:
        points: Of shape (n, 3).
        normals: Of the faces.
        close: How far points may be from a straight edge.
        least: How high triangles are at least.
        triangles: Of shape (m, 3).
        of: The face of each; -1 for none.
        number: How many faces each point is in; 0 where it stays.
    """

    points: Floats
    normals: Floats
    close: float
    least: float
    triangles: Integers
    of: Integers
    number: Integers

    def heights(self, triangles: Integers, faces: Integers) -> Floats:
        """Return the heights of triangles that are seen along the normals of faces."""
        corners = (self.points[triangles[:, i]] for i in range(3))
        found: Floats = rows_of(flat_arithmetic.height_along, *corners, self.normals[faces])
        return found


def without_spare_points(
    points: Floats, triangles: Integers, groups: FaceGroups, close: float
) -> tuple[Integers, Integers]:
    """Return triangles that need no points inside of flat faces and of straight edges, and faces.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        groups: The flat faces.
        close: How far points may be from a straight edge.
    """
    number = _faces_around(triangles, groups.of, len(points))
    used = np.zeros(len(points), np.bool_)
    used[triangles[groups.of >= 0].reshape(-1)] = True
    if not number.any():
        return triangles, groups.of
    near = used[triangles].any(axis=1)
    rounding = float(np.finfo(np.float32).eps) * float(np.abs(points).max())
    faces = _Faces(
        points,
        groups.normals,
        close,
        _ROUNDINGS * rounding,
        triangles[near],
        groups.of[near],
        number,
    )
    _take_out(faces)
    _flip(faces)
    rows = np.concatenate([triangles[~near], faces.triangles])
    return rows, np.concatenate([groups.of[~near], faces.of])


def _faces_around(triangles: Integers, of: Integers, count: int) -> Integers:
    """Return for each point of how many faces it is, if that is one or two and nothing else is."""
    size = np.int64(max(int(of.max(initial=0)) + 2, 2))
    keys = np.unique(triangles.reshape(-1) * size + np.repeat(of, 3) + 1)
    corner, face = np.divmod(keys, size)
    number = np.bincount(corner, minlength=count)
    curved = np.zeros(count, np.bool_)
    curved[corner[face == 0]] = True
    number[curved | (number > 2)] = 0
    return number


def _take_out(faces: _Faces) -> None:
    """Take points out of the faces, in rounds, until none is left that can be taken out."""
    order = np.random.default_rng(_SEED).random(len(faces.points))
    waiting = faces.number > 0
    for _ in range(_MOST_ROUNDS):
        some = waiting[faces.triangles].any(axis=1)
        if not some.any():
            return
        near = np.zeros(len(faces.points), np.bool_)
        near[faces.triangles[some].reshape(-1)] = True
        rows = np.flatnonzero(near[faces.triangles].any(axis=1))
        own = faces.triangles[rows]
        around = StarFinder(own, len(faces.points))
        # Points with few neighbors first: then no point gets many, and more go at the same time.
        rank = np.where(waiting, order - around.count, -np.inf)
        points = np.flatnonzero(waiting & (around.largest(rank) == rank))
        stars = around.of(points)
        chosen = _chosen(faces, around, points, stars, faces.of[rows])
        moves = without_twins(stars, chosen, len(faces.points))
        late = (chosen >= 0) & ~moves
        chosen[~moves] = -1
        changed = moved(own, stars, points, chosen)
        flips = ~moves & ~late
        flipped = _flip_at(faces, changed, stars, points, faces.of[rows], flips)
        faces.triangles[rows] = changed
        waiting[points[~(late | flipped)]] = False
        # Where a neighbor is gone, what was not possible may be.
        freed = stars.after[moves[stars.owner]]
        waiting[freed] = faces.number[freed] > 0
        faces.number[points[moves]] = 0
        waiting[points[moves]] = False
        proper = is_proper(faces.triangles)
        faces.triangles, faces.of = faces.triangles[proper], faces.of[proper]


def _chosen(
    faces: _Faces, around: StarFinder, points: Integers, stars: Stars, of: Integers
) -> Integers:
    """Return the neighbor that each point can move onto, that leaves the highest triangles; or -1.

    Args:
        faces: The mesh.
        around: Finds the triangles around points.
        points: The points.
        stars: The triangles around them.
        of: The face of each triangle.
    """
    allowed = _along_edges(faces, points, stars, of)
    target, other = stars.pairs()
    onto = stars.after[target]
    stays = allowed[target] & (stars.after[other] != onto) & (stars.before[other] != onto)
    target, other, onto = target[stays], other[stays], onto[stays]
    first = np.concatenate([points[stars.owner], onto])
    every = np.concatenate([np.arange(len(stars.owner)), other])
    made = np.stack([first, stars.after[every], stars.before[every]], axis=1)
    heights = faces.heights(made, of[stars.triangle[every]])
    before = np.full(len(points), np.inf)
    np.minimum.at(before, stars.owner, heights[: len(stars.owner)])
    least = np.full(len(stars.owner), -np.inf)
    least[target] = np.inf
    np.minimum.at(least, target, heights[len(stars.owner) :])
    needed = np.maximum(np.minimum(faces.least, before), 0.0)[stars.owner]
    rows = np.flatnonzero(allowed & (least > needed))
    rows = rows[around.is_joined_by_two(stars, rows)]
    rows = rows[np.lexsort((-least[rows], stars.owner[rows]))]
    rows = rows[np.flatnonzero(np.diff(stars.owner[rows], prepend=-1))]
    chosen = np.full(len(points), -1, np.int64)
    chosen[stars.owner[rows]] = stars.after[rows]
    return chosen


def _along_edges(faces: _Faces, points: Integers, stars: Stars, of: Integers) -> Bools:
    """Return onto which corners points may move: those at a straight edge only along the edge.

    Args:
        faces: The mesh.
        points: The points.
        stars: The triangles around them.
        of: The face of each triangle.
    """
    on_edge = faces.number[points] == 2
    at_edge = of[stars.triangle] != of[stars.triangle[stars.across()]]
    ends = np.flatnonzero(at_edge & on_edge[stars.owner])
    two = np.bincount(stars.owner[ends], minlength=len(points)) == 2
    ends = ends[two[stars.owner[ends]]].reshape(-1, 2)
    places = [faces.points[rows] for rows in (points[stars.owner[ends[:, 0]]],)]
    places += [faces.points[stars.after[ends[:, i]]] for i in range(2)]
    straight = rows_of(flat_arithmetic.is_between, *places, np.full(len(ends), faces.close))
    allowed: Bools = ~on_edge[stars.owner]
    allowed[ends[straight].reshape(-1)] = True
    return allowed


def _flip_at(
    faces: _Faces,
    triangles: Integers,
    stars: Stars,
    points: Integers,
    of: Integers,
    flips: Bools,
) -> Bools:
    """Flip lines at some points, so that they have fewer neighbors; return where it is done.

    Args:
        faces: The mesh.
        triangles: Of shape (m, 3), changed in place.
        stars: The triangles around the points.
        points: The points.
        of: The face of each triangle.
        flips: The points where a line is flipped.
    """
    across = stars.across()
    rows = np.flatnonzero(flips[stars.owner] & (of[stars.triangle] == of[stars.triangle[across]]))
    # The triangles (p, after, before) and, on the other side of p to after, (p, next, after).
    p, end = points[stars.owner[rows]], stars.after[rows]
    left, right = stars.before[rows], stars.after[across[rows]]
    at_p, beyond = np.stack([p, right, left], axis=1), np.stack([end, left, right], axis=1)
    old = (np.stack([p, end, left], axis=1), np.stack([p, right, end], axis=1))
    face = np.tile(of[stars.triangle[rows]], 4)
    heights = faces.heights(np.concatenate([at_p, beyond, *old]), face).reshape(2, 2, -1)
    height, now = heights.min(axis=1)
    fits = height > np.maximum(np.minimum(faces.least, now), 0.0)
    fits &= ~_are_joined(triangles, left, right, len(faces.points))
    some = np.flatnonzero(fits)
    other = stars.triangle[across[rows]]
    some = some[_first_at_both(height[some], stars.triangle[rows[some]], other[some], len(of))]
    # Half of the neighbors that are too many: three stay.
    owner = stars.owner[rows[some]]
    order = np.lexsort((-height[some], owner))
    place = np.arange(len(some)) - np.searchsorted(owner[order], owner[order])
    most = np.maximum((np.bincount(stars.owner, minlength=len(points)) - 3) // 2, 1)
    some = some[order[place < most[owner[order]]]]
    # Two points may flip to the same line.
    ends = np.stack([left[some], right[some]], axis=1)
    keys = ends.min(axis=1) * np.int64(len(faces.points)) + ends.max(axis=1)
    some = some[np.unique(keys, return_index=True)[1]]
    triangles[stars.triangle[rows[some]]] = at_p[some]
    triangles[stars.triangle[across[rows[some]]]] = beyond[some]
    flipped = np.zeros(len(points), np.bool_)
    flipped[stars.owner[rows[some]]] = True
    return flipped


def _are_joined(triangles: Integers, one: Integers, other: Integers, count: int) -> Bools:
    """Return which pairs of points are ends of a side."""
    size = np.int64(count)
    sides = np.sort((triangles * size + np.roll(triangles, -1, axis=1)).reshape(-1))
    found = np.zeros(len(one), np.bool_)
    for keys in (one * size + other, other * size + one):
        at = np.minimum(np.searchsorted(sides, keys), len(sides) - 1)
        found |= sides[at] == keys
    return found


def _flip(faces: _Faces) -> None:
    """Flip diagonals inside of faces until no two triangles are rounder with the other one.

    Source: Charles Lawson, "Software for C1 Surface Interpolation" (1977).
    """
    rows = np.flatnonzero(faces.of >= 0)
    size = len(faces.points)
    own, of = faces.triangles[rows], faces.of[rows]
    near = np.zeros(size, np.bool_)
    near[own.reshape(-1)] = True
    others = faces.triangles[(faces.of < 0) & (near[faces.triangles].sum(axis=1) >= 2)]
    for _ in range(_MOST_FLIPS):
        half, mate = _inner_sides(own, of, size)
        one, other = half // 3, mate // 3
        a, b, c = (own[one, (half % 3 + i) % 3] for i in range(3))
        d = own[other, (mate % 3 + 2) % 3]
        gain = rows_of(flat_arithmetic.flip_gain, *(faces.points[p] for p in (a, b, c, d)))
        some = np.flatnonzero(gain > _ROUNDER)
        first, second = (np.stack(corners, axis=1) for corners in ((c, a, d), (d, b, c)))
        lowest = np.minimum(
            faces.heights(first[some], of[one[some]]), faces.heights(second[some], of[one[some]])
        )
        some = some[lowest > 0.0]
        some = some[~_are_joined(np.concatenate([own, others]), c[some], d[some], size)]
        some = some[_first_at_both(gain[some], one[some], other[some], len(own))]
        keys = np.minimum(c[some], d[some]) * np.int64(size) + np.maximum(c[some], d[some])
        some = some[np.unique(keys, return_index=True)[1]]
        if not len(some):
            break
        own[one[some]], own[other[some]] = first[some], second[some]
    faces.triangles[rows] = own


def _inner_sides(triangles: Integers, of: Integers, count: int) -> tuple[Integers, Integers]:
    """Return the sides between triangles of one face: the halves of each."""
    size = np.int64(count)
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    keys = np.minimum(start, end) * size + np.maximum(start, end)
    order = np.argsort(keys, kind="stable")
    first = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    half, mate = order[first], order[first + 1]
    same = of[half // 3] == of[mate // 3]
    return half[same], mate[same]


def _first_at_both(gain: Floats, one: Integers, other: Integers, count: int) -> Integers:
    """Return the rows of pairs of triangles whose gain is the largest at both triangles."""
    order = np.lexsort((np.arange(len(gain)), -gain))
    rank = np.empty(len(gain), np.int64)
    rank[order] = np.arange(len(gain))
    lowest = np.full(count, len(gain))
    np.minimum.at(lowest, one, rank)
    np.minimum.at(lowest, other, rank)
    return np.flatnonzero((lowest[one] == rank) & (lowest[other] == rank))
