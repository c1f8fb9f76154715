"""What planes, cones and balls leave of a ball, and the body of two arcs.

Input: a point and the numbers of a shape. Output: the distance. All are round
about the y axis: the point is looked at as how far from the axis, and how high.
"""

from __future__ import annotations

import math

from distal.fields.constants import PI
from distal.fields.guarantees import EXACT, Bounds, Limit, primitive
from distal.fields.solids.axes import (
    HIGH_END,
    LOW_END,
    apart,
    around_axis,
    around_y,
    below_pi,
    discs_bounds,
    sphere_bounds,
    upright_bounds,
)
from distal.lang import abs, clamp, cos, dot, func, length, max, min, select, sin, sqrt, vec2, vec3


@func
def rim_radius(radius: float, height: float) -> float:
    """Radius of the circle that a plane at ``height`` cuts out of a ball."""
    return sqrt(max(radius * radius - height * height, 0.0))


def _plane_cuts_ball(radius: float, height: float) -> str | None:
    return None if -radius < height < radius else "height must lie between -radius and radius"


@func
def cut_sphere_bounds(radius: float, height: float) -> Bounds:
    """The box of the upper part."""
    return upright_bounds(select(height > 0.0, rim_radius(radius, height), radius), height, radius)


@primitive(
    "CutSphere",
    EXACT,
    bounds=cut_sphere_bounds,
    limits={"height": Limit.ANY},
    requires=_plane_cuts_ball,
)
@func
def cut_sphere(p: vec3, radius: float = 1.0, height: float = 0.25) -> float:
    """What a level plane leaves of a ball: the part above.

    Args:
        p: Point.
        radius: Of the ball, which is centred at the origin.
        height: Of the plane, between -radius and radius.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cut_sphere((0.0, 3.0, 0.0), 1.0, 0.6) = 2.0
        cut_sphere((0.5, -1.4, 0.0), 1.0, 0.6) = 2.0
        cut_sphere((3.8, -3.4, 0.0), 1.0, 0.6) = 5.0
    """
    q = around_y(p)
    rim = vec2(rim_radius(radius, height), height)
    # Above the cone through the rim, and under the disc, a face is nearest; elsewhere the rim.
    facing = rim.x * q.y > rim.y * q.x or q.x < rim.x
    return select(facing, max(length(q) - radius, height - q.y), length(q - rim))


@func
def cut_hollow_sphere_bounds(radius: float, height: float, thickness: float) -> Bounds:
    """The box of the lower part of the wall."""
    rim = select(height < 0.0, rim_radius(radius, height), radius)
    half = 0.5 * thickness
    return upright_bounds(rim + half, -radius - half, height + half)


