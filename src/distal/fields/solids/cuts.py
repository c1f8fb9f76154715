"""Parts of a ball cut by planes, cones and balls, and the solid between two arcs (vesica).

Input: a point and the numbers of a shape. Output: the distance. All shapes are rotationally
symmetric about the y axis and are computed from the distance from the axis and the height.
"""

from __future__ import annotations

import math

from distal.fields.chords import below_face, in_ball, in_both
from distal.fields.constants import PI
from distal.fields.guarantees import EXACT, Bounds, Limit, primitive
from distal.fields.solids.axes import (
    HIGH_END,
    LOW_END,
    apart,
    around_axis,
    around_y,
    below_a_turn,
    discs_bounds,
    sphere_bounds,
    upright_bounds,
)
from distal.fields.widths import bitten_width, cut_width, half_width, sector_width, thickness_width
from distal.lang import abs, clamp, cos, dot, func, length, max, min, select, sin, sqrt, vec2, vec3


@func
def rim_radius(radius: float, height: float) -> float:
    """Return the radius of the circle in which a plane at ``height`` cuts a ball."""
    return sqrt(max(radius * radius - height * height, 0.0))


def _plane_cuts_ball(radius: float, height: float) -> str | None:
    return None if -radius < height < radius else "height must lie between -radius and radius"


@func
def cut_sphere_bounds(radius: float, height: float) -> Bounds:
    """Return the box of the upper part."""
    return upright_bounds(select(height > 0.0, rim_radius(radius, height), radius), height, radius)


@func
def cut_sphere_chord(p: vec3, direction: vec3, radius: float, height: float) -> vec2:
    """Return the part of a line in the ball and above the plane."""
    return in_both(in_ball(p, direction, radius), below_face(height - p.y, -direction.y))


@primitive(
    "CutSphere",
    EXACT,
    chord=cut_sphere_chord,
    bounds=cut_sphere_bounds,
    limits={"height": Limit.ANY},
    requires=_plane_cuts_ball,
    width=cut_width,
)
@func
def cut_sphere(p: vec3, radius: float = 1.0, height: float = 0.25) -> float:
    """Ball cut by a horizontal plane; the part above the plane.

    Args:
        p: Point.
        radius: Radius of the ball, which is centred at the origin.
        height: Height of the plane, between -radius and radius.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cut_sphere((0.0, 3.0, 0.0), 1.0, 0.6) = 2.0
        cut_sphere((0.5, -1.4, 0.0), 1.0, 0.6) = 2.0
        cut_sphere((3.8, -3.4, 0.0), 1.0, 0.6) = 5.0
    """
    q = around_y(p)
    rim = vec2(rim_radius(radius, height), height)
    # Above the cone through the rim, and below the disc, a face is nearest; elsewhere the rim.
    facing = rim.x * q.y > rim.y * q.x or q.x < rim.x
    return select(facing, max(length(q) - radius, height - q.y), length(q - rim))


@func
def cut_hollow_sphere_bounds(radius: float, height: float, thickness: float) -> Bounds:
    """Return the box of the lower part of the wall."""
    rim = select(height < 0.0, rim_radius(radius, height), radius)
    half = 0.5 * thickness
    return upright_bounds(rim + half, -radius - half, height + half)


def cut_hollow_sphere_requires(radius: float, height: float, thickness: float) -> str | None:
    """Return why the wall is too thick, or None."""
    if thickness > 2.0 * radius:
        return "thickness must be at most twice the radius"
    if 0.0 < height < radius and thickness > 2.0 * math.sqrt(radius**2 - height**2):
        return "the rim must not close: thickness must be at most the opening's width"
    return _plane_cuts_ball(radius, height)


@primitive(
    "CutHollowSphere",
    EXACT,
    bounds=cut_hollow_sphere_bounds,
    limits={"height": Limit.ANY},
    requires=cut_hollow_sphere_requires,
    width=thickness_width,
)
@func
def cut_hollow_sphere(
    p: vec3, radius: float = 0.9, height: float = 0.25, thickness: float = 0.1
) -> float:
    """Bowl: the wall of a ball below a horizontal plane, with a round rim.

    Args:
        p: Point.
        radius: Radius of the middle of the wall.
        height: Height at which the middle of the wall ends, between -radius and radius.
        thickness: Thickness of the wall.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cut_hollow_sphere((0.0, 0.0, 0.0), 1.0, 0.6, 0.5) = 0.75
        cut_hollow_sphere((0.0, -3.0, 0.0), 1.0, 0.6, 0.5) = 1.75
        cut_hollow_sphere((0.8, 2.6, 0.0), 1.0, 0.6, 0.5) = 1.75
    """
    q = around_y(p)
    rim = vec2(rim_radius(radius, height), height)
    below_rim = rim.x * q.y <= rim.y * q.x
    return select(below_rim, abs(length(q) - radius), length(q - rim)) - 0.5 * thickness


def death_star_requires(radius: float, cut_radius: float, distance: float) -> str | None:
    """Return why the two balls do not intersect, or None."""
    if math.fabs(radius - cut_radius) < distance < radius + cut_radius:
        return None
    return "the balls must cross: distance between |radius - cut_radius| and radius + cut_radius"


