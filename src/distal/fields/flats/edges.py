"""Parts of several flat shapes: edges (in space too), folds of the plane, boxes of points.

Input: a point of the plane and the numbers of an edge or a fold. Output: the vector
from the nearest point of the edge, or the point folded. Declares no shapes.

Outlines made of several edges compare vectors by their squares and take one root at the end; the
length of a vector has a derivative everywhere, where the root of a square has none at 0.
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
def nearer(a: Vectors, b: Vectors) -> Vectors:
    """The shorter of two vectors."""
    return select(dot(b, b) < dot(a, a), b, a)


@func
def turned_from(a: vec2, b: vec2) -> float:
    """Above 0 where ``b`` lies counterclockwise of ``a``: the plane's cross product."""
    return a.x * b.y - a.y * b.x


@func
def from_segment(p: Vectors, start: Vectors, end: Vectors) -> Vectors:
    """The vector from the nearest point of a straight edge to ``p``."""
    along = end - start
    from_start = p - start
    # The longest edge too short to divide by has a square of TINY^2, which 32 bits still hold.
    t = clamp(dot(from_start, along) / max(dot(along, along), TINY * TINY), 0.0, 1.0)
    return from_start - along * t


@func
def inside_both(a: float, b: float) -> float:
    """Distance to what is inside both of two edges at right angles, exact."""
    return length(max(vec2(a, b), 0.0)) + min(max(a, b), 0.0)


@func
def fold_past(p: vec2, angle: float) -> vec2:
    """Mirrors what lies at more than ``angle`` clockwise from the y axis back across that line."""
    across = vec2(cos(angle), -sin(angle))
    return p - (2.0 * max(dot(p, across), 0.0)) * across


@func
def fold_sectors(p: vec2, count: int) -> vec2:
    """Brings every one of ``count`` equal sectors to that around the y axis, its right half.

    The angle only chooses the sector: its error moves no outline, because neighbours mirror each
    other at their border.
    """
    sector = 2.0 * PI / float(count)
    angle = sector * round(atan2(p.x, p.y) / sector)
    c = cos(angle)
    s = sin(angle)
    return vec2(abs(c * p.x - s * p.y), s * p.x + c * p.y)


@func
def centred_bounds(reach: vec2) -> Bounds2:
    """The rectangle that reaches equally far both ways."""
    return Bounds2(-reach, reach)


@func
def disc_bounds(radius: float) -> Bounds2:
    """The square around a circle."""
    return Bounds2(vec2(-radius), vec2(radius))


@func
def points_bounds(points: Buffer[vec2], radius: float) -> Bounds2:
    """The rectangle around points, wider by ``radius``."""
    low = points[0]
    high = points[0]
    for i in range(1, size(points)):
        low = min(low, points[i])
        high = max(high, points[i])
    return Bounds2(low - radius, high + radius)
