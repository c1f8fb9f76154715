"""Geometry of boxes, for the bounds of operators and for the code that keeps their values safe.

Input: boxes of shapes, finite or with sides beyond ``ENDLESS``. Output: enlarged, intersected and
rotated boxes, distances to a box, radii. Does not depend on operators.
"""

from __future__ import annotations

from typing import TypeVar

from distal.fields.guarantees import ENDLESS, UNBOUNDED, Bounds, Bounds2
from distal.lang import (
    Vectors,
    abs,
    dot,
    func,
    length,
    mat2,
    mat3,
    max,
    min,
    select,
    step,
    vec2,
    vec3,
)

# The least that remains of infinity after a rotation with rounding; no shape is that large.
LEAK = 1e9


Boxes = TypeVar("Boxes", Bounds, Bounds2)


@func
def hull_of(bounds_a: Boxes, bounds_b: Boxes) -> Boxes:
    """Return the smallest box around two boxes."""
    around = bounds_a
    around.low = min(bounds_a.low, bounds_b.low)
    around.high = max(bounds_a.high, bounds_b.high)
    return around


@func
def overlap(bounds_a: Boxes, bounds_b: Boxes) -> Boxes:
    """Return the intersection of two boxes; a box of size 0 on axes where they do not overlap."""
    shared = bounds_a
    shared.low = max(bounds_a.low, bounds_b.low)
    shared.high = max(min(bounds_a.high, bounds_b.high), shared.low)
    return shared


@func
def grown(bounds: Boxes, by: float) -> Boxes:
    """Return a box with its sides moved outwards."""
    larger = bounds
    larger.low = bounds.low - by
    larger.high = bounds.high + by
    return larger


@func
def moved_out(bounds: Boxes, by: float, side_growth: float) -> Boxes:
    """Return the box of a shape whose surface is moved outwards.

    It is infinite if the growth is not known.
    """
    return grown(bounds, select(side_growth > ENDLESS and by > 0.0, UNBOUNDED, by * side_growth))


@func
def largest(v: vec3) -> float:
    """Return the largest component."""
    return max(max(v.x, v.y), v.z)


@func
def smallest(v: vec3) -> float:
    """Return the smallest component."""
    return min(min(v.x, v.y), v.z)


@func
def box_distance(p: vec3, bounds: Bounds) -> float:
    """Return the exact distance to a box, negative inside; infinite sides are ignored."""
    beyond = max(bounds.low - p, p - bounds.high)
    return length(max(beyond, vec3(0.0))) + min(largest(beyond), 0.0)


@func
def drum_distance(across: float, along: float, radius: float, low: float, high: float) -> float:
    """Return the exact distance to a cylinder, negative inside.

    Args:
        across: Distance of the point from the axis.
        along: Position of the point along the axis.
        radius: Radius.
        low: Lower end on the axis.
        high: Upper end on the axis.
    """
    beyond = vec2(across - radius, max(low - along, along - high))
    return length(max(beyond, vec2(0.0))) + min(max(beyond.x, beyond.y), 0.0)


@func
def rectangle_distance(p: vec2, bounds: Bounds2) -> float:
    """Return the exact distance to a rectangle, negative inside."""
    beyond = max(bounds.low - p, p - bounds.high)
    return length(max(beyond, vec2(0.0))) + min(max(beyond.x, beyond.y), 0.0)


@func
def reach(bounds: Bounds) -> vec3:
    """Return how far a box extends from the origin along each axis, on either side."""
    return max(abs(bounds.low), abs(bounds.high))


@func
def reach_flat(bounds: Bounds2) -> vec2:
    """Return how far a rectangle extends from the origin along each axis, on either side."""
    return max(abs(bounds.low), abs(bounds.high))


@func
def diameter(bounds: Bounds) -> float:
    """Return the length of a box's diagonal."""
    return length(bounds.high - bounds.low)


@func
def at_least_one(slope: float) -> float:
    """Return the slope of a shape whose value may also be a true distance (to a box or plane)."""
    return max(slope, 1.0)


@func
def unless_endless(size: float, slope: float) -> float:
    """Return a slope if the size that it depends on is finite; otherwise no bound."""
    return select(size > ENDLESS, UNBOUNDED, slope)


@func
def product(factor: Vectors, limit: float) -> Vectors:
    """Return a product; 0 for an infinite side that only the rounding of a turn lets through."""
    made = factor * limit
    return made if abs(limit) < ENDLESS else made * step(LEAK, abs(made))


@func
def least_product(factor: Vectors, low: float, high: float) -> Vectors:
    """Return the least values of ``factor`` times any number between two limits."""
    return min(product(factor, low), product(factor, high))


@func
def turned(bounds: Bounds, m: mat3) -> Bounds:
    """Return the box around a box after the linear map ``m``.

    Each axis is computed as an interval, not from the centre and half sizes, so that an infinite
    side on one axis leaves the others finite.
    """
    a, b = bounds.low, bounds.high
    low = least_product(m[0], a.x, b.x) + least_product(m[1], a.y, b.y)
    low += least_product(m[2], a.z, b.z)
    high = least_product(-m[0], a.x, b.x) + least_product(-m[1], a.y, b.y)
    high += least_product(-m[2], a.z, b.z)
    far = vec3(UNBOUNDED)
    return Bounds(select(low < vec3(-LEAK), -far, low), select(high < vec3(-LEAK), far, -high))


@func
def along_axes(bounds: Bounds, x: vec3, y: vec3, z: vec3, at: vec3) -> Bounds:
    """Return the box along three axes around a box: a point is at dot(x, p) + at.x along the first.

    Args:
        bounds: The box.
        x: The first axis.
        y: The second axis.
        z: The third axis.
        at: Where the origin is along the axes.
    """
    made = turned(bounds, mat3(vec3(x.x, y.x, z.x), vec3(x.y, y.y, z.y), vec3(x.z, y.z, z.z)))
    return Bounds(made.low + at, made.high + at)


@func
def moved_along(at: vec3, factor: float, origin: vec3, x: vec3, y: vec3, z: vec3) -> vec3:
    """Return where the origin of a moved shape is along axes.

    Args:
        at: Where the origin is before the move.
        factor: How much the move scales the shape.
        origin: What the move makes of the origin: the point at which the shape is evaluated.
        x: The first axis, seen from the shape.
        y: The second axis.
        z: The third axis.
    """
    return at / factor - vec3(dot(x, origin), dot(y, origin), dot(z, origin))


@func
def turned_flat(bounds: Bounds2, m: mat2) -> Bounds2:
    """Return the rectangle around a rectangle after the linear map ``m``."""
    a, b = bounds.low, bounds.high
    low = least_product(m[0], a.x, b.x) + least_product(m[1], a.y, b.y)
    high = least_product(-m[0], a.x, b.x) + least_product(-m[1], a.y, b.y)
    far = vec2(UNBOUNDED)
    return Bounds2(select(low < vec2(-LEAK), -far, low), select(high < vec2(-LEAK), far, -high))
