"""Lines with a width along Bézier curves and splines.

Input: a point, and the numbers or points of a curve. Output: the distance to the region that a disc
covers as it moves along the curve.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import TINY
from distal.fields.flats.edges import LEFT, RIGHT, from_segment, nearer
from distal.fields.guarantees import EXACT, EXACT_OUTSIDE, Approximation, Bounds2, primitive
from distal.fields.widths import radius_width
from distal.lang import Buffer, Vectors, abs, clamp, dot, func, length, max, min, select, size, vec2

LOWER_LEFT: Final = vec2(-0.5, -0.3)
LOWER_RIGHT: Final = vec2(0.5, -0.3)
UPPER_RIGHT: Final = vec2(0.5, 0.3)
TOP: Final = vec2(0.0, 0.7)
UPWARDS: Final = vec2(-0.3, 0.7)
FROM_BELOW: Final = vec2(0.3, -0.7)
# Steps from each end of a parabola. Next to its evolute, where convergence is slowest, the error of
# the distance is then 3e-7 of the curve's size. Newton's method needs 12 steps (both measured).
BEZIER_STEPS: Final = 7
CUBIC_PIECES: Final = 4


def _ends_differ(start: tuple[float, ...], end: tuple[float, ...]) -> str | None:
    if tuple(start) == tuple(end):
        return "start and end must be two different points"
    return None


@func
def segment_bounds(start: vec2, end: vec2, radius: float) -> Bounds2:
    """Return the rectangle around both ends."""
    return Bounds2(min(start, end) - radius, max(start, end) + radius)


@primitive(
    "Segment",
    EXACT,
    bounds=segment_bounds,
    width=radius_width,
)
@func
def segment(p: vec2, start: vec2 = LEFT, end: vec2 = RIGHT, radius: float = 0.05) -> float:
    """A straight line with round ends.

    Args:
        p: Point.
        start: First point.
        end: Last point.
        radius: Half of the line's width.

    Source: the point's projection on the line, held between the ends.

    Measured:
        segment((2.0, 3.0), (0.0, 0.0), (4.0, 0.0), 0.5) = 2.5
        segment((-3.0, -4.0), (0.0, 0.0), (4.0, 0.0), 0.5) = 4.5
        segment((0.0, 1.0), (0.0, 0.0), (0.0, 2.0), 0.25) = -0.25
    """
    return length(from_segment(p, start, end)) - radius


@func
def bezier_step(t: float, third: float, second: float, first: float, zeroth: float) -> float:
    """Return the next value of Halley's iteration for a root of a cubic.

    The step is at most twice that of Newton's method, and the result is clamped to 0 to 1.
    """
    value = ((third * t + second) * t + first) * t + zeroth
    slope = (3.0 * third * t + 2.0 * second) * t + first
    bend = 3.0 * third * t + second  # half of the second derivative
    square = slope * slope
    step = value * slope / max(square - value * bend, 0.5 * square, TINY * TINY)
    # If the cubic does not increase, move to the end in the direction of the root.
    return clamp(t - select(slope > 0.0, step, value / TINY), 0.0, 1.0)


@func
def from_bezier(p: Vectors, start: Vectors, control: Vectors, end: Vectors) -> Vectors:
    """Return the vector from the nearest point of a quadratic Bézier curve to p.

    Along the curve the squared distance has at most two minima, at the outer roots of a cubic. One
    search for each starts at its own end of the curve; if the cubic has only one root, this root is
    on the proper side of its inflection for one of the searches. No coefficient is used as a
    divisor, so a straight curve is not a special case.
    """
    velocity = control - start
    bend = end - control - velocity
    offset = start - p
    third = dot(bend, bend)
    second = 3.0 * dot(velocity, bend)
    first = 2.0 * dot(velocity, velocity) + dot(offset, bend)
    zeroth = dot(offset, velocity)
    low = 0.0
    high = 1.0
    for _ in range(BEZIER_STEPS):
        low = bezier_step(low, third, second, first, zeroth)
        high = bezier_step(high, third, second, first, zeroth)
    return nearer(
        offset + (2.0 * velocity + bend * low) * low,
        offset + (2.0 * velocity + bend * high) * high,
    )


@func
def quadratic_bezier_bounds(start: vec2, control: vec2, end: vec2, radius: float) -> Bounds2:
    """Return the rectangle around the ends and the curve's extreme points along each axis."""
    velocity = control - start
    bend = end - control - velocity
    away = select(abs(bend.x) > TINY, bend.x, TINY)
    up = select(abs(bend.y) > TINY, bend.y, TINY)
    t = clamp(vec2(-velocity.x / away, -velocity.y / up), 0.0, 1.0)
    turn = start + (2.0 * velocity + bend * t) * t
    return Bounds2(min(start, end, turn) - radius, max(start, end, turn) + radius)


