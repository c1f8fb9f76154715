"""Tubes that wind around the y axis: an infinite helix and a spring.

Input: a point and the numbers of a coil. Output: a lower bound of the distance.
"""

from __future__ import annotations

from distal.fields.constants import PI, TAU
from distal.fields.guarantees import LOWER_BOUND, UNBOUNDED, Approximation, Bounds, primitive
from distal.fields.widths import coil_width
from distal.lang import abs, atan2, func, length, max, round, sqrt, vec2, vec3


@func
def coil_steepest(major: float, pitch: float) -> float:
    """Return a bound on the gradient of ``coil`` before the division by this bound.

    Across the coil and along it the two parts of the distance are true lengths. The second part
    also changes with the distance from the axis, by at most ``shear`` where this matters: beyond
    the distance ``start`` from the axis, where the first part is small.
    """
    rise = pitch / TAU
    start = max(major - 0.17 * PI * PI * rise, 0.0)
    square = start * start + rise * rise
    shear = PI * rise * rise * rise / (square * sqrt(square))
    return 0.5 * (shear + sqrt(shear * shear + 4.0))


@func
def coil(p: vec3, major: float, minor: float, pitch: float) -> float:
    """Return a lower bound of the distance to the nearest turn.

    It is computed from the distance from the axis and the height over a helix at the point's own
    radius, shortened by this helix's slope, and divided by ``coil_steepest``.
    """
    rise = pitch / TAU
    out = length(p.xz)
    turns = p.y / pitch - atan2(p.z, p.x) / TAU
    height = pitch * (turns - round(turns)) * out / sqrt(out * out + rise * rise)
    return (length(vec2(out - major, height)) - minor) / coil_steepest(major, pitch)


@func
def coil_growth(major: float, pitch: float) -> float:
    """Return the growth of the sides: the factor by which ``coil`` is divided."""
    return coil_steepest(major, pitch)


@func
def helix_bounds(major: float, minor: float, pitch: float) -> Bounds:
    """Return the box of the tube, which ends only around its axis."""
    out = major + minor
    reach = vec3(out, UNBOUNDED, out)
    return Bounds(-reach, reach)


@primitive(
    "Helix",
    LOWER_BOUND,
    bounds=helix_bounds,
    tier=2,
    growth=coil_growth,
    approximates=Approximation("a tube with a round section", 7e-5),
    width=coil_width,
)
@func
def helix(p: vec3, major: float = 0.5, minor: float = 0.1, pitch: float = 0.4) -> float:
    """Infinite tube that winds around the y axis and crosses the x axis, rising towards z.

    Args:
        p: Point.
        major: Distance from the axis to the tube's centre line.
        minor: Radius of the tube.
        pitch: Rise in one turn.

    Source: the distance in the half plane through the axis, its height shortened.

    Measured:
        helix((0.0, 0.1, 0.5625), 0.5, 0.0625, 0.4) = 0.0
        helix((0.0, 0.0, 0.0), 2.0, 0.5, 0.0001) = 1.5
        helix((-5.0, 0.00005, 0.0), 2.0, 0.5, 0.0001) = 2.5
    """
    return coil(p, major, minor, pitch)


@func
def spring_bounds(major: float, minor: float, height: float) -> Bounds:
    """Return the box around the coil, between its ends."""
    reach = vec3(major + minor, 0.5 * height, major + minor)
    return Bounds(-reach, reach)


@func
def spring_growth(major: float, pitch: float) -> float:
    """Return the growth: that of a side, and that past an end at the same time."""
    return length(vec2(coil_steepest(major, pitch), 1.0))


@primitive(
    "Spring",
    LOWER_BOUND,
    bounds=spring_bounds,
    tier=2,
    growth=spring_growth,
    side_growth=coil_growth,
    approximates=Approximation("a tube with a round section", 3.3e-5),
    width=coil_width,
)
@func
def spring(
    p: vec3, major: float = 0.4, minor: float = 0.07, pitch: float = 0.25, height: float = 1.0
) -> float:
    """Coil spring around the y axis with flat ends.

    Args:
        p: Point.
        major: Distance from the axis to the wire's centre line.
        minor: Radius of the wire.
        pitch: Rise in one turn.
        height: Full height.

    Source: ``helix``, cut by two planes.

    Measured:
        spring((0.0, 0.1, 0.4375), 0.5, 0.0625, 0.4, 2.0) = 0.0
        spring((0.0, 4.0, 0.0), 0.5, 0.0625, 0.4, 2.0) = 3.0
        spring((-5.0, 0.00005, 0.0), 2.0, 0.5, 0.0001, 1.0) = 2.5
    """
    return max(coil(p, major, minor, pitch), abs(p.y) - 0.5 * height)
