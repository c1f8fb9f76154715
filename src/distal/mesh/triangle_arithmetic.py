"""The arithmetic of triangles, as scene code: distances, integrals, shapes, separation.

Input: corners of triangles. Output: numbers. One row for each triangle or pair. Needs no field.
"""

from __future__ import annotations

from distal.lang import abs, array, clamp, cross, dot, func, length, max, min, sqrt, vec2, vec3
from distal.mesh.arithmetic import unit_or_zero


@func
def roundness(a: vec3, b: vec3, c: vec3) -> float:
    """Return twice the area of a triangle, for each unit of its longest side squared."""
    longest = max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c)))
    return length(cross(b - a, c - a)) / max(longest, 1e-300)


@func
def chosen_diagonal(
    points: array[vec3, 4],  # type: ignore[valid-type]
    fits: vec3,
    misses: vec3,
    tolerance: float,
    tie: float,
) -> int:
    """Return the diagonal that splits four points into triangles: 0, 1, or 2 for neither.

    Args:
        points: The four points, in order.
        fits: 1 in x and y for the diagonals that may be used, else 0; z is not used.
        misses: How far each diagonal's middle is from the surface, or the edge's root from the
            triangles, if that is more; in x and y.
        tolerance: How far it may be.
        tie: Below this difference, the rounder triangles are preferred.
    """
    first = fits.x > 0.0 and misses.x <= tolerance
    second = fits.y > 0.0 and misses.y <= tolerance
    if not first and not second:
        return 2
    if first != second:
        return 0 if first else 1
    round_first = min(
        roundness(points[0], points[1], points[2]), roundness(points[0], points[2], points[3])
    )
    round_second = min(
        roundness(points[1], points[2], points[3]), roundness(points[1], points[3], points[0])
    )
    if round_first < 1e-3 and round_second > 1e-2:
        return 1
    if round_second < 1e-3 and round_first > 1e-2:
        return 0
    if abs(misses.x - misses.y) < tie:
        # In flat faces both are often as round: rounding must not decide.
        return 1 if round_second > round_first + 1e-3 else 0
    return 0 if misses.x <= misses.y else 1


@func
def distance_to_triangle(p: vec3, a: vec3, b: vec3, c: vec3) -> float:
    """Return the distance from a point to a triangle.

    Source: Inigo Quilez, "Triangle - distance" (https://iquilezles.org/articles/triangledistance/).
    """
    normal = cross(b - a, a - c)
    outside = (
        dot(cross(b - a, normal), p - a) < 0.0
        or dot(cross(c - b, normal), p - b) < 0.0
        or dot(cross(a - c, normal), p - c) < 0.0
    )
    if outside or dot(normal, normal) < 1e-300:
        return min(to_line(p, a, b), min(to_line(p, b, c), to_line(p, c, a)))
    return abs(dot(normal, p - a)) / sqrt(dot(normal, normal))


@func
def distance_if_alike(p: vec3, normal: vec3, a: vec3, b: vec3, c: vec3, least: float) -> float:
    """Return the distance from a point to a triangle; 1e30 if its normal is another.

    Args:
        p: The point.
        normal: The normal that is expected there, of length 1.
        a: The first corner of the triangle.
        b: The second corner.
        c: The third corner.
        least: The least cosine between the normal and that of the triangle.
    """
    outside = unit_or_zero(cross(b - a, c - a))
    return distance_to_triangle(p, a, b, c) if dot(outside, normal) >= least else 1e30


@func
def distance_to_pair(p: vec3, a: vec3, b: vec3, c: vec3, d: vec3) -> float:
    """Return the distance from a point to the two triangles beside the line from a to c."""
    return min(distance_to_triangle(p, a, b, c), distance_to_triangle(p, a, c, d))


@func
def to_line(p: vec3, a: vec3, b: vec3) -> float:
    """Return the distance from a point to the line between two points."""
    way = b - a
    share = clamp(dot(p - a, way) / max(dot(way, way), 1e-300), 0.0, 1.0)
    return length(p - a - way * share)


@func
def middle(a: vec3, b: vec3, c: vec3) -> vec3:
    """Return the middle of a triangle."""
    return (a + b + c) / 3.0


@func
def moments(a: vec3, b: vec3, c: vec3) -> tuple[float, float, vec3, vec3, vec3]:
    """Return the integrals over the tetrahedron of the origin and a triangle.

    They are its volume, negative if the triangle is seen from behind; the triangle's area; and the
    integrals of p, of (xx, yy, zz) and of (xy, yz, zx).
    """
    volume = dot(a, cross(b, c)) / 6.0
    area = 0.5 * length(cross(b - a, c - a))
    total = a + b + c
    squares = (total * total + a * a + b * b + c * c) * (volume / 20.0)
    products = (total * total.yzx + a * a.yzx + b * b.yzx + c * c.yzx) * (volume / 20.0)
    return volume, area, total * (volume / 4.0), squares, products


@func
def face(a: vec3, b: vec3, c: vec3) -> tuple[float, vec3]:
    """Return the area of a triangle and its normal, 0 for a triangle without area."""
    doubled = cross(b - a, c - a)
    return 0.5 * length(doubled), unit_or_zero(doubled)


