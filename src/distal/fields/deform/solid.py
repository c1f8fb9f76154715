"""Solids bent out of shape: elongated, twisted, bent, tapered, wrapped, attracted, shaken by noise.

Input: a point, the numbers of the deformation, the child's box. Output: the point
to ask the child at, the slope that the deformation makes of the child's, the box of the result.

The slope of a deformed shape is the child's times how far the map of points takes two points apart,
its largest singular value. Where that grows with the distance from an axis, points farther out than
the child's box are first moved in to its radius, which takes no two apart. What is lost by that the
finish gives back: a deformed shape answers at least the distance to the drum of that radius, which
holds it (where the surface touches the drum, places moved in would else be on the surface too). A
child without end in such a direction has no slope (``UNBOUNDED``) and is refused.
"""

from __future__ import annotations

from distal.fields.ease import ease_requirement, ease_slope, eased
from distal.fields.extents import box_distance, drum_distance, reach, unless_endless
from distal.fields.guarantees import LOWER_BOUND, Bounds, Growth, Limit, operator
from distal.fields.place.solid import rotated_y
from distal.lang import abs, clamp, cos, dot, func, length, max, min, mix, sin, sqrt, vec2, vec3


@func
def largest_of_two(a: float, b: float, c: float, d: float) -> float:
    """The larger singular value of the matrix with rows (a, b) and (c, d)."""
    return 0.5 * (length(vec2(a + d, b - c)) + length(vec2(a - d, b + c)))


@func
def shear_stretch(shear: float) -> float:
    """How far a shear takes two points apart: s and sqrt(s^2 + 4), halved."""
    return 0.5 * (abs(shear) + sqrt(shear * shear + 4.0))


@func
def radius_of(v: vec2) -> float:
    """The length of ``v``; infinite lengths stay so."""
    return unless_endless(max(v.x, v.y), length(v))


@func
def moved_in(v: vec2, radius: float) -> vec2:
    """The nearest point of a disc."""
    return v * min(radius / max(length(v), 1e-12), 1.0)


# Elongated


@func
def elongated(p: vec3, lengths: vec3) -> vec3:
    """The place before the shape was cut in the middle and its halves were moved apart.

    Source: Inigo Quilez, "Distance functions" (elongation).
    """
    return p - clamp(p, -0.5 * lengths, 0.5 * lengths)


@func
def elongated_bounds(bounds: Bounds, lengths: vec3) -> Bounds:
    """The box, larger by half the lengths on each side."""
    return Bounds(bounds.low - 0.5 * lengths, bounds.high + 0.5 * lengths)


# Twisted about y


@func
def around_y(bounds: Bounds) -> float:
    """How far a box reaches from the y axis."""
    return radius_of(reach(bounds).xz)


@func
def twisted(p: vec3, rate: float, bounds: Bounds) -> vec3:
    """The place before a turn about the y axis by ``rate`` for each unit of height."""
    q = moved_in(p.xz, around_y(bounds))
    return rotated_y(vec3(q.x, p.y, q.y), rate * p.y)


@func
def twisted_bounds(bounds: Bounds) -> Bounds:
    """As far around as the box reaches."""
    r = around_y(bounds)
    return Bounds(vec3(-r, bounds.low.y, -r), vec3(r, bounds.high.y, r))


@func
def twisted_value(d: float, p: vec3, bounds: Bounds) -> float:
    """At least the distance to the drum."""
    drum = drum_distance(length(p.xz), p.y, around_y(bounds), bounds.low.y, bounds.high.y)
    return max(d, drum)


@func
def twisted_slope(slope: float, bounds: Bounds, rate: float) -> float:
    """A step up the axis is a step of ``rate`` times the radius across it: a shear."""
    r = around_y(bounds)
    return unless_endless(r, max(slope * shear_stretch(rate * r), 1.0))


# Bent about z


@func
def around_z(bounds: Bounds) -> float:
    """How far a box reaches from the z axis."""
    return radius_of(reach(bounds).xy)


