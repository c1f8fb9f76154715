"""From one shape to another across space: a morph whose progress depends on the place.

Input: two distances, the point, the children's boxes and slopes. Output: the
distance between the two, and the rules of slope and material.
"""

from __future__ import annotations

from distal.fields.ease import ease_requirement, ease_slope, eased
from distal.fields.extents import diameter, hull_of, unless_endless
from distal.fields.guarantees import Bounds, Growth, Limit, operator
from distal.lang import abs, clamp, dot, func, length, max, vec3


@func
def most_apart(bounds_a: Bounds, bounds_b: Bounds, slope_a: float, slope_b: float) -> float:
    """How far apart the values of two shapes are at most, within the box around both.

    Each is 0 somewhere in the box, so that within it neither is beyond slope times diagonal.
    """
    return max(slope_a, slope_b) * diameter(hull_of(bounds_a, bounds_b))


@func
def transition(
    a: float,
    b: float,
    t: float,
    bounds_a: Bounds,
    bounds_b: Bounds,
    slope_a: float,
    slope_b: float,
) -> float:
    """From one shape to the other by ``t``.

    How far they are apart is cut off at what they can be where the surfaces are; farther out, where
    both are positive, the result stays positive.
    """
    limit = most_apart(bounds_a, bounds_b, slope_a, slope_b)
    return a + t * clamp(b - a, -limit, limit)


@func
def transition_slope(
    rise: float, bounds_a: Bounds, bounds_b: Bounds, slope_a: float, slope_b: float
) -> float:
    """A mean of both slopes, and how fast the mean shifts times what is between them."""
    limit = most_apart(bounds_a, bounds_b, slope_a, slope_b)
    return unless_endless(limit, max(slope_a, slope_b) + rise * limit)


@func
def linear_progress(p: vec3, start: vec3, end: vec3, ease: int) -> float:
    """How far ``p`` is on the way from ``start`` to ``end``."""
    way = end - start
    return eased(dot(p - start, way) / dot(way, way), ease)


@func
def transition_linear(
    a: float,
    b: float,
    p: vec3,
    start: vec3,
    end: vec3,
    bounds_a: Bounds,
    bounds_b: Bounds,
    slope_a: float,
    slope_b: float,
    ease: int = 1,
) -> float:
    """The first shape before the point ``start``, the second beyond ``end``."""
    t = linear_progress(p, start, end, ease)
    return transition(a, b, t, bounds_a, bounds_b, slope_a, slope_b)


@func
def transition_linear_mix(
    a: float, b: float, p: vec3, start: vec3, end: vec3, ease: int = 1
) -> float:
    """The share of ``b``."""
    return linear_progress(p, start, end, ease)


@func
def transition_linear_slope(
    slope_a: float,
    slope_b: float,
    bounds_a: Bounds,
    bounds_b: Bounds,
    start: vec3,
    end: vec3,
    ease: int = 1,
) -> float:
    """The shorter the way, the steeper."""
    rise = ease_slope(ease) / length(end - start)
    return transition_slope(rise, bounds_a, bounds_b, slope_a, slope_b)


@func
def radial_progress(p: vec3, inner: float, outer: float, ease: int) -> float:
    """How far ``p`` is on the way out from the y axis."""
    return eased((length(p.xz) - inner) / (outer - inner), ease)


@func
def transition_radial(
    a: float,
    b: float,
    p: vec3,
    inner: float,
    outer: float,
    bounds_a: Bounds,
    bounds_b: Bounds,
    slope_a: float,
    slope_b: float,
    ease: int = 1,
) -> float:
    """The first shape within ``inner`` of the y axis, the second beyond ``outer``."""
    t = radial_progress(p, inner, outer, ease)
    return transition(a, b, t, bounds_a, bounds_b, slope_a, slope_b)


@func
def transition_radial_mix(
    a: float, b: float, p: vec3, inner: float, outer: float, ease: int = 1
) -> float:
    """The share of ``b``."""
    return radial_progress(p, inner, outer, ease)


@func
def transition_radial_slope(
    slope_a: float,
    slope_b: float,
    bounds_a: Bounds,
    bounds_b: Bounds,
    inner: float,
    outer: float,
    ease: int = 1,
) -> float:
    """The narrower the ring, the steeper."""
    rise = ease_slope(ease) / abs(outer - inner)
    return transition_slope(rise, bounds_a, bounds_b, slope_a, slope_b)


def way_requirement(
    start: tuple[float, float, float], end: tuple[float, float, float], ease: int
) -> str | None:
    """Why a transition along a way cannot be, or None."""
    if tuple(start) == tuple(end):
        return "start and end must be different points"
    return ease_requirement(ease)


def ring_requirement(inner: float, outer: float, ease: int) -> str | None:
    """Why a transition across a ring cannot be, or None."""
    if inner >= outer:
        return "outer must be above inner"
    return ease_requirement(ease)


TRANSITION_LINEAR = operator(
    "transition linear",
    combine=transition_linear,
    mix=transition_linear_mix,
    slope=transition_linear_slope,
    requires=way_requirement,
    needs="shapes with an end: without a box their values can be any distance apart",
    growth=Growth.KEPT,
)
TRANSITION_RADIAL = operator(
    "transition radial",
    combine=transition_radial,
    mix=transition_radial_mix,
    slope=transition_radial_slope,
    limits={"inner": Limit.NOT_NEGATIVE},
    requires=ring_requirement,
    needs="shapes with an end: without a box their values can be any distance apart",
    growth=Growth.KEPT,
)
