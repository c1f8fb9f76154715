"""The arithmetic of points that move onto neighbors, as scene code.

Input: corners of triangles. Output: numbers. One row for each triangle. Needs no field.
"""

from __future__ import annotations

from distal.lang import atan2, cross, dot, func, length, max, sqrt, vec3
from distal.mesh.triangle_arithmetic import distance_to_triangle


@func
def replaced(p: vec3, onto: vec3, b: vec3, c: vec3, thin: float) -> vec3:
    """Return what a triangle is after a corner has moved.

    These are the cosine of the angle that it turns by, 1 where it was too thin for a direction; its
    smallest height; and how far the corner was from what it is now.

    Args:
        p: The corner.
        onto: Where it moves.
        b: The second corner.
        c: The third corner.
        thin: The height below which a triangle has no direction.
    """
    old = cross(b - p, c - p)
    new = cross(b - onto, c - onto)
    height = height_of(new, onto, b, c)
    cosine = dot(old, new) / max(length(old) * length(new), 1e-300)
    if height_of(old, p, b, c) < thin:
        cosine = 1.0
    return vec3(cosine, height, distance_to_triangle(p, onto, b, c))


@func
def height_of(doubled: vec3, a: vec3, b: vec3, c: vec3) -> float:
    """Return the smallest height of a triangle.

    Args:
        doubled: Its normal, of twice its area.
        a: Its first corner.
        b: Its second corner.
        c: Its third corner.
    """
    longest = max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c)))
    return length(doubled) / sqrt(max(longest, 1e-300))


@func
def angle(a: vec3, b: vec3, c: vec3) -> float:
    """Return the angle of a triangle at its first corner, in radians."""
    return atan2(length(cross(b - a, c - a)), dot(b - a, c - a))
