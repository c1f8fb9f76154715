"""Tubes along lines in space: through points and along Bézier curves.

Input: a point, the curve's points as numbers or data, radii. Output: the distance, exact outside. A
tube of variable radius is approximated by straight pieces, each the convex hull of two balls: along
the exact curve, the nearest point would jump if its radius changes.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import TINY
from distal.fields.flats.curves import from_bezier
from distal.fields.flats.edges import from_segment, nearer
from distal.fields.guarantees import EXACT_OUTSIDE, Approximation, Bounds, Limit, primitive
from distal.fields.solids.cones import round_cone_between
from distal.fields.widths import end_radii_width, radius_width, tapered_width
from distal.lang import Buffer, abs, clamp, func, length, max, min, select, size, vec2, vec3, vec4

START: Final = vec3(-0.5, -0.3, 0.0)
CONTROL: Final = vec3(0.0, 0.8, 0.4)
LEAVING: Final = vec3(-0.3, 0.7, 0.3)
ARRIVING: Final = vec3(0.3, -0.7, 0.3)
END: Final = vec3(0.5, -0.3, 0.0)
PIECES: Final = 16


@func
def polyline_tube_bounds(points: Buffer[vec3], radius: float) -> Bounds:
    """Return the box around all points, enlarged by the radius."""
    low = points[0]
    high = points[0]
    for i in range(1, size(points)):
        low = min(low, points[i])
        high = max(high, points[i])
    return Bounds(low - radius, high + radius)


@primitive(
    "PolylineTube",
    EXACT_OUTSIDE,
    bounds=polyline_tube_bounds,
    tier=2,
    width=radius_width,
)
@func
def polyline_tube(
    p: vec3, points: Buffer[vec3], radius: float = 0.1, closed: bool = False
) -> float:
    """Round tube along straight lines between points.

    Args:
        p: Point.
        points: Points in order.
        radius: Radius of the tube.
        closed: Whether the last point is connected to the first.

    Source: the nearest of the lines between the points.

    Measured:
        polyline_tube((2.0, 0.0, 3.0), Buffer([(0.0, 0.0, 0.0), (4.0, 0.0, 0.0)]), 0.5) = 2.5
        polyline_tube((-3.0, 0.0, 4.0), Buffer([(0.0, 0.0, 0.0), (4.0, 0.0, 0.0)]), 0.5) = 4.5
        polyline_tube((0.0, 1.0, 0.0), Buffer([(0.0, 0.0, 0.0), (0.0, 2.0, 0.0)]), 0.25) = -0.25
    """
    start = points[0]
    first = 1
    if closed:
        start = points[size(points) - 1]
        first = 0
    nearest = p - start
    for i in range(first, size(points)):
        nearest = nearer(nearest, from_segment(p, start, points[i]))
        start = points[i]
    return length(nearest) - radius


@func
def tapered_tube_bounds(points: Buffer[vec4]) -> Bounds:
    """Return the box around all balls."""
    low = points[0].xyz - points[0].w
    high = points[0].xyz + points[0].w
    for i in range(1, size(points)):
        low = min(low, points[i].xyz - points[i].w)
        high = max(high, points[i].xyz + points[i].w)
    return Bounds(low, high)


@primitive(
    "TaperedPolylineTube",
    EXACT_OUTSIDE,
    bounds=tapered_tube_bounds,
    tier=2,
    width=tapered_width,
)
@func
def tapered_polyline_tube(p: vec3, points: Buffer[vec4]) -> float:
    """Round tube along straight lines between points, with a radius for each point.

    Args:
        p: Point.
        points: Points in order; the fourth number of each is the radius there, above 0.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/), for
    each piece, a round cone.

    Measured:
        tapered_polyline_tube((0.0, 3.0, 4.0), Buffer([(0.0, 0.0, 0.0, 2.0)])) = 3.0
        tapered_polyline_tube((4.0, 0.0, 0.0), Buffer([(0.0, 0.0, 0.0, 1.0), (2.0, 0.0, 0.0, 0.5)])) = 1.5
        tapered_polyline_tube((1.0, 0.0, 2.0), Buffer([(0.0, 0.0, 0.0, 0.5), (2.0, 0.0, 0.0, 0.5)])) = 1.5
    """  # noqa: E501
    start = points[0]
    d = length(p - start.xyz) - start.w
    for i in range(1, size(points)):
        end = points[i]
        d = min(d, round_cone_between(p, start.xyz, end.xyz, start.w, end.w))
        start = end
    return d


@func
def bezier_tube_bounds(start: vec3, control: vec3, end: vec3, radius: float) -> Bounds:
    """Return the box around the ends and the curve's extreme points along each axis."""
    velocity = control - start
    bend = end - control - velocity
    divisor = select(abs(bend) > TINY, bend, TINY)
    t = clamp(-velocity / divisor, 0.0, 1.0)
    turn = start + (2.0 * velocity + bend * t) * t
    return Bounds(min(start, end, turn) - radius, max(start, end, turn) + radius)


