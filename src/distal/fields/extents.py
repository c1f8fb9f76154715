"""Geometry of boxes, for the rules of operators and for the guards that keep their values safe.

Input: boxes of shapes, finite or with sides beyond ``ENDLESS``. Output: grown,
overlapping and turned boxes, distances to a box, radii. Knows no operator.
"""

from __future__ import annotations

from typing import TypeVar

from distal.fields.guarantees import ENDLESS, UNBOUNDED, Bounds, Bounds2
from distal.lang import Vectors, abs, func, length, mat2, mat3, max, min, select, vec2, vec3

# What is left of infinity after turning a box by a rounded zero; no shape is that large.
LEAK = 1e9


Boxes = TypeVar("Boxes", Bounds, Bounds2)


@func
def hull_of(bounds_a: Boxes, bounds_b: Boxes) -> Boxes:
    """The smallest box around two."""
    around = bounds_a
    around.low = min(bounds_a.low, bounds_b.low)
    around.high = max(bounds_a.high, bounds_b.high)
    return around


@func
def overlap(bounds_a: Boxes, bounds_b: Boxes) -> Boxes:
    """What two boxes share; a point where they share nothing."""
    shared = bounds_a
    shared.low = max(bounds_a.low, bounds_b.low)
    shared.high = max(min(bounds_a.high, bounds_b.high), shared.low)
    return shared


@func
def grown(bounds: Boxes, by: float) -> Boxes:
    """A box with its sides moved out."""
    larger = bounds
    larger.low = bounds.low - by
    larger.high = bounds.high + by
    return larger


@func
def moved_out(bounds: Boxes, by: float, side_growth: float) -> Boxes:
    """The box of a shape whose surface is moved out; without end where its growth is not known."""
    return grown(bounds, select(side_growth > ENDLESS and by > 0.0, UNBOUNDED, by * side_growth))


@func
def largest(v: vec3) -> float:
    """The largest component."""
    return max(max(v.x, v.y), v.z)


@func
def smallest(v: vec3) -> float:
    """The smallest component."""
    return min(min(v.x, v.y), v.z)


@func
def box_distance(p: vec3, bounds: Bounds) -> float:
    """The distance to a box, negative inside. Exact; a missing side is nowhere near."""
    beyond = max(bounds.low - p, p - bounds.high)
    return length(max(beyond, vec3(0.0))) + min(largest(beyond), 0.0)


@func
def drum_distance(across: float, along: float, radius: float, low: float, high: float) -> float:
    """The distance to a drum, negative inside. Exact.

    ``across`` is how far the place is from the axis, ``along`` where on the axis.
    """
    beyond = vec2(across - radius, max(low - along, along - high))
    return length(max(beyond, vec2(0.0))) + min(max(beyond.x, beyond.y), 0.0)


@func
def rectangle_distance(p: vec2, bounds: Bounds2) -> float:
    """The distance to a rectangle, negative inside. Exact."""
    beyond = max(bounds.low - p, p - bounds.high)
    return length(max(beyond, vec2(0.0))) + min(max(beyond.x, beyond.y), 0.0)


@func
def reach(bounds: Bounds) -> vec3:
    """How far a box goes from the origin along each axis, on either side."""
    return max(abs(bounds.low), abs(bounds.high))


@func
def reach_flat(bounds: Bounds2) -> vec2:
    """How far a rectangle goes from the origin along each axis, on either side."""
    return max(abs(bounds.low), abs(bounds.high))


@func
def diameter(bounds: Bounds) -> float:
    """The length of a box's diagonal."""
    return length(bounds.high - bounds.low)


@func
def at_least_one(slope: float) -> float:
    """The slope of a shape where a true distance (to a box, to a plane) may stand too."""
    return max(slope, 1.0)


@func
def unless_endless(size: float, slope: float) -> float:
    """A slope, where the size that it rests on is finite; else no bound."""
    return select(size > ENDLESS, UNBOUNDED, slope)


@func
def least_product(factor: Vectors, low: float, high: float) -> Vectors:
    """The lower ends of ``factor`` times everything between two numbers."""
    return min(factor * low, factor * high)


@func
def turned(bounds: Bounds, m: mat3) -> Bounds:
    """The box around a box after the linear map ``m``.

    Interval by interval rather than about the middle: an infinite side on one axis leaves the
    others as they are.
    """
    a, b = bounds.low, bounds.high
    low = least_product(m[0], a.x, b.x) + least_product(m[1], a.y, b.y)
    low += least_product(m[2], a.z, b.z)
    high = least_product(-m[0], a.x, b.x) + least_product(-m[1], a.y, b.y)
    high += least_product(-m[2], a.z, b.z)
    far = vec3(UNBOUNDED)
    return Bounds(select(low < vec3(-LEAK), -far, low), select(high < vec3(-LEAK), far, -high))


@func
def turned_flat(bounds: Bounds2, m: mat2) -> Bounds2:
    """The rectangle around a rectangle after the linear map ``m``."""
    a, b = bounds.low, bounds.high
    low = least_product(m[0], a.x, b.x) + least_product(m[1], a.y, b.y)
    high = least_product(-m[0], a.x, b.x) + least_product(-m[1], a.y, b.y)
    far = vec2(UNBOUNDED)
    return Bounds2(select(low < vec2(-LEAK), -far, low), select(high < vec2(-LEAK), far, -high))
