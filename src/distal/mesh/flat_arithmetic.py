"""The arithmetic of flat faces, as scene code: planes, heights, what is straight.

Input: corners of triangles and normals of faces. Output: numbers. One row for each triangle, pair
or line. Needs no field.
"""

from __future__ import annotations

from distal.lang import abs, cross, dot, func, length, max, min, sqrt, vec3
from distal.mesh.arithmetic import unit_or_zero

# The smaller of two triangles has any normal if it has less than this share of the other's area.
THIN = 1e-3
# Neighbors in a plane look the same way.
ALIKE = 0.9


@func
def unit(way: vec3) -> vec3:
    """Return a vector's direction; 0 for 0."""
    return unit_or_zero(way)


@func
def is_flat(a: vec3, b: vec3, c: vec3, d: vec3, close: float) -> bool:
    """Return whether two neighbors are in one plane: that of the larger one.

    Args:
        a: One end of their common side.
        b: The other end.
        c: The third corner of the first triangle.
        d: The third corner of the other.
        close: How far the third corner of the smaller one may be from the plane.
    """
    one = cross(b - a, c - a)
    other = cross(a - b, d - b)
    size = length(one)
    of_other = length(other)
    above = abs(dot(one, d - a)) / max(size, 1e-300)
    of_first = abs(dot(other, c - a)) / max(of_other, 1e-300)
    alike = dot(one, other) > ALIKE * size * of_other or min(size, of_other) < THIN * max(
        size, of_other
    )
    return alike and (above if size >= of_other else of_first) <= close


@func
def from_plane(a: vec3, b: vec3, c: vec3, center: vec3, normal: vec3) -> float:
    """Return how far the farthest corner of a triangle is from a plane."""
    return max(
        abs(dot(a - center, normal)),
        max(abs(dot(b - center, normal)), abs(dot(c - center, normal))),
    )


@func
def height_along(a: vec3, b: vec3, c: vec3, normal: vec3) -> float:
    """Return the smallest height of a triangle, negative if it is seen from behind."""
    longest = max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c)))
    return dot(cross(b - a, c - a), normal) / sqrt(max(longest, 1e-300))


@func
def is_between(p: vec3, a: vec3, b: vec3, close: float) -> bool:
    """Return whether a point is on the line between two others, and not at its ends."""
    way = b - a
    share = dot(p - a, way)
    size = dot(way, way)
    if not (share > 0.0 and share < size):
        return False
    return length(cross(p - a, way)) <= close * sqrt(size)


@func
def flip_gain(a: vec3, b: vec3, c: vec3, d: vec3) -> float:
    """Return how much rounder two triangles are with the other diagonal; above 0 if they are.

    It is the sine of the sum of the angles at c and d, below 180 degrees for Delaunay's
    triangulation, negated.

    Args:
        a: One end of their common side.
        b: The other end.
        c: The third corner of one triangle.
        d: The third corner of the other.
    """
    sine_c = length(cross(a - c, b - c))
    sine_d = length(cross(a - d, b - d))
    cosine_c = dot(a - c, b - c)
    cosine_d = dot(a - d, b - d)
    size = length(a - c) * length(b - c) * length(a - d) * length(b - d)
    return -(sine_c * cosine_d + cosine_c * sine_d) / max(size, 1e-300)