@primitive(
    "QuadraticBezier",
    EXACT_OUTSIDE,
    bounds=quadratic_bezier_bounds,
    width=radius_width,
)
@func
def quadratic_bezier(
    p: vec2,
    start: vec2 = LOWER_LEFT,
    control: vec2 = TOP,
    end: vec2 = LOWER_RIGHT,
    radius: float = 0.05,
) -> float:
    """Line along a quadratic Bézier curve.

    Args:
        p: Point.
        start: First point.
        control: Control point: the tangents at both ends point to it.
        end: Last point.
        radius: Half of the line's width.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/), for the cubic; its roots by Edmond Halley's
    method.

    Measured:
        quadratic_bezier((0.0, 3.0), (-1.0, -1.0), (0.0, 1.0), (1.0, -1.0), 0.5) = 2.5
        quadratic_bezier((5.0, -4.0), (-1.0, -1.0), (0.0, 1.0), (1.0, -1.0), 0.5) = 4.5
        quadratic_bezier((2.0, 1.0), (0.0, 0.0), (1.0, 0.0), (4.0, 0.0), 0.5) = 0.5
    """
    return length(from_bezier(p, start, control, end)) - radius


@func
def from_arc_pair(p: vec2, start: vec2, leaving: vec2, end: vec2, arriving: vec2) -> vec2:
    """Return the vector from the nearest point of two parabolas that join two points smoothly.

    The parabolas leave ``start`` and arrive at ``end`` with the velocities of a cubic curve (over a
    unit of time). They meet where the cubic with these velocities is at half of the time.
    """
    first = start + 0.25 * leaving
    second = end - 0.25 * arriving
    middle = 0.5 * (first + second)
    return nearer(from_bezier(p, start, first, middle), from_bezier(p, middle, second, end))


@func
def cubic_bezier_bounds(
    start: vec2, leaving: vec2, arriving: vec2, end: vec2, radius: float
) -> Bounds2:
    """Return the rectangle around the ends and all control points.

    This includes the control points of the parabolas.
    """
    low = min(start, leaving, arriving, end) - radius
    high = max(start, leaving, arriving, end) + radius
    return Bounds2(low, high)