@func
def bent(p: vec3, rate: float, bounds: Bounds) -> vec3:
    """The place before a turn about the z axis by ``rate`` for each unit along x: ends go up.

    Source: Inigo Quilez, "Distance functions" (cheap bend).
    """
    q = moved_in(p.xy, around_z(bounds))
    c, s = cos(rate * q.x), sin(rate * q.x)
    return vec3(c * q.x + s * q.y, c * q.y - s * q.x, p.z)


@func
def bent_bounds(bounds: Bounds) -> Bounds:
    """As far around as the box reaches."""
    r = around_z(bounds)
    return Bounds(vec3(-r, -r, bounds.low.z), vec3(r, r, bounds.high.z))


@func
def bent_value(d: float, p: vec3, bounds: Bounds) -> float:
    """At least the distance to the drum."""
    drum = drum_distance(length(p.xy), p.z, around_z(bounds), bounds.low.z, bounds.high.z)
    return max(d, drum)


@func
def bent_slope(slope: float, bounds: Bounds, rate: float) -> float:
    """A turn that changes along the plane it turns: 1 and the rate times the radius."""
    r = around_z(bounds)
    return unless_endless(r, max(slope * (1.0 + abs(rate) * r), 1.0))


# Bent along a line, and up around an axis


@func
def bent_linear(p: vec3, start: vec3, end: vec3, shift: vec3, ease: int = 1) -> vec3:
    """The place before all beyond ``end`` was moved by ``shift``, and all before ``start`` not."""
    way = end - start
    return p - shift * eased(dot(p - start, way) / dot(way, way), ease)


@func
def bent_linear_bounds(bounds: Bounds, shift: vec3) -> Bounds:
    """The box, and the box moved."""
    return Bounds(bounds.low + min(shift, vec3(0.0)), bounds.high + max(shift, vec3(0.0)))


@func
def bent_linear_value(d: float, p: vec3, shift: vec3, bounds: Bounds) -> float:
    """At least the distance to the box."""
    return max(d, box_distance(p, bent_linear_bounds(bounds, shift)))


@func
def bent_linear_slope(slope: float, start: vec3, end: vec3, shift: vec3, ease: int = 1) -> float:
    """In the plane of the way and the shift: what the shift does along the way, and across it.

    The stretch is convex in how steep the ease is, so it is largest at one end.
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
    """The place before all beyond ``outer`` of the y axis was raised, and all within ``inner`` not.

    A brim: the shape climbs by ``rise`` on the way out.
    """
    return p - vec3(0.0, rise * eased((length(p.xz) - inner) / (outer - inner), ease), 0.0)


@func
def bent_radial_bounds(bounds: Bounds, rise: float) -> Bounds:
    """The box, and the box raised."""
    return bent_linear_bounds(bounds, vec3(0.0, rise, 0.0))


@func
def bent_radial_value(d: float, p: vec3, rise: float, bounds: Bounds) -> float:
    """At least the distance to the box."""
    return max(d, box_distance(p, bent_radial_bounds(bounds, rise)))


@func
def bent_radial_slope(
    slope: float, inner: float, outer: float, rise: float, ease: int = 1
) -> float:
    """A shear along the radius."""
    return max(slope, 1.0) * shear_stretch(rise * ease_slope(ease) / (outer - inner))


# Tapered along y


@func
def taper_factor(y: float, bottom: float, top: float, factor: float) -> float:
    """1 up to ``bottom``, ``factor`` from ``top`` on."""
    return mix(1.0, factor, clamp((y - bottom) / (top - bottom), 0.0, 1.0))


@func
def tapered(p: vec3, bottom: float, top: float, factor: float, bounds: Bounds) -> vec3:
    """The place before the cross-section was scaled, by 1 at ``bottom``, ``factor`` at ``top``."""
    q = moved_in(p.xz / taper_factor(p.y, bottom, top, factor), around_y(bounds))
    return vec3(q.x, p.y, q.y)


@func
def tapered_bounds(bounds: Bounds, factor: float) -> Bounds:
    """The box around the box and the box scaled."""
    scale = vec3(factor, 1.0, factor)
    return Bounds(min(bounds.low, bounds.low * scale), max(bounds.high, bounds.high * scale))


@func
def tapered_value(
    d: float, p: vec3, bottom: float, top: float, factor: float, bounds: Bounds
) -> float:
    """At least the distance to the box, and to the drum, tapered too: its wall leans."""
    r = around_y(bounds)
    lean = r * (factor - 1.0) / (top - bottom)
    wall = length(p.xz) - r * taper_factor(p.y, bottom, top, factor)
    wall /= sqrt(1.0 + lean * lean)
    return max(max(d, wall), box_distance(p, tapered_bounds(bounds, factor)))


@func
def tapered_slope(slope: float, bounds: Bounds, bottom: float, top: float, factor: float) -> float:
    """Across it is the factor's inverse; up it, how fast a place at the edge of the box moves."""
    r = around_y(bounds)
    narrow = 1.0 / min(factor, 1.0)
    drift = r * abs(factor - 1.0) / (top - bottom) * narrow
    return unless_endless(r, max(slope * largest_of_two(narrow, drift, 0.0, 1.0), 1.0))


