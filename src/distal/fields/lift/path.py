"""Flat shapes swept along a path: through points, or along a Bézier curve.

Input: the field of a flat shape, its rectangle, and the points of a path. Output: the distance of
the solid, the point in the outline, and the rules for slope and box.

Each straight piece of the path carries the outline. At a joint two pieces meet in the bisecting
plane, where a point has the same coordinates in the outline for both, because the frame of the next
piece is the mirror image of the last one's (a rotation minimizing frame).

Source: Wenping Wang, Bert Jüttler, Dayue Zheng and Yang Liu, "Computation of Rotation Minimizing
Frames", ACM Transactions on Graphics 27(1), 2008, for frames by mirrors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.constants import TINY
from distal.fields.guarantees import (
    ENDLESS,
    LOWER_BOUND,
    UNBOUNDED,
    Approximation,
    Bounds,
    Bounds2,
    operator,
)
from distal.fields.lift.extrude import circle_around
from distal.lang import (
    Buffer,
    Field2,
    cross,
    dot,
    func,
    length,
    max,
    min,
    select,
    size,
    sqrt,
    vec2,
    vec3,
)

SIDEWAYS: Final = vec3(1.0, 0.0, 0.0)
UP: Final = vec3(0.0, 1.0, 0.0)
START: Final = vec3(-0.8, 0.0, 0.0)
CONTROL: Final = vec3(0.0, 0.0, 1.0)
END: Final = vec3(0.8, 0.0, 0.0)
# If the part of ``up`` across the path is shorter than this, ``up`` counts as parallel to the path.
PARALLEL: Final = 1e-4
# The sharpest bend that is allowed, as the cosine of half its angle: 157 degrees.
SHARPEST: Final = 0.2
FOLLOWS: Final = "an outline with an end, and a path that never turns back on itself"


@func
def direction(way: vec3) -> vec3:
    """Return a vector of length 1; zero for a zero vector."""
    return way / max(length(way), TINY)


@func
def upright(ahead: vec3, up: vec3) -> vec3:
    """Return the outline's y axis for a path direction: as near to ``up`` as possible."""
    across = up - dot(up, ahead) * ahead
    other = SIDEWAYS - ahead.x * ahead
    return direction(select(length(across) > PARALLEL, across, other))


@func
def bend_cosine(ahead: vec3, turned: vec3) -> float:
    """Return the cosine of half the angle between two directions."""
    return 0.5 * length(ahead + turned)


@func
def bend_tangent(ahead: vec3, turned: vec3) -> float:
    """Return the tangent of half the angle between two directions."""
    cosine = bend_cosine(ahead, turned)
    return sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, TINY)


@func
def joints_are_apart(
    bounds: Bounds2, pieces: int, point_at: Callable[[int], vec3], closed: bool
) -> bool:
    """Return whether no two joints' planes intersect within the outline."""
    radius = circle_around(bounds)
    apart = True
    start = point_at(0)
    end = point_at(1)
    arriving = point_at(pieces) - point_at(pieces - 1)
    taken = bend_tangent(direction(arriving), direction(end - start)) if closed else 0.0
    for i in range(pieces):
        following = point_at(i + 2 if closed else min(i + 2, pieces))
        ahead = direction(end - start)
        turned = direction(following - end)
        tangent = 0.0 if i == pieces - 1 and not closed else bend_tangent(ahead, turned)
        apart = apart and radius * (taken + tangent) < length(end - start)
        taken = tangent
        start = end
        end = following
    return apart


@func
def sharpest_bend(pieces: int, point_at: Callable[[int], vec3], closed: bool) -> float:
    """Return the smallest cosine of half a bend's angle."""
    sharpest = 1.0
    start = point_at(0)
    end = point_at(1)
    for i in range(pieces if closed else pieces - 1):
        following = point_at(i + 2)
        cosine = bend_cosine(direction(end - start), direction(following - end))
        sharpest = min(sharpest, cosine)
        start = end
        end = following
    return sharpest


@func
def from_disc(q: vec3, normal: vec3, radius: float) -> float:
    """Return the distance to a disc about the origin."""
    height = dot(q, normal)
    return length(vec2(height, max(length(q - height * normal) - radius, 0.0)))


