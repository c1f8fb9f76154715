"""Triangles, regular polygons and stars.

Input: a point and the numbers of a shape. Output: the distance, negative inside. Regular shapes
have a corner at the top, at distance ``radius``; mirror symmetry maps all their edges onto one.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import PI, ROOT_THREE
from distal.fields.flats.edges import (
    disc_bounds,
    fold_past,
    fold_sectors,
    from_segment,
    nearer,
    turned_from,
)
from distal.fields.flats.slanted import isosceles_trapezoid, trapezoid_bounds
from distal.fields.guarantees import EXACT, Bounds2, Limit, primitive
from distal.fields.widths import (
    corners_width,
    equilateral_width,
    half_radius_width,
    isosceles_width,
    pentagram_width,
    polygon_width,
    round_solid_width,
    star_width,
)
from distal.lang import abs, cos, func, length, max, min, select, sin, vec2

LEFT_CORNER: Final = vec2(-0.5, -0.4)
RIGHT_CORNER: Final = vec2(0.5, -0.3)
TOP_CORNER: Final = vec2(0.1, 0.5)
# Distance of the crossings of a pentagram's edges, as a fraction of its radius: (3 - sqrt(5)) / 2.
PENTAGRAM_INNER: Final = 0.3819660112501051


def _not_in_line(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> str | None:
    along = (b[0] - a[0], b[1] - a[1])
    if along[0] * (c[1] - a[1]) == along[1] * (c[0] - a[0]):
        return "the corners must not lie on one line"
    return None


def _three_corners(radius: float, count: int) -> str | None:
    return "count must be 3 or more" if count < 3 else None


def _is_a_star(radius: float, inner: float, count: int) -> str | None:
    if count < 2:
        return "count must be 2 or more"
    return "inner must be less than radius" if inner >= radius else None


@func
def past_corner(q: vec2, radius: float, angle: float) -> float:
    """Return the distance to the edge that starts at the corner (0, radius).

    The point must be folded to beside this edge.

    Args:
        q: Point, folded to between the y axis and ``angle`` clockwise from it.
        radius: Distance of the corner from the origin.
        angle: Angle from the corner to the middle of the edge, in radians.
    """
    c = cos(angle)
    s = sin(angle)
    from_corner = vec2(q.x, q.y - radius)
    beyond = from_corner.x * c < from_corner.y * s
    return select(beyond, length(from_corner), from_corner.x * s + from_corner.y * c)


@func
def triangle_bounds(size: float) -> Bounds2:
    """Return the rectangle from the base to the tip."""
    return Bounds2(
        vec2(-0.5 * size, -size / (2.0 * ROOT_THREE)), vec2(0.5 * size, size / ROOT_THREE)
    )


@primitive(
    "EquilateralTriangle",
    EXACT,
    bounds=triangle_bounds,
    width=equilateral_width,
)
@func
def equilateral_triangle(p: vec2, size: float = 1.0) -> float:
    """Equilateral triangle with a corner at the top, centred at the origin.

    Args:
        p: Point.
        size: Length of a side.

    Source: mirrored to the edge beside the upper corner.

    Measured:
        equilateral_triangle((0.0, 0.0), 3.4641016151377544) = -1.0
        equilateral_triangle((0.0, 5.0), 3.4641016151377544) = 3.0
        equilateral_triangle((0.5, -4.0), 3.4641016151377544) = 3.0
    """
    q = fold_past(fold_past(vec2(abs(p.x), p.y), 2.0 * PI / 3.0), PI / 3.0)
    return past_corner(q, size / ROOT_THREE, PI / 3.0)


@func
def isosceles_triangle_bounds(width: float, height: float) -> Bounds2:
    """Return the rectangle from the base to the tip."""
    return trapezoid_bounds(width, 0.0, height)


@primitive(
    "IsoscelesTriangle",
    EXACT,
    bounds=isosceles_triangle_bounds,
    width=isosceles_width,
)
@func
def isosceles_triangle(p: vec2, width: float = 0.8, height: float = 1.0) -> float:
    """Isosceles triangle with its tip at the top; y = 0 is at half of its height.

    Args:
        p: Point.
        width: Length of the base.
        height: Distance from the base to the tip.

    Source: a trapezoid without an upper side.

    Measured:
        isosceles_triangle((0.0, 5.0), 6.0, 4.0) = 3.0
        isosceles_triangle((0.0, -4.5), 6.0, 4.0) = 2.5
        isosceles_triangle((7.0, -5.0), 6.0, 4.0) = 5.0
    """
    return isosceles_trapezoid(p, width, 0.0, height)


@func
def corners_bounds(a: vec2, b: vec2, c: vec2) -> Bounds2:
    """Return the rectangle around the corners."""
    return Bounds2(min(a, b, c), max(a, b, c))


@primitive(
    "Triangle",
    EXACT,
    bounds=corners_bounds,
    requires=_not_in_line,
    width=corners_width,
)
@func
def triangle(
    p: vec2,
    a: vec2 = LEFT_CORNER,
    b: vec2 = RIGHT_CORNER,
    c: vec2 = TOP_CORNER,
) -> float:
    """Triangle with three given corners.

    Args:
        p: Point.
        a: First corner.
        b: Second corner.
        c: Third corner.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        triangle((1.0, 1.0), (0.0, 0.0), (4.0, 0.0), (0.0, 3.0)) = -1.0
        triangle((-3.0, -4.0), (0.0, 0.0), (4.0, 0.0), (0.0, 3.0)) = 5.0
        triangle((2.0, -2.0), (0.0, 0.0), (4.0, 0.0), (0.0, 3.0)) = 2.0
    """
    from_edges = nearer(from_segment(p, a, b), from_segment(p, b, c))
    from_edges = nearer(from_edges, from_segment(p, c, a))
    turns = select(turned_from(b - a, c - a) < 0.0, -1.0, 1.0)
    inside = min(
        turns * turned_from(b - a, p - a),
        turns * turned_from(c - b, p - b),
        turns * turned_from(a - c, p - c),
    )
    d = length(from_edges)
    return select(inside > 0.0, -d, d)


@primitive(
    "Pentagon",
    EXACT,
    bounds=disc_bounds,
    width=round_solid_width,
)
@func
def pentagon(p: vec2, radius: float = 0.5) -> float:
    """Regular pentagon with a corner at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a corner.

    Source: mirrored to the edge beside the upper corner.

    Measured:
        pentagon((0.0, 5.0), 2.0) = 3.0
        pentagon((0.0, 0.0), 2.0) = -1.618033988749895
        pentagon((0.0, -4.0), 2.0) = 2.381966011250105
    """
    q = fold_past(fold_past(fold_past(vec2(abs(p.x), p.y), 0.8 * PI), 0.4 * PI), 0.2 * PI)
    return past_corner(q, radius, PI / 5.0)


@primitive(
    "Hexagon",
    EXACT,
    bounds=disc_bounds,
    width=round_solid_width,
)
@func
def hexagon(p: vec2, radius: float = 0.5) -> float:
    """Regular hexagon with a corner at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a corner.

    Source: mirrored to the edge beside the upper corner.

    Measured:
        hexagon((0.0, -5.0), 2.0) = 3.0
        hexagon((0.0, 0.0), 2.0) = -1.7320508075688772
        hexagon((3.7320508075688772, 0.5), 2.0) = 2.0
    """
    q = fold_past(fold_past(abs(p), PI / 3.0), PI / 6.0)
    return past_corner(q, radius, PI / 6.0)


@primitive(
    "Octagon",
    EXACT,
    bounds=disc_bounds,
    width=round_solid_width,
)
@func
def octagon(p: vec2, radius: float = 0.5) -> float:
    """Regular octagon with a corner at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a corner.

    Source: mirrored to the edge beside the upper corner.

    Measured:
        octagon((4.0, 0.0), 1.0) = 3.0
        octagon((0.0, 0.0), 1.0) = -0.9238795325112867
        octagon((0.0, -3.5), 1.0) = 2.5
    """
    q = fold_past(fold_past(abs(p), PI / 4.0), PI / 8.0)
    return past_corner(q, radius, PI / 8.0)


@primitive(
    "RegularPolygon",
    EXACT,
    bounds=disc_bounds,
    requires=_three_corners,
    width=polygon_width,
)
@func
def regular_polygon(p: vec2, radius: float = 0.5, count: int = 7) -> float:
    """Regular polygon with a corner at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a corner.
        count: Number of corners, 3 or more.

    Source: turned to the sector of the nearest corner, mirrored to the edge beside it.

    Measured:
        regular_polygon((0.0, 5.0), 2.0, 7) = 3.0
        regular_polygon((0.0, 0.0), 2.0, 6) = -1.7320508075688772
        regular_polygon((0.0, -4.0), 2.0, 5) = 2.381966011250105
    """
    return past_corner(fold_sectors(p, count), radius, PI / float(count))


@func
def past_point_of_star(q: vec2, radius: float, inner: float, angle: float) -> float:
    """Return the distance to the edge from (0, radius) to the inner corner.

    The point must be folded to beside this edge.
    """
    point = vec2(0.0, radius)
    notch = inner * vec2(sin(angle), cos(angle))
    d = length(from_segment(q, point, notch))
    return select(turned_from(notch - point, q - point) < 0.0, -d, d)


@primitive(
    "Hexagram",
    EXACT,
    bounds=disc_bounds,
    width=half_radius_width,
)
@func
def hexagram(p: vec2, radius: float = 0.5) -> float:
    """Star with six points made of two triangles; one point is at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a point of the star.

    Source: mirrored to the edge beside the upper point.

    Measured:
        hexagram((0.0, 5.0), 2.0) = 3.0
        hexagram((1.1547005383792515, 0.0), 2.0) = 0.0
        hexagram((0.0, 0.0), 3.0) = -1.7320508075688772
    """
    q = fold_past(fold_past(abs(p), PI / 3.0), PI / 6.0)
    return past_point_of_star(q, radius, radius / ROOT_THREE, PI / 6.0)


@primitive(
    "Pentagram",
    EXACT,
    bounds=disc_bounds,
    width=pentagram_width,
)
@func
def pentagram(p: vec2, radius: float = 0.5) -> float:
    """Star with five points made of the diagonals of a pentagon; one point is at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a point of the star.

    Source: mirrored to the edge beside the upper point.

    Measured:
        pentagram((0.0, 5.0), 2.0) = 3.0
        pentagram((0.0, -0.38196601125010515), 1.0) = 0.0
        pentagram((0.0, 0.0), 1.0) = -0.38196601125010515
    """
    q = fold_past(fold_past(fold_past(vec2(abs(p.x), p.y), 0.8 * PI), 0.4 * PI), 0.2 * PI)
    return past_point_of_star(q, radius, PENTAGRAM_INNER * radius, 0.2 * PI)


@primitive(
    "RegularStar",
    EXACT,
    bounds=disc_bounds,
    limits={"inner": Limit.POSITIVE},
    requires=_is_a_star,
    width=star_width,
)
@func
def regular_star(p: vec2, radius: float = 0.5, inner: float = 0.25, count: int = 7) -> float:
    """Star with equal points, one of them at the top.

    Args:
        p: Point.
        radius: Distance from the middle to a point of the star.
        inner: Distance from the middle to a corner between two points, less than the radius.
        count: Number of points, 2 or more.

    Source: turned to the sector of the nearest point, mirrored to the edge beside it.

    Measured:
        regular_star((0.0, 5.0), 2.0, 1.0, 7) = 3.0
        regular_star((0.0, -0.5), 1.0, 0.5, 5) = 0.0
        regular_star((0.0, 0.0), 3.0, 1.7320508075688772, 6) = -1.7320508075688772
    """
    return past_point_of_star(fold_sectors(p, count), radius, inner, PI / float(count))
