"""Deformations of solids: elongated, twisted, bent, tapered, attracted, repelled.

Input: a point, the numbers of the deformation, the child's box. Output: the point at which the
child is evaluated, the slope of the result, the box of the result.

The slope of a deformed shape is the child's times the largest stretch of the map of points (its
largest singular value). If the stretch grows with the distance from an axis, points farther out
than the child's box are first moved to the box's radius, which increases no distance. The
operator's ``finish`` compensates for this: the value is at least the distance to the cylinder of
this radius, which contains the shape (otherwise, where the surface touches the cylinder, moved
points would be on the surface too). A child that is infinite in such a direction has no slope
(``UNBOUNDED``) and is refused.
"""

from __future__ import annotations

from distal.fields.ease import ease_requirement, ease_slope, eased
from distal.fields.extents import box_distance, drum_distance, reach, unless_endless
from distal.fields.guarantees import LOWER_BOUND, Bounds, Growth, Limit, operator
from distal.fields.place.solid import rotated_y
from distal.fields.widths import deformed_width
from distal.lang import abs, clamp, cos, dot, func, length, max, min, mix, sin, sqrt, vec2, vec3


@func
def largest_of_two(a: float, b: float, c: float, d: float) -> float:
    """Return the larger singular value of the matrix with rows (a, b) and (c, d)."""
    return 0.5 * (length(vec2(a + d, b - c)) + length(vec2(a - d, b + c)))


@func
def shear_stretch(shear: float) -> float:
    """Return the largest stretch of a shear s: (s + sqrt(s^2 + 4)) / 2."""
    return 0.5 * (abs(shear) + sqrt(shear * shear + 4.0))


@func
def radius_of(v: vec2) -> float:
    """Return the length of ``v``; infinite lengths stay infinite."""
    return unless_endless(max(v.x, v.y), length(v))


@func
def moved_in(v: vec2, radius: float) -> vec2:
    """Return the nearest point of a disc."""
    return v * min(radius / max(length(v), 1e-12), 1.0)


# Elongation


@func
def elongated(p: vec3, lengths: vec3) -> vec3:
    """Return the point before the shape was cut in the middle and its halves moved apart.

    Source: Inigo Quilez, "Distance functions" (elongation).
    """
    return p - clamp(p, -0.5 * lengths, 0.5 * lengths)


@func
def elongated_bounds(bounds: Bounds, lengths: vec3) -> Bounds:
    """Return the box, enlarged by half of the lengths on each side."""
    return Bounds(bounds.low - 0.5 * lengths, bounds.high + 0.5 * lengths)


# Twist about y


@func
def around_y(bounds: Bounds) -> float:
    """Return the largest distance of a box from the y axis."""
    return radius_of(reach(bounds).xz)


@func
def twisted(p: vec3, rate: float, bounds: Bounds) -> vec3:
    """Return the point before a rotation about the y axis by ``rate`` per unit of height."""
    q = moved_in(p.xz, around_y(bounds))
    return rotated_y(vec3(q.x, p.y, q.y), rate * p.y)


@func
def twisted_bounds(bounds: Bounds) -> Bounds:
    """Return the box of the cylinder about the y axis that contains the box."""
    r = around_y(bounds)
    return Bounds(vec3(-r, bounds.low.y, -r), vec3(r, bounds.high.y, r))


