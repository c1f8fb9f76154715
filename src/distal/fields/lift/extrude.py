"""Extrusion of flat shapes to solids: straight, twisted, tapered, and lofts between two outlines.

Input: the distance of a flat shape, the point, and the shape's bounds. Output: the distance of the
solid, and the rules for its slope and box. The flat shape lies in the xy plane; the solid extends
along z, its middle at z = 0.
"""

from __future__ import annotations

from distal.fields.constants import HALF_ROOT, TINY
from distal.fields.ease import ease_requirement, ease_slope, eased
from distal.fields.extents import (
    at_least_one,
    hull_of,
    reach_flat,
    rectangle_distance,
    unless_endless,
)
from distal.fields.flats.edges import inside_both
from distal.fields.guarantees import EXACT, UNBOUNDED, Bounds, Bounds2, Growth, Limit, operator
from distal.fields.widths import deformed_width, extruded_width
from distal.lang import abs, clamp, cos, func, length, max, min, mix, sin, sqrt, vec2, vec3

ENDED = "a flat shape with an end: without a box its slope grows without end"


@func
def flat_point(p: vec3) -> vec2:
    """Return the projection of the point along z."""
    return p.xy


@func
def extruded(d: float, p: vec3, height: float) -> float:
    """Return the distance to the extruded outline; exact if that of the outline is.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).
    """
    return inside_both(d, abs(p.z) - 0.5 * height)


@func
def extruded_bounds(bounds: Bounds2, height: float) -> Bounds:
    """Return the box from end to end."""
    half = 0.5 * height
    return Bounds(vec3(bounds.low, -half), vec3(bounds.high, half))


@func
def endless_bounds(bounds: Bounds2) -> Bounds:
    """Return the box of an outline extruded without end."""
    return Bounds(vec3(bounds.low, -UNBOUNDED), vec3(bounds.high, UNBOUNDED))


@func
def rounded_extruded(d: float, p: vec3, height: float, radius: float) -> float:
    """Return ``extruded`` with rounded edges; outline and ends do not move."""
    return inside_both(d + radius, abs(p.z) - 0.5 * height + radius) - radius


@func
def chamfered_extruded(d: float, p: vec3, height: float, chamfer: float) -> float:
    """Return ``extruded`` with edges chamfered at 45 degrees; outline and ends do not move."""
    past_end = abs(p.z) - 0.5 * height
    return max(inside_both(d, past_end), HALF_ROOT * (d + past_end + chamfer))


@func
def progress(p: vec3, height: float) -> float:
    """Return the position between the lower and the upper end, clamped to 0 to 1."""
    return clamp(p.z / height + 0.5, 0.0, 1.0)


@func
def circle_around(bounds: Bounds2) -> float:
    """Return the radius of the circle about the origin that contains a rectangle."""
    return length(reach_flat(bounds))


@func
def within_circle(q: vec2, radius: float) -> vec2:
    """Return the nearest point in a circle; points outside it are not evaluated."""
    return q * min(1.0, radius / max(length(q), TINY))


@func
def turn_at(p: vec3, height: float, angle: float) -> float:
    """Return the rotation of the outline at the height of ``p``; constant beyond the ends."""
    return angle * (progress(p, height) - 0.5)


@func
def twisted(p: vec3, height: float, angle: float, bounds: Bounds2) -> vec2:
    """Return the point in the outline, with the rotation undone."""
    turn = turn_at(p, height, angle)
    c = cos(turn)
    s = sin(turn)
    q = vec2(c * p.x + s * p.y, c * p.y - s * p.x)
    return within_circle(q, circle_around(bounds))


@func
def twisted_value(d: float, p: vec3, height: float, bounds: Bounds2) -> float:
    """Return the extruded value; at least the distance to the circle around the outline."""
    return extruded(max(d, length(p.xy) - circle_around(bounds)), p, height)


@func
def twisted_slope(slope: float, bounds: Bounds2, height: float, angle: float) -> float:
    """Return the slope, from the largest singular value of a shear s: (s + sqrt(s^2 + 4)) / 2.

    s grows with the radius.
    """
    radius = circle_around(bounds)
    shear = abs(angle) * radius / height
    return unless_endless(radius, max(slope * 0.5 * (shear + sqrt(shear * shear + 4.0)), 1.0))


@func
def twisted_bounds(bounds: Bounds2, height: float) -> Bounds:
    """Return the box of the circle around the outline, from end to end."""
    radius = circle_around(bounds)
    return extruded_bounds(Bounds2(vec2(-radius), vec2(radius)), height)


@func
def size_at(p: vec3, height: float, top: float) -> float:
    """Return the scale of the outline at the height of ``p``; constant beyond the ends."""
    return mix(1.0, top, progress(p, height))


@func
def both_ends(bounds: Bounds2, top: float) -> Bounds2:
    """Return the rectangle around the lower and the upper end."""
    return hull_of(bounds, Bounds2(top * bounds.low, top * bounds.high))


@func
def tapered(p: vec3, height: float, top: float, bounds: Bounds2) -> vec2:
    """Return the point in the outline, with the scale undone."""
    return within_circle(p.xy / size_at(p, height, top), circle_around(bounds))


@func
def tapered_value(
    d: float, p: vec3, height: float, top: float, bounds: Bounds2, slope: float
) -> float:
    """Return the extruded value, limited where it would increase the slope.

    It is at least the distance to the box. With s the scale at a height and R the radius of the
    circle around the outline, the derivative of s d(q / s) by s is d - q . grad d, at most R slope
    plus the value itself.
    """
    radius = circle_around(bounds)
    scale = size_at(p, height, top)
    limit = 0.5 * radius * slope
    near = scale * clamp(d, -limit, limit)
    wall = max(length(p.xy) - scale * radius, rectangle_distance(p.xy, both_ends(bounds, top)))
    return extruded(max(near, wall), p, height)


