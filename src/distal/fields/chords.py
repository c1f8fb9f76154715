"""Where a line is inside of a convex solid: its chord, in closed form.

Input: a point and a unit direction in the coordinates of a shape. Output: the distances along the
line at which it enters and leaves; the first is larger if it misses the solid. Declares no shapes.
The functions are accurate for starts far away, on the surface and inside, and for solids much
larger than their distance. No component of a direction may be infinite; all may be 0.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import TINY
from distal.fields.guarantees import UNBOUNDED
from distal.lang import abs, clamp, cross, dot, func, length, max, min, select, sqrt, vec2, vec3

# A slower approach to a face counts as this: its crossing is far away, on the right side.
SLOWEST: Final = 1e-14
# A line whose angle to the side of a cone is smaller is parallel to the side.
PARALLEL: Final = 1e-12
# The rounding error of a difference of two lengths, as a part of them.
ROUNDED: Final = 1e-6


@func
def missed() -> vec2:
    """Return the chord of a line that misses a solid."""
    return vec2(UNBOUNDED, -UNBOUNDED)


@func
def in_both(chord: vec2, other: vec2) -> vec2:
    """Return the part of a line that is inside of two convex solids."""
    return vec2(max(chord.x, other.x), min(chord.y, other.y))


@func
def below_face(height: float, rise: float) -> vec2:
    """Return the part of a line that is below a plane.

    Args:
        height: Height of the line's start above the plane.
        rise: How much the height grows for each unit of the line.
    """
    steady = select(abs(rise) < SLOWEST, SLOWEST, rise)
    t = -height / steady
    return vec2(select(steady > 0.0, -UNBOUNDED, t), select(steady > 0.0, t, UNBOUNDED))


@func
def between_faces(height: float, rise: float, half: float) -> vec2:
    """Return the part of a line that is between two parallel planes.

    Args:
        height: Height of the line's start above the middle of the planes.
        rise: How much the height grows for each unit of the line.
        half: Distance of the planes from their middle.
    """
    inverse = 1.0 / select(abs(rise) < SLOWEST, SLOWEST, rise)
    first = (-half - height) * inverse
    last = (half - height) * inverse
    return vec2(min(first, last), max(first, last))


@func
def in_box(p: vec3, direction: vec3, half: vec3) -> vec2:
    """Return the part of a line that is in a box around the origin.

    Args:
        p: Start of the line.
        direction: Its direction.
        half: Half of the size of the box.
    """
    inverse = 1.0 / select(abs(direction) < SLOWEST, direction * 0.0 + SLOWEST, direction)
    first = (-half - p) * inverse
    last = (half - p) * inverse
    near = min(first, last)
    far = max(first, last)
    return vec2(max(near.x, near.y, near.z), min(far.x, far.y, far.z))


@func
def in_ball(p: vec3, direction: vec3, radius: float) -> vec2:
    """Return the part of a line that is in a ball around the origin.

    The point of the line nearest to the middle gives the length of the chord, without the
    difference of large squares that the quadratic formula has for a ball far away. The end nearer
    to the start follows from the product of both ends, which is the power of the start: a
    difference of large lengths would be lost for a start on a large ball.

    Args:
        p: Start of the line.
        direction: Its unit direction; or the zero vector, for a line that stays at its start.
        radius: Radius.

    Source: Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems
        (2019), chapter 7.
    """
    along = dot(p, direction)
    beside = p - along * direction
    squared = radius * radius - dot(beside, beside)
    half = sqrt(max(squared, 0.0))
    to_far = select(along > 0.0, -along - half, half - along)
    to_near = select(along > 0.0, half - along, -along - half)
    # Where the line grazes the ball, the power has no more digits than the difference.
    away = length(p)
    power = (away - radius) * (away + radius)
    error = ROUNDED * (abs(along) + half)
    exact = power / select(abs(to_far) < TINY, TINY, to_far)
    nearer = clamp(exact, to_near - error, to_near + error)
    first = select(along > 0.0, to_far, nearer)
    last = select(along > 0.0, nearer, to_far)
    return vec2(select(squared < 0.0, UNBOUNDED, first), select(squared < 0.0, -UNBOUNDED, last))


@func
def in_round(p: vec3, direction: vec3, radius: float) -> vec2:
    """As ``in_ball``, for a direction of any length: of a cylinder's cross-section, for example.

    Args:
        p: Start of the line.
        direction: Its direction; 0 for a line along the axis of a cylinder.
        radius: Radius.
    """
    speed = max(length(direction), SLOWEST)
    return in_ball(p, direction / speed, radius) / speed


@func
def in_cylinder(p: vec3, direction: vec3, axis: vec3, half: float, radius: float) -> vec2:
    """Return the part of a line that is in a cylinder around the origin.

    Args:
        p: Start of the line.
        direction: Its unit direction.
        axis: Unit vector along the cylinder.
        half: Half of its height.
        radius: Radius.
    """
    height = dot(p, axis)
    rise = dot(direction, axis)
    around = in_round(p - height * axis, direction - rise * axis, radius)
    return in_both(around, between_faces(height, rise, half))


@func
def in_capsule(p: vec3, direction: vec3, axis: vec3, half: float, radius: float) -> vec2:
    """Return the part of a line that is in a capsule around the origin.

    The line's part in the infinite cylinder ends there between the centres of the half balls, and
    beyond them in the ball.

    Args:
        p: Start of the line.
        direction: Its unit direction.
        axis: Unit vector along the capsule; 0 if it is a ball.
        half: Half of the distance between the centres of the half balls.
        radius: Radius.
    """
    height = dot(p, axis)
    rise = dot(direction, axis)
    around = in_round(p - height * axis, direction - rise * axis, radius)
    low = in_ball(p + half * axis, direction, radius)
    high = in_ball(p - half * axis, direction, radius)
    first = height + around.x * rise
    last = height + around.y * rise
    entry = select(first < -half, low.x, select(first > half, high.x, around.x))
    leave = select(last < -half, low.y, select(last > half, high.y, around.y))
    is_hit = around.x <= around.y
    return vec2(select(is_hit, entry, UNBOUNDED), select(is_hit, leave, -UNBOUNDED))


@func
def in_cone(p: vec3, direction: vec3, axis: vec3, bottom: float, top: float, height: float) -> vec2:
    """Return the part of a line that is in a truncated cone around the origin.

    The quadratic equation is that of the point of the line nearest to the origin, so that its
    numbers are small. A line steeper than the side is inside beyond one root, without end.

    Args:
        p: Start of the line.
        direction: Its unit direction.
        axis: Unit vector from the bottom to the top.
        bottom: Radius at the bottom.
        top: Radius at the top.
        height: Full height; the origin is at half of it.
    """
    start = -dot(p, direction)
    middle = p + start * direction
    level = dot(middle, axis)
    rise = dot(direction, axis)
    beside = middle - level * axis
    way = direction - rise * axis
    taper = (top - bottom) / height
    radius = bottom + (level + 0.5 * height) * taper
    growth = rise * taper
    a = dot(way, way) - growth * growth
    b = dot(beside, way) - radius * growth
    c = dot(beside, beside) - radius * radius
    # b b - a c, without the terms that cancel for a line through the tip.
    across = radius * way - growth * beside
    turn = dot(cross(way, beside), axis)
    steady = select(abs(a) < PARALLEL, PARALLEL, a)
    squared = dot(across, across) - turn * turn - (steady - a) * c
    root = sqrt(max(squared, 0.0))
    q = select(b > 0.0, -b - root, root - b)
    one = q / steady
    other = c / select(abs(q) < TINY, TINY, q)
    first = min(one, other)
    last = max(one, other)
    is_steep = a <= -PARALLEL
    is_beside = squared < 0.0 and not is_steep
    entry = select(is_steep, select(growth > 0.0, last, -UNBOUNDED), first)
    leave = select(is_steep, select(growth > 0.0, UNBOUNDED, first), last)
    side = vec2(select(is_beside, UNBOUNDED, entry), select(is_beside, -UNBOUNDED, leave))
    return start + in_both(side, between_faces(level, rise, 0.5 * height))
