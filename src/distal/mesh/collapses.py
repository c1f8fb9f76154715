"""Fewer triangles within the tolerance: points of curved faces move onto their neighbors.

Input: a closed mesh, the shape, and how far the surface may be from the mesh. Output: triangles
between some of its points. A point moves if the new triangles face as the old ones, are not too
low, are within the tolerance of the surface at 28 places or more, and if all points of the first
mesh that were nearest to the old ones are within the tolerance of the new ones. Points that are no
neighbors move at the same time, in an order by chance that is always the same.

Source: Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh Optimization" (1993), for the condition
    that the mesh stays a manifold; Klein, Liebich, Strasser, "Mesh Reduction with Error Control"
    (1996), for points of the first mesh that are followed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh import collapse_arithmetic, triangle_arithmetic
from distal.mesh.accuracy import runs
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.moves import Followed, Moves
from distal.mesh.pieces import distances, turns
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.stars import StarFinder, Stars, is_proper, moved, without_twins

# Triangles are not lower than this share of the tolerance, unless they were.
LEAST_HEIGHT: Final = 0.2
# How far a triangle may turn at once: 45 degrees.
_COSINE: Final = 0.7
# What of the tolerance is used: between the places that are measured the surface is farther away.
_SHARE: Final = 0.9
_MOST_TRIES: Final = 3
_MOST_NEIGHBORS: Final = 24
_MOST_ROUNDS: Final = 400
# A triangle that is as long as so many cells is measured in two pieces along each side.
_CELLS: Final = 4.0
_MOST_PIECES: Final = 8
# Up to so many points are all tried in a round, so that there are fewer of them; of more only those
# that can move at the same time.
_FEW: Final = 4_000
_SEED: Final = 35


@dataclass(slots=True)
class Collapsing:
    """A mesh that loses points.

    Attributes:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3); those that are gone have two equal corners.
        tolerance: How far mesh and surface may be apart.
        angle: How much the surface may turn within a triangle, in radians; infinite for any angle.
        step: The length of a cell.
        waiting: The points that may move.
        nearest: For each point the triangle that it is close to; -1 if it is not followed.
        away: How far each of them is from it.
        tries: How many neighbors each point has tried.
        is_left: Which triangles are left.
        log: The moves of each round.
    """

    kernels: FieldKernels
    points: Floats
    triangles: Integers
    tolerance: float
    angle: float
    step: float
    waiting: Bools
    nearest: Integers
    away: Floats
    tries: Integers
    is_left: Bools
    log: list[Moves]

    @staticmethod
    def of(
        kernels: FieldKernels,
        points: Floats,
        triangles: Integers,
        movable: Bools,
        tolerance: float,
        angle: float,
        step: float,
    ) -> Collapsing:
        """Return a mesh whose points are all followed.

        Args:
            kernels: The shape.
            points: Of shape (n, 3).
            triangles: Of shape (m, 3).
            movable: The points that may move.
            tolerance: How far mesh and surface may be apart.
            angle: How much the surface may turn within a triangle, in radians.
            step: The length of a cell.
        """
        count = len(points)
        nearest = np.full(count, -1, np.int64)
        nearest[triangles.reshape(-1)] = np.repeat(np.arange(len(triangles)), 3)
        return Collapsing(
            kernels,
            points,
            triangles.copy(),
            tolerance,
            angle,
            step,
            waiting=movable & (nearest >= 0),
            nearest=nearest,
            away=np.zeros(count),
            tries=np.zeros(count, np.int64),
            is_left=np.ones(len(triangles), np.bool_),
            log=[],
        )

    def corners(self, triangles: Integers) -> list[Floats]:
        """Return the corners of triangles."""
        return [self.points[triangles[:, i]] for i in range(3)]


def collapsed(mesh: Collapsing, watch: Callable[[float], None] = lambda share: None) -> None:
    """Move points onto neighbors until none is left that may.

    Args:
        mesh: The mesh; changed in place.
        watch: Called now and then.
    """
    order = np.random.default_rng(_SEED).random(len(mesh.points))
    movable = mesh.waiting.copy()
    for _ in range(_MOST_ROUNDS):
        some: Bools = np.any(mesh.waiting[mesh.triangles], axis=1) & mesh.is_left
        if not some.any():
            return
        watch(1.0)
        _round(mesh, some, order, movable)


def _round(mesh: Collapsing, some: Bools, order: Floats, movable: Bools) -> None:
    """Move points that are no neighbors.

    Args:
        mesh: The mesh; changed in place.
        some: The triangles at points that wait.
        order: The order by chance.
        movable: The points that may move.
    """
    near = np.zeros(len(mesh.points), np.bool_)
    near[mesh.triangles[some].reshape(-1)] = True
    rows = np.flatnonzero(near[mesh.triangles].any(axis=1) & mesh.is_left)
    own = mesh.triangles[rows]
    around = StarFinder(own, len(mesh.points))
    rank = order - around.count
    points = np.flatnonzero(mesh.waiting)
    if len(points) > _FEW:
        points = points[_are_first(around, points, rank)]
    stars = around.of(points)
    chosen, possible = _chosen(mesh, around, points, stars)
    chosen[_are_far(mesh, rows, stars, chosen)] = -1
    fits = chosen >= 0
    fitting = np.flatnonzero(fits)
    chosen[fitting[~_are_first(around, points[fitting], rank)]] = -1
    chosen[~without_twins(stars, chosen, len(mesh.points))] = -1
    late = fits & (chosen < 0)
    followed = _follow(mesh, rows, points, stars, chosen)
    moves = chosen >= 0
    mesh.log.append(
        Moves.of(moves, stars.owner, rows[stars.triangle], own[stars.triangle], followed)
    )
    mesh.triangles[rows] = moved(own, stars, points, chosen)
    mesh.is_left[rows] = is_proper(mesh.triangles[rows])
    mesh.tries[points[~moves & ~late]] += 1
    done = ~moves & ~late & (mesh.tries[points] >= np.minimum(possible, _MOST_TRIES))
    mesh.waiting[points[done | moves]] = False
    movable[points[moves]] = False
    freed = stars.after[moves[stars.owner]]
    mesh.waiting[freed] = movable[freed]
    mesh.tries[freed] = 0


def _chosen(
    mesh: Collapsing, around: StarFinder, points: Integers, stars: Stars
) -> tuple[Integers, Integers]:
    """Return the neighbor that each point may move onto, and how many there are; -1 for none.

    The first one is what the point is closest to afterwards; after a try the next one.

    Args:
        mesh: The mesh.
        around: Finds the triangles around points.
        points: The points.
        stars: The triangles around them.
    """
    target, other = stars.pairs()
    onto = stars.after[target]
    stays = (stars.after[other] != onto) & (stars.before[other] != onto)
    target, other, onto = target[stays], other[stays], onto[stays]
    least = LEAST_HEIGHT * mesh.tolerance
    places = [mesh.points[p] for p in (points[stars.owner[other]], onto)]
    places += [mesh.points[p[other]] for p in (stars.after, stars.before)]
    found = rows_of(collapse_arithmetic.replaced, *places, np.full(len(other), 0.1 * least))
    own = [mesh.points[p] for p in (points[stars.owner], stars.after, stars.before)]
    heights = np.full(len(points), least)
    np.minimum.at(heights, stars.owner, 0.999 * rows_of(triangle_arithmetic.least_height, *own))
    count = len(stars.owner)
    cosine, height, away = (np.full(count, np.inf) for _ in range(3))
    for column, total in enumerate((cosine, height, away)):
        np.minimum.at(total, target, found[:, column])
    fits = (cosine > _COSINE) & (height >= heights[stars.owner]) & (away <= mesh.tolerance)
    fits &= around.count[stars.after] + around.count[points[stars.owner]] < _MOST_NEIGHBORS
    rows = np.flatnonzero(fits)
    rows = rows[around.is_joined_by_two(stars, rows)]
    rows = rows[np.lexsort((away[rows], stars.owner[rows]))]
    possible = np.bincount(stars.owner[rows], minlength=len(points))
    first = np.cumsum(possible) - possible
    chosen = np.full(len(points), -1, np.int64)
    tried = mesh.tries[points]
    left = np.flatnonzero(tried < possible)
    chosen[left] = stars.after[rows[first[left] + tried[left]]]
    return chosen, possible


def _are_first(around: StarFinder, points: Integers, rank: Floats) -> Bools:
    """Return which of some points have no neighbor of a higher rank among them."""
    own = np.full(len(rank), -np.inf)
    own[points] = rank[points]
    found: Bools = around.largest(own)[points] == own[points]
    return found


def _made(stars: Stars, chosen: Integers) -> tuple[Integers, Integers]:
    """Return the rows of the triangles that stay around points that move, and their corners."""
    onto = chosen[stars.owner]
    new = np.flatnonzero((onto >= 0) & (stars.after != onto) & (stars.before != onto))
    return new, np.stack([onto[new], stars.after[new], stars.before[new]], axis=1)


def _follow(
    mesh: Collapsing, rows: Integers, points: Integers, stars: Stars, chosen: Integers
) -> Followed:
    """Set the corner of points to -1 if places that are followed would be too far from the mesh.

    What was nearest to the other places before is returned.

    Args:
        mesh: The mesh; what is nearest to its points is changed.
        rows: The triangles whose numbers are in the stars.
        points: The points; no two of those that move are neighbors.
        stars: The triangles around them.
        chosen: The corner that each point moves onto; changed in place.
    """
    new, made = _made(stars, chosen)
    if not len(new):
        return Followed.none()
    place, point = _followed(mesh, rows, points, stars, chosen)
    # Each place with each new triangle around its point.
    count = np.bincount(stars.owner[new], minlength=len(points))
    first = np.cumsum(count) - count
    pair, which = runs(np.arange(len(place)), first[point], count[point])
    away = rows_of(
        triangle_arithmetic.distance_to_triangle,
        mesh.points[place[pair]],
        *mesh.corners(made[which]),
    )
    best = np.lexsort((away, pair))
    best = best[np.flatnonzero(np.diff(pair[best], prepend=-1))]
    far = _worst(point, away[best], len(points)) > mesh.tolerance
    chosen[far] = -1
    keeps = ~far[point]
    place, point, best = place[keeps], point[keeps], best[keeps]
    before = Followed(place, point, mesh.nearest[place], mesh.away[place])
    mesh.nearest[place] = rows[stars.triangle[new[which[best]]]]
    mesh.away[place] = away[best]
    return before


def _are_far(mesh: Collapsing, rows: Integers, stars: Stars, chosen: Integers) -> Bools:
    """Return which points would have new triangles that are too far from the surface.

    Those around it may already be farther than the share of the tolerance: between the places that
    were measured. Then the new ones need not be closer than these.

    Args:
        mesh: The mesh.
        rows: The triangles whose numbers are in the stars.
        stars: The triangles around the points.
        chosen: The corner that each point moves onto.
    """
    new, made = _made(stars, chosen)
    misses = _worst(stars.owner[new], _misses(mesh, made), len(chosen))
    far = misses > _SHARE * mesh.tolerance
    unsure = far & (misses <= mesh.tolerance)
    if unsure.any():
        own = np.flatnonzero(unsure[stars.owner])
        before = _misses(mesh, mesh.triangles[rows[stars.triangle[own]]])
        far &= ~unsure | (misses > _worst(stars.owner[own], before, len(chosen)))
    return far


def _worst(owner: Integers, values: Floats, count: int) -> Floats:
    """Return the largest value of each owner, 0 for those without any."""
    found = np.zeros(count)
    np.maximum.at(found, owner, values)
    return found


def _misses(mesh: Collapsing, triangles: Integers) -> Floats:
    """Return how far triangles are from the surface; infinite where it turns too much in them."""
    if not len(triangles):
        return np.empty(0)
    pieces = pieces_of(mesh.points, triangles, mesh.step)
    found = distances(mesh.kernels, mesh.points, triangles, pieces).largest
    limits = mesh.tolerance, mesh.angle
    turned = turns(mesh.kernels, mesh.points, triangles, pieces, found, *limits)
    return np.where(turned > 1.0, np.inf, found)


def pieces_of(
    points: Floats, triangles: Integers, step: float, most: int = _MOST_PIECES
) -> Integers:
    """Return in how many pieces along each side triangles are measured.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        step: The length of a cell.
        most: The most pieces.
    """
    corners = points[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    # Powers of 2: triangles with the same number are measured at once.
    power = np.ceil(np.log2(np.maximum(2.0 * sides / (_CELLS * step), 2.0)))
    found: Integers = np.minimum(2.0**power, most).astype(np.int64)
    return found


def _followed(
    mesh: Collapsing, rows: Integers, points: Integers, stars: Stars, chosen: Integers
) -> tuple[Integers, Integers]:
    """Return the places whose nearest triangle changes, and the point that moves, by its row.

    Args:
        mesh: The mesh.
        rows: The triangles whose numbers are in the stars.
        points: The points.
        stars: The triangles around them.
        chosen: The corner that each point moves onto; -1 for none.
    """
    of_triangle = np.full(len(mesh.triangles), -1, np.int64)
    moving = chosen[stars.owner] >= 0
    of_triangle[rows[stars.triangle[moving]]] = stars.owner[moving]
    followed = np.flatnonzero(mesh.nearest >= 0)
    point = of_triangle[mesh.nearest[followed]]
    own = point >= 0
    return followed[own], point[own]
