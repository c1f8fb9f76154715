"""Parts that several solids are made of: an axis, and boxes along it.

Input: a point and the numbers of a shape. Output: the point as seen from the axis,
or the box of what lies along it. Declares no shapes.
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


@func
def around_y(p: vec3) -> vec2:
    """How far from the y axis, and how high."""
    return vec2(length(p.xz), p.y)


@func
def axis_direction(start: vec3, end: vec3) -> vec3:
    """From start to end, of length 1; zero where they meet."""
    axis = end - start
    return axis / max(length(axis), TINY)


@func
def around_axis(p: vec3, start: vec3, end: vec3) -> vec2:
    """How far from the axis, and how far along it from the middle."""
    direction = axis_direction(start, end)
    offset = p - 0.5 * (start + end)
    along = dot(offset, direction)
    return vec2(length(offset - along * direction), along)


@func
def upright_bounds(radius: float, low: float, high: float) -> Bounds:
    """The box of what stands around the y axis."""
    return Bounds(vec3(-radius, low, -radius), vec3(radius, high, radius))


@func
def sphere_bounds(radius: float) -> Bounds:
    """The cube around the ball."""
    return Bounds(vec3(-radius), vec3(radius))


def cube_of_radius(name: str, reach: float) -> Func:
    """The function, of this name, that gives the cube of a shape from its radius.

    Args:
        name: The function's.
        reach: How far the shape reaches along an axis, for a radius of 1.
    """

    def cube_around(radius: float) -> Bounds:
        return Bounds(vec3(-radius * reach), vec3(radius * reach))

    return named(name, cube_around)


@func
def balls_bounds(start: vec3, end: vec3, start_radius: float, end_radius: float) -> Bounds:
    """The box around two balls."""
    return Bounds(
        min(start - start_radius, end - end_radius), max(start + start_radius, end + end_radius)
    )


@func
def discs_bounds(start: vec3, end: vec3, start_radius: float, end_radius: float) -> Bounds:
    """The box around two discs that face each other.

    A disc reaches along each axis by its radius times the sine to the disc's own axis.

    Source: Inigo Quilez, "Bounding boxes" (https://iquilezles.org/articles/diskbbox/).
    """
    direction = axis_direction(start, end)
    reach = sqrt(max(1.0 - direction * direction, 0.0))
    return Bounds(
        min(start - start_radius * reach, end - end_radius * reach),
        max(start + start_radius * reach, end + end_radius * reach),
    )


def apart(start: vec3, end: vec3) -> str | None:
    """Refuses an axis without length."""
    if tuple(start) == tuple(end):
        return "start and end must be two different points"
    return None


def below_pi(angle: float) -> str | None:
    """A cone opens by less than half a turn on either side."""
    return None if angle < math.pi else "angle must be below pi"
