"""Parts that several flat shapes share: edges (also in space), folds of the plane, boxes of points.

Input: a point of the plane and the numbers of an edge or a fold. Output: the vector from the
nearest point of the edge, or the folded point. Declares no shapes.

Outlines made of several edges compare squared lengths of vectors and take one square root at the
end. The length of a vector has a derivative everywhere; the square root of its square has none at
0.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import PI, TINY
from distal.fields.guarantees import Bounds2
from distal.lang import (
    Buffer,
    Vectors,
    abs,
    atan2,
    clamp,
    cos,
    dot,
    func,
    length,
    max,
    min,
    round,
    select,
    sin,
    size,
    vec2,
)

# The default ends of shapes between two points.
LEFT: Final = vec2(-0.5, 0.0)
RIGHT: Final = vec2(0.5, 0.0)


@func
def length_of(v: Vectors) -> float:
    """Return the length of a vector, where a number is called ``length``."""
    return length(v)


@func
def nearer(a: Vectors, b: Vectors) -> Vectors:
    """Return the shorter of two vectors."""
    return select(dot(b, b) < dot(a, a), b, a)


@func
def turned_from(a: vec2, b: vec2) -> float:
    """Return a number above 0 if ``b`` lies counterclockwise of ``a``: the 2D cross product."""
    return a.x * b.y - a.y * b.x


@func
def from_segment(p: Vectors, start: Vectors, end: Vectors) -> Vectors:
    """Return the vector from the nearest point of a straight edge to ``p``."""
    along = end - start
    from_start = p - start
    # The square of the shortest usable edge is TINY^2, which 32 bits can still represent.
    t = clamp(dot(from_start, along) / max(dot(along, along), TINY * TINY), 0.0, 1.0)
    return from_start - along * t


@func
def inside_both(a: float, b: float) -> float:
    """Return the exact distance to the region inside both of two perpendicular edges."""
    return length(max(vec2(a, b), 0.0)) + min(max(a, b), 0.0)


@func
def fold_past(p: vec2, angle: float) -> vec2:
    """Mirror points at more than ``angle`` clockwise from the y axis back across that line."""
    across = vec2(cos(angle), -sin(angle))
    return p - (2.0 * max(dot(p, across), 0.0)) * across


@func
def fold_sectors(p: vec2, count: int) -> vec2:
    """Map each of ``count`` equal sectors to the right half of the one around the y axis.

    The angle only selects the sector. An error in it does not move outlines, because adjacent
    sectors are mirror images at their border.
    """
    sector = 2.0 * PI / float(count)
    angle = sector * round(atan2(p.x, p.y) / sector)
    c = cos(angle)
    s = sin(angle)
    return vec2(abs(c * p.x - s * p.y), s * p.x + c * p.y)


@func
def centred_bounds(reach: vec2) -> Bounds2:
    """Return the rectangle that extends equally to both sides of the origin."""
    return Bounds2(-reach, reach)


@func
def disc_bounds(radius: float) -> Bounds2:
    """Return the square around a circle."""
    return Bounds2(vec2(-radius), vec2(radius))


@func
def points_bounds(points: Buffer[vec2], radius: float) -> Bounds2:
    """Return the rectangle around points, enlarged by ``radius``."""
    low = points[0]
    high = points[0]
    for i in range(1, size(points)):
        low = min(low, points[i])
        high = max(high, points[i])
    return Bounds2(low - radius, high + radius)
