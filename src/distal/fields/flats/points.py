"""Polygons and lines through any number of points.

Input: a point, and points in a buffer. Output: the distance, negative inside.
"""

from __future__ import annotations

from distal.fields.flats.edges import from_segment, nearer, points_bounds, turned_from
from distal.fields.guarantees import EXACT, EXACT_OUTSIDE, Bounds2, primitive
from distal.fields.widths import radius_width
from distal.lang import Buffer, func, length, select, size, vec2


@func
def from_polygon(p: vec2, points: Buffer[vec2]) -> float:
    """Return the distance to a closed chain of edges, negative inside by the even-odd rule.

    Source: the even-odd rule, each edge counted where it crosses the level of ``p`` to the right.
    """
    last = size(points) - 1
    start = points[last]
    nearest = p - start
    inside = False
    for i in range(size(points)):
        end = points[i]
        nearest = nearer(nearest, from_segment(p, start, end))
        below = start.y <= p.y
        crosses = below != (end.y <= p.y)
        left = turned_from(end - start, p - start) > 0.0
        inside = inside != (crosses and left == below)
        start = end
    d = length(nearest)
    return select(inside, -d, d)


@func
def polygon_bounds(points: Buffer[vec2]) -> Bounds2:
    """Return the rectangle around the corners."""
    return points_bounds(points, 0.0)


@primitive("Polygon", EXACT, bounds=polygon_bounds)
@func
def polygon(p: vec2, points: Buffer[vec2]) -> float:
    """Polygon through any points; if it crosses itself, the even-odd rule applies.

    Args:
        p: Point.
        points: The corners in order, 3 or more; the last is connected to the first.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        polygon((1.0, 1.0), Buffer([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)])) = -1.0
        polygon((-3.0, -4.0), Buffer([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)])) = 5.0
        polygon((2.0, 1.5), Buffer([(0.0, 0.0), (4.0, 0.0), (2.0, 1.0), (2.0, 4.0)])) = 0.0
    """
    return from_polygon(p, points)


@primitive("RoundedPolygon", EXACT_OUTSIDE, bounds=points_bounds)
@func
def rounded_polygon(p: vec2, points: Buffer[vec2], radius: float = 0.1) -> float:
    """Polygon enlarged by a radius, so that its outer corners are round.

    Args:
        p: Point.
        points: The centres of the round corners in order, 3 or more.
        radius: Radius of the corners; the sides lie this far outside the points.

    Source: a polygon, its distance less the radius.

    Measured:
        rounded_polygon((1.0, 1.0), Buffer([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]), 0.5) = -1.5
        rounded_polygon((-3.0, -4.0), Buffer([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]), 2.0) = 3.0
        rounded_polygon((2.0, -0.5), Buffer([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]), 0.5) = 0.0
    """
    return from_polygon(p, points) - radius


@primitive(
    "Polyline",
    EXACT_OUTSIDE,
    bounds=points_bounds,
    width=radius_width,
)
@func
def polyline(p: vec2, points: Buffer[vec2], radius: float = 0.05, closed: bool = False) -> float:
    """Line with a width through points, with round ends and joints.

    Args:
        p: Point.
        points: The corners in order.
        radius: Half of the line's width.
        closed: Whether the last point is connected to the first.

    Source: the nearest of the segments.

    Measured:
        polyline((2.0, 3.0), Buffer([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]), 0.5) = 1.5
        polyline((-3.0, -4.0), Buffer([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]), 0.5) = 4.5
        polyline((2.0, 1.5), Buffer([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]), 0.5, True) = -0.5
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