@primitive(
    "BezierTube",
    EXACT_OUTSIDE,
    bounds=bezier_tube_bounds,
    tier=2,
    width=radius_width,
)
@func
def bezier_tube(
    p: vec3, start: vec3 = START, control: vec3 = CONTROL, end: vec3 = END, radius: float = 0.1
) -> float:
    """Round tube along a quadratic Bézier curve.

    Args:
        p: Point.
        start: First point.
        control: Control point: the tangents at both ends point to it.
        end: Last point.
        radius: Radius of the tube.

    Source: Inigo Quilez, "Quadratic Bézier - distance 3D"
    (https://iquilezles.org/articles/distfunctions/), for the cubic; its roots by Edmond Halley's
    method.

    Measured:
        bezier_tube((0.0, 3.0, 0.0), (-1.0, -1.0, 0.0), (0.0, 1.0, 0.0), (1.0, -1.0, 0.0), 0.5) = 2.5
        bezier_tube((5.0, -1.0, -3.0), (-1.0, -1.0, 0.0), (0.0, 1.0, 0.0), (1.0, -1.0, 0.0), 0.5) = 4.5
        bezier_tube((2.0, 1.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (4.0, 0.0, 0.0), 0.5) = 0.5
    """  # noqa: E501
    return length(from_bezier(p, start, control, end)) - radius


