"""Discs, rings and their parts.

Input: a point and the numbers of a shape. Output: the distance, negative inside. An ``opening`` is
a whole angle in radians, half of it on either side of the y axis.
"""

from __future__ import annotations

import math

from distal.fields.constants import PI
from distal.fields.flats.edges import disc_bounds, turned_from
from distal.fields.guarantees import EXACT, Bounds2, Limit, primitive
from distal.fields.widths import (
    annulus_width,
    cut_width,
    radius_width,
    sector_width,
    thickness_width,
)
from distal.lang import abs, clamp, cos, dot, func, length, max, min, select, sin, sqrt, vec2


def _hole_is_left(radius: float, thickness: float) -> str | None:
    return "thickness may be at most twice the radius" if thickness > 2.0 * radius else None


def _less_than_a_turn(opening: float) -> str | None:
    return "opening must be below a whole turn, 2 pi" if opening >= math.tau else None


def _ends_are_apart(radius: float, thickness: float, opening: float) -> str | None:
    half = 0.5 * opening
    if half > 0.5 * math.pi and (half >= math.pi or 2.0 * radius * math.sin(half) < thickness):
        return "the round ends must not meet: take a smaller opening, or Annulus"
    return _hole_is_left(radius, thickness)


def _ring_is_open(radius: float, thickness: float, opening: float) -> str | None:
    return _less_than_a_turn(opening) or _hole_is_left(radius, thickness)


def _legs_are_apart(radius: float, legs: float, thickness: float, opening: float) -> str | None:
    half = 0.5 * opening
    inner = (radius - 0.5 * thickness) * math.sin(half)
    if half > 0.5 * math.pi and inner + legs * math.cos(half) < 0.0:
        return "the legs must not meet: take a smaller opening or shorter legs"
    return _ring_is_open(radius, thickness, opening)


def _cuts_the_disc(radius: float, height: float) -> str | None:
    if not -radius < height < radius:
        return "height must lie between -radius and radius"
    return None


@primitive(
    "Circle",
    EXACT,
    bounds=disc_bounds,
    width=radius_width,
)
@func
def circle(p: vec2, radius: float = 1.0) -> float:
    """Disc, centred at the origin.

    Args:
        p: Point.
        radius: Radius.

    Source: the definition of a circle.

    Measured:
        circle((3.0, 4.0), 1.0) = 4.0
        circle((0.0, 0.0), 2.0) = -2.0
        circle((0.0, -2.5), 2.5) = 0.0
    """
    return length(p) - radius


@func
def annulus_bounds(radius: float, thickness: float) -> Bounds2:
    """Return the square around the outer circle."""
    return disc_bounds(radius + 0.5 * thickness)


@primitive(
    "Annulus",
    EXACT,
    bounds=annulus_bounds,
    requires=_hole_is_left,
    width=annulus_width,
)
@func
def annulus(p: vec2, radius: float = 0.75, thickness: float = 0.25) -> float:
    """Full ring, centred at the origin.

    Args:
        p: Point.
        radius: Radius of the middle line.
        thickness: Distance from the inner to the outer circle.

    Source: two circles about one centre.

    Measured:
        annulus((0.0, 0.0), 2.0, 1.0) = 1.5
        annulus((0.0, 2.0), 2.0, 1.0) = -0.5
        annulus((3.0, 4.0), 2.0, 1.0) = 2.5
    """
    return abs(length(p) - radius) - 0.5 * thickness


@func
def pie_bounds(radius: float, opening: float) -> Bounds2:
    """Return the rectangle around the origin, the ends of the arc and its extreme points."""
    half = 0.5 * opening
    end = radius * vec2(sin(half), cos(half))
    reach = select(half > 0.5 * PI, radius, end.x)
    return Bounds2(vec2(-reach, min(end.y, 0.0)), vec2(reach, radius))


