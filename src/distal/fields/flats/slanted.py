"""Four-sided flat shapes with slanted sides.

Input: a point and the numbers of a shape. Output: the distance, negative inside. Sizes are full
sizes, from side to side.
"""

from __future__ import annotations

from typing import Final

from distal.fields.flats.boxes import rectangle_bounds
from distal.fields.flats.edges import centred_bounds, from_segment, nearer, turned_from
from distal.fields.guarantees import EXACT, Bounds2, Limit, primitive
from distal.fields.widths import parallelogram_width, rhombus_width, trapezoid_width
from distal.lang import abs, clamp, func, length, max, select, vec2

DIAGONALS: Final = vec2(1.0, 0.6)


def _has_a_side(bottom: float, top: float) -> str | None:
    return "bottom or top must be above 0" if bottom == 0.0 and top == 0.0 else None


@func
def rhombus_bounds(diagonals: vec2) -> Bounds2:
    """Return the rectangle around a rhombus."""
    return rectangle_bounds(diagonals)


@primitive(
    "Rhombus",
    EXACT,
    bounds=rhombus_bounds,
    width=rhombus_width,
)
@func
def rhombus(p: vec2, diagonals: vec2 = DIAGONALS) -> float:
    """Rhombus with its diagonals along the axes.

    Args:
        p: Point.
        diagonals: Full lengths along x and y.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        rhombus((0.0, 0.0), (6.0, 8.0)) = -2.4
        rhombus((5.0, 0.0), (6.0, 8.0)) = 2.0
        rhombus((0.0, 7.0), (6.0, 8.0)) = 3.0
    """
    half = 0.5 * diagonals
    q = abs(p)
    d = length(from_segment(q, vec2(half.x, 0.0), vec2(0.0, half.y)))
    return select(q.x * half.y + q.y * half.x < half.x * half.y, -d, d)


@func
def trapezoid_bounds(bottom: float, top: float, height: float) -> Bounds2:
    """Return the rectangle as wide as the wider side."""
    return centred_bounds(0.5 * vec2(max(bottom, top), height))


@primitive(
    "IsoscelesTrapezoid",
    EXACT,
    bounds=trapezoid_bounds,
    limits={"bottom": Limit.NOT_NEGATIVE, "top": Limit.NOT_NEGATIVE},
    requires=_has_a_side,
    width=trapezoid_width,
)
@func
def isosceles_trapezoid(
    p: vec2, bottom: float = 1.0, top: float = 0.6, height: float = 0.7
) -> float:
    """Isosceles trapezoid; y = 0 is at half of its height.

    Args:
        p: Point.
        bottom: Full width of the lower side.
        top: Full width of the upper side.
        height: Distance from the lower to the upper side.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        isosceles_trapezoid((0.0, 3.0), 8.0, 2.0, 4.0) = 1.0
        isosceles_trapezoid((2.5, 0.0), 8.0, 2.0, 4.0) = 0.0
        isosceles_trapezoid((7.0, -6.0), 8.0, 2.0, 4.0) = 5.0
    """
    q = vec2(abs(p.x), p.y)
    low = vec2(0.5 * bottom, -0.5 * height)
    high = vec2(0.5 * top, 0.5 * height)
    level = select(q.y < 0.0, low, high)
    from_level = vec2(max(q.x - level.x, 0.0), q.y - level.y)
    d = length(nearer(from_level, from_segment(q, low, high)))
    inside = turned_from(high - low, q - low) > 0.0 and abs(q.y) < high.y
    return select(inside, -d, d)


@func
def parallelogram_bounds(width: float, height: float, skew: float) -> Bounds2:
    """Return the rectangle around both horizontal sides."""
    return centred_bounds(0.5 * vec2(width + abs(skew), height))


@primitive(
    "Parallelogram",
    EXACT,
    bounds=parallelogram_bounds,
    width=parallelogram_width,
)
@func
def parallelogram(p: vec2, width: float = 0.8, height: float = 0.6, skew: float = 0.3) -> float:
    """Parallelogram with two horizontal sides, centred at the origin.

    Args:
        p: Point.
        width: Length of the lower and the upper side.
        height: Distance from the lower to the upper side.
        skew: How far the upper side is shifted along x relative to the lower one.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        parallelogram((1.0, 3.0), 4.0, 4.0, 3.0) = 1.0
        parallelogram((2.0, 0.0), 4.0, 4.0, 3.0) = 0.0
        parallelogram((0.0, 0.0), 4.0, 4.0, 3.0) = -1.6
    """
    half = 0.5 * width
    slant = vec2(0.5 * skew, 0.5 * height)
    # The shape is symmetric under half a turn: rotate the point first to the nearer horizontal
    # side, then to the nearer slanted one.
    up = select(p.y < 0.0, -p, p)
    level = up - slant
    from_level = vec2(level.x - clamp(level.x, -half, half), level.y)
    side = select(turned_from(p, slant) < 0.0, -p, p)
    corner = vec2(half, 0.0)
    d = length(nearer(from_level, from_segment(side, corner - slant, corner + slant)))
    inside = up.y < slant.y and turned_from(side, slant) < half * slant.y
    return select(inside, -d, d)