@primitive(
    "CubicBezier",
    EXACT_OUTSIDE,
    bounds=cubic_bezier_bounds,
    approximates=Approximation("a cubic Bézier curve", 1.4e-3),
    width=radius_width,
)
@func
def cubic_bezier(
    p: vec2,
    start: vec2 = LOWER_LEFT,
    leaving: vec2 = UPWARDS,
    arriving: vec2 = FROM_BELOW,
    end: vec2 = UPPER_RIGHT,
    radius: float = 0.05,
    pieces: int = CUBIC_PIECES,
) -> float:
    """Line along a cubic Bézier curve, approximated by pairs of parabolas.

    The distance is exact for the parabolas. They have the positions and directions of the cubic at
    the ends of each piece; with 4 pieces the deviation is below 2e-3 of the curve's size
    (measured).

    Args:
        p: Point.
        start: First point.
        leaving: First control point: the direction in which the curve starts.
        arriving: Second control point: the direction from which the curve ends.
        end: Last point.
        radius: Half of the line's width.
        pieces: Number of pairs of parabolas.

    Source: each piece in Hermite's form, its two parabolas by halving.

    Measured:
        cubic_bezier((2.0, 1.0), (0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (4.0, 0.0), 0.5) = 0.5
        cubic_bezier((7.0, 4.0), (0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (4.0, 0.0), 0.5) = 4.5
        cubic_bezier((0.0, 0.0), (-1.0, 0.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 0.0), 0.25) = -0.25
    """
    share = 1.0 / float(pieces)
    velocity = 3.0 * (leaving - start)
    bend = 3.0 * (start - 2.0 * leaving + arriving)
    jerk = end - start - 3.0 * (arriving - leaving)
    from_point = start
    from_velocity = velocity * share
    nearest = p - start
    for i in range(pieces):
        t = float(i + 1) * share
        to_point = start + ((jerk * t + bend) * t + velocity) * t
        to_velocity = ((3.0 * jerk * t + 2.0 * bend) * t + velocity) * share
        piece = from_arc_pair(p, from_point, from_velocity, to_point, to_velocity)
        nearest = nearer(nearest, piece)
        from_point = to_point
        from_velocity = to_velocity
    return length(nearest) - radius


@func
def spline_velocity(points: Buffer[vec2], index: int, closed: bool) -> vec2:
    """Return the Catmull-Rom velocity at a point: half of the vector between its neighbors."""
    count = size(points)
    before = index - 1
    after = index + 1
    if closed:
        before = (index + count - 1) % count
        after = (index + 1) % count
    before = max(before, 0)
    after = min(after, count - 1)
    # At the ends of an open curve, it is the whole vector to the only neighbor.
    whole = 1.0 if after - before == 1 and not closed else 0.5
    return whole * (points[after] - points[before])


@func
def spline_bounds(points: Buffer[vec2], radius: float, closed: bool) -> Bounds2:
    """Return the rectangle around the points and the control points of the parabolas.

    These lie on the tangents at the points.
    """
    low = points[0]
    high = points[0]
    for i in range(size(points)):
        reach = abs(0.25 * spline_velocity(points, i, closed))
        low = min(low, points[i] - reach)
        high = max(high, points[i] + reach)
    return Bounds2(low - radius, high + radius)


@primitive(
    "SplinePath",
    EXACT_OUTSIDE,
    bounds=spline_bounds,
    approximates=Approximation("a Catmull-Rom spline", 8e-3),
    width=radius_width,
)
@func
def spline_path(p: vec2, points: Buffer[vec2], radius: float = 0.05, closed: bool = False) -> float:
    """Smooth line through points, made of two parabolas between each two points.

    The distance is exact for the parabolas, which pass through each point in the direction of a
    Catmull-Rom spline. Between two points the spline itself is a cubic curve, from which the
    parabolas deviate by up to 1 % of the path's size (measured).

    Args:
        p: Point.
        points: The points in order, 2 or more.
        radius: Half of the line's width.
        closed: Whether the last point is connected to the first.

    Source: Edwin Catmull and Raphael Rom, "A Class of Local Interpolating Splines" (1974), for the
    velocities.

    Measured:
        spline_path((2.0, 1.0), Buffer([(0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (4.0, 0.0)]), 0.5) = 0.5
        spline_path((7.0, 4.0), Buffer([(0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (4.0, 0.0)]), 0.5) = 4.5
        spline_path((0.0, 0.0), Buffer([(-1.0, -1.0), (0.0, 0.0), (1.0, 1.0)]), 0.25) = -0.25
    """
    count = size(points)
    spans = count if closed else count - 1
    start = points[0]
    leaving = spline_velocity(points, 0, closed)
    nearest = p - start
    for i in range(spans):
        following = (i + 1) % count
        end = points[following]
        arriving = spline_velocity(points, following, closed)
        nearest = nearer(nearest, from_arc_pair(p, start, leaving, end, arriving))
        start = end
        leaving = arriving
    return length(nearest) - radius
