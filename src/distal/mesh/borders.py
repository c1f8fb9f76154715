"""Cut triangles where their colors or finishes change abruptly.

Input: points, triangles, and a function that gives the appearance of places as rows of numbers.
Output: more points and triangles with the same surface. New points lie on sides of triangles, one
on a side, and where three appearances meet one more lies inside the triangle. So nothing new
intersects, and triangles on both sides of a cut side share its point. Does not depend on shapes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final, TypeAlias

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.jumps import (
    PIECES,
    Appearance,
    border_between,
    change,
    has_border,
    has_two_borders,
)
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Floats, Integers

# Triangles that are this many times as long as a cell are halved first, where there is a border.
_LONG: Final = 1.5
_MOST_HALVINGS: Final = 12
# Triangles shorter than this share of it stay: simpler meshes of smaller ones met themselves.
_SHORT: Final = 0.5
_MOST_ROUNDS: Final = 4
_INNER_HALVINGS: Final = 16
# The smallest share that a corner has in a point inside a triangle.
_INNER: Final = 0.02
# Pieces of triangles are at least this many roundings of 32 bits high.
_ROUNDINGS: Final = 64.0
_AT_ONCE: Final = 1 << 16
# Of three corners and the middles of the sides after them: the parts of a triangle.
_QUARTERS: Final = np.array([(0, 3, 5), (1, 4, 3), (2, 5, 4), (3, 4, 5)])


@dataclass(frozen=True, slots=True)
class Cut:
    """A mesh with cut triangles.

    Attributes:
        points: The points of the mesh, then the new ones, of shape (n, 3).
        triangles: Of shape (m, 3).
        normals: At the points; those at new points are between those at the ends of their sides.
        added: How many points are new.
    """

    points: Floats
    triangles: Integers
    normals: Floats
    added: int


def cut_at_borders(
    points: Floats,
    triangles: Integers,
    normals: Floats,
    appearance: Appearance,
    cell: float,
    watch: Callable[[float], None],
) -> Cut:
    """Return the mesh with triangles cut where the appearance jumps.

    A border is where the appearance changes by more than ``DIFFERENT`` within a millionth of a
    side; or the middle of a gradient that is narrower than about a third of a side, where triangles
    would show nothing but a jagged edge. Within a triangle it is straight.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        normals: Of shape (n, 3).
        appearance: Gives the appearance of places.
        cell: How long cells are that are neither joined nor divided, in scene units.
        watch: Called now and then.
    """
    mesh = _CutMesh(points, normals, triangles, np.arange(len(triangles)))
    first = 0
    for _ in range(_MOST_HALVINGS):
        halved = partial(_halved, mesh, first, appearance, _LONG * cell)
        first = len(mesh.points)
        if not mesh.cut(np.arange(len(mesh.triangles)), halved, appearance):
            break
        watch(1.0)
    first = 0
    for number in range(_MOST_ROUNDS):
        # A side with a new point has new triangles on both sides; the others were looked at.
        rows = np.flatnonzero((mesh.triangles >= first).any(axis=1))
        looks = partial(
            _at_borders, mesh, first, appearance=appearance, watch=watch, narrow=number == 0
        )
        first = len(mesh.points)
        if not mesh.cut(rows, looks, appearance):
            break
    added = len(mesh.points) - len(points)
    return Cut(mesh.points, mesh.triangles, mesh.normals, added)


# From the sides of triangles, and the sides of each triangle, to where each side is cut.
_Asked: TypeAlias = Callable[[Integers, Integers], Floats]


@dataclass(slots=True)
class _CutMesh:
    """A mesh that is cut, round by round.

    Attributes:
        points: Of shape (n, 3).
        normals: At the points.
        triangles: Of shape (m, 3).
        order: For each the triangle of the whole mesh that it is a piece of.
    """

    points: Floats
    normals: Floats
    triangles: Integers
    order: Integers

    def cut(self, rows: Integers, asked: _Asked, appearance: Appearance) -> bool:
        """Cut sides of triangles, with all triangles at these sides; return whether there are any.

        Args:
            rows: The triangles that are looked at, with all neighbors at sides that are cut.
            asked: Returns where sides are cut; 0 for nowhere.
            appearance: Gives the appearance of places.
        """
        triangles, order = self.triangles, self.order
        sides, of_triangle = _sides(triangles[rows], len(self.points))
        shares = asked(sides, of_triangle)
        _keep_thick(self.points, triangles[rows], of_triangle, sides, shares)
        cut = np.flatnonzero(shares > 0.0)
        if not len(cut):
            return False
        of_side = np.full(len(sides), -1, np.int64)
        of_side[cut] = len(self.points) + np.arange(len(cut))
        points, normals = _with_points_on(self.points, self.normals, sides[cut], shares[cut])
        new = of_side[of_triangle]
        three = np.flatnonzero((new >= 0).all(axis=1))
        middle = np.full(len(rows), -1, np.int64)
        middle[three] = len(points) + np.arange(len(three))
        inner = _inner_shares(points[triangles[rows[three]]], appearance)
        points, normals = _with_points_in(points, normals, triangles[rows[three]], inner)
        divided, source = _divided(triangles[rows], new, middle, points)
        triangles = np.concatenate([np.delete(triangles, rows, axis=0), divided])
        order = np.concatenate([np.delete(order, rows), order[rows[source]]])
        # Pieces of a triangle are beside each other, which keeps neighbors close in memory.
        sorted_rows = np.argsort(order, kind="stable")
        self.points, self.normals = points, normals
        self.triangles, self.order = triangles[sorted_rows], order[sorted_rows]
        return True


def _at_borders(
    mesh: _CutMesh,
    first: int,
    sides: Integers,
    of_triangle: Integers,
    *,
    appearance: Appearance,
    watch: Callable[[float], None],
    narrow: bool,
) -> Floats:
    """Return at which share of each side there is a border; 0 for sides without one.

    Args:
        mesh: The mesh.
        first: Sides without a point from this number on were looked at.
        sides: Of shape (k, 2).
        of_triangle: Not used.
        appearance: Gives the appearance of places.
        watch: Called now and then.
        narrow: Whether narrow gradients count.
    """
    shares = np.zeros(len(sides))
    fresh = np.flatnonzero(sides[:, 1] >= first)
    shares[fresh] = _shares(mesh.points, sides[fresh], appearance, watch, narrow=narrow)
    return shares


def _halved(
    mesh: _CutMesh,
    first: int,
    appearance: Appearance,
    longest: float,
    sides: Integers,
    of_triangle: Integers,
) -> Floats:
    """Return 0.5 for the longest sides of triangles that their sides alone do not tell enough of.

    These are long ones with a border within, of joined cells, and those with a side that has two.

    Args:
        mesh: The mesh.
        first: Triangles without a point from this number on were looked at.
        appearance: Gives the appearance of places.
        longest: How long sides may be, in scene units.
        sides: Of shape (k, 2).
        of_triangle: The three sides of each triangle.
    """
    shares = np.zeros(len(sides))
    ends = (mesh.points[sides[:, i]] for i in range(2))
    lengths = rows_of(triangle_arithmetic.between, *ends)[of_triangle]
    fresh = (mesh.triangles >= first).any(axis=1)
    long = np.flatnonzero((lengths.max(axis=1) > longest) & fresh)
    halved = np.zeros(len(lengths), np.bool_)
    pieces = np.ceil(lengths[long].max(axis=1) / longest * PIECES * _LONG).astype(np.int64)
    for count in np.flatnonzero(np.bincount(pieces)):
        some = long[pieces == count]
        size = max(1, _AT_ONCE // int(count * count))
        for start in range(0, len(some), size):
            part = some[start : start + size]
            corners = mesh.points[mesh.triangles[part]]
            halved[part[has_border(corners, int(count), appearance)]] = True
    # Where borders meet, a side may have two of them.
    others = np.flatnonzero((lengths.max(axis=1) > _SHORT * longest) & fresh & ~halved)
    own, which = np.unique(of_triangle[others], return_inverse=True)
    low, high = (mesh.points[sides[own, i]] for i in range(2))
    twice = has_two_borders(low, high, appearance)
    halved[others[twice[which.reshape(-1, 3)].any(axis=1)]] = True
    shares[of_triangle[halved, lengths[halved].argmax(axis=1)]] = 0.5
    return shares


def _sides(triangles: Integers, count: int) -> tuple[Integers, Integers]:
    """Return the sides, (k, 2), the lower point first, and the three sides of each triangle.

    Args:
        triangles: Of shape (m, 3).
        count: How many points there are.
    """
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    low, high = ends.min(axis=1), ends.max(axis=1)
    keys, which = np.unique(low * np.int64(count) + high, return_inverse=True)
    return np.stack(np.divmod(keys, count), axis=1), which.reshape(-1, 3)


def _shares(
    points: Floats,
    sides: Integers,
    appearance: Appearance,
    watch: Callable[[float], None],
    *,
    narrow: bool,
) -> Floats:
    """Return at which share of each side there is a border; 0 for sides without one.

    Args:
        points: Of shape (n, 3).
        sides: Of shape (k, 2).
        appearance: Gives the appearance of places.
        watch: Called now and then.
        narrow: Whether narrow gradients count.
    """
    found = np.zeros(len(sides))
    for start in range(0, len(sides), _AT_ONCE):
        rows = slice(start, start + _AT_ONCE)
        a, b = (points[sides[rows, i]] for i in range(2))
        found[rows] = border_between(a, b, appearance, narrow=narrow)
        watch(1.0)
    return found


def _keep_thick(
    points: Floats, triangles: Integers, of_triangle: Integers, sides: Integers, shares: Floats
) -> None:
    """Leave out the borders that would make pieces too thin for numbers of 32 bits.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        of_triangle: The three sides of each triangle.
        sides: Of shape (k, 2).
        shares: Where each side is cut; changed to 0 where it must not be.
    """
    heights = rows_of(
        triangle_arithmetic.least_height, *(points[triangles[:, i]] for i in range(3))
    )
    least = np.full(len(sides), np.inf)
    np.minimum.at(least, of_triangle.reshape(-1), np.repeat(heights, 3))
    rounding = float(np.finfo(np.float32).eps) * float(np.abs(points).max())
    shares[np.minimum(shares, 1.0 - shares) * least < _ROUNDINGS * rounding] = 0.0


def _with_points_on(
    points: Floats, normals: Floats, sides: Integers, shares: Floats
) -> tuple[Floats, Floats]:
    """Return points and normals, with a new point on each of some sides."""
    ends = (sides[:, 0], sides[:, 1])
    made = rows_of(triangle_arithmetic.along, *(points[end] for end in ends), shares)
    turned = rows_of(triangle_arithmetic.normal_along, *(normals[end] for end in ends), shares)
    return np.concatenate([points, made]), np.concatenate([normals, turned])


def _with_points_in(
    points: Floats, normals: Floats, triangles: Integers, shares: Floats
) -> tuple[Floats, Floats]:
    """Return points and normals, with a new point in each of some triangles."""
    if not len(triangles):
        return points, normals
    corners = [triangles[:, i] for i in range(3)]
    made = rows_of(triangle_arithmetic.weighted, *(points[c] for c in corners), shares)
    turned = rows_of(triangle_arithmetic.weighted_normal, *(normals[c] for c in corners), shares)
    return np.concatenate([points, made]), np.concatenate([normals, turned])


def _inner_shares(corners: Floats, appearance: Appearance) -> Floats:
    """Return where in triangles three appearances meet, as shares of the corners, (n, 3).

    A triangle whose corners differ has, divided into four, a part whose corners differ too
    (Sperner's lemma), and so on.

    Args:
        corners: Of shape (n, 3, 3).
        appearance: Gives the appearance of places.
    """
    if not len(corners):
        return np.empty((0, 3))
    known = np.stack([appearance(corners[:, i]) for i in range(3)], axis=1)

    def labels(shares: Floats) -> Integers:
        places = rows_of(triangle_arithmetic.weighted, *(corners[:, i] for i in range(3)), shares)
        found: Integers = change(appearance(places)[:, None], known).argmin(axis=1)
        return found

    part = np.repeat(np.eye(3)[None], len(corners), axis=0)
    names = np.repeat(np.arange(3)[None], len(corners), axis=0)
    every = np.arange(len(corners))
    for _halving in range(_INNER_HALVINGS):
        halves = (part + np.roll(part, -1, axis=1)) / 2.0
        of_halves = np.stack([labels(halves[:, i]) for i in range(3)], axis=1)
        six, of_six = np.concatenate([part, halves], axis=1), np.concatenate([names, of_halves], 1)
        some = of_six[:, _QUARTERS]
        which = (np.sort(some, axis=2) == np.arange(3)).all(axis=2).argmax(axis=1)
        chosen = _QUARTERS[which]
        part, names = six[every[:, None], chosen], of_six[every[:, None], chosen]
    shares = np.maximum(part.mean(axis=1), _INNER)
    found: Floats = shares / shares.sum(axis=1, keepdims=True)
    return found


def _divided(
    triangles: Integers, new: Integers, middle: Integers, points: Floats
) -> tuple[Integers, Integers]:
    """Return the pieces of triangles, and the triangle that each is of.

    Args:
        triangles: Of shape (m, 3).
        new: The point on the side after each corner; -1 for none.
        middle: The point inside; -1 for none.
        points: Of shape (n, 3).
    """
    cuts = (new >= 0).sum(axis=1)
    whole = np.flatnonzero(cuts == 0)
    made = [(whole, triangles[whole])]
    # Turned so that the first side is cut, and the second too if two are.
    turn = np.argmax((new >= 0) & ((cuts == 1)[:, None] | (np.roll(new, -1, axis=1) >= 0)), axis=1)
    turned = (turn[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, turned, axis=1).T
    on_ab, on_bc, on_ca = np.take_along_axis(new, turned, axis=1).T

    def add(rows: Integers, *corners: Integers) -> None:
        made.append((rows, np.stack([corner[rows] for corner in corners], axis=1)))

    one = np.flatnonzero(cuts == 1)
    add(one, a, on_ab, c)
    add(one, on_ab, b, c)
    two = np.flatnonzero(cuts == 2)
    add(two, on_ab, b, on_bc)
    lengths = [
        rows_of(triangle_arithmetic.between, points[p[two]], points[q[two]])
        for p, q in ((a, on_bc), (c, on_ab))
    ]
    first = lengths[0] <= lengths[1]
    add(two[first], a, on_ab, on_bc)
    add(two[first], a, on_bc, c)
    add(two[~first], a, on_ab, c)
    add(two[~first], on_ab, on_bc, c)
    three = np.flatnonzero(cuts == 3)
    ring = (a, on_ab, b, on_bc, c, on_ca)
    for i in range(6):
        add(three, ring[i], ring[(i + 1) % 6], middle)
    return np.concatenate([rows for _, rows in made]), np.concatenate([rows for rows, _ in made])
