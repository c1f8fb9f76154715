"""Circles and shapes around them: rings, arcs, links, discs.

Input: a point and the numbers of a shape. Output: the distance. Rings are horizontal, around the y
axis.
"""

from __future__ import annotations

import math

from distal.fields.constants import PI
from distal.fields.guarantees import EXACT, EXACT_OUTSIDE, Bounds, Limit, primitive
from distal.fields.widths import minor_width, ring_width
from distal.lang import abs, cos, func, length, max, select, sin, vec2, vec3


@func
def flat_bounds(radius: float) -> Bounds:
    """Return the box of a horizontal circle."""
    reach = vec3(radius, 0.0, radius)
    return Bounds(-reach, reach)


@primitive(
    "CircleLine",
    EXACT_OUTSIDE,
    bounds=flat_bounds,
    signed=False,
    width=0.0,
)
@func
def circle_line(p: vec3, radius: float = 0.75) -> float:
    """Circle without thickness around the y axis.

    Args:
        p: Point.
        radius: Radius.

    Source: Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), fCircle.

    Measured:
        circle_line((0.0, 0.0, 0.0), 2.0) = 2.0
        circle_line((3.0, 4.0, 4.0), 2.0) = 5.0
        circle_line((0.0, 1.5, 2.0), 2.0) = 1.5
    """
    return length(vec2(length(p.xz) - radius, p.y))


@primitive(
    "Disc",
    EXACT_OUTSIDE,
    bounds=flat_bounds,
    signed=False,
    width=0.0,
)
@func
def disc(p: vec3, radius: float = 0.75) -> float:
    """Round plate without thickness around the y axis.

    Args:
        p: Point.
        radius: Radius.

    Source: Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), fDisc.

    Measured:
        disc((0.5, 2.0, 0.5), 1.0) = 2.0
        disc((3.0, 3.0, 4.0), 1.0) = 5.0
        disc((0.0, 0.0, 0.5), 1.0) = 0.0
    """
    return length(vec2(max(length(p.xz) - radius, 0.0), p.y))


@func
def torus_bounds(major: float, minor: float) -> Bounds:
    """Return the box of a horizontal ring."""
    reach = vec3(major + minor, minor, major + minor)
    return Bounds(-reach, reach)


def torus_requires(major: float, minor: float) -> str | None:
    """Return why the tube is too thick, or None."""
    return "minor must be at most major" if minor > major else None


@primitive(
    "Torus",
    EXACT,
    bounds=torus_bounds,
    requires=torus_requires,
    width=ring_width,
)
@func
def torus(p: vec3, major: float = 0.75, minor: float = 0.25) -> float:
    """Torus (ring) around the y axis.

    Args:
        p: Point.
        major: Radius of the ring's centre line.
        minor: Radius of the tube, at most ``major``.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        torus((1.0, 0.0, 0.0), 0.75, 0.25) = 0.0
        torus((0.0, 0.0, 0.0), 0.75, 0.25) = 0.5
        torus((0.75, 1.0, 0.0), 0.75, 0.25) = 0.75
    """
    return circle_line(p, major) - minor


@func
def capped_torus_bounds(major: float, minor: float, opening: float) -> Bounds:
    """Return the box of an arc that is symmetric about x."""
    half = 0.5 * opening
    wide = major * select(half > 0.5 * PI, 1.0, sin(half))
    return Bounds(
        vec3(major * cos(half) - minor, -minor, -wide - minor),
        vec3(major + minor, minor, wide + minor),
    )


def capped_torus_requires(major: float, minor: float, opening: float) -> str | None:
    """Return why the tube would intersect itself, or None."""
    half = 0.5 * opening
    if half > PI + 1e-6:
        return "opening must be at most a whole turn, 2 pi"
    if minor > major:
        return "minor must be at most major"
    gap = major * math.sin(half)
    if 0.5 * PI < half < PI - 1e-6 and minor > gap:
        return "the two ends must not meet: minor must be at most major * sin(opening / 2)"
    return None


@primitive(
    "CappedTorus",
    EXACT,
    bounds=capped_torus_bounds,
    requires=capped_torus_requires,
    width=minor_width,
)
@func
def capped_torus(
    p: vec3, major: float = 0.75, minor: float = 0.25, *, opening: float = 4.0
) -> float:
    """Arc of a ring around the y axis, with round ends, symmetric about the x axis.

    Args:
        p: Point.
        major: Radius of the arc.
        minor: Radius of the tube.
        opening: Whole angle of the arc in radians, from one end to the other; at most 2 pi.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        capped_torus((3.0, 0.0, 0.0), 1.0, 0.25, opening=3.141592653589793) = 1.75
        capped_torus((-4.0, 3.0, 1.0), 1.0, 0.25, opening=3.141592653589793) = 4.75
        capped_torus((0.0, 0.0, -1.0), 1.0, 0.25, opening=3.141592653589793) = -0.25
    """
    side = abs(p.z)
    half = 0.5 * opening
    # In 32 bits the sine of pi is below 0, which would leave a gap in the ring.
    end = vec2(cos(half), max(sin(half), 0.0))
    to_end = length(vec3(p.x - major * end.x, p.y, side - major * end.y))
    beside_arc = p.x * end.y >= side * end.x
    return select(beside_arc, circle_line(p, major), to_end) - minor


@func
def link_bounds(major: float, minor: float, length: float) -> Bounds:
    """Return the box of an upright link."""
    reach = vec3(major + minor, 0.5 * length + major + minor, minor)
    return Bounds(-reach, reach)


def link_requires(major: float, minor: float) -> str | None:
    """Return why the tube is too thick, or None."""
    return "minor must be at most major" if minor > major else None


@primitive(
    "Link",
    EXACT,
    bounds=link_bounds,
    limits={"length": Limit.NOT_NEGATIVE},
    requires=link_requires,
    width=ring_width,
)
@func
def link(p: vec3, major: float = 0.4, minor: float = 0.15, *, length: float = 0.5) -> float:
    """Upright link of a chain; its hole faces the z axis.

    Args:
        p: Point.
        major: Radius of the two half rings' centre lines.
        minor: Radius of the tube, at most ``major``.
        length: Length of the two straight parts: the distance between the centres of the half
            rings.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        link((0.0, 0.0, 0.0), 0.5, 0.25, length=1.0) = 0.25
        link((0.5, 0.25, 0.0), 0.5, 0.25, length=1.0) = -0.25
        link((0.0, 5.0, 3.0), 0.5, 0.25, length=1.0) = 4.75
    """
    # The half rings together are a ring that lies in the plane of x and y.
    return circle_line(vec3(p.x, p.z, max(abs(p.y) - 0.5 * length, 0.0)), major) - minor