# Attracted to a point, or repelled


@func
def attracted(p: vec3, center: vec3, radius: float, strength: float) -> vec3:
    """The place before everything within ``radius`` was drawn toward ``center``.

    By (1 - t^2)^2 of ``strength``, t the share of the radius.
    """
    away = p - center
    rest = max(1.0 - dot(away, away) / (radius * radius), 0.0)
    return p + away * (strength * rest * rest)


@func
def repelled(p: vec3, center: vec3, radius: float, strength: float) -> vec3:
    """The place before everything within ``radius`` was pushed away from ``center``."""
    return attracted(p, center, radius, -strength)


@func
def attracted_bounds(bounds: Bounds, radius: float, strength: float) -> Bounds:
    """No place moves farther than t(1 - t^2)^2 at its highest, for t = sqrt(1/5)."""
    most = 0.28622 * radius * abs(strength)
    return Bounds(bounds.low - most, bounds.high + most)


@func
def attracted_value(d: float, p: vec3, radius: float, strength: float, bounds: Bounds) -> float:
    """At least the distance to the box."""
    return max(d, box_distance(p, attracted_bounds(bounds, radius, strength)))


@func
def attracted_slope(slope: float, strength: float) -> float:
    """In the middle 1 + strength; along the radius never beyond that."""
    return max(slope, 1.0) * (1.0 + strength)


@func
def repelled_slope(slope: float, strength: float) -> float:
    """Along the radius 1 - strength (1 - 6t^2 + 5t^4), whose least value is -0.8 at t^2 = 0.6."""
    return max(slope, 1.0) * (1.0 + 0.8 * strength)


def way_requirement(start: tuple[float, ...], end: tuple[float, ...], ease: int = 1) -> str | None:
    """Why there is no way from start to end, or None."""
    if tuple(start) == tuple(end):
        return "start and end must be different points"
    return ease_requirement(ease)


def ring_requirement(inner: float, outer: float, ease: int = 1) -> str | None:
    """Why there is no ring between two radii, or None."""
    if inner >= outer:
        return "outer must be above inner"
    return ease_requirement(ease)


def taper_requirement(bottom: float, top: float) -> str | None:
    """Why nothing lies between bottom and top, or None."""
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
)
BEND = operator(
    "bend",
    point=bent,
    finish=bent_value,
    slope=bent_slope,
    bounds=bent_bounds,
    needs="a shape that ends around the z axis: the farther out, the steeper it would get",
    growth=Growth.HELD,
)
BEND_LINEAR = operator(
    "bend linear",
    point=bent_linear,
    finish=bent_linear_value,
    slope=bent_linear_slope,
    bounds=bent_linear_bounds,
    requires=way_requirement,
    growth=Growth.HELD,
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
)
ATTRACT = operator(
    "attract",
    point=attracted,
    finish=attracted_value,
    slope=attracted_slope,
    bounds=attracted_bounds,
    limits={"radius": Limit.POSITIVE, "strength": Limit.NOT_NEGATIVE},
    growth=Growth.HELD,
)
REPEL = operator(
    "repel",
    point=repelled,
    finish=attracted_value,
    slope=repelled_slope,
    bounds=attracted_bounds,
    limits={"radius": Limit.POSITIVE, "strength": Limit.FRACTION},
    growth=Growth.HELD,
)