@primitive(
    "Pie",
    EXACT,
    bounds=pie_bounds,
    requires=_less_than_a_turn,
    width=sector_width,
)
@func
def pie(p: vec2, radius: float = 1.0, *, opening: float = 1.4) -> float:
    """Sector of a disc, symmetric about the y axis.

    Args:
        p: Point.
        radius: Radius of the disc.
        opening: Whole angle of the sector in radians, below 2 pi.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        pie((0.0, 3.0), 2.0, opening=2.0) = 1.0
        pie((0.0, -1.0), 2.0, opening=1.5) = 1.0
        pie((0.0, 0.5), 2.0, opening=1.0471975511965976) = -0.25
    """
    half = 0.5 * opening
    side = vec2(sin(half), cos(half))
    q = vec2(abs(p.x), p.y)
    past_circle = length(q) - radius
    past_side = length(q - side * clamp(dot(q, side), 0.0, radius))
    return max(past_circle, select(turned_from(q, side) > 0.0, past_side, -past_side))


@func
def cut_disk_bounds(radius: float, height: float) -> Bounds2:
    """Return the rectangle from the cut to the top."""
    reach = select(height > 0.0, sqrt(max(radius * radius - height * height, 0.0)), radius)
    return Bounds2(vec2(-reach, height), vec2(reach, radius))


@primitive(
    "CutDisk",
    EXACT,
    bounds=cut_disk_bounds,
    limits={"height": Limit.ANY},
    requires=_cuts_the_disc,
    width=cut_width,
)
@func
def cut_disk(p: vec2, radius: float = 1.0, height: float = -0.3) -> float:
    """Disc cut by a horizontal line; the part above the line.

    Args:
        p: Point.
        radius: Radius of the disc.
        height: Height of the line, from -radius to radius.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        cut_disk((0.0, -7.0), 5.0, -3.0) = 4.0
        cut_disk((7.0, -7.0), 5.0, -3.0) = 5.0
        cut_disk((6.0, 8.0), 5.0, -3.0) = 5.0
    """
    corner = vec2(sqrt(max(radius * radius - height * height, 0.0)), height)
    q = vec2(abs(p.x), p.y)
    past_circle = length(q) - radius
    inside = max(past_circle, height - q.y)
    below = select(q.x < corner.x, height - q.y, length(q - corner))
    above = past_circle > 0.0 and turned_from(corner, q) > 0.0
    outside = select(above, past_circle, below)
    return select(inside > 0.0, outside, inside)


@func
def from_arc(q: vec2, radius: float, angle: float) -> float:
    """Return the distance to an arc without thickness around the y axis, for q.x >= 0.

    ``angle`` is half of the arc's: from the y axis to either end.
    """
    side = vec2(sin(angle), cos(angle))
    from_end = length(q - radius * side)
    return select(turned_from(q, side) > 0.0, from_end, abs(length(q) - radius))


@func
def arc_bounds(radius: float, thickness: float, opening: float) -> Bounds2:
    """Return the rectangle around the middle line, enlarged by half of the thickness."""
    half = 0.5 * opening
    reach = select(half > 0.5 * PI, radius, radius * sin(half))
    wide = 0.5 * thickness
    low = radius * cos(half)
    return Bounds2(vec2(-reach, low) - wide, vec2(reach, radius) + wide)


@primitive(
    "Arc",
    EXACT,
    bounds=arc_bounds,
    limits={"opening": Limit.NOT_NEGATIVE},
    requires=_ends_are_apart,
    width=thickness_width,
)
@func
def arc(p: vec2, radius: float = 0.75, *, thickness: float = 0.2, opening: float = 3.2) -> float:
    """Arc of a ring with round ends, symmetric about the y axis.

    Args:
        p: Point.
        radius: Radius of the middle line.
        thickness: Distance from the inner to the outer side.
        opening: Whole angle in radians, between the middles of the two ends.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        arc((0.0, 4.0), 2.0, thickness=1.0, opening=2.0) = 1.5
        arc((0.0, 0.0), 2.0, thickness=1.0, opening=6.0) = 1.5
        arc((5.0, -4.0), 2.0, thickness=1.0, opening=3.141592653589793) = 4.5
    """
    return from_arc(vec2(abs(p.x), p.y), radius, 0.5 * opening) - 0.5 * thickness