@func
def swept_along(
    field: Field2,
    p: vec3,
    pieces: int,
    point_at: Callable[[int], vec3],
    up: vec3,
    bounds: Bounds2,
    closed: bool,
) -> vec3:
    """Return the distance, and the point in the outline (y, z), of the nearest piece of a path.

    The end of a closed path is a joint like the others, if its frame meets itself there.

    Behind a joint's plane the next piece is used, so that there are no hollow places: inside, only
    the distance to the path's own ends counts. This is continuous if the joints are apart;
    otherwise each piece is closed by its planes.
    """
    joined = joints_are_apart(bounds, pieces, point_at, closed)
    start = point_at(0)
    end = point_at(1)
    ahead = direction(end - start)
    final = point_at(pieces)
    arriving = direction(final - point_at(pieces - 1))
    radius = circle_around(bounds)
    inside_ends = -min(from_disc(p - start, ahead, radius), from_disc(p - final, arriving, radius))
    y = upright(ahead, up)
    past_start = dot(start - p, ahead)
    if closed:
        inside_ends = -UNBOUNDED
        past_start = dot(start - p, direction(arriving + ahead))
    found = vec3(UNBOUNDED, 0.0, 0.0)
    for i in range(pieces):
        following = point_at(i + 2 if closed else min(i + 2, pieces))
        last = i == pieces - 1 and not closed
        turned = select(last, ahead, direction(following - end))
        end_plane = direction(ahead + turned)
        q = p - start
        place = vec2(dot(q, cross(y, ahead)), dot(q, y))
        past_end = dot(p - end, end_plane)
        past = max(past_start, past_end)
        here = max(field(place), select(joined and past <= 0.0, inside_ends, past))
        found = select(here < found.x, vec3(here, place), found)
        # Mirror the frame in the joint's plane.
        if not last:
            y -= (2.0 * dot(y, end_plane)) * end_plane
        start = end
        end = following
        # Exactly the same number, so that no point is beyond a plane for both of its pieces.
        past_start = -past_end
        ahead = turned
    return found


@func
def sweep_slope(
    slope: float, bounds: Bounds2, pieces: int, point_at: Callable[[int], vec3], closed: bool
) -> float:
    """Return the outline's slope, at least 1; no bound if a bend is too sharp.

    There is also no bound for an infinite outline.
    """
    fits = sharpest_bend(pieces, point_at, closed) > SHARPEST and circle_around(bounds) < ENDLESS
    return select(fits, max(slope, 1.0), UNBOUNDED)


@func
def sweep_box(
    bounds: Bounds2, pieces: int, point_at: Callable[[int], vec3], closed: bool
) -> Bounds:
    """Return the box around the points, enlarged by the outline's extent at the sharpest bend."""
    low = point_at(0)
    high = low
    for i in range(pieces):
        low = min(low, point_at(i + 1))
        high = max(high, point_at(i + 1))
    reach = circle_around(bounds) / max(sharpest_bend(pieces, point_at, closed), SHARPEST)
    return Bounds(low - reach, high + reach)


@func
def sweep_growth(
    growth: float, pieces: int, point_at: Callable[[int], vec3], closed: bool
) -> float:
    """Return the growth: the largest distance from the box for a value of 1.

    A point lies within the growth of the outline's circle, and 1 past a joint's plane; at the
    sharpest bend both are divided by the cosine.
    """
    return min((1.0 + growth) / max(sharpest_bend(pieces, point_at, closed), SHARPEST), UNBOUNDED)


@func
def corner(points: Buffer[vec3], i: int) -> vec3:
    """Return a point of a path; those after the end of a closed one are those after its start."""
    last = size(points) - 1
    return points[i - last if i > last else i]


@func
def swept(
    field: Field2,
    p: vec3,
    points: Buffer[vec3],
    bounds: Bounds2,
    up: vec3 = UP,
    closed: bool = False,
) -> float:
    """Return the distance to the outline swept along lines between points, with flat ends.

    A closed path ends with its first point.
    """
    pieces = size(points) - 1
    return swept_along(field, p, pieces, lambda i: corner(points, i), up, bounds, closed).x


