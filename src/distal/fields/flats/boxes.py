"""Flat shapes with right angles: rectangles, crosses, stairs.

Input: a point and the numbers of a shape. Output: the distance, negative inside. Sizes are full
sizes, from side to side.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import HALF_ROOT, TINY
from distal.fields.flats.edges import LEFT, RIGHT, centred_bounds, inside_both, nearer, turned_from
from distal.fields.guarantees import EXACT, UNBOUNDED, Bounds2, Limit, primitive
from distal.fields.ordering import larger_first
from distal.fields.widths import (
    chamfered_width,
    cross_width,
    oriented_width,
    rectangle_width,
    steps_width,
    tunnel_width,
)
from distal.lang import abs, clamp, dot, floor, func, length, max, min, round, select, vec2, vec4

UP: Final = vec2(0.0, 1.0)
EQUAL_RADII: Final = vec4(0.2)
STEP: Final = vec2(0.25, 0.2)
UNIT_SQUARE: Final = vec2(1.0, 1.0)


def _corners_fit(size: tuple[float, ...], radii: tuple[float, ...]) -> str | None:
    sides = tuple(size)
    if any(2.0 * radius > side for radius in tuple(radii) for side in sides):
        return "no radius may be more than half of the shorter side"
    return None


def _chamfer_fits(size: tuple[float, ...], bevel: float) -> str | None:
    if any(2.0 * bevel > side for side in tuple(size)):
        return "bevel may be at most half of the shorter side"
    return None


def _ends_differ(start: tuple[float, ...], end: tuple[float, ...]) -> str | None:
    if tuple(start) == tuple(end):
        return "start and end must be two different points"
    return None


def _arms_fit(span: float, thickness: float) -> str | None:
    return "thickness may be at most span" if thickness > span else None


@primitive(
    "HalfPlane",
    EXACT,
    width=UNBOUNDED,
)
@func
def half_plane(p: vec2, normal: vec2 = UP, distance: float = 0.0) -> float:
    """Half plane on one side of a straight line.

    Args:
        p: Point.
        normal: Normal of the line that points outwards, of length 1.
        distance: Distance of the line from the origin along the normal.

    Source: the point's projection on the normal.

    Measured:
        half_plane((3.0, 2.0)) = 2.0
        half_plane((1.0, 2.0), (0.6, 0.8), 1.0) = 1.2
        half_plane((-4.0, 0.0), (1.0, 0.0), -1.0) = -3.0
    """
    return dot(p, normal) - distance


@func
def rectangle_bounds(size: vec2) -> Bounds2:
    """Return the rectangle itself."""
    return centred_bounds(0.5 * size)


@primitive(
    "Rectangle",
    EXACT,
    bounds=rectangle_bounds,
    endless=("size",),
    width=rectangle_width,
    along="xy",
)
@func
def rectangle(p: vec2, size: vec2 = UNIT_SQUARE) -> float:
    """Rectangle with sides along the axes, centred at the origin.

    Args:
        p: Point.
        size: Full width and height; ``math.inf`` along an axis without an end.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        rectangle((4.0, 5.0), (2.0, 2.0)) = 5.0
        rectangle((0.0, 0.0), (2.0, 4.0)) = -1.0
        rectangle((0.25, -1.5), (1.0, 1.0)) = 1.0
    """
    q = abs(p) - 0.5 * size
    return inside_both(q.x, q.y)


@primitive(
    "RoundedRectangle",
    EXACT,
    bounds=rectangle_bounds,
    limits={"radii": Limit.NOT_NEGATIVE},
    requires=_corners_fit,
    width=rectangle_width,
)
@func
def rounded_rectangle(p: vec2, size: vec2 = UNIT_SQUARE, radii: vec4 = EQUAL_RADII) -> float:
    """Rectangle with rounded corners, each with its own radius.

    Args:
        p: Point.
        size: Full width and height.
        radii: Radii of the corners: upper right, upper left, lower left, lower right.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        rounded_rectangle((4.0, 5.0), (4.0, 4.0), (1.0, 0.0, 0.0, 0.0)) = 4.0
        rounded_rectangle((-5.0, 6.0), (4.0, 4.0), (1.0, 0.0, 0.0, 0.0)) = 5.0
        rounded_rectangle((0.0, 0.0), (1.0, 2.0), (0.1, 0.2, 0.3, 0.4)) = -0.5
    """
    right = select(p.y > 0.0, radii.x, radii.w)
    left = select(p.y > 0.0, radii.y, radii.z)
    radius = select(p.x > 0.0, right, left)
    q = abs(p) - 0.5 * size + radius
    return inside_both(q.x, q.y) - radius


@primitive(
    "ChamferedRectangle",
    EXACT,
    bounds=rectangle_bounds,
    requires=_chamfer_fits,
    width=chamfered_width,
)
@func
def chamfered_rectangle(p: vec2, size: vec2 = UNIT_SQUARE, bevel: float = 0.2) -> float:
    """Rectangle with corners chamfered at 45 degrees.

    Args:
        p: Point.
        size: Full width and height.
        bevel: Length that the bevel removes from each side.

    Source: its three edges in one quarter, folded again at the diagonal of the corner.

    Measured:
        chamfered_rectangle((3.0, 0.0), (4.0, 4.0), 1.0) = 1.0
        chamfered_rectangle((1.5, 1.5), (4.0, 4.0), 1.0) = 0.0
        chamfered_rectangle((5.0, 5.0), (4.0, 4.0), 1.0) = 4.949747468305833
    """
    q = larger_first(abs(p) - 0.5 * size)
    from_corner = vec2(q.x, q.y + bevel)
    cut = HALF_ROOT * (from_corner.x + from_corner.y)
    beyond_side = select(from_corner.y > from_corner.x, cut, length(from_corner))
    outside = select(from_corner.y > 0.0, beyond_side, q.x)
    return select(max(q.x, cut) > 0.0, outside, max(q.x, cut))


@func
def oriented_rectangle_bounds(start: vec2, end: vec2, thickness: float) -> Bounds2:
    """Return the rectangle around all four corners."""
    along = end - start
    direction = along / max(length(along), TINY)
    reach = 0.5 * thickness * abs(vec2(direction.y, direction.x))
    return Bounds2(min(start, end) - reach, max(start, end) + reach)


@primitive(
    "OrientedRectangle",
    EXACT,
    bounds=oriented_rectangle_bounds,
    requires=_ends_differ,
    width=oriented_width,
)
@func
def oriented_rectangle(
    p: vec2, start: vec2 = LEFT, end: vec2 = RIGHT, thickness: float = 0.25
) -> float:
    """Bar with square ends between two points.

    Args:
        p: Point.
        start: Middle of one end.
        end: Middle of the other.
        thickness: Full width of the bar.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        oriented_rectangle((2.0, 2.0), (0.0, 0.0), (3.0, 0.0), 2.0) = 1.0
        oriented_rectangle((7.0, 9.0), (0.0, 0.0), (3.0, 4.0), 2.0) = 6.4
        oriented_rectangle((0.0, 1.0), (0.0, 0.0), (0.0, 2.0), 0.5) = -0.25
    """
    along = end - start
    span = length(along)
    direction = along / max(span, TINY)
    q = p - 0.5 * (start + end)
    seen = vec2(dot(q, direction), turned_from(direction, q))
    return rectangle(seen, vec2(span, thickness))


@func
def cross_bounds(span: float) -> Bounds2:
    """Return the square around the bars."""
    return centred_bounds(vec2(0.5 * span))


@primitive(
    "Cross",
    EXACT,
    bounds=cross_bounds,
    limits={"span": Limit.POSITIVE},
    requires=_arms_fit,
    width=cross_width,
)
@func
def cross_shape(p: vec2, span: float = 1.0, thickness: float = 0.3) -> float:
    """Cross of two equal perpendicular bars.

    Args:
        p: Point.
        span: Length of each bar.
        thickness: Full width of each bar.

    Source: its two edges in one eighth of the plane.

    Measured:
        cross_shape((0.0, 0.0), 4.0, 1.0) = -0.7071067811865476
        cross_shape((0.0, 5.0), 4.0, 1.0) = 3.0
        cross_shape((1.0, -1.5), 4.0, 1.0) = 0.5
    """
    arm = 0.5 * span
    side = 0.5 * thickness
    q = larger_first(abs(p))
    from_end = vec2(q.x - arm, max(q.y - side, 0.0))
    from_side = vec2(q.x - clamp(q.x, side, arm), q.y - side)
    d = length(nearer(from_end, from_side))
    return select(q.x < arm and q.y < side, -d, d)


@func
def tunnel_bounds(width: float, height: float) -> Bounds2:
    """Return the rectangle from the floor to the top of the arch."""
    return Bounds2(vec2(-0.5 * width, -height), vec2(0.5 * width, 0.5 * width))


@primitive(
    "Tunnel",
    EXACT,
    bounds=tunnel_bounds,
    limits={"height": Limit.NOT_NEGATIVE},
    width=tunnel_width,
)
@func
def tunnel(p: vec2, width: float = 1.0, height: float = 0.5) -> float:
    """Tunnel profile: half a disc on top of a rectangle; the disc's centre is the origin.

    Args:
        p: Point.
        width: Distance between the walls.
        height: Height of the walls, below y = 0.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        tunnel((3.0, 4.0), 4.0, 3.0) = 3.0
        tunnel((5.0, -7.0), 4.0, 3.0) = 5.0
        tunnel((0.0, 0.0), 4.0, 1.0) = -1.0
    """
    arch = select(p.y > 0.0, length(p), abs(p.x)) - 0.5 * width
    return inside_both(arch, -height - p.y)


@func
def stairs_bounds(step: vec2, count: int) -> Bounds2:
    """Return the rectangle from the foot of the first step to the top."""
    return Bounds2(vec2(0.0), step * float(count))


@func
def from_step(p: vec2, step: vec2, index: float) -> vec2:
    """Return the vector from the nearest point of one step (its riser and tread) to p."""
    q = p - step * vec2(index, index + 1.0)
    from_riser = vec2(q.x, q.y - clamp(q.y, -step.y, 0.0))
    from_tread = vec2(q.x - clamp(q.x, 0.0, step.x), q.y)
    return nearer(from_riser, from_tread)


@primitive(
    "Stairs",
    EXACT,
    bounds=stairs_bounds,
    limits={"step": Limit.POSITIVE},
    width=steps_width,
)
@func
def stairs(p: vec2, step: vec2 = STEP, count: int = 4) -> float:
    """Stairs that rise to the right from the origin, with the area below them.

    Args:
        p: Point.
        step: Width and height of each step.
        count: Number of steps.

    Source: the step nearest along the flight and its neighbors; corners of steps are evenly
    spaced along the flight, so no other is nearer.

    Measured:
        stairs((-3.0, 0.5), (1.0, 1.0), 4) = 3.0
        stairs((1.0, 2.0), (1.0, 1.0), 4) = 0.0
        stairs((7.0, 8.0), (1.0, 1.0), 4) = 5.0
    """
    last = float(count) - 1.0
    end = step * float(count)
    corner = vec2(p.x, p.y - step.y)
    nearest = clamp(round(dot(corner, step) / dot(step, step)), 0.0, last)
    from_flight = from_step(p, step, nearest)
    from_flight = nearer(from_flight, from_step(p, step, max(nearest - 1.0, 0.0)))
    from_flight = nearer(from_flight, from_step(p, step, min(nearest + 1.0, last)))
    from_floor = vec2(p.x - clamp(p.x, 0.0, end.x), p.y)
    from_back = vec2(p.x - end.x, p.y - clamp(p.y, 0.0, end.y))
    d = length(nearer(from_flight, nearer(from_floor, from_back)))
    above = clamp(floor(p.x / step.x), 0.0, last) + 1.0
    inside = p.x > 0.0 and p.x < end.x and p.y > 0.0 and p.y < above * step.y
    return select(inside, -d, d)
