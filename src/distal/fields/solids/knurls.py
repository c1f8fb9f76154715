"""Cylinders with a knurled surface, as on grips and thumb screws.

Input: a point and the sizes of the grooves. Output: a lower bound of the distance.
"""

from __future__ import annotations

from distal.fields.constants import HALF_ROOT, PI, TAU
from distal.fields.flats.teeth import below_teeth
from distal.fields.guarantees import LOWER_BOUND, Bounds, Limit, primitive
from distal.fields.widths import cylinder_width
from distal.lang import abs, atan2, cos, func, length, max, sin, sqrt, vec2, vec3


def _grooves_fit(
    radius: float, height: float, depth: float, bevel: float, count: int, slant: float
) -> str | None:
    if count < 3:
        return "count must be 3 or more"
    if depth > 0.25 * radius:
        return "depth may be at most a quarter of radius"
    if not -1.2 <= slant <= 1.2:
        return "slant must lie between -1.2 and 1.2"
    if 2.0 * bevel >= height or bevel >= radius:
        return "bevel must be below half of height and below radius"
    return None


@func
def groove_lean(radius: float, depth: float, slant: float, count: int) -> float:
    """Return the largest share of the outline's gradient along the grooves' row, 0 to 1."""
    half_width = PI * radius * cos(slant) / float(count)
    return depth / length(vec2(half_width, depth))


@func
def knurl_steepest(radius: float, depth: float, slant: float, count: int) -> float:
    """Return the bound on the gradient of the outline's distance.

    The outline is a row of grooves on the unrolled cylinder. At half of the radius, where values
    are limited, a step around the axis counts twice; along the axis it counts once.
    """
    lean = groove_lean(radius, depth, slant, count)
    stretch = length(vec2(2.0 * cos(slant), sin(slant)))
    return sqrt(max(1.0 + lean * lean * (stretch * stretch - 1.0), 1.0))


@func
def one_knurl(p: vec3, radius: float, depth: float, slant: float, count: int) -> float:
    """Return the distance to grooves that run at an angle to the axis, on the unrolled cylinder.

    The row is ``count`` grooves long, so that it closes around the cylinder at every angle.
    """
    around = radius * atan2(p.x, p.z)
    across = around * cos(slant) + p.y * sin(slant)
    pitch = TAU * radius * cos(slant) / float(count)
    outline = below_teeth(vec2(across, length(p.xz) - radius), 0.0, 0.0, pitch, depth)
    return max(outline, -0.5 * radius)


@func
def knurled_bounds(radius: float, height: float) -> Bounds:
    """Return the box of the cylinder."""
    reach = vec3(radius, 0.5 * height, radius)
    return Bounds(-reach, reach)


@func
def knurled_side_growth(radius: float, depth: float, slant: float, count: int) -> float:
    """Return the growth of the sides: the factor by which the distance is divided."""
    return knurl_steepest(radius, depth, slant, count)


@func
def knurled_growth(radius: float, depth: float, slant: float, count: int) -> float:
    """Return the growth: that of a side, and that past an end at the same time."""
    return length(vec2(knurl_steepest(radius, depth, slant, count), 1.0))


@primitive(
    "KnurledCylinder",
    LOWER_BOUND,
    bounds=knurled_bounds,
    growth=knurled_growth,
    side_growth=knurled_side_growth,
    limits={"depth": Limit.POSITIVE},
    requires=_grooves_fit,
    width=cylinder_width,
)
@func
def knurled_cylinder(
    p: vec3,
    radius: float = 0.5,
    height: float = 1.0,
    depth: float = 0.04,
    bevel: float = 0.04,
    count: int = 30,
    *,
    slant: float = 0.5235987755982988,
    crossed: bool = True,
) -> float:
    """Upright cylinder with V-shaped grooves: straight, slanted or crossed (diamonds).

    Args:
        p: Point.
        radius: Radius over the ridges.
        height: Full height.
        depth: Depth of the grooves.
        bevel: Size of the chamfers at 45 degrees at both ends.
        count: Number of grooves around the cylinder, in one direction.
        slant: Angle between the grooves and the axis in radians; 0 for straight ones.
        crossed: Whether there are grooves in both directions, which leave diamonds.

    Source: the exact distance to a row of grooves on the unrolled cylinder, divided by the bound on
        its slope.

    Measured:
        knurled_cylinder((0.0, 0.0, 2.0), 2.0, 4.0, 0.125, 0.25, 24, slant=0.5) = 0.0
        knurled_cylinder((0.0, 3.5, 0.0), 2.0, 4.0, 0.125, 0.25, 24, slant=0.5) = 1.5
        knurled_cylinder((0.0, 0.0, -1.875), 2.0, 4.0, 0.125, 0.25, 25, slant=0.0) = 0.0
    """
    past = abs(p.y) - 0.5 * height
    edge = HALF_ROOT * (length(p.xz) - radius + past + bevel)
    ridges = one_knurl(p, radius, depth, slant, count)
    if crossed:
        ridges = max(ridges, one_knurl(p, radius, depth, -slant, count))
    return max(ridges / knurl_steepest(radius, depth, slant, count), max(past, edge))
