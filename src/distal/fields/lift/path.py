"""Flat shapes swept along a path: through points, or along a Bézier curve.

Input: the field of a flat shape, its rectangle, and the points of a path. Output:
the distance of the solid, the place in the outline, and the rules of slope and box.

Each straight piece of the path carries the outline; at a joint two pieces meet in the plane that
halves the bend, where the outline has the same place for both because the frame of the next piece
is the mirror image of the last one's (a frame that turns no more than the path does).

Source: Wenping Wang, Bert Jüttler, Dayue Zheng and Yang Liu, "Computation of Rotation Minimizing
Frames", ACM Transactions on Graphics 27(1), 2008, for frames by mirrors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.constants import TINY
from distal.fields.guarantees import ENDLESS, LOWER_BOUND, UNBOUNDED, Bounds, Bounds2, operator
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
# Below this two directions are taken for one.
PARALLEL: Final = 1e-4
# The sharpest bend that is followed, as the cosine of half of it: 157 degrees.
SHARPEST: Final = 0.2
FOLLOWS: Final = "an outline with an end, and a path that never turns back on itself"


@func
def direction(way: vec3) -> vec3:
    """Of length 1; zero where there is no way."""
    return way / max(length(way), TINY)


@func
def upright(ahead: vec3, up: vec3) -> vec3:
    """The outline's y axis where the path goes ``ahead``: as far toward ``up`` as can be."""
    across = up - dot(up, ahead) * ahead
    other = SIDEWAYS - ahead.x * ahead
    return direction(select(length(across) > PARALLEL, across, other))


@func
def bend_cosine(ahead: vec3, turned: vec3) -> float:
    """Of half of the angle between two directions."""
    return 0.5 * length(ahead + turned)


@func
def joints_are_apart(bounds: Bounds2, pieces: int, point_at: Callable[[int], vec3]) -> bool:
    """Whether no two joints' planes cross within the outline."""
    radius = circle_around(bounds)
    apart = True
    start = point_at(0)
    end = point_at(1)
    taken = 0.0
    for i in range(pieces):
        following = point_at(min(i + 2, pieces))
        ahead = direction(end - start)
        turned = select(i == pieces - 1, ahead, direction(following - end))
        cosine = bend_cosine(ahead, turned)
        tangent = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, TINY)
        apart = apart and radius * (taken + tangent) < length(end - start)
        taken = tangent
        start = end
        end = following
    return apart


@func
def sharpest_bend(pieces: int, point_at: Callable[[int], vec3]) -> float:
    """The least cosine of half of a bend."""
    sharpest = 1.0
    start = point_at(0)
    end = point_at(1)
    for i in range(pieces - 1):
        following = point_at(i + 2)
        cosine = bend_cosine(direction(end - start), direction(following - end))
        sharpest = min(sharpest, cosine)
        start = end
        end = following
    return sharpest


@func
def from_disc(q: vec3, normal: vec3, radius: float) -> float:
    """Distance to a disc about the origin."""
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
) -> vec3:
    """The distance, and the place in the outline (y, z), of the nearest piece of a path.

    Behind a joint's plane the next piece stands in, so that nothing is hollow there: inside, only
    the way to the path's own ends counts. That makes no jump where the joints are apart; else each
    piece is closed by its planes.
    """
    joined = joints_are_apart(bounds, pieces, point_at)
    start = point_at(0)
    end = point_at(1)
    ahead = direction(end - start)
    final = point_at(pieces)
    arriving = direction(final - point_at(pieces - 1))
    radius = circle_around(bounds)
    inside_ends = -min(from_disc(p - start, ahead, radius), from_disc(p - final, arriving, radius))
    y = upright(ahead, up)
    past_start = dot(start - p, ahead)
    found = vec3(UNBOUNDED, 0.0, 0.0)
    for i in range(pieces):
        following = point_at(min(i + 2, pieces))
        last = i == pieces - 1
        turned = select(last, ahead, direction(following - end))
        end_plane = direction(ahead + turned)
        q = p - start
        place = vec2(dot(q, cross(y, ahead)), dot(q, y))
        past_end = dot(p - end, end_plane)
        past = max(past_start, past_end)
        here = max(field(place), select(joined and past <= 0.0, inside_ends, past))
        found = select(here < found.x, vec3(here, place), found)
        # The frame's mirror image in the joint's plane.
        if not last:
            y -= (2.0 * dot(y, end_plane)) * end_plane
        start = end
        end = following
        # The same number to its last bit: no point is beyond a plane for both of its pieces.
        past_start = -past_end
        ahead = turned
    return found


