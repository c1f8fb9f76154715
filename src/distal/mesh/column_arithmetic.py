"""The solid between a triangle of a mesh and the surface, as scene code.

Input: a field and the corners of a triangle. Output: integrals. Columns stand on the triangle,
along its normal, and end at the surface: the triangle with its columns has the integrals of the
solid to a higher order than the triangle alone. One row for each triangle.
"""

from __future__ import annotations

from distal.lang import (
    Field3,
    abs,
    array,
    clamp,
    cross,
    dot,
    func,
    length,
    max,
    value_and_gradient,
    vec3,
)
from distal.mesh.arithmetic import OFF_SURFACE

# A column is at most this share of the triangle's longest side.
LONGEST = 0.5
# Below this cosine between the normal of the triangle and that of the surface, they do not face
# each other: the foot of the column is at a crease.
LEAST_COSINE = 0.3


@func
def column_places(a: vec3, b: vec3, c: vec3) -> array[vec3, 7]:  # type: ignore[valid-type]
    """Return seven points of a triangle: six that integrate degree 4 exactly, and the middle.

    Source: D. A. Dunavant, "High Degree Efficient Symmetrical Gaussian Quadrature Rules for the
        Triangle" (1985), degree 4.
    """
    total = a + b + c
    inner = 0.445948490915965
    outer = 0.091576213509771
    return [
        total * inner + a * (1.0 - 3.0 * inner),
        total * inner + b * (1.0 - 3.0 * inner),
        total * inner + c * (1.0 - 3.0 * inner),
        total * outer + a * (1.0 - 3.0 * outer),
        total * outer + b * (1.0 - 3.0 * outer),
        total * outer + c * (1.0 - 3.0 * outer),
        total / 3.0,
    ]


@func
def column(field: Field3, p: vec3, normal: vec3, longest: float) -> float:
    """Return how far the surface is from a point along a direction.

    Args:
        field: The field.
        p: The point.
        normal: The direction, of length 1, outwards.
        longest: The most that is returned.
    """
    # On the surface the gradient may be 0 or noise; beside it, it is not.
    beside = OFF_SURFACE * longest
    value, steep = value_and_gradient(field, p + normal * beside)
    slope = max(dot(steep, normal), max(LEAST_COSINE * length(steep), 1e-9))
    height = clamp(beside - value / slope, -longest, longest)
    # One more step with the same slope: what is left is of the fourth order.
    return clamp(height - field(p + normal * height) / slope, -longest, longest)


@func
def columns(
    field: Field3, a: vec3, b: vec3, c: vec3, origin: vec3
) -> tuple[vec3, vec3, vec3, vec3]:
    """Return integrals over the columns on a triangle.

    Args:
        field: The field.
        a: The first corner of the triangle.
        b: The second, counter-clockwise seen from outside.
        c: The third.
        origin: The point from which p is taken in integrals.

    Returns:
        The volume, negative inside the mesh; how far it may be off since the surface is not as
        smooth as the rule assumes; the volume without signs; the integrals of p; those of
        (xx, yy, zz); those of (xy, yz, zx).
    """
    doubled = cross(b - a, c - a)
    area = 0.5 * length(doubled)
    normal = doubled / max(2.0 * area, 1e-300)
    longest = LONGEST * max(length(b - a), max(length(c - b), length(a - c)))
    sums = vec3(0.0)
    first = vec3(0.0)
    squares = vec3(0.0)
    products = vec3(0.0)
    at_inner = 0.0
    at_outer = 0.0
    places = column_places(a, b, c)
    for i in range(6):
        p = places[i]
        height = column(field, p, normal, longest)
        at_inner += height if i < 3 else 0.0
        at_outer += 0.0 if i < 3 else height
        volume = area * height * (0.223381589678011 if i < 3 else 0.109951743655322)
        middle = p - origin + normal * (0.5 * height)
        sums += vec3(volume, 0.0, abs(volume))
        first += middle * volume
        squares += middle * middle * volume
        products += middle * middle.yzx * volume
    # Of a polynomial of degree 2, the middle follows from the others.
    middle_height = column(field, places[6], normal, longest)
    expected = at_inner * 0.425706391607957 - at_outer * 0.092373058274624
    return vec3(sums.x, area * (middle_height - expected), sums.z), first, squares, products
