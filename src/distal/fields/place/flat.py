"""Placement of flat shapes: translation, rotation, scaling, shear, mirror images, symmetry.

Input: a point of the plane, and the numbers of the placement. Output: the point at which the shape
is evaluated (the inverse placement of the given point), and the rectangle of the placed shape. The
counterparts for solids are ``solid`` and ``mirrors``.
"""

from __future__ import annotations

from typing import Final

from distal.fields.extents import at_least_one, hull_of, rectangle_distance, turned_flat
from distal.fields.guarantees import EXACT, LOWER_BOUND, NOTHING, Bounds2, Growth, Limit, operator
from distal.fields.ordering import larger_first
from distal.fields.place.mirrors import count_requirement, folded, reflected
from distal.fields.place.solid import same_direction, scaled_value
from distal.fields.widths import deformed_width, scaled_width, stretched_flat_width
from distal.lang import abs, cos, dot, func, length, mat2, max, min, sin, sqrt, vec2


@func
def translated_flat(p: vec2, offset: vec2) -> vec2:
    """Return the point before a translation by ``offset``."""
    return p - offset


@func
def same_direction_flat(p: vec2) -> vec2:
    """Return a direction before an operator that keeps all directions."""
    return p


@func
def translated_flat_bounds(bounds: Bounds2, offset: vec2) -> Bounds2:
    """Return the rectangle, translated."""
    return Bounds2(bounds.low + offset, bounds.high + offset)


@func
def turn_matrix(angle: float) -> mat2:
    """Return the matrix of a counterclockwise rotation."""
    c, s = cos(angle), sin(angle)
    return mat2(vec2(c, s), vec2(-s, c))


@func
def rotated_flat(p: vec2, angle: float) -> vec2:
    """Return the point before a counterclockwise rotation about the origin."""
    m = turn_matrix(angle)
    return vec2(dot(m[0], p), dot(m[1], p))


@func
def rotated_flat_bounds(bounds: Bounds2, angle: float) -> Bounds2:
    """Return the rectangle around the rotated rectangle."""
    return turned_flat(bounds, turn_matrix(angle))


@func
def scaled_flat(p: vec2, factor: float) -> vec2:
    """Return the point before scaling about the origin."""
    return p / factor


@func
def scaled_flat_bounds(bounds: Bounds2, factor: float) -> Bounds2:
    """Return the rectangle, scaled."""
    return Bounds2(bounds.low * factor, bounds.high * factor)


@func
def stretched_flat(p: vec2, factors: vec2) -> vec2:
    """Return the point before scaling each axis by its own factor."""
    return p / factors


@func
def stretched_flat_bounds(bounds: Bounds2, factors: vec2) -> Bounds2:
    """Return the rectangle, scaled."""
    return Bounds2(bounds.low * factors, bounds.high * factors)


@func
def stretched_flat_value(d: float, p: vec2, factors: vec2, bounds: Bounds2) -> float:
    """Return the distance times the smaller factor; at least that to the rectangle."""
    around = stretched_flat_bounds(bounds, factors)
    return max(d * min(factors.x, factors.y), rectangle_distance(p, around))


@func
def sheared_flat(p: vec2, xy: float) -> vec2:
    """Return the point before a shear that moves x by ``xy`` times y."""
    return vec2(p.x - xy * p.y, p.y)


@func
def sheared_flat_bounds(bounds: Bounds2, xy: float) -> Bounds2:
    """Return the rectangle around the sheared one."""
    return turned_flat(bounds, mat2(vec2(1.0, 0.0), vec2(xy, 1.0)))


@func
def sheared_flat_value(d: float, p: vec2, xy: float, bounds: Bounds2) -> float:
    """Return the value, but at least the distance to the rectangle."""
    return max(d, rectangle_distance(p, sheared_flat_bounds(bounds, xy)))


