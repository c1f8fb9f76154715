"""The arithmetic of outlines, as scene code: roots on edges, points of cells, distances, areas.

Input: a flat field, and numbers of one edge, cell or line. Output: its numbers. Compiled as vector
code of the CPU, in 64 bits, one row for each edge, cell or line. Does not depend on topology.

Source: Tao Ju, Frank Losasso, Scott Schaefer, Joe Warren, "Dual Contouring of Hermite Data" (2002).
"""

from __future__ import annotations

from distal.lang import (
    Field2,
    abs,
    clamp,
    dot,
    func,
    gradient,
    length,
    max,
    min,
    value_and_gradient,
    vec2,
)
from distal.mesh.root_arithmetic import share_of_root

# Roots and points keep these shares of a cell's side away from corners and sides of their cells, so
# that lines of different cells never touch.
ROOT_MARGIN = 6.103515625e-05  # 2^-14
POINT_MARGIN = 1.52587890625e-05  # 2^-16
# Below this cosine between the normals at two roots, a cell may have a corner.
CORNER_COSINE = 0.95


@func
def distance_value(field: Field2, p: vec2) -> float:
    """Return the field's value."""
    return field(p)


@func
def unit_or_zero(v: vec2) -> vec2:
    """Return the vector scaled to length 1; 0 if it has no direction."""
    return v / max(length(v), 1e-12)


@func
def distance_and_normal(field: Field2, p: vec2, step: float) -> tuple[float, vec2]:
    """Return the distance from a point to the edge, to first order, and the normal there.

    Args:
        field: The field.
        p: The point.
        step: A length; the normal is taken a tiny share of it beside the point, since on the edge
            the gradient may be 0.
    """
    value, slope = value_and_gradient(field, p)
    beside = gradient(field, p + vec2(0.51, 0.86) * (1e-5 * step))
    return abs(value) / max(length(slope), 1e-9), unit_or_zero(beside)


@func
def step_to_edge(value: float, slope: vec2) -> vec2:
    """Return the Newton step from a point to the edge of the shape."""
    return slope * (-value / max(dot(slope, slope), 1e-12))


@func
def root_on_edge(
    field: Field2, start: vec2, way: vec2, first: float, second: float
) -> tuple[vec2, vec2]:
    """Return where the field is 0 on an edge of a cell, and the gradient there.

    Args:
        field: The field.
        start: The first end of the edge.
        way: From the first end to the second.
        first: The value at the first end.
        second: The value at the second end; its sign differs.
    """

    def along(t: float) -> float:
        return field(start + way * t)

    t = share_of_root(along, first, second)
    found = start + way * clamp(t, ROOT_MARGIN, 1.0 - ROOT_MARGIN)
    slope = gradient(field, found)
    # Distances made of a sign and a length have no gradient where they are 0.
    if dot(slope, slope) < 1e-12:
        slope = gradient(field, found + way * 1e-4)
    return found, slope


@func
def meeting_point(a: vec2, b: vec2, normal_a: vec2, normal_b: vec2) -> vec2:
    """Return where the lines through two points meet; the middle if they are parallel.

    Args:
        a: A point of the first line.
        b: A point of the second line.
        normal_a: The first line's normal, of length 1.
        normal_b: The second line's normal, of length 1.
    """
    middle = (a + b) * 0.5
    sine = normal_a.x * normal_b.y - normal_a.y * normal_b.x
    offset_a = dot(normal_a, a - middle)
    offset_b = dot(normal_b, b - middle)
    x = offset_a * normal_b.y - offset_b * normal_a.y
    y = normal_a.x * offset_b - normal_b.x * offset_a
    return middle + vec2(x, y) / sine if abs(sine) > 1e-6 else middle


