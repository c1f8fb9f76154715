"""The corners of a path along which an outline is swept.

Input: the points of a path as the author wrote them. Output: the same path without points that
repeat the one before, and whether it is closed: its end is its start. Refused are paths without a
length, paths that turn back on themselves, and closed ones along which an outline comes back
turned. Needs no NumPy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final, TypeAlias

from distal.diagnostics import Span
from distal.fields.lift.path import SHARPEST
from distal.ir.types import VEC3
from distal.ir.types import Buffer as BufferType
from distal.lang.resources import MovingBuffer
from distal.scene.tree.conversion import Asked, resource
from distal.scene.tree.errors import refuse

Point: TypeAlias = tuple[float, ...]

# Points that are nearer than four units of rounding in 32 bits are the same.
ROUNDING: Final = 2.0**-21
# The turn of an outline, in radians, below which it meets itself: rounding of plane curves.
MEETS: Final = 1e-6


def path_corners(points: Any, place: Span | None, kind: str = "path") -> tuple[Any, bool]:
    """Return the corners of a path, and whether it is closed: its last corner is then its first.

    Args:
        points: The points: (n, 3) numbers, or a ``Buffer``. One that moves is returned as it is.
        place: The author's line.
        kind: What it is called in messages.

    Raises:
        SceneTypeError: The points are no points.
        SceneValueError: The path has no length, turns back on itself, or is closed and an outline
            along it does not meet itself.
    """
    buffer = resource(points, Asked("points", "sweep", BufferType(VEC3), place=place))
    if isinstance(buffer, MovingBuffer):
        return buffer, False
    given: list[Point] = [tuple(map(float, row)) for row in buffer.data]
    for i, point in enumerate(given):
        if not all(map(math.isfinite, point)):
            refuse(f"point {i} of this {kind} is not finite", None, place)
    same = ROUNDING * max(abs(c) for point in given for c in point)
    kept = _distinct(given, same)
    if len(kept) < 2:
        count = f"its {len(given)} points are all" if len(given) > 1 else "its only point is"
        refuse(
            f"this {kind} has no length: {count} {_shown(given[0])}",
            "give two different points or more",
            place,
        )
    corners = [given[i] for i in kept]
    closed = len(kept) > 3 and math.dist(corners[-1], corners[0]) <= same
    if closed:
        corners[-1] = corners[0]
    ways = [_unit([b - a for a, b in zip(*ends, strict=True)]) for ends in pairwise(corners)]
    joints = list(pairwise([*ways, ways[0]] if closed else ways))
    for i, (ahead, turned) in enumerate(joints, 1):
        if 0.5 * math.hypot(*_sum(ahead, turned)) <= SHARPEST:
            refuse(
                f"this {kind} turns by {math.degrees(_angle(ahead, turned)):.4g} degrees at point "
                f"{kept[i]}, {_shown(corners[i])}; at most "
                f"{math.degrees(2.0 * math.acos(SHARPEST)):.0f} are possible",
                "end the shape there and unite it with a second one",
                place,
            )
    turn = _seam_turn(joints) if closed else 0.0
    if abs(turn) > MEETS:
        refuse(
            f"an outline along this closed {kind} does not meet itself: it comes back turned "
            f"by {math.degrees(turn):.3g} degrees",
            "a tube is round and may be closed; or leave a gap: end before the start",
            place,
        )
    return corners, closed


def _distinct(given: Sequence[Point], same: float) -> list[int]:
    """Return the indices of points that do not repeat the one before; the last one is kept."""
    kept = [0]
    for i, point in enumerate(given):
        if math.dist(point, given[kept[-1]]) > same:
            kept.append(i)
    return [*kept[:-1], len(given) - 1] if len(kept) > 1 else kept


def _seam_turn(joints: Sequence[tuple[Point, Point]]) -> float:
    """Return the angle by which a frame comes back turned that the joints of a path mirror.

    Args:
        joints: The directions before and after each joint of a closed path.
    """
    ahead = joints[0][0]
    axis = min(range(3), key=lambda i: abs(ahead[i]))
    across = [float(i == axis) - ahead[axis] * c for i, c in enumerate(ahead)]
    first = side = _unit(across)
    for before, after in joints:
        plane = _unit(_sum(before, after))
        height = 2.0 * _dot(side, plane)
        side = tuple(s - height * c for s, c in zip(side, plane, strict=True))
    (ax, ay, az), (bx, by, bz) = first, side
    turned = (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)
    return math.atan2(_dot(turned, ahead), _dot(first, side))


def _angle(a: Point, b: Point) -> float:
    return 2.0 * math.acos(min(0.5 * math.hypot(*_sum(a, b)), 1.0))


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _sum(a: Point, b: Point) -> Point:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def _unit(way: Sequence[float]) -> Point:
    length = math.hypot(*way)
    return tuple(c / length for c in way)


def _shown(point: Point) -> str:
    return f"({', '.join(f'{c:.6g}' for c in point)})"