@primitive(
    "DeathStar",
    EXACT,
    bounds=sphere_bounds,
    limits={"cut_radius": Limit.POSITIVE, "distance": Limit.POSITIVE},
    requires=death_star_requires,
    width=bitten_width,
)
@func
def death_star(
    p: vec3, radius: float = 1.0, cut_radius: float = 0.75, distance: float = 1.25
) -> float:
    """Ball with a hollow cut by another ball above it.

    Args:
        p: Point.
        radius: Radius of the ball, which is centred at the origin.
        cut_radius: Radius of the ball that is subtracted.
        distance: Distance between the centres, along y.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        death_star((0.0, 1.0, 0.0), 1.0, 1.0, 1.6) = 0.4
        death_star((0.0, -3.0, 0.0), 1.0, 1.0, 1.6) = 2.0
        death_star((0.0, 2.6, 0.0), 1.0, 1.0, 1.6) = 1.8973665961010275
    """
    q = around_y(p)
    height = 0.5 * (radius * radius - cut_radius * cut_radius + distance * distance) / distance
    rim = vec2(rim_radius(radius, height), height)
    # The rim is nearest to points that lie past it as seen from both centres.
    past_wall = q.y * rim.x - q.x * rim.y
    past_hollow = (q.y - distance) * rim.x - q.x * (rim.y - distance)
    hollow = cut_radius - length(vec2(q.x, q.y - distance))
    face = max(length(q) - radius, hollow)
    return select(min(past_wall, past_hollow) > 0.0, length(q - rim), face)


@func
def solid_angle_bounds(radius: float, opening: float) -> Bounds:
    """Return the box of a cone with a spherical base above it."""
    half = 0.5 * opening
    return upright_bounds(
        radius * select(half > 0.5 * PI, 1.0, sin(half)), min(radius * cos(half), 0.0), radius
    )


@primitive(
    "SolidAngle",
    EXACT,
    bounds=solid_angle_bounds,
    requires=below_a_turn,
    width=sector_width,
)
@func
def solid_angle(p: vec3, radius: float = 1.0, *, opening: float = 1.2) -> float:
    """Sector of a ball: the part within an angle of the y axis, its tip at the origin.

    Args:
        p: Point.
        radius: Radius of the ball.
        opening: Whole angle of the cone at the tip in radians, below 2 pi.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        solid_angle((0.0, 3.0, 0.0), 1.0, opening=1.0) = 2.0
        solid_angle((0.0, -3.0, 4.0), 1.0, opening=1.0) = 5.0
        solid_angle((3.0, -4.0, 0.0), 2.0, opening=3.141592653589793) = 4.123105625617661
    """
    q = around_y(p)
    half = 0.5 * opening
    side = vec2(sin(half), cos(half))
    to_side = length(q - side * clamp(dot(q, side), 0.0, radius))
    outside = q.x * side.y > q.y * side.x
    return max(length(q) - radius, select(outside, to_side, -to_side))


@func
def two_arcs(q: vec2, width: float, height: float) -> float:
    """Return the distance to the solid between two arcs that meet on the axis.

    They meet at half of ``height`` above and below the middle.
    """
    tip = 0.5 * height
    bulge = 0.5 * width
    # The arc's centre lies on the other side of the axis.
    centre = 0.5 * (tip * tip - bulge * bulge) / bulge
    high = abs(q.y)
    past_tip = tip * q.x < centre * (high - tip)
    to_tip = length(vec2(q.x, high - tip))
    to_arc = length(vec2(q.x + centre, high)) - (centre + bulge)
    return select(past_tip, to_tip, to_arc)


@func
def vesica_solid_bounds(width: float, height: float) -> Bounds:
    """Return the box of an upright vesica."""
    return upright_bounds(0.5 * width, -0.5 * height, 0.5 * height)


def vesica_solid_requires(width: float, height: float) -> str | None:
    """Return why the width is too large (the arcs would exceed half circles), or None."""
    return "width must be at most height" if width > height else None


@primitive(
    "VesicaSolid",
    EXACT,
    bounds=vesica_solid_bounds,
    requires=vesica_solid_requires,
    width=half_width,
)
@func
def vesica_solid(p: vec3, width: float = 0.75, *, height: float = 1.5) -> float:
    """Upright solid of an arc rotated about its chord, with two tips, like a grain of rice.

    Args:
        p: Point.
        width: Width in the middle, at most ``height``.
        height: Distance between the tips.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        vesica_solid((0.0, 0.0, 0.0), 1.0, height=2.0) = -0.5
        vesica_solid((0.0, 3.0, 0.0), 1.0, height=2.0) = 2.0
        vesica_solid((2.0, 0.0, 0.0), 1.0, height=2.0) = 1.5
    """
    return two_arcs(around_y(p), width, height)


@func
def vesica_between_bounds(start: vec3, end: vec3, width: float) -> Bounds:
    """Return the box of a cylinder around the shape."""
    return discs_bounds(start, end, 0.5 * width, 0.5 * width)


def vesica_between_requires(start: vec3, end: vec3, width: float) -> str | None:
    """Return why the width is too large, or None."""
    if width > math.dist(tuple(start), tuple(end)):
        return "width must be at most the distance from start to end"
    return apart(start, end)


@primitive(
    "VesicaBetween",
    EXACT,
    bounds=vesica_between_bounds,
    requires=vesica_between_requires,
    width=half_width,
)
@func
def vesica_between(
    p: vec3, start: vec3 = LOW_END, end: vec3 = HIGH_END, width: float = 0.5
) -> float:
    """Solid of an arc rotated about its chord between two given points.

    Args:
        p: Point.
        start: The first tip.
        end: The second tip.
        width: Width in the middle, at most the distance between the tips.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        vesica_between((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = -0.5
        vesica_between((14.0, 5.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = 13.0
        vesica_between((1.0, 0.0, 2.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = 1.5
    """
    return two_arcs(around_axis(p, start, end), width, length(end - start))