def cut_hollow_sphere_requires(radius: float, height: float, thickness: float) -> str | None:
    """The wall must not run into itself."""
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
)
@func
def cut_hollow_sphere(
    p: vec3, radius: float = 0.9, height: float = 0.25, thickness: float = 0.1
) -> float:
    """Bowl: what lies below a level plane of a ball's wall, with a round rim.

    Args:
        p: Point.
        radius: Of the wall's middle.
        height: Where the wall's middle ends, between -radius and radius.
        thickness: Of the wall.

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
    """The two balls must cross."""
    if math.fabs(radius - cut_radius) < distance < radius + cut_radius:
        return None
    return "the balls must cross: distance between |radius - cut_radius| and radius + cut_radius"


@primitive(
    "DeathStar",
    EXACT,
    bounds=sphere_bounds,
    limits={"cut_radius": Limit.POSITIVE, "distance": Limit.POSITIVE},
    requires=death_star_requires,
)
@func
def death_star(
    p: vec3, radius: float = 1.0, cut_radius: float = 0.75, distance: float = 1.25
) -> float:
    """Ball with a hollow that another ball above it leaves.

    Args:
        p: Point.
        radius: Of the ball, which is centred at the origin.
        cut_radius: Of the ball that is taken away.
        distance: Between the centres, along y.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        death_star((0.0, 1.0, 0.0), 1.0, 1.0, 1.6) = 0.4
        death_star((0.0, -3.0, 0.0), 1.0, 1.0, 1.6) = 2.0
        death_star((0.0, 2.6, 0.0), 1.0, 1.0, 1.6) = 1.8973665961010275
    """
    q = around_y(p)
    height = 0.5 * (radius * radius - cut_radius * cut_radius + distance * distance) / distance
    rim = vec2(rim_radius(radius, height), height)
    # The rim is nearest to what lies past it as seen from both centres.
    past_wall = q.y * rim.x - q.x * rim.y
    past_hollow = (q.y - distance) * rim.x - q.x * (rim.y - distance)
    hollow = cut_radius - length(vec2(q.x, q.y - distance))
    face = max(length(q) - radius, hollow)
    return select(min(past_wall, past_hollow) > 0.0, length(q - rim), face)


@func
def solid_angle_bounds(angle: float, radius: float) -> Bounds:
    """The box of a cone with a round base above it."""
    return upright_bounds(
        radius * select(angle > 0.5 * PI, 1.0, sin(angle)), min(radius * cos(angle), 0.0), radius
    )


@primitive("SolidAngle", EXACT, bounds=solid_angle_bounds, requires=below_pi)
@func
def solid_angle(p: vec3, angle: float = 0.6, radius: float = 1.0) -> float:
    """The part of a ball that lies within an angle of the y axis, its tip at the origin.

    Args:
        p: Point.
        angle: From the y axis to the side, below pi.
        radius: Of the ball.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        solid_angle((0.0, 3.0, 0.0), 0.5, 1.0) = 2.0
        solid_angle((0.0, -3.0, 4.0), 0.5, 1.0) = 5.0
        solid_angle((3.0, -4.0, 0.0), 1.5707963267948966, 2.0) = 4.123105625617661
    """
    q = around_y(p)
    side = vec2(sin(angle), cos(angle))
    to_side = length(q - side * clamp(dot(q, side), 0.0, radius))
    outside = q.x * side.y > q.y * side.x
    return max(length(q) - radius, select(outside, to_side, -to_side))


@func
def two_arcs(q: vec2, height: float, width: float) -> float:
    """Distance to the body between two arcs that meet on the axis, at half of ``height``."""
    tip = 0.5 * height
    bulge = 0.5 * width
    # The arc's centre lies beyond the axis.
    centre = 0.5 * (tip * tip - bulge * bulge) / bulge
    high = abs(q.y)
    past_tip = tip * q.x < centre * (high - tip)
    to_tip = length(vec2(q.x, high - tip))
    to_arc = length(vec2(q.x + centre, high)) - (centre + bulge)
    return select(past_tip, to_tip, to_arc)


@func
def vesica_solid_bounds(height: float, width: float) -> Bounds:
    """The box of an upright one."""
    return upright_bounds(0.5 * width, -0.5 * height, 0.5 * height)


def vesica_solid_requires(height: float, width: float) -> str | None:
    """Else the arcs would be more than half circles."""
    return "width must be at most height" if width > height else None


@primitive("VesicaSolid", EXACT, bounds=vesica_solid_bounds, requires=vesica_solid_requires)
@func
def vesica_solid(p: vec3, height: float = 1.5, width: float = 0.75) -> float:
    """Upright body between two arcs, with a tip at either end, like a grain of rice.

    Args:
        p: Point.
        height: From tip to tip.
        width: In the middle, at most ``height``.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        vesica_solid((0.0, 0.0, 0.0), 2.0, 1.0) = -0.5
        vesica_solid((0.0, 3.0, 0.0), 2.0, 1.0) = 2.0
        vesica_solid((2.0, 0.0, 0.0), 2.0, 1.0) = 1.5
    """
    return two_arcs(around_y(p), height, width)


@func
def vesica_between_bounds(start: vec3, end: vec3, width: float) -> Bounds:
    """The box of a cylinder around it."""
    return discs_bounds(start, end, 0.5 * width, 0.5 * width)


def vesica_between_requires(start: vec3, end: vec3, width: float) -> str | None:
    """Else the arcs would be more than half circles."""
    if width > math.dist(tuple(start), tuple(end)):
        return "width must be at most the distance from start to end"
    return apart(start, end)


@primitive("VesicaBetween", EXACT, bounds=vesica_between_bounds, requires=vesica_between_requires)
@func
def vesica_between(
    p: vec3, start: vec3 = LOW_END, end: vec3 = HIGH_END, width: float = 0.5
) -> float:
    """Body between two arcs that meet in two given points.

    Args:
        p: Point.
        start: One tip.
        end: The other tip.
        width: In the middle, at most the distance between the tips.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        vesica_between((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = -0.5
        vesica_between((14.0, 5.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = 13.0
        vesica_between((1.0, 0.0, 2.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = 1.5
    """
    return two_arcs(around_axis(p, start, end), length(end - start), width)