@func
def are_apart(
    a0: vec3,
    a1: vec3,
    a2: vec3,
    b0: vec3,
    b1: vec3,
    b2: vec3,
    share_first: bool,
) -> bool:
    """Return whether two triangles are certainly apart, but for a first corner that they share.

    They are if all corners of one, the shared one left out, are on one side of a plane and those of
    the other are on the other side. The planes tried are those of the separating axis theorem.

    Args:
        a0: The first corner of the first triangle.
        a1: Its second corner.
        a2: Its third corner.
        b0: The first corner of the other triangle.
        b1: Its second corner.
        b2: Its third corner.
        share_first: Whether the first corners are the same point.
    """
    a = [vec3(0.0), a1 - a0, a2 - a0]
    b = [b0 - a0, b1 - a0, b2 - a0]
    sides_a = [a[1], a[2] - a[1], -a[2]]
    sides_b = [b[1] - b[0], b[2] - b[1], b[0] - b[2]]
    normal_a = cross(a[1], a[2])
    normal_b = cross(sides_b[0], b[2] - b[0])
    size = length(a[1]) + length(a[2]) + length(b[0]) + length(b[1]) + length(b[2])
    if has_gap(a, b, normal_a, size, share_first) or has_gap(a, b, normal_b, size, share_first):
        return True
    for i in range(3):
        if has_gap(a, b, cross(normal_a, sides_a[i]), size, share_first):
            return True
        if has_gap(a, b, cross(normal_b, sides_b[i]), size, share_first):
            return True
        for j in range(3):
            if has_gap(a, b, cross(sides_a[i], sides_b[j]), size, share_first):
                return True
    return False


@func
def has_gap(
    a: array[vec3, 3],  # type: ignore[valid-type]
    b: array[vec3, 3],  # type: ignore[valid-type]
    axis: vec3,
    size: float,
    share_first: bool,
) -> bool:
    """Return whether a plane perpendicular to an axis lies between two triangles.

    Args:
        a: The corners of the first triangle.
        b: The corners of the other.
        axis: The axis.
        size: The size of the triangles, which limits rounding errors.
        share_first: Whether the first corners are the same point, 0.
    """
    if share_first:
        return has_corner_gap(a, b, axis) or has_corner_gap(b, a, axis)
    room = 1e-13 * size * length(axis)
    low_a = min(min(dot(a[1], axis), dot(a[2], axis)), 0.0)
    high_a = max(max(dot(a[1], axis), dot(a[2], axis)), 0.0)
    low_b = min(min(dot(b[1], axis), dot(b[2], axis)), dot(b[0], axis))
    high_b = max(max(dot(b[1], axis), dot(b[2], axis)), dot(b[0], axis))
    return low_b - high_a > room or low_a - high_b > room


@func
def has_corner_gap(
    a: array[vec3, 3],  # type: ignore[valid-type]
    b: array[vec3, 3],  # type: ignore[valid-type]
    axis: vec3,
) -> bool:
    """Return whether a plane through the first corner of two triangles, 0, lies between them.

    One of them may have a side in the plane: rounding turns it by less than the other is away.

    Args:
        a: The corners of the first triangle.
        b: The corners of the other.
        axis: The plane's normal.
    """
    if min(min(length(a[1]), length(a[2])), min(length(b[1]), length(b[2]))) <= 0.0:
        return False
    room = 1e-13 * length(axis)
    first = vec2(dot(a[1], axis) / length(a[1]), dot(a[2], axis) / length(a[2]))
    second = vec2(dot(b[1], axis) / length(b[1]), dot(b[2], axis) / length(b[2]))
    low_a = min(first.x, first.y)
    high_a = max(first.x, first.y)
    low_b = min(second.x, second.y)
    high_b = max(second.x, second.y)
    touch = 0.1 * room
    return (high_a < touch and low_b > room) or (low_a > -touch and high_b < -room)


@func
def is_unfolded(a: vec3, b: vec3, c: vec3, d: vec3) -> bool:
    """Return whether two triangles with a common side are certainly not folded onto each other.

    Args:
        a: One end of the side.
        b: The other end.
        c: The third corner of the first triangle.
        d: The third corner of the other.
    """
    one = cross(b - a, c - a)
    other = cross(b - a, d - a)
    size = length(one) * length(other)
    return dot(one, other) < -1e-10 * size or abs(dot(one, d - a)) > 1e-10 * (
        length(one) * length(d - a)
    )


@func
def between(a: vec3, b: vec3) -> float:
    """Return the distance between two points."""
    return length(b - a)


@func
def along(a: vec3, b: vec3, share: float) -> vec3:
    """Return the point at a share of the way from ``a`` to ``b``."""
    return a + (b - a) * share


@func
def normal_along(a: vec3, b: vec3, share: float) -> vec3:
    """Return the unit vector at a share of the way from ``a`` to ``b``; 0 between opposite ones."""
    return unit_or_zero(along(a, b, share))


@func
def weighted(a: vec3, b: vec3, c: vec3, shares: vec3) -> vec3:
    """Return the point with these shares of three corners."""
    return a * shares.x + b * shares.y + c * shares.z


@func
def weighted_normal(a: vec3, b: vec3, c: vec3, shares: vec3) -> vec3:
    """Return the unit vector with these shares of three vectors; 0 if they cancel."""
    return unit_or_zero(weighted(a, b, c, shares))


@func
def least_height(a: vec3, b: vec3, c: vec3) -> float:
    """Return the smallest height of a triangle."""
    longest = max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c)))
    return length(cross(b - a, c - a)) / sqrt(max(longest, 1e-300))
