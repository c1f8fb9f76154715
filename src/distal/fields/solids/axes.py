"""Coordinates relative to an axis, and boxes of shapes along an axis.

Input: a point and the numbers of a shape. Output: the point in coordinates of the axis, or a box.
Declares no shapes.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.constants import TINY
from distal.fields.guarantees import Bounds, named
from distal.lang import dot, func, length, max, min, sqrt, vec2, vec3
from distal.lang.functions import Func

# The default ends of shapes between two points.
LOW_END: Final = vec3(0.0, -0.5, 0.0)
HIGH_END: Final = vec3(0.0, 0.5, 0.0)
# The axis of upright shapes.
UPWARD: Final = vec3(0.0, 1.0, 0.0)


@func
def around_y(p: vec3) -> vec2:
    """Return the distance from the y axis, and the height."""
    return vec2(length(p.xz), p.y)


@func
def axis_direction(start: vec3, end: vec3) -> vec3:
    """Return the unit vector from start to end; zero if they coincide."""
    axis = end - start
    return axis / max(length(axis), TINY)


@func
def around_axis(p: vec3, start: vec3, end: vec3) -> vec2:
    """Return the distance from the axis, and the position along it from its middle."""
    direction = axis_direction(start, end)
    offset = p - 0.5 * (start + end)
    along = dot(offset, direction)
    return vec2(length(offset - along * direction), along)


@func
def upright_bounds(radius: float, low: float, high: float) -> Bounds:
    """Return the box of a shape around the y axis."""
    return Bounds(vec3(-radius, low, -radius), vec3(radius, high, radius))


@func
def sphere_bounds(radius: float) -> Bounds:
    """Return the cube around a ball."""
    return Bounds(vec3(-radius), vec3(radius))


def cube_of_radius(name: str, reach: float) -> Func:
    """Return a function of a shape's radius that returns the cube around the shape.

    Args:
        name: Name of the function.
        reach: Extent of the shape along an axis, for a radius of 1.
    """

    def cube_around(radius: float) -> Bounds:
        return Bounds(vec3(-radius * reach), vec3(radius * reach))

    return named(name, cube_around)


@func
def balls_bounds(start: vec3, end: vec3, start_radius: float, end_radius: float) -> Bounds:
    """Return the box around two balls."""
    return Bounds(
        min(start - start_radius, end - end_radius), max(start + start_radius, end + end_radius)
    )


@func
def discs_bounds(start: vec3, end: vec3, start_radius: float, end_radius: float) -> Bounds:
    """Return the box around two discs perpendicular to the line between them.

    A disc extends along each axis by its radius times the sine of the angle to its own axis.

    Source: Inigo Quilez, "Bounding boxes" (https://iquilezles.org/articles/diskbbox/).
    """
    direction = axis_direction(start, end)
    reach = sqrt(max(1.0 - direction * direction, 0.0))
    return Bounds(
        min(start - start_radius * reach, end - end_radius * reach),
        max(start + start_radius * reach, end + end_radius * reach),
    )


def apart(start: vec3, end: vec3) -> str | None:
    """Return why an axis is invalid if it has no length."""
    if tuple(start) == tuple(end):
        return "start and end must be two different points"
    return None


def below_a_turn(opening: float) -> str | None:
    """Return why an opening is invalid if it is not below a whole turn."""
    return None if opening < math.tau else "opening must be below a whole turn, 2 pi"
