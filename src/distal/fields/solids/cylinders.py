"""Cylinders and capsules, upright or between two points.

Input: a point and the numbers of a shape. Output: the distance.
"""

from __future__ import annotations

from distal.fields.chords import in_capsule, in_cylinder, in_round
from distal.fields.constants import TINY
from distal.fields.flats.edges import inside_both, length_of
from distal.fields.guarantees import EXACT, UNBOUNDED, Bounds, Limit, primitive
from distal.fields.solids.axes import (
    HIGH_END,
    LOW_END,
    UPWARD,
    apart,
    around_axis,
    around_y,
    axis_direction,
    balls_bounds,
    discs_bounds,
    upright_bounds,
)
from distal.fields.widths import between_width, cylinder_width, radius_width
from distal.lang import abs, clamp, dot, func, length, max, vec2, vec3


@func
def infinite_cylinder_chord(p: vec3, direction: vec3, radius: float) -> vec2:
    """Return the part of a line inside."""
    return in_round(vec3(p.x, 0.0, p.z), vec3(direction.x, 0.0, direction.z), radius)


@func
def infinite_cylinder_bounds(radius: float) -> Bounds:
    """Return the box of the cylinder, which ends only around its axis."""
    reach = vec3(radius, UNBOUNDED, radius)
    return Bounds(-reach, reach)


@primitive(
    "InfiniteCylinder",
    EXACT,
    bounds=infinite_cylinder_bounds,
    chord=infinite_cylinder_chord,
    width=radius_width,
    along="y",
)
@func
def infinite_cylinder(p: vec3, radius: float = 0.5) -> float:
    """Infinite cylinder around the y axis.

    Args:
        p: Point.
        radius: Radius.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        infinite_cylinder((3.0, 100.0, 4.0), 0.5) = 4.5
        infinite_cylinder((0.0, -7.0, 0.0), 0.5) = -0.5
        infinite_cylinder((0.0, 2.0, -0.5), 0.5) = 0.0
    """
    return length(p.xz) - radius


@func
def cylinder_profile(q: vec2, radius: float, height: float) -> float:
    """Return the distance to a cylinder.

    ``q`` is the distance from the axis and the height above the middle.
    """
    return inside_both(q.x - radius, abs(q.y) - 0.5 * height)


@func
def cylinder_bounds(radius: float, height: float) -> Bounds:
    """Return the box of an upright cylinder."""
    return upright_bounds(radius, -0.5 * height, 0.5 * height)


@func
def cylinder_chord(p: vec3, direction: vec3, radius: float, height: float) -> vec2:
    """Return the part of a line inside."""
    return in_cylinder(p, direction, UPWARD, 0.5 * height, radius)


@primitive(
    "Cylinder",
    EXACT,
    bounds=cylinder_bounds,
    chord=cylinder_chord,
    width=cylinder_width,
    along="y",
)
@func
def cylinder(p: vec3, radius: float = 0.5, height: float = 1.0) -> float:
    """Upright cylinder, centred at the origin.

    Args:
        p: Point.
        radius: Radius.
        height: Full height.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cylinder((2.0, 0.0, 0.0), 0.5, 2.0) = 1.5
        cylinder((0.0, 0.0, 0.0), 0.5, 2.0) = -0.5
        cylinder((0.0, 5.0, 3.5), 0.5, 2.0) = 5.0
    """
    return cylinder_profile(around_y(p), radius, height)


@func
def cylinder_between_bounds(start: vec3, end: vec3, radius: float) -> Bounds:
    """Return the box around the two ends."""
    return discs_bounds(start, end, radius, radius)


@func
def cylinder_between_chord(p: vec3, direction: vec3, start: vec3, end: vec3, radius: float) -> vec2:
    """Return the part of a line inside."""
    axis = axis_direction(start, end)
    half = 0.5 * length(end - start)
    return in_cylinder(p - 0.5 * (start + end), direction, axis, half, radius)


@primitive(
    "CylinderBetween",
    EXACT,
    bounds=cylinder_between_bounds,
    requires=apart,
    chord=cylinder_between_chord,
    width=between_width,
)
@func
def cylinder_between(
    p: vec3, start: vec3 = LOW_END, end: vec3 = HIGH_END, radius: float = 0.5
) -> float:
    """Cylinder whose ends are centred at two points.

    Args:
        p: Point.
        start: Centre of one end.
        end: Centre of the other end.
        radius: Radius.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cylinder_between((1.0, 2.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5) = 1.5
        cylinder_between((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5) = -0.5
        cylinder_between((6.0, 3.5, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5) = 5.0
    """
    return cylinder_profile(around_axis(p, start, end), radius, length(end - start))