@func
def tapered_slope(slope: float, bounds: Bounds2, height: float, top: float) -> float:
    """Return the outline's slope, combined with the lean of its sides; see ``tapered_value``."""
    radius = circle_around(bounds)
    lean = abs(top - 1.0) * radius / height
    sides = slope * sqrt(1.0 + 2.25 * lean * lean)
    return unless_endless(radius, max(sides, sqrt(1.0 + lean * lean)))


@func
def tapered_bounds(bounds: Bounds2, height: float, top: float) -> Bounds:
    """Return the box around both ends."""
    return extruded_bounds(both_ends(bounds, top), height)


@func
def flat_most_apart(bounds_a: Bounds2, bounds_b: Bounds2, slope_a: float, slope_b: float) -> float:
    """Return a bound on the difference of two outlines' values in the rectangle around both."""
    around = hull_of(bounds_a, bounds_b)
    return max(slope_a, slope_b) * length(around.high - around.low)


@func
def lofted(
    a: float,
    b: float,
    p: vec3,
    height: float,
    bounds_a: Bounds2,
    bounds_b: Bounds2,
    slope_a: float,
    slope_b: float,
    ease: int = 0,
) -> float:
    """Interpolate between an outline at the lower end and another at the upper end.

    The difference of the values is limited to its bound at the outlines; farther out, where both
    are positive, the result stays positive.
    """
    limit = flat_most_apart(bounds_a, bounds_b, slope_a, slope_b)
    return a + eased(progress(p, height), ease) * clamp(b - a, -limit, limit)


@func
def lofted_mix(a: float, b: float, p: vec3, height: float, ease: int = 0) -> float:
    """Return the share of ``b``."""
    return eased(progress(p, height), ease)


@func
def lofted_slope(
    slope_a: float,
    slope_b: float,
    bounds_a: Bounds2,
    bounds_b: Bounds2,
    height: float,
    ease: int = 0,
) -> float:
    """Return the slope.

    Across z it is a mean of both slopes; along z, perpendicular to that, it is the rate at which
    the mean changes.
    """
    limit = flat_most_apart(bounds_a, bounds_b, slope_a, slope_b)
    rise = ease_slope(ease) * limit / height
    across = max(slope_a, slope_b)
    return unless_endless(limit, max(sqrt(across * across + rise * rise), 1.0))


@func
def lofted_bounds(bounds_a: Bounds2, bounds_b: Bounds2, height: float) -> Bounds:
    """Return the box around both outlines, from end to end."""
    return extruded_bounds(hull_of(bounds_a, bounds_b), height)


def edges_requirement(height: float, radius: float) -> str | None:
    """Return why the rounding is too large, or None."""
    return "radius may be at most half of height" if 2.0 * radius > height else None


def bevels_requirement(height: float, chamfer: float) -> str | None:
    """Return why the chamfer is too large, or None."""
    return "chamfer may be at most half of height" if 2.0 * chamfer > height else None


def loft_requirement(height: float, ease: int) -> str | None:
    """Return why a loft is invalid, or None."""
    return ease_requirement(ease)


EXTRUDE = operator(
    "extrude",
    point=flat_point,
    finish=extruded,
    keeps=EXACT,
    along="z",
    slope=at_least_one,
    bounds=extruded_bounds,
    limits={"height": Limit.POSITIVE},
    growth=Growth.KEPT,
    width=extruded_width,
)
EXTRUDE_ENDLESS = operator(
    "extrude endless",
    point=flat_point,
    keeps=EXACT,
    along="z",
    bounds=endless_bounds,
    growth=Growth.KEPT,
)
EXTRUDE_ROUNDED = operator(
    "extrude rounded",
    point=flat_point,
    finish=rounded_extruded,
    slope=at_least_one,
    bounds=extruded_bounds,
    limits={"height": Limit.POSITIVE, "radius": Limit.NOT_NEGATIVE},
    requires=edges_requirement,
    growth=Growth.KEPT,
    width=extruded_width,
)
EXTRUDE_CHAMFERED = operator(
    "extrude chamfered",
    point=flat_point,
    finish=chamfered_extruded,
    slope=at_least_one,
    bounds=extruded_bounds,
    limits={"height": Limit.POSITIVE, "chamfer": Limit.NOT_NEGATIVE},
    requires=bevels_requirement,
    growth=Growth.KEPT,
    width=extruded_width,
)
EXTRUDE_TWISTED = operator(
    "extrude twisted",
    point=twisted,
    finish=twisted_value,
    slope=twisted_slope,
    bounds=twisted_bounds,
    limits={"height": Limit.POSITIVE},
    needs=ENDED,
    growth=Growth.HELD,
    width=deformed_width,
)
EXTRUDE_TAPERED = operator(
    "extrude tapered",
    point=tapered,
    finish=tapered_value,
    slope=tapered_slope,
    bounds=tapered_bounds,
    limits={"height": Limit.POSITIVE, "top": Limit.POSITIVE},
    needs=ENDED,
    growth=Growth.HELD,
    width=extruded_width,
)
LOFT = operator(
    "loft",
    point=flat_point,
    combine=lofted,
    finish=extruded,
    mix=lofted_mix,
    slope=lofted_slope,
    bounds=lofted_bounds,
    limits={"height": Limit.POSITIVE},
    requires=loft_requirement,
    needs=ENDED,
    growth=Growth.KEPT,
    width=extruded_width,
)
