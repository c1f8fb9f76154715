"""Gradual transitions from one shape to another: a morph whose progress depends on the point.

Input: two distances, the point, the children's boxes and slopes. Output: the interpolated distance,
and the rules for its slope and material.
"""

from __future__ import annotations

from distal.fields.ease import ease_requirement, ease_slope, eased
from distal.fields.extents import diameter, hull_of
from distal.fields.guarantees import ENDLESS, Bounds, Growth, Limit, operator
from distal.lang import clamp, dot, func, length, max, min, mix, select, vec3


@func
def most_apart(bounds_a: Bounds, bounds_b: Bounds, slope_a: float, slope_b: float) -> float:
    """Return a bound on the difference of two shapes' values within the box around both.

    Each value is 0 somewhere in the box, so within it neither exceeds slope times diagonal.
    """
    return max(slope_a, slope_b) * diameter(hull_of(bounds_a, bounds_b))


@func
def transition(
    a: float,
    b: float,
    t: float,
    way: float,
    bounds_a: Bounds,
    bounds_b: Bounds,
    slope_a: float,
    slope_b: float,
) -> float:
    """Interpolate between two shapes by ``t``, which changes within a length ``way``.

    The difference of finite shapes' values is limited to its bound at the surfaces; farther out,
    where both are positive, the result stays positive. Values of infinite shapes differ without
    limit: both are cut off at what they can reach within ``way``, and the result stays between
    them. So the surface is that of the first shape before the way, and of the second beyond it.
    """
    limit = most_apart(bounds_a, bounds_b, slope_a, slope_b)
    if limit > ENDLESS:
        most = max(slope_a, slope_b) * way
        within = mix(clamp(a, -most, most), clamp(b, -most, most), t)
        return clamp(within, min(a, b), max(a, b))
    return a + t * clamp(b - a, -limit, limit)


@func
def transition_slope(
    rise: float, way: float, bounds_a: Bounds, bounds_b: Bounds, slope_a: float, slope_b: float
) -> float:
    """Return a mean of both slopes plus the slope of ``t`` times the difference of values.

    ``rise`` is the slope of ``t`` times ``way``.
    """
    limit = most_apart(bounds_a, bounds_b, slope_a, slope_b)
    slope = max(slope_a, slope_b)
    return slope + rise * select(limit > ENDLESS, 2.0 * slope, limit / way)


@func
def linear_progress(p: vec3, start: vec3, end: vec3, ease: int) -> float:
    """Return the eased progress of ``p`` from ``start`` to ``end``."""
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
    """Return the first shape before the point ``start``, the second beyond ``end``."""
    t = linear_progress(p, start, end, ease)
    return transition(a, b, t, length(end - start), bounds_a, bounds_b, slope_a, slope_b)


@func
def transition_linear_mix(
    a: float, b: float, p: vec3, start: vec3, end: vec3, ease: int = 1
) -> float:
    """Return the share of ``b``."""
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
    """Return the slope; it is larger for a shorter distance from start to end."""
    way = length(end - start)
    return transition_slope(ease_slope(ease), way, bounds_a, bounds_b, slope_a, slope_b)


@func
def radial_progress(p: vec3, inner: float, outer: float, ease: int) -> float:
    """Return the eased progress of ``p`` between two radii about the y axis."""
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
    """Return the first shape within ``inner`` of the y axis, the second beyond ``outer``."""
    t = radial_progress(p, inner, outer, ease)
    return transition(a, b, t, outer - inner, bounds_a, bounds_b, slope_a, slope_b)


@func
def transition_radial_mix(
    a: float, b: float, p: vec3, inner: float, outer: float, ease: int = 1
) -> float:
    """Return the share of ``b``."""
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
    """Return the slope; it is larger for a narrower ring."""
    return transition_slope(ease_slope(ease), outer - inner, bounds_a, bounds_b, slope_a, slope_b)


def way_requirement(
    start: tuple[float, float, float], end: tuple[float, float, float], ease: int
) -> str | None:
    """Return why a linear transition is invalid, or None."""
    if tuple(start) == tuple(end):
        return "start and end must be different points"
    return ease_requirement(ease)


def ring_requirement(inner: float, outer: float, ease: int) -> str | None:
    """Return why a radial transition is invalid, or None."""
    if inner >= outer:
        return "outer must be above inner"
    return ease_requirement(ease)


TRANSITION_LINEAR = operator(
    "transition linear",
    combine=transition_linear,
    mix=transition_linear_mix,
    slope=transition_linear_slope,
    requires=way_requirement,
    growth=Growth.KEPT,
)
TRANSITION_RADIAL = operator(
    "transition radial",
    combine=transition_radial,
    mix=transition_radial_mix,
    slope=transition_radial_slope,
    limits={"inner": Limit.NOT_NEGATIVE},
    requires=ring_requirement,
    growth=Growth.KEPT,
)
