"""Trusses around an axis: straight bars between points of a cylinder.

Input: a point, the radius of the cylinder, the height of a bay, the radius of the bars, the number
of nodes. Output: the distance, exact outside.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import PI
from distal.fields.flats.edges import from_segment, nearer
from distal.fields.guarantees import EXACT_OUTSIDE, UNBOUNDED, Bounds, Limit, primitive
from distal.fields.widths import radius_width
from distal.lang import atan2, cos, floor, func, length, min, round, sin, vec2, vec3

# Sectors beside that of the point, and bays above and below, whose bars may be nearest.
SECTORS: Final = 5
BAYS: Final = 3
# Of a bay's height to the radius of the nodes; beyond, bars of other sectors may be nearer.
FLATTEST: Final = 0.25
STEEPEST: Final = 4.0


def _bars_stay_apart(major: float, height: float, radius: float, count: int) -> str | None:
    if not 5 <= count <= 24:
        return "count must be from 5 to 24"
    if not FLATTEST * major <= height <= STEEPEST * major:
        return f"height must be from {FLATTEST:g} to {STEEPEST:g} times major"
    return (
        None
        if 8.0 * radius <= min(height, major)
        else "radius must be at most 1/8 of major and of height"
    )


@func
def isotruss_bounds(major: float, radius: float) -> Bounds:
    """Return the box around the tube, which is infinite along y."""
    outer = major + radius
    return Bounds(vec3(-outer, -UNBOUNDED, -outer), vec3(outer, UNBOUNDED, outer))


@func
def on_cylinder(angle: float, y: float, radius: float) -> vec3:
    """Return a point of a cylinder about the y axis; the angle goes from x to z."""
    return vec3(radius * cos(angle), y, radius * sin(angle))


@func
def from_helical_bars(p: vec3, major: float, height: float, count: int) -> vec3:
    """Return the offset from the nearest of the bars that rise from node to next but one."""
    sector = 2.0 * PI / float(count)
    first = floor(atan2(p.z, p.x) / sector)
    bay = floor(p.y / height)
    nearest = vec3(UNBOUNDED)
    for i in range(SECTORS):
        start = (first + float(i - SECTORS // 2)) * sector
        for j in range(BAYS):
            y = (bay + float(j - BAYS // 2)) * height
            low = on_cylinder(start, y, major)
            high = on_cylinder(start + 2.0 * sector, y + height, major)
            nearest = nearer(nearest, from_segment(p, low, high))
    return nearest


@func
def from_straight_bars(p: vec3, major: float, count: int) -> vec2:
    """Return the offset from the nearest of the bars along y, where two helical bars cross."""
    sector = 2.0 * PI / float(count)
    angle = (round(atan2(p.z, p.x) / sector - 0.5) + 0.5) * sector
    place = on_cylinder(angle, 0.0, major * cos(sector) / cos(0.5 * sector))
    return vec2(p.x - place.x, p.z - place.z)


@primitive(
    "Isotruss",
    EXACT_OUTSIDE,
    bounds=isotruss_bounds,
    limits={"height": Limit.POSITIVE, "major": Limit.POSITIVE},
    requires=_bars_stay_apart,
    tier=2,
    width=radius_width,
)
@func
def isotruss(
    p: vec3, major: float = 0.6, height: float = 0.6, radius: float = 0.03, count: int = 8
) -> float:
    """Infinite truss tube about the y axis: helical bars that make pyramids, and straight bars.

    In each bay, bars rise from each node to the next but one, in both directions; straight bars run
    where they cross. Seen along the axis they are a star.

    Args:
        p: Point.
        major: Distance of the nodes from the axis.
        height: Height of a bay, from 0.25 to 4 times ``major``.
        radius: Radius of the bars, at most 1/8 of ``major`` and ``height``.
        count: Number of nodes around the axis, from 5 to 24.

    Source: David W. Jensen and Larry R. Francom, "Three-dimensional iso-truss structure", US patent
        5921048 (1999), for the arrangement of the bars.

    Measured:
        isotruss((1.0, 0.0, 0.0), 1.0, 1.0, 0.125, 8) = -0.125
        isotruss((3.0, 0.0, 0.0), 1.0, 1.0, 0.125, 8) = 1.875
        isotruss((0.0, 5.5, -1.0), 1.0, 0.5, 0.0625, 6) = 0.3173425
    """
    mirrored = vec3(p.x, p.y, -p.z)
    rising = from_helical_bars(p, major, height, count)
    falling = from_helical_bars(mirrored, major, height, count)
    helical = length(nearer(rising, falling))
    return min(helical, length(from_straight_bars(p, major, count))) - radius