def rounded_cylinder_requires(radius: float, height: float, rounding: float) -> str | None:
    """Return why the rounding is too large, or None."""
    if rounding > radius or 2.0 * rounding > height:
        return "rounding must be at most the radius and half of the height"
    return None


@func
def rounded_cylinder_bounds(radius: float, height: float, rounding: float) -> Bounds:
    """Return the box of an upright cylinder."""
    return cylinder_bounds(radius, height)


@primitive(
    "RoundedCylinder",
    EXACT,
    bounds=rounded_cylinder_bounds,
    requires=rounded_cylinder_requires,
    width=cylinder_width,
)
@func
def rounded_cylinder(
    p: vec3, radius: float = 0.5, height: float = 1.0, rounding: float = 0.1
) -> float:
    """Upright cylinder with rounded edges; the full size does not change.

    Args:
        p: Point.
        radius: Radius.
        height: Full height.
        rounding: Radius of the edges, at most ``radius`` and half of ``height``.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        rounded_cylinder((2.0, 0.0, 0.0), 0.5, 2.0, 0.25) = 1.5
        rounded_cylinder((0.0, 0.0, 0.0), 0.5, 2.0, 0.25) = -0.5
        rounded_cylinder((0.0, 4.75, 3.25), 0.5, 2.0, 0.25) = 4.75
    """
    return cylinder(p, radius - rounding, height - 2.0 * rounding) - rounding


@func
def capsule_bounds(radius: float, length: float) -> Bounds:
    """Return the box of an upright capsule."""
    return upright_bounds(radius, -0.5 * length - radius, 0.5 * length + radius)


@func
def capsule_chord(p: vec3, direction: vec3, radius: float, length: float) -> vec2:
    """Return the part of a line inside."""
    return in_capsule(p, direction, UPWARD, 0.5 * length, radius)


@primitive(
    "Capsule",
    EXACT,
    bounds=capsule_bounds,
    limits={"length": Limit.NOT_NEGATIVE},
    chord=capsule_chord,
    width=radius_width,
)
@func
def capsule(p: vec3, radius: float = 0.4, length: float = 1.0) -> float:
    """Upright capsule: a cylinder with half balls at its ends.

    Args:
        p: Point.
        radius: Radius.
        length: Length of the straight part: the distance between the centres of the half balls.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        capsule((2.0, 0.5, 0.0), 0.5, 2.0) = 1.5
        capsule((0.0, 0.0, 0.0), 0.5, 2.0) = -0.5
        capsule((0.0, 4.0, 4.0), 0.5, 2.0) = 4.5
    """
    half = 0.5 * length
    return length_of(vec3(p.x, p.y - clamp(p.y, -half, half), p.z)) - radius


@func
def to_segment(p: vec3, start: vec3, end: vec3) -> vec3:
    """Return the vector from the nearest point of a line segment to p.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).
    """
    offset = p - start
    axis = end - start
    return offset - axis * clamp(dot(offset, axis) / max(dot(axis, axis), TINY * TINY), 0.0, 1.0)


@func
def capsule_between_bounds(start: vec3, end: vec3, radius: float) -> Bounds:
    """Return the box around the two balls."""
    return balls_bounds(start, end, radius, radius)


@func
def capsule_between_chord(p: vec3, direction: vec3, start: vec3, end: vec3, radius: float) -> vec2:
    """Return the part of a line inside."""
    axis = axis_direction(start, end)
    half = 0.5 * length(end - start)
    return in_capsule(p - 0.5 * (start + end), direction, axis, half, radius)


@primitive(
    "CapsuleBetween",
    EXACT,
    bounds=capsule_between_bounds,
    chord=capsule_between_chord,
    width=radius_width,
)
@func
def capsule_between(
    p: vec3, start: vec3 = LOW_END, end: vec3 = HIGH_END, radius: float = 0.4
) -> float:
    """Capsule: a cylinder between two points, with half balls at its ends.

    Args:
        p: Point.
        start: Centre of one half ball.
        end: Centre of the other half ball; if it equals ``start``, the shape is a ball.
        radius: Radius.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        capsule_between((1.0, 2.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5) = 1.5
        capsule_between((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5) = -0.5
        capsule_between((5.0, 4.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5) = 4.5
    """
    return length(to_segment(p, start, end)) - radius