@func
def sheared_flat_slope(slope: float, xy: float) -> float:
    """Return the slope.

    The largest singular value of a shear is (|xy| + sqrt(xy^2 + 4)) / 2.
    """
    return max(slope * 0.5 * (abs(xy) + sqrt(xy * xy + 4.0)), 1.0)


@func
def reflected_flat(p: vec2, x: bool, y: bool) -> vec2:
    """Return the point before a reflection along the chosen axes."""
    q = p
    if x:
        q.x = -q.x
    if y:
        q.y = -q.y
    return q


@func
def reflected_flat_bounds(bounds: Bounds2, x: bool, y: bool) -> Bounds2:
    """Return the rectangle of the mirror image."""
    low, high = bounds.low, bounds.high
    if x:
        low.x, high.x = -bounds.high.x, -bounds.low.x
    if y:
        low.y, high.y = -bounds.high.y, -bounds.low.y
    return Bounds2(low, high)


@func
def reflected_flat_across(p: vec2, across: vec2, offset: float) -> vec2:
    """Return the point before a reflection in the line with the normal ``across``."""
    return p - across * (2.0 / dot(across, across) * (dot(p, across) - offset))


@func
def reflected_flat_direction(p: vec2, across: vec2) -> vec2:
    """Return the direction before a reflection in a line."""
    return reflected_flat_across(p, across, 0.0)


@func
def reflected_flat_across_bounds(bounds: Bounds2, across: vec2, offset: float) -> Bounds2:
    """Return the rectangle around the mirror image of the rectangle."""
    twice = across * (2.0 / dot(across, across))
    image = mat2(vec2(1.0, 0.0) - across.x * twice, vec2(0.0, 1.0) - across.y * twice)
    there = turned_flat(bounds, image)
    shift = twice * offset
    return Bounds2(there.low + shift, there.high + shift)


@func
def symmetric_flat_across(p: vec2, across: vec2, offset: float) -> vec2:
    """Mirror a point to the side of the line that its normal ``across`` points to."""
    return p - across * (2.0 * min(dot(p, across) - offset, 0.0))


@func
def symmetric_flat_across_bounds(bounds: Bounds2, across: vec2, offset: float) -> Bounds2:
    """Return the rectangle around the rectangle and its mirror image."""
    return hull_of(bounds, reflected_flat_across_bounds(bounds, across, offset))


@func
def symmetric_flat(p: vec2, x: bool, y: bool) -> vec2:
    """Mirror a point to the positive side of the chosen axes."""
    q = p
    if x:
        q.x = abs(q.x)
    if y:
        q.y = abs(q.y)
    return q


@func
def symmetric_flat_bounds(bounds: Bounds2, x: bool, y: bool) -> Bounds2:
    """Return the positive part of the rectangle and its mirror images."""
    both = max(bounds.high, vec2(0.0))
    low, high = bounds.low, bounds.high
    if x:
        low.x, high.x = -both.x, both.x
    if y:
        low.y, high.y = -both.y, both.y
    return Bounds2(low, high)


@func
def diagonal_flat(p: vec2) -> vec2:
    """Mirror a point to the side of the line x = y where x is larger."""
    return larger_first(p)


@func
def diagonal_flat_bounds(bounds: Bounds2) -> Bounds2:
    """Return the rectangle around the rectangle and its mirror image."""
    return hull_of(bounds, Bounds2(bounds.low.yx, bounds.high.yx))


@func
def octant_flat(p: vec2) -> vec2:
    """Mirror a point to the eighth of a turn between the x axis and the diagonal."""
    return larger_first(abs(p))


@func
def octant_flat_bounds(bounds: Bounds2) -> Bounds2:
    """Return the rectangle's part in this eighth and its mirror images."""
    side = max(bounds.high.x, 0.0)
    return Bounds2(vec2(-side), vec2(side))


@func
def kaleidoscope_flat(p: vec2, count: int) -> vec2:
    """Mirror a point to the wedge from the x axis to half of one of ``count`` sectors."""
    return folded(p, count)