@func
def twisted_value(d: float, p: vec3, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the cylinder around the shape."""
    drum = drum_distance(length(p.xz), p.y, around_y(bounds), bounds.low.y, bounds.high.y)
    return max(d, drum)


@func
def twisted_slope(slope: float, bounds: Bounds, rate: float) -> float:
    """Return the slope of a shear: a step along the axis moves a point by ``rate`` times radius."""
    r = around_y(bounds)
    return unless_endless(r, max(slope * shear_stretch(rate * r), 1.0))


# Bend about z


@func
def around_z(bounds: Bounds) -> float:
    """Return the largest distance of a box from the z axis."""
    return radius_of(reach(bounds).xy)


@func
def bent(p: vec3, rate: float, bounds: Bounds) -> vec3:
    """Return the point before a rotation about the z axis by ``rate`` per unit of x: ends go up.

    Source: Inigo Quilez, "Distance functions" (cheap bend).
    """
    q = moved_in(p.xy, around_z(bounds))
    c, s = cos(rate * q.x), sin(rate * q.x)
    return vec3(c * q.x + s * q.y, c * q.y - s * q.x, p.z)


@func
def bent_bounds(bounds: Bounds) -> Bounds:
    """Return the box of the cylinder about the z axis that contains the box."""
    r = around_z(bounds)
    return Bounds(vec3(-r, -r, bounds.low.z), vec3(r, r, bounds.high.z))


@func
def bent_value(d: float, p: vec3, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the cylinder around the shape."""
    drum = drum_distance(length(p.xy), p.z, around_z(bounds), bounds.low.z, bounds.high.z)
    return max(d, drum)


@func
def bent_slope(slope: float, bounds: Bounds, rate: float) -> float:
    """Return the slope of a rotation whose angle changes in its plane: 1 plus rate times radius."""
    r = around_z(bounds)
    return unless_endless(r, max(slope * (1.0 + abs(rate) * r), 1.0))


# Bend along a line, and along the radius about the y axis


@func
def bent_linear(p: vec3, start: vec3, end: vec3, shift: vec3, ease: int = 1) -> vec3:
    """Return the point before the shift.

    The part beyond ``end`` moved by ``shift``, the part before ``start`` did not move.
    """
    way = end - start
    return p - shift * eased(dot(p - start, way) / dot(way, way), ease)


@func
def bent_linear_bounds(bounds: Bounds, shift: vec3) -> Bounds:
    """Return the box around the box and the shifted box."""
    return Bounds(bounds.low + min(shift, vec3(0.0)), bounds.high + max(shift, vec3(0.0)))


@func
def bent_linear_value(d: float, p: vec3, shift: vec3, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the box."""
    return max(d, box_distance(p, bent_linear_bounds(bounds, shift)))


@func
def bent_linear_slope(slope: float, start: vec3, end: vec3, shift: vec3, ease: int = 1) -> float:
    """Return the slope in the plane of the line and the shift.

    It combines the part of the shift along the line and the part across it. The stretch is convex
    in the easing's derivative, so it is largest at one end of that range.
    """
    way = end - start
    size = length(way)
    rise = ease_slope(ease) / size
    along = dot(shift, way) / size
    across = length(shift - way * (along / size))
    steepest = largest_of_two(1.0 - rise * along, 0.0, rise * across, 1.0)
    return max(slope, 1.0) * max(steepest, 1.0)


@func
def bent_radial(p: vec3, inner: float, outer: float, rise: float, ease: int = 1) -> vec3:
    """Return the point before the part beyond ``outer`` was raised by ``rise``.

    Radii are distances from the y axis; the part within ``inner`` did not move.
    """
    return p - vec3(0.0, rise * eased((length(p.xz) - inner) / (outer - inner), ease), 0.0)


@func
def bent_radial_bounds(bounds: Bounds, rise: float) -> Bounds:
    """Return the box around the box and the raised box."""
    return bent_linear_bounds(bounds, vec3(0.0, rise, 0.0))


@func
def bent_radial_value(d: float, p: vec3, rise: float, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the box."""
    return max(d, box_distance(p, bent_radial_bounds(bounds, rise)))


@func
def bent_radial_slope(
    slope: float, inner: float, outer: float, rise: float, ease: int = 1
) -> float:
    """Return the slope of a shear along the radius."""
    return max(slope, 1.0) * shear_stretch(rise * ease_slope(ease) / (outer - inner))


# Taper along y


@func
def taper_factor(y: float, bottom: float, top: float, factor: float) -> float:
    """Return the scale at a height: 1 up to ``bottom``, ``factor`` from ``top`` on."""
    return mix(1.0, factor, clamp((y - bottom) / (top - bottom), 0.0, 1.0))


@func
def tapered(p: vec3, bottom: float, top: float, factor: float, bounds: Bounds) -> vec3:
    """Return the point before scaling across y: by 1 at ``bottom``, by ``factor`` at ``top``."""
    q = moved_in(p.xz / taper_factor(p.y, bottom, top, factor), around_y(bounds))
    return vec3(q.x, p.y, q.y)


@func
def tapered_bounds(bounds: Bounds, factor: float) -> Bounds:
    """Return the box around the box and the scaled box."""
    scale = vec3(factor, 1.0, factor)
    return Bounds(min(bounds.low, bounds.low * scale), max(bounds.high, bounds.high * scale))


@func
def tapered_value(
    d: float, p: vec3, bottom: float, top: float, factor: float, bounds: Bounds
) -> float:
    """Return the value, but at least the distances to the box and to the tapered cylinder."""
    r = around_y(bounds)
    lean = r * (factor - 1.0) / (top - bottom)
    wall = length(p.xz) - r * taper_factor(p.y, bottom, top, factor)
    wall /= sqrt(1.0 + lean * lean)
    return max(max(d, wall), box_distance(p, tapered_bounds(bounds, factor)))


@func
def tapered_slope(slope: float, bounds: Bounds, bottom: float, top: float, factor: float) -> float:
    """Return the slope.

    Across the axis it is the inverse of the factor; along it, the speed of a point at the edge of
    the box.
    """
    r = around_y(bounds)
    narrow = 1.0 / min(factor, 1.0)
    drift = r * abs(factor - 1.0) / (top - bottom) * narrow
    return unless_endless(r, max(slope * largest_of_two(narrow, drift, 0.0, 1.0), 1.0))


# Attraction to a point, and repulsion


@func
def attracted(p: vec3, center: vec3, radius: float, strength: float) -> vec3:
    """Return the point before everything within ``radius`` was pulled towards ``center``.

    The pull is (1 - t^2)^2 times ``strength``, with t the distance as a fraction of the radius.
    """
    away = p - center
    rest = max(1.0 - dot(away, away) / (radius * radius), 0.0)
    return p + away * (strength * rest * rest)


@func
def repelled(p: vec3, center: vec3, radius: float, strength: float) -> vec3:
    """Return the point before everything within ``radius`` was pushed away from ``center``."""
    return attracted(p, center, radius, -strength)


@func
def attracted_bounds(bounds: Bounds, radius: float, strength: float) -> Bounds:
    """Return the box, enlarged by the largest shift: t(1 - t^2)^2 at t = sqrt(1/5)."""
    most = 0.28622 * radius * abs(strength)
    return Bounds(bounds.low - most, bounds.high + most)


@func
def attracted_value(d: float, p: vec3, radius: float, strength: float, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the box."""
    return max(d, box_distance(p, attracted_bounds(bounds, radius, strength)))


@func
def attracted_slope(slope: float, strength: float) -> float:
    """Return the slope: 1 + strength in the middle, and never more along the radius."""
    return max(slope, 1.0) * (1.0 + strength)


@func
def repelled_slope(slope: float, strength: float) -> float:
    """Return the slope.

    Along the radius it is 1 - strength (1 - 6t^2 + 5t^4), whose least bracket is -0.8 at t^2 = 0.6.
    """
    return max(slope, 1.0) * (1.0 + 0.8 * strength)


def way_requirement(start: tuple[float, ...], end: tuple[float, ...], ease: int = 1) -> str | None:
    """Return why start and end are invalid, or None."""
    if tuple(start) == tuple(end):
        return "start and end must be different points"
    return ease_requirement(ease)


def ring_requirement(inner: float, outer: float, ease: int = 1) -> str | None:
    """Return why two radii are invalid, or None."""
    if inner >= outer:
        return "outer must be above inner"
    return ease_requirement(ease)


def taper_requirement(bottom: float, top: float) -> str | None:
    """Return why bottom and top are invalid, or None."""
    return None if bottom < top else "top must be above bottom"


ELONGATE = operator(
    "elongate",
    point=elongated,
    keeps=LOWER_BOUND,
    bounds=elongated_bounds,
    limits={"lengths": Limit.NOT_NEGATIVE},
    growth=Growth.KEPT,
)
TWIST = operator(
    "twist",
    point=twisted,
    finish=twisted_value,
    slope=twisted_slope,
    bounds=twisted_bounds,
    needs="a shape that ends around the y axis: the farther out, the steeper it would get",
    growth=Growth.HELD,
    width=deformed_width,
)
BEND = operator(
    "bend",
    point=bent,
    finish=bent_value,
    slope=bent_slope,
    bounds=bent_bounds,
    needs="a shape that ends around the z axis: the farther out, the steeper it would get",
    growth=Growth.HELD,
    width=deformed_width,
)
BEND_LINEAR = operator(
    "bend linear",
    point=bent_linear,
    finish=bent_linear_value,
    slope=bent_linear_slope,
    bounds=bent_linear_bounds,
    requires=way_requirement,
    growth=Growth.HELD,
    width=deformed_width,
)
BEND_RADIAL = operator(
    "bend radial",
    point=bent_radial,
    finish=bent_radial_value,
    slope=bent_radial_slope,
    bounds=bent_radial_bounds,
    limits={"inner": Limit.NOT_NEGATIVE},
    requires=ring_requirement,
    growth=Growth.HELD,
    width=deformed_width,
)
TAPER = operator(
    "taper",
    point=tapered,
    finish=tapered_value,
    slope=tapered_slope,
    bounds=tapered_bounds,
    limits={"factor": Limit.POSITIVE},
    requires=taper_requirement,
    needs="a shape that ends around the y axis: the farther out, the steeper it would get",
    growth=Growth.HELD,
    width=deformed_width,
)
ATTRACT = operator(
    "attract",
    point=attracted,
    finish=attracted_value,
    slope=attracted_slope,
    bounds=attracted_bounds,
    limits={"radius": Limit.POSITIVE, "strength": Limit.NOT_NEGATIVE},
    growth=Growth.HELD,
    width=deformed_width,
)
REPEL = operator(
    "repel",
    point=repelled,
    finish=attracted_value,
    slope=repelled_slope,
    bounds=attracted_bounds,
    limits={"radius": Limit.POSITIVE, "strength": Limit.FRACTION},
    growth=Growth.HELD,
    width=deformed_width,
)
