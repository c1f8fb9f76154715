"""Tubes that wind around the y axis: a helix without end, and a spring.

Input: a point and the numbers of a coil. Output: a lower bound of the distance.
"""

from __future__ import annotations

from distal.fields.constants import PI, TAU
from distal.fields.guarantees import LOWER_BOUND, Bounds, primitive
from distal.lang import abs, atan2, func, length, max, round, sqrt, vec2, vec3


@func
def coil_steepest(major: float, pitch: float) -> float:
    """How much faster than the way ``coil`` may rise at most.

    Across the coil and along it the two parts of the distance are true lengths, but the second also
    changes outward, by at most ``shear``, where the first is so small that it counts: beyond
    ``start`` from the axis.
    """
    rise = pitch / TAU
    start = max(major - 0.17 * PI * PI * rise, 0.0)
    square = start * start + rise * rise
    shear = PI * rise * rise * rise / (square * sqrt(square))
    return 0.5 * (shear + sqrt(shear * shear + 4.0))


@func
def coil(p: vec3, major: float, minor: float, pitch: float) -> float:
    """The way to the nearest turn, by how far from the axis and how high, over its steepest.

    The height is seen across a helix as far out as the point, and shortened by that one's slope.
    """
    rise = pitch / TAU
    out = length(p.xz)
    turns = p.y / pitch - atan2(p.z, p.x) / TAU
    height = pitch * (turns - round(turns)) * out / sqrt(out * out + rise * rise)
    return (length(vec2(out - major, height)) - minor) / coil_steepest(major, pitch)


@primitive("Helix", LOWER_BOUND, tier=2)
@func
def helix(p: vec3, major: float = 0.5, minor: float = 0.1, pitch: float = 0.4) -> float:
    """A tube that winds around the y axis without end, through the x axis, rising toward z.

    Args:
        p: Point.
        major: From the axis to the tube's middle.
        minor: Radius of the tube.
        pitch: How much higher each turn is than the one before.

    Source: the distance in the half plane through the axis, its height shortened.

    Measured:
        helix((0.0, 0.1, 0.5625), 0.5, 0.0625, 0.4) = 0.0
        helix((0.0, 0.0, 0.0), 2.0, 0.5, 0.0001) = 1.5
        helix((-5.0, 0.00005, 0.0), 2.0, 0.5, 0.0001) = 2.5
    """
    return coil(p, major, minor, pitch)


@func
def spring_bounds(major: float, minor: float, height: float) -> Bounds:
    """Around the coil, between its ends."""
    reach = vec3(major + minor, 0.5 * height, major + minor)
    return Bounds(-reach, reach)


@func
def spring_side_growth(major: float, pitch: float) -> float:
    """The coil's value is the way to it over its steepest."""
    return coil_steepest(major, pitch)


@func
def spring_growth(major: float, pitch: float) -> float:
    """Outward as for a side, and past an end at once."""
    return length(vec2(coil_steepest(major, pitch), 1.0))


@primitive(
    "Spring",
    LOWER_BOUND,
    bounds=spring_bounds,
    tier=2,
    growth=spring_growth,
    side_growth=spring_side_growth,
)
@func
def spring(
    p: vec3, major: float = 0.4, minor: float = 0.07, pitch: float = 0.25, height: float = 1.0
) -> float:
    """A coil spring around the y axis, its ends ground flat.

    Args:
        p: Point.
        major: From the axis to the wire's middle.
        minor: Radius of the wire.
        pitch: How much higher each turn is than the one before.
        height: From end to end.

    Source: ``helix``, cut by two planes.

    Measured:
        spring((0.0, 0.1, 0.4375), 0.5, 0.0625, 0.4, 2.0) = 0.0
        spring((0.0, 4.0, 0.0), 0.5, 0.0625, 0.4, 2.0) = 3.0
        spring((-5.0, 0.00005, 0.0), 2.0, 0.5, 0.0001, 1.0) = 2.5
    """
    return max(coil(p, major, minor, pitch), abs(p.y) - 0.5 * height)