@func
def kaleidoscope_flat_bounds(bounds: Bounds2) -> Bounds2:
    """Return the square around the circle about the origin that contains the rectangle."""
    side = length(max(abs(bounds.low), abs(bounds.high)))
    return Bounds2(vec2(-side), vec2(side))


# Of the rigid moves and scales (``Operator.turn``), those that turn no axis away from its line.
UPRIGHT_TURNS: Final = (same_direction, same_direction_flat, reflected, reflected_flat)


def axes_flat_requirement(x: bool, y: bool) -> str | None:
    """Return why no axis is chosen, or None."""
    return None if x or y else "name at least one axis"


TRANSLATE_FLAT = operator(
    "flat translate",
    point=translated_flat,
    keeps=EXACT,
    turn=same_direction_flat,
    linear=True,
    bounds=translated_flat_bounds,
    growth=Growth.KEPT,
)
ROTATE_FLAT = operator(
    "flat rotate",
    point=rotated_flat,
    keeps=EXACT,
    turn=rotated_flat,
    linear=True,
    bounds=rotated_flat_bounds,
    growth=Growth.TURNED,
)
SCALE_FLAT = operator(
    "flat scale",
    point=scaled_flat,
    finish=scaled_value,
    keeps=EXACT,
    turn=same_direction_flat,
    linear=True,
    bounds=scaled_flat_bounds,
    limits={"factor": Limit.POSITIVE},
    growth=Growth.KEPT,
    width=scaled_width,
)
STRETCH_FLAT = operator(
    "flat scale axes",
    point=stretched_flat,
    finish=stretched_flat_value,
    keeps=LOWER_BOUND,
    slope=at_least_one,
    bounds=stretched_flat_bounds,
    limits={"factors": Limit.POSITIVE},
    growth=Growth.HELD,
    width=stretched_flat_width,
)
SHEAR_FLAT = operator(
    "flat shear",
    point=sheared_flat,
    finish=sheared_flat_value,
    keeps=NOTHING,
    slope=sheared_flat_slope,
    bounds=sheared_flat_bounds,
    growth=Growth.HELD,
    width=deformed_width,
)
REFLECT_FLAT = operator(
    "flat mirror",
    point=reflected_flat,
    keeps=EXACT,
    turn=reflected_flat,
    linear=True,
    bounds=reflected_flat_bounds,
    requires=axes_flat_requirement,
    growth=Growth.KEPT,
)
REFLECT_ACROSS_FLAT = operator(
    "flat mirror across",
    point=reflected_flat_across,
    keeps=EXACT,
    turn=reflected_flat_direction,
    linear=True,
    bounds=reflected_flat_across_bounds,
    limits={"across": Limit.UNIT},
    growth=Growth.TURNED,
)
SYMMETRY_FLAT = operator(
    "flat symmetry",
    point=symmetric_flat,
    keeps=LOWER_BOUND,
    bounds=symmetric_flat_bounds,
    requires=axes_flat_requirement,
    growth=Growth.KEPT,
)
SYMMETRY_ACROSS_FLAT = operator(
    "flat symmetry across",
    point=symmetric_flat_across,
    keeps=LOWER_BOUND,
    bounds=symmetric_flat_across_bounds,
    limits={"across": Limit.UNIT},
    growth=Growth.TURNED,
)
SYMMETRY_DIAGONAL_FLAT = operator(
    "flat symmetry diagonal",
    point=diagonal_flat,
    keeps=LOWER_BOUND,
    bounds=diagonal_flat_bounds,
    growth=Growth.KEPT,
)
SYMMETRY_OCTANT_FLAT = operator(
    "flat symmetry octant",
    point=octant_flat,
    keeps=LOWER_BOUND,
    bounds=octant_flat_bounds,
    growth=Growth.CORNERED,
)
KALEIDOSCOPE_FLAT = operator(
    "flat kaleidoscope",
    point=kaleidoscope_flat,
    keeps=LOWER_BOUND,
    bounds=kaleidoscope_flat_bounds,
    requires=count_requirement,
    growth=Growth.TURNED,
)