@func
def curve_tube_bounds(points: Buffer[vec3], radius: float) -> Bounds:
    """Return the box around all pieces, enlarged by the radius."""
    found = bezier_tube_bounds(points[0], points[0], points[0], radius)
    last = size(points) - 1
    for i in range(size(points) // 2):
        at = 2 * i
        end = points[min(at + 2, last)]
        piece = bezier_tube_bounds(points[at], points[at + 1], end, radius)
        found = Bounds(min(found.low, piece.low), max(found.high, piece.high))
    return found


@func
def from_chord(p: vec3, start: vec3, control: vec3, end: vec3) -> vec2:
    """Return the distance to a parabola's chord, and how far the parabola is from it at most."""
    chord = length(from_segment(p, start, end))
    return vec2(chord, 0.5 * length(control - 0.5 * start - 0.5 * end))


@primitive(
    "CurveTube",
    EXACT_OUTSIDE,
    bounds=curve_tube_bounds,
    tier=2,
    width=radius_width,
)
@func
def curve_tube(p: vec3, points: Buffer[vec3], radius: float = 0.1) -> float:
    """Round tube along quadratic Bézier curves, one after the other; ``Curve.tube`` makes them.

    Curves that are farther away than the chord of another are left out, so that of many pieces few
    are searched.

    Args:
        p: Point.
        points: The start, then for each piece its control point and its end. If the last end is
            missing, the last piece is straight.
        radius: Radius of the tube.

    Source: the nearest point of each piece as in ``bezier_tube``.

    Measured:
        curve_tube((2.0, 1.0, 0.0), Buffer([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (4.0, 0.0, 0.0)]), 0.5) = 0.5
        curve_tube((0.0, 3.0, 0.0), Buffer([(-1.0, -1.0, 0.0), (0.0, 1.0, 0.0), (1.0, -1.0, 0.0)]), 0.5) = 2.5
        curve_tube((3.0, 0.0, 4.0), Buffer([(0.0, 0.0, 0.0)]), 0.5) = 4.5
    """  # noqa: E501
    last = size(points) - 1
    near = length(p - points[0])
    for i in range(size(points) // 2):
        at = 2 * i
        reach = from_chord(p, points[at], points[at + 1], points[min(at + 2, last)])
        near = min(near, reach.x + reach.y)
    nearest = p - points[0]
    for i in range(size(points) // 2):
        at = 2 * i
        end = points[min(at + 2, last)]
        reach = from_chord(p, points[at], points[at + 1], end)
        if reach.x - reach.y <= near:
            nearest = nearer(nearest, from_bezier(p, points[at], points[at + 1], end))
    return length(nearest) - radius


@func
def cubic_tube_bounds(
    start: vec3, leaving: vec3, arriving: vec3, end: vec3, start_radius: float, end_radius: float
) -> Bounds:
    """Return the box around all four points, enlarged by the larger radius."""
    radius = max(start_radius, end_radius)
    low = min(start, leaving, arriving, end) - radius
    return Bounds(low, max(start, leaving, arriving, end) + radius)


TAPERED: Final = {"start_radius": Limit.POSITIVE, "end_radius": Limit.POSITIVE}


def _has_pieces(pieces: int) -> str | None:
    return "pieces must be 1 or more" if pieces < 1 else None


@primitive(
    "CubicBezierTube",
    EXACT_OUTSIDE,
    bounds=cubic_tube_bounds,
    approximates=Approximation("a cubic Bézier curve", 4.4e-3),
    limits={"start_radius": Limit.POSITIVE, "end_radius": Limit.POSITIVE},
    requires=_has_pieces,
    tier=2,
    width=end_radii_width,
)
@func
def cubic_bezier_tube(
    p: vec3,
    start: vec3 = START,
    leaving: vec3 = LEAVING,
    arriving: vec3 = ARRIVING,
    end: vec3 = END,
    start_radius: float = 0.12,
    end_radius: float = 0.06,
    pieces: int = PIECES,
) -> float:
    """Round tube along a cubic Bézier curve, of linearly changing radius; straight pieces.

    Args:
        p: Point.
        start: First point.
        leaving: First control point: the direction in which the curve starts.
        arriving: Second control point: the direction from which the curve ends.
        end: Last point.
        start_radius: Radius at ``start``.
        end_radius: Radius at ``end``.
        pieces: Number of straight pieces that approximate the curve.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/), for
    each piece, a round cone.

    Measured:
        cubic_bezier_tube((2.0, 0.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (3.0, 0.0, 0.0), (4.0, 0.0, 0.0), 0.5, 0.5) = 0.5
        cubic_bezier_tube((7.0, 4.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (3.0, 0.0, 0.0), (4.0, 0.0, 0.0), 0.5, 0.5) = 4.5
        cubic_bezier_tube((0.0, 0.0, -9.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 3.0), (0.0, 0.0, 4.0), 1.0, 0.5) = 8.0
    """  # noqa: E501
    velocity = 3.0 * (leaving - start)
    bend = 3.0 * (start - 2.0 * leaving + arriving)
    jerk = end - start - 3.0 * (arriving - leaving)
    share = 1.0 / float(pieces)
    near = start
    near_radius = start_radius
    d = length(p - start) - start_radius
    for i in range(pieces):
        t = float(i + 1) * share
        far = start + ((jerk * t + bend) * t + velocity) * t
        far_radius = start_radius + (end_radius - start_radius) * t
        d = min(d, round_cone_between(p, near, far, near_radius, far_radius))
        near = far
        near_radius = far_radius
    return d


@func
def tapered_bezier_bounds(
    start: vec3, control: vec3, end: vec3, start_radius: float, end_radius: float
) -> Bounds:
    """Return the box around the ends and extreme points, enlarged by the larger radius."""
    return bezier_tube_bounds(start, control, end, max(start_radius, end_radius))


@primitive(
    "TaperedBezierTube",
    EXACT_OUTSIDE,
    bounds=tapered_bezier_bounds,
    approximates=Approximation("a quadratic Bézier curve", 2.4e-3),
    limits={"start_radius": Limit.POSITIVE, "end_radius": Limit.POSITIVE},
    requires=_has_pieces,
    tier=2,
    width=end_radii_width,
)
@func
def tapered_bezier_tube(
    p: vec3,
    start: vec3 = START,
    control: vec3 = CONTROL,
    end: vec3 = END,
    start_radius: float = 0.12,
    end_radius: float = 0.06,
    pieces: int = PIECES,
) -> float:
    """Round tube along a quadratic Bézier curve, of linearly changing radius.

    The curve is approximated by straight pieces.

    Args:
        p: Point.
        start: First point.
        control: Control point: the tangents at both ends point to it.
        end: Last point.
        start_radius: Radius at ``start``.
        end_radius: Radius at ``end``.
        pieces: Number of straight pieces that approximate the curve.

    Source: ``cubic_bezier_tube``, the curve raised by a degree.

    Measured:
        tapered_bezier_tube((2.0, 0.0, 1.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (4.0, 0.0, 0.0), 0.5, 0.5) = 0.5
        tapered_bezier_tube((7.0, 4.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (4.0, 0.0, 0.0), 0.5, 0.5) = 4.5
        tapered_bezier_tube((0.0, 0.0, -9.0), (0.0, 0.0, 0.0), (0.0, 0.0, 2.0), (0.0, 0.0, 4.0), 1.0, 0.5) = 8.0
    """  # noqa: E501
    leaving = (start + 2.0 * control) / 3.0
    arriving = (end + 2.0 * control) / 3.0
    return cubic_bezier_tube(p, start, leaving, arriving, end, start_radius, end_radius, pieces)
