"""Shapes that emit light, for paths: random directions to them, and how likely each direction is.

Input: a ``Lamp``, the ball or the box around a shape of the scene that emits light, and a point.
Output: directions and densities. What a ray in such a direction shows is that of the surface that
it meets, so a lamp may be looser than its shape, and may overlap others; ``lamps_density`` counts
them all. Does not depend on what the shapes emit.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import dot, func, max, select, sqrt, struct, vec3
from distal.render.box_emitter import aim_at_box, box_density
from distal.render.emitters import narrowness_of
from distal.render.sampling.warps import axes_about, cone_density, in_cone, into_space

# Larger shapes are met by chance.
LARGEST = 1e6
UP = vec3(0.0, 1.0, 0.0)


@struct
class Lamp:
    """Where a shape that emits light is.

    Attributes:
        middle: The middle of the ball or of the box.
        half: Half of the box's sizes; the ball's radius is the largest. 0 for no lamp.
        round: Whether it is a ball.
    """

    middle: vec3
    half: vec3
    round: bool


@func
def no_lamp() -> Lamp:
    """Return a lamp that no direction meets."""
    return Lamp(vec3(0.0), vec3(0.0), False)


@func
def lamp_in(bounds: Bounds, round: bool) -> Lamp:
    """Return the lamp of a shape; none if the shape has no bounds.

    Args:
        bounds: The box around the shape.
        round: Whether the shape is a ball.
    """
    half = 0.5 * (bounds.high - bounds.low)
    known = max(half.x, half.y, half.z) < LARGEST
    middle = 0.5 * (bounds.low + bounds.high)
    return Lamp(select(known, middle, vec3(0.0)), select(known, half, vec3(0.0)), round)


@func
def cone_to(lamp: Lamp, offset: vec3) -> float:
    """Return 1 - cos of half the angle of a ball; 2, the whole sphere, inside of it.

    Args:
        lamp: The ball.
        offset: Its middle relative to the point.
    """
    radius = max(lamp.half.x, lamp.half.y, lamp.half.z)
    return narrowness_of(radius * radius / max(dot(offset, offset), 1e-30))


@func
def aim_at_lamp(lamp: Lamp, p: vec3, u: vec3) -> vec3:
    """Return a random direction from a point to a lamp; any, if the point is inside of a box.

    Args:
        lamp: The lamp.
        p: The point.
        u: Three random numbers in [0, 1).
    """
    offset = lamp.middle - p
    if lamp.round:
        squared = dot(offset, offset)
        to_middle = select(squared > 0.0, offset / sqrt(max(squared, 1e-30)), UP)
        return into_space(axes_about(to_middle), in_cone(u.xy, cone_to(lamp, offset)))
    return aim_at_box(-offset, lamp.half, u).direction


@func
def lamp_density(lamp: Lamp, p: vec3, direction: vec3) -> float:
    """Return the density with which ``aim_at_lamp`` chooses a direction; 0 if it misses the lamp.

    Args:
        lamp: The lamp.
        p: The point.
        direction: Unit direction.
    """
    offset = lamp.middle - p
    if lamp.round:
        narrow = cone_to(lamp, offset)
        along = dot(offset, direction)
        across = offset - along * direction
        radius = max(lamp.half.x, lamp.half.y, lamp.half.z)
        meets = along > 0.0 and dot(across, across) <= radius * radius
        return select(narrow >= 2.0 or meets, cone_density(max(narrow, 1e-30)), 0.0)
    return box_density(-offset, lamp.half, direction).density


@func
def lamps_density(p: vec3, direction: vec3, lamps: Callable[[int], Lamp], lamp_count: int) -> float:
    """Return the sum of all lamps' densities of a direction.

    Args:
        p: The point.
        direction: Unit direction.
        lamps: The lamp with a given index.
        lamp_count: How many there are.
    """
    total = 0.0
    for i in range(lamp_count):
        total += lamp_density(lamps(i), p, direction)
    return total