@func
def swept_site(
    field: Field2,
    p: vec3,
    points: Buffer[vec3],
    bounds: Bounds2,
    up: vec3 = UP,
    closed: bool = False,
) -> vec2:
    """Return the point in the outline."""
    pieces = size(points) - 1
    return swept_along(field, p, pieces, lambda i: corner(points, i), up, bounds, closed).yz


@func
def swept_slope(slope: float, bounds: Bounds2, points: Buffer[vec3], closed: bool = False) -> float:
    """Return ``sweep_slope`` of the points."""
    return sweep_slope(slope, bounds, size(points) - 1, lambda i: corner(points, i), closed)


@func
def swept_bounds(bounds: Bounds2, points: Buffer[vec3], closed: bool = False) -> Bounds:
    """Return ``sweep_box`` of the points."""
    return sweep_box(bounds, size(points) - 1, lambda i: corner(points, i), closed)


@func
def swept_growth(growth: float, points: Buffer[vec3], closed: bool = False) -> float:
    """Return ``sweep_growth`` of the points."""
    return sweep_growth(growth, size(points) - 1, lambda i: corner(points, i), closed)


@func
def on_bezier(i: int, pieces: int, start: vec3, control: vec3, end: vec3) -> vec3:
    """Return the end of a piece of a quadratic Bézier curve."""
    t = float(i) / float(pieces)
    way = control - start
    return start + (2.0 * way + (end - control - way) * t) * t


@func
def swept_bezier(
    field: Field2,
    p: vec3,
    bounds: Bounds2,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    up: vec3 = UP,
    pieces: int = 12,
) -> float:
    """Return the distance to the outline swept along a Bézier curve, with flat ends.

    The quadratic curve is approximated by straight pieces.
    """
    return swept_along(
        field, p, pieces, lambda i: on_bezier(i, pieces, start, control, end), up, bounds, False
    ).x


@func
def swept_bezier_site(
    field: Field2,
    p: vec3,
    bounds: Bounds2,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    up: vec3 = UP,
    pieces: int = 12,
) -> vec2:
    """Return the point in the outline."""
    return swept_along(
        field, p, pieces, lambda i: on_bezier(i, pieces, start, control, end), up, bounds, False
    ).yz


@func
def swept_bezier_slope(
    slope: float,
    bounds: Bounds2,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    pieces: int = 12,
) -> float:
    """Return ``sweep_slope`` of the curve."""
    return sweep_slope(
        slope, bounds, pieces, lambda i: on_bezier(i, pieces, start, control, end), False
    )


@func
def swept_bezier_bounds(
    bounds: Bounds2,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    pieces: int = 12,
) -> Bounds:
    """Return ``sweep_box`` of the curve."""
    return sweep_box(bounds, pieces, lambda i: on_bezier(i, pieces, start, control, end), False)


@func
def swept_bezier_growth(
    growth: float,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    pieces: int = 12,
) -> float:
    """Return ``sweep_growth`` of the curve."""
    return sweep_growth(growth, pieces, lambda i: on_bezier(i, pieces, start, control, end), False)


def bezier_requirement(start: tuple[float, ...], end: tuple[float, ...], pieces: int) -> str | None:
    """Return why a curve is invalid, or None."""
    if not 1 <= pieces <= 1000:
        return "pieces must be from 1 to 1000"
    return "start and end must be two different points" if tuple(start) == tuple(end) else None


SWEEP = operator(
    "sweep",
    around=swept,
    site=swept_site,
    keeps=LOWER_BOUND,
    slope=swept_slope,
    bounds=swept_bounds,
    needs=FOLLOWS,
    growth=swept_growth,
)
SWEEP_BEZIER = operator(
    "sweep bezier",
    around=swept_bezier,
    site=swept_bezier_site,
    keeps=LOWER_BOUND,
    slope=swept_bezier_slope,
    bounds=swept_bezier_bounds,
    requires=bezier_requirement,
    needs=FOLLOWS,
    growth=swept_bezier_growth,
    approximates=Approximation("a quadratic Bézier curve", 3e-3),
)