@func
def sweep_slope(
    slope: float, bounds: Bounds2, pieces: int, point_at: Callable[[int], vec3]
) -> float:
    """The outline's."""
    fits = sharpest_bend(pieces, point_at) > SHARPEST and circle_around(bounds) < ENDLESS
    return select(fits, max(slope, 1.0), UNBOUNDED)


@func
def sweep_box(bounds: Bounds2, pieces: int, point_at: Callable[[int], vec3]) -> Bounds:
    """Around the points, wider by how far the outline reaches at the sharpest bend."""
    low = point_at(0)
    high = low
    for i in range(pieces):
        low = min(low, point_at(i + 1))
        high = max(high, point_at(i + 1))
    reach = circle_around(bounds) / max(sharpest_bend(pieces, point_at), SHARPEST)
    return Bounds(low - reach, high + reach)


@func
def sweep_growth(growth: float, pieces: int, point_at: Callable[[int], vec3]) -> float:
    """How far out a value of 1 may be.

    A place lies within the growth of the outline's circle, and 1 past a joint's plane; at the
    sharpest bend both count by the inverse cosine.
    """
    return min((1.0 + growth) / max(sharpest_bend(pieces, point_at), SHARPEST), UNBOUNDED)


@func
def swept(field: Field2, p: vec3, points: Buffer[vec3], bounds: Bounds2, up: vec3 = UP) -> float:
    """The outline along the straight ways between points, cut off at both ends."""
    return swept_along(field, p, size(points) - 1, lambda i: points[i], up, bounds).x


@func
def swept_site(
    field: Field2, p: vec3, points: Buffer[vec3], bounds: Bounds2, up: vec3 = UP
) -> vec2:
    """The place in the outline."""
    return swept_along(field, p, size(points) - 1, lambda i: points[i], up, bounds).yz


@func
def swept_slope(slope: float, bounds: Bounds2, points: Buffer[vec3]) -> float:
    """As ``sweep_slope``."""
    return sweep_slope(slope, bounds, size(points) - 1, lambda i: points[i])


@func
def swept_bounds(bounds: Bounds2, points: Buffer[vec3]) -> Bounds:
    """As ``sweep_box``."""
    return sweep_box(bounds, size(points) - 1, lambda i: points[i])


@func
def swept_growth(growth: float, points: Buffer[vec3]) -> float:
    """As ``sweep_growth``."""
    return sweep_growth(growth, size(points) - 1, lambda i: points[i])


@func
def on_bezier(i: int, pieces: int, start: vec3, control: vec3, end: vec3) -> vec3:
    """The end of a piece of a quadratic Bézier curve."""
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
    """The outline along a quadratic Bézier curve of straight pieces, cut off at both ends."""
    return swept_along(
        field, p, pieces, lambda i: on_bezier(i, pieces, start, control, end), up, bounds
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
    """The place in the outline."""
    return swept_along(
        field, p, pieces, lambda i: on_bezier(i, pieces, start, control, end), up, bounds
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
    """As ``sweep_slope``."""
    return sweep_slope(slope, bounds, pieces, lambda i: on_bezier(i, pieces, start, control, end))


@func
def swept_bezier_bounds(
    bounds: Bounds2,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    pieces: int = 12,
) -> Bounds:
    """As ``sweep_box``."""
    return sweep_box(bounds, pieces, lambda i: on_bezier(i, pieces, start, control, end))


@func
def swept_bezier_growth(
    growth: float,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    pieces: int = 12,
) -> float:
    """As ``sweep_growth``."""
    return sweep_growth(growth, pieces, lambda i: on_bezier(i, pieces, start, control, end))


def bezier_requirement(start: tuple[float, ...], end: tuple[float, ...], pieces: int) -> str | None:
    """Why a curve cannot be, or None."""
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
)