@func
def cell_point(
    field: Field2, a: vec2, b: vec2, slope_a: vec2, slope_b: vec2
) -> tuple[vec2, float, float]:
    """Return the point between two roots: at the corner, if the edge has one there.

    The tangents at the roots meet in a first place; tangents at points closer to it give a better
    one. Besides, return 1 for a corner, else 0, and how far the point is from the edge.

    Args:
        field: The field.
        a: The first root.
        b: The second root.
        slope_a: The gradient at the first root.
        slope_b: The gradient at the second root.
    """
    found = (a + b) * 0.5
    corner = 0.0
    normal_a = unit_or_zero(slope_a)
    normal_b = unit_or_zero(slope_b)
    if dot(normal_a, normal_b) < CORNER_COSINE:
        found = meeting_point(a, b, normal_a, normal_b)
        share = 0.5
        # Distances made of a sign and a length have no gradient where they are 0.
        inwards = 1e-3 * length(b - a)
        for _turn in range(4):
            near_a = found + (a - found) * share - normal_a * inwards
            near_b = found + (b - found) * share - normal_b * inwards
            value_a, there_a = value_and_gradient(field, near_a)
            value_b, there_b = value_and_gradient(field, near_b)
            new_a = unit_or_zero(there_a)
            new_b = unit_or_zero(there_b)
            # A tangent at the other side of the corner says nothing new.
            if dot(new_a, normal_a) > 0.7 and dot(new_b, normal_b) > 0.7:
                corner = 1.0 if dot(new_a, new_b) < CORNER_COSINE else 0.0
                found = meeting_point(
                    near_a + step_to_edge(value_a, there_a),
                    near_b + step_to_edge(value_b, there_b),
                    new_a,
                    new_b,
                )
            share = share * 0.4
    value, slope = value_and_gradient(field, found)
    off = abs(value) / max(length(slope), 1e-9)
    if corner > 0.5:
        found = found + step_to_edge(value, slope)
    if corner < 0.5 or off > 1e-2 * length(b - a):
        corner = 0.0
        # Where there is no corner, the meeting point of tangents may be far from their cell.
        far = length(found - (a + b) * 0.5) > length(b - a)
        found = (a + b) * 0.5 if far else found
        for _turn in range(2):
            value, slope = value_and_gradient(field, found)
            found = found + step_to_edge(value, slope)
        value, slope = value_and_gradient(field, found)
        off = abs(value) / max(length(slope), 1e-9)
    return found, corner, off


@func
def kept_in_region(
    inner: vec2, target: vec2, low: vec2, high: vec2, normal: vec2, offset: float
) -> tuple[vec2, float]:
    """Return the target, or the last point on the way to it within a region; how far it moved.

    Args:
        inner: A point inside the region.
        target: The point that is wanted.
        low: The lowest corner of the region's box.
        high: The highest corner.
        normal: The normal of a line that ends the region; 0 for none.
        offset: The largest product of the normal with a point of the region.
    """
    way = target - inner
    share = 1.0
    if way.x != 0.0:
        share = min(share, ((high.x if way.x > 0.0 else low.x) - inner.x) / way.x)
    if way.y != 0.0:
        share = min(share, ((high.y if way.y > 0.0 else low.y) - inner.y) / way.y)
    speed = dot(normal, way)
    if speed > 0.0:
        share = min(share, (offset - dot(normal, inner)) / speed)
    share = max(share, 0.0)
    return inner + way * share, length(way) * (1.0 - share)


@func
def distance_on_line(field: Field2, a: vec2, b: vec2, share: float) -> float:
    """Return the distance from a point of a line to the edge of the shape, to first order."""
    value, slope = value_and_gradient(field, a + (b - a) * share)
    return abs(value) / max(length(slope), 1e-9)


@func
def behind_thin(field: Field2, p: vec2, step: float) -> tuple[vec2, float, float]:
    """Return the edge of the shape near a point, how far it is, and the value just behind it.

    Args:
        field: The field.
        p: The point.
        step: The length of a cell.
    """
    q = p
    for _turn in range(3):
        value, slope = value_and_gradient(field, q)
        q = q + step_to_edge(value, slope)
    away = length(q - p)
    behind = field(p + (q - p) * ((away + 1e-6 * step) / max(away, 1e-12)))
    return q, away, behind


@func
def distance_to_line(p: vec2, a: vec2, b: vec2) -> float:
    """Return the distance from a point to a line between two points."""
    way = b - a
    share = clamp(dot(p - a, way) / max(dot(way, way), 1e-30), 0.0, 1.0)
    return length(p - a - way * share)


@func
def distance_if_alike(p: vec2, normal: vec2, a: vec2, b: vec2, least: float) -> float:
    """Return the distance from a point to a line whose inside is at its left; 1e30 if it differs.

    Args:
        p: The point.
        normal: The normal that is expected there, of length 1.
        a: The start of the line.
        b: Its end.
        least: The least cosine between the normal and that of the line.
    """
    outside = unit_or_zero(vec2(b.y - a.y, a.x - b.x))
    return distance_to_line(p, a, b) if dot(outside, normal) >= least else 1e30


@func
def step_along(away: float, normal: vec2, held: vec2, beyond: float) -> vec2:
    """Return the step to the edge of a shape along a line; see ``arithmetic.step_along``."""
    way = normal - held * dot(normal, held)
    goal = away + (beyond if away > 0.0 else -beyond)
    return way * (-goal / max(dot(way, way), 0.01))


@func
def line_measures(a: vec2, b: vec2) -> vec2:
    """Return the signed area of the triangle of a line and the origin, and the line's length."""
    return vec2(0.5 * (a.x * b.y - a.y * b.x), length(b - a))