@func
def ring_bounds(radius: float, thickness: float, opening: float) -> Bounds2:
    """Return the rectangle around both ends and the outer circle between them."""
    half = 0.5 * opening
    outer = radius + 0.5 * thickness
    inner = radius - 0.5 * thickness
    reach = select(half > 0.5 * PI, outer, outer * sin(half))
    low = min(inner * cos(half), outer * cos(half))
    return Bounds2(vec2(-reach, low), vec2(reach, outer))


@primitive(
    "Ring",
    EXACT,
    bounds=ring_bounds,
    requires=_ring_is_open,
    width=thickness_width,
)
@func
def ring(p: vec2, radius: float = 0.75, *, thickness: float = 0.25, opening: float = 3.2) -> float:
    """Arc of a ring with straight ends, symmetric about the y axis.

    Args:
        p: Point.
        radius: Radius of the middle line.
        thickness: Distance from the inner to the outer side.
        opening: Whole angle between the two ends in radians, below 2 pi.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        ring((0.0, 4.0), 2.0, thickness=1.0, opening=2.0) = 1.5
        ring((5.5, -4.0), 2.0, thickness=1.0, opening=3.141592653589793) = 5.0
        ring((1.75, 0.125), 2.0, thickness=1.0, opening=3.141592653589793) = -0.125
    """
    half = 0.5 * opening
    side = vec2(sin(half), cos(half))
    q = vec2(abs(p.x), p.y)
    wide = 0.5 * thickness
    past_side = turned_from(q, side)
    from_end = length(vec2(past_side, max(abs(dot(q, side) - radius) - wide, 0.0)))
    past_circles = abs(length(q) - radius) - wide
    return max(past_circles, select(past_side > 0.0, from_end, -from_end))


@func
def horseshoe_bounds(radius: float, legs: float, thickness: float, opening: float) -> Bounds2:
    """Return the rectangle around the ring and the ends of the legs."""
    half = 0.5 * opening
    side = vec2(sin(half), cos(half))
    ahead = legs * vec2(side.y, -side.x)
    box = ring_bounds(radius, thickness, opening)
    inner = (radius - 0.5 * thickness) * side + ahead
    outer = (radius + 0.5 * thickness) * side + ahead
    reach = max(box.high.x, max(inner.x, outer.x))
    low = min(box.low.y, min(inner.y, outer.y))
    return Bounds2(vec2(-reach, low), vec2(reach, box.high.y))


@primitive(
    "Horseshoe",
    EXACT,
    bounds=horseshoe_bounds,
    limits={"legs": Limit.NOT_NEGATIVE},
    requires=_legs_are_apart,
    width=thickness_width,
)
@func
def horseshoe(
    p: vec2,
    radius: float = 0.5,
    *,
    legs: float = 0.4,
    thickness: float = 0.25,
    opening: float = 3.8,
) -> float:
    """Arc of a ring, symmetric about the y axis, with a straight leg at each end.

    Args:
        p: Point.
        radius: Radius of the ring's middle line.
        legs: Length of the straight parts.
        thickness: Distance from the inner to the outer side.
        opening: Whole angle of the ring in radians, from one leg to the other.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        horseshoe((0.0, 4.0), 2.0, legs=1.0, thickness=1.0, opening=6.0) = 1.5
        horseshoe((2.0, -5.0), 2.0, legs=3.0, thickness=1.0, opening=3.141592653589793) = 2.0
        horseshoe((2.25, -1.0), 2.0, legs=3.0, thickness=1.0, opening=3.141592653589793) = -0.25
    """
    half = 0.5 * opening
    side = vec2(sin(half), cos(half))
    q = vec2(abs(p.x), p.y)
    # Coordinates at the ring's end: along the leg, and the distance from the ring's centre.
    ahead = -turned_from(side, q)
    from_centre = select(ahead < 0.0, length(q), dot(q, side))
    past_side = abs(from_centre - radius) - 0.5 * thickness
    past_end = ahead - legs
    return length(max(vec2(past_side, past_end), 0.0)) + min(max(past_side, past_end), 0.0)
