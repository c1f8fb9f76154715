"""Intersections of prisms whose ends lie in one plane: what an edge profile must not move.

Input: a point, the boxes of two shapes that are prisms along some axes, the size of the profile.
Output: the point at which both are evaluated, and the distance to the planes that end the result.

A profile changes an intersection where both distances are less than its size. Two shapes that end
in one plane are both that near everywhere on it, although there is no edge. But every section of a
prism is the same: a point near such ends is moved inwards, until it is a size away from them, and
the result is cut at the ends.
"""

from __future__ import annotations

from distal.fields.extents import box_distance, overlap, rectangle_distance
from distal.fields.guarantees import UNBOUNDED, Bounds, Bounds2
from distal.lang import Vectors, abs, clamp, func, max, min, select, vec2, vec3


@func
def depth_moved(smooth: float, along: Vectors, half: Vectors, apart: Vectors) -> Vectors:
    """Return how far points are moved inwards from the ends of two prisms.

    It is 0 if the ends are ``smooth`` apart.

    Args:
        smooth: The size of the profile.
        along: 1 for the axes along which both shapes are prisms, else 0.
        half: Half the size of what is in both boxes.
        apart: The distance of the ends of the two.
    """
    return along * min(max(smooth - apart, 0.0), max(half, 0.0))


@func
def shared_ends(
    smooth: float, along: vec3, bounds_a: Bounds, bounds_b: Bounds, share: float
) -> Bounds:
    """Return the ends that lie in one plane, as a box; its other sides are infinite.

    ``share`` is how much of their depth the sides are moved inwards.
    """
    ends = overlap(bounds_a, bounds_b)
    half = 0.5 * (ends.high - ends.low)
    below = depth_moved(smooth, along, half, abs(bounds_a.low - bounds_b.low))
    above = depth_moved(smooth, along, half, abs(bounds_a.high - bounds_b.high))
    far = vec3(UNBOUNDED)
    return Bounds(
        select(below > vec3(0.0), ends.low + share * below, -far),
        select(above > vec3(0.0), ends.high - share * above, far),
    )


@func
def shared_ends_flat(
    smooth: float, along: vec2, bounds_a: Bounds2, bounds_b: Bounds2, share: float
) -> Bounds2:
    """Return the ends of flat shapes that lie on one line, as a rectangle."""
    ends = overlap(bounds_a, bounds_b)
    half = 0.5 * (ends.high - ends.low)
    below = depth_moved(smooth, along, half, abs(bounds_a.low - bounds_b.low))
    above = depth_moved(smooth, along, half, abs(bounds_a.high - bounds_b.high))
    far = vec2(UNBOUNDED)
    return Bounds2(
        select(below > vec2(0.0), ends.low + share * below, -far),
        select(above > vec2(0.0), ends.high - share * above, far),
    )


@func
def moved_inwards(p: vec3, smooth: float, along: vec3, bounds_a: Bounds, bounds_b: Bounds) -> vec3:
    """Return the point at which two prisms are evaluated."""
    ends = shared_ends(smooth, along, bounds_a, bounds_b, 1.0)
    return clamp(p, ends.low, ends.high)


@func
def moved_inwards_flat(
    p: vec2, smooth: float, along: vec2, bounds_a: Bounds2, bounds_b: Bounds2
) -> vec2:
    """Return the point at which two flat shapes with straight sides are evaluated."""
    ends = shared_ends_flat(smooth, along, bounds_a, bounds_b, 1.0)
    return clamp(p, ends.low, ends.high)


@func
def cut_at_ends(
    d: float, p: vec3, smooth: float, along: vec3, bounds_a: Bounds, bounds_b: Bounds
) -> float:
    """Return a distance that is at least that to the ends of two prisms."""
    return max(d, box_distance(p, shared_ends(smooth, along, bounds_a, bounds_b, 0.0)))


@func
def cut_at_ends_flat(
    d: float, p: vec2, smooth: float, along: vec2, bounds_a: Bounds2, bounds_b: Bounds2
) -> float:
    """Return a distance that is at least that to the ends of two flat shapes."""
    return max(d, rectangle_distance(p, shared_ends_flat(smooth, along, bounds_a, bounds_b, 0.0)))
