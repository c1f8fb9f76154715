"""Upright prisms over regular polygons and rhombi.

Input: a point and the numbers of a shape. Output: the distance. The symmetry of the outline is used
to move the point to where one side, perpendicular to the z axis, is the nearest.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.chords import between_faces, in_both
from distal.fields.constants import PI
from distal.fields.flats.edges import fold_past, fold_sectors, inside_both
from distal.fields.guarantees import EXACT, Bounds, Limit, primitive
from distal.fields.ordering import larger_first
from distal.fields.widths import prism_width, rhombus_prism_width
from distal.lang import abs, cos, dot, func, length, max, min, select, sin, vec2, vec3

DIAGONALS: Final = vec2(1.0, 0.6)

# Half of the side length, and the distance of the corners, for a side at distance 1.
TRIANGLE_HALF_SIDE: Final = math.sqrt(3.0)
HEXAGON_HALF_SIDE: Final = math.tan(math.pi / 6.0)
HEXAGON_SIDE: Final = math.cos(math.pi / 6.0)
HEXAGON_REACH: Final = 1.0 / math.cos(math.pi / 6.0)
OCTAGON_HALF_SIDE: Final = math.tan(math.pi / 8.0)


@func
def prism_side(q: vec2, y: float, half_side: float, inradius: float, height: float) -> float:
    """Return the distance to a prism whose nearest side faces q's y axis."""
    beyond = vec3(abs(q.x) - half_side, q.y - inradius, abs(y) - 0.5 * height)
    inside = max(beyond.y, beyond.z)
    # Past the outline's corner the upright edge is nearest. Inside, q.x is always within the side,
    # except by rounding: then its distance must not be added to that of the side.
    return select(inside > 0.0, length(max(beyond, 0.0)), inside)


@func
def tri_prism_bounds(inradius: float, height: float) -> Bounds:
    """Return the box of a prism over a triangle with a side perpendicular to z."""
    half = TRIANGLE_HALF_SIDE * inradius
    return Bounds(vec3(-half, -0.5 * height, -2.0 * inradius), vec3(half, 0.5 * height, inradius))


@primitive(
    "TriPrism",
    EXACT,
    bounds=tri_prism_bounds,
    width=prism_width,
    along="y",
)
@func
def tri_prism(p: vec3, inradius: float = 0.4, height: float = 1.0) -> float:
    """Upright prism over an equilateral triangle; one side faces +z.

    Args:
        p: Point.
        inradius: Distance from the axis to the middle of a side; a corner is twice as far away.
        height: Full height.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/);
        made exact.

    Measured:
        tri_prism((0.0, 0.0, 3.0), 1.0, 4.0) = 2.0
        tri_prism((0.0, 5.0, -6.0), 1.0, 4.0) = 5.0
        tri_prism((0.0, 0.0, 0.0), 1.0, 4.0) = -1.0
    """
    q = fold_past(vec2(abs(p.x), p.z), PI / 3.0)
    return prism_side(q, p.y, TRIANGLE_HALF_SIDE * inradius, inradius, height)


@func
def hex_prism_bounds(inradius: float, height: float) -> Bounds:
    """Return the box of a prism over a hexagon with two sides perpendicular to z."""
    reach = vec3(HEXAGON_REACH * inradius, 0.5 * height, inradius)
    return Bounds(-reach, reach)


@func
def hex_prism_chord(p: vec3, direction: vec3, inradius: float, height: float) -> vec2:
    """Return the part of a line inside: between four pairs of faces."""
    aslant = HEXAGON_SIDE * p.x
    turned = HEXAGON_SIDE * direction.x
    return in_both(
        in_both(
            between_faces(p.y, direction.y, 0.5 * height),
            between_faces(p.z, direction.z, inradius),
        ),
        in_both(
            between_faces(aslant + 0.5 * p.z, turned + 0.5 * direction.z, inradius),
            between_faces(aslant - 0.5 * p.z, turned - 0.5 * direction.z, inradius),
        ),
    )


@primitive(
    "HexPrism",
    EXACT,
    bounds=hex_prism_bounds,
    chord=hex_prism_chord,
    width=prism_width,
    along="y",
)
@func
def hex_prism(p: vec3, inradius: float = 0.5, height: float = 1.0) -> float:
    """Upright prism over a regular hexagon; two sides face along z.

    Args:
        p: Point.
        inradius: Distance from the axis to the middle of a side.
        height: Full height.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        hex_prism((0.0, 0.0, 3.0), 1.0, 4.0) = 2.0
        hex_prism((4.1547005383792515, 6.0, 0.0), 1.0, 4.0) = 5.0
        hex_prism((0.0, 1.5, 0.0), 1.0, 4.0) = -0.5
    """
    q = fold_past(abs(p.xz), PI / 6.0)
    return prism_side(q, p.y, HEXAGON_HALF_SIDE * inradius, inradius, height)


@func
def octagon_prism_bounds(inradius: float, height: float) -> Bounds:
    """Return the box of a prism over an octagon with sides perpendicular to x and z."""
    reach = vec3(inradius, 0.5 * height, inradius)
    return Bounds(-reach, reach)


@primitive(
    "OctagonPrism",
    EXACT,
    bounds=octagon_prism_bounds,
    width=prism_width,
    along="y",
)
@func
def octagon_prism(p: vec3, inradius: float = 0.5, height: float = 1.0) -> float:
    """Upright prism over a regular octagon; sides face along x and z.

    Args:
        p: Point.
        inradius: Distance from the axis to the middle of a side.
        height: Full height.

    Source: Inigo Quilez, "2D distance functions"
        (https://iquilezles.org/articles/distfunctions2d/), for the octagon.

    Measured:
        octagon_prism((3.0, 0.0, 0.0), 1.0, 4.0) = 2.0
        octagon_prism((4.0, 6.0, 0.0), 1.0, 4.0) = 5.0
        octagon_prism((2.0, 0.0, 2.0), 1.0, 4.0) = 1.8284271247461903
    """
    q = larger_first(abs(p.xz))
    return prism_side(
        fold_past(q.yx, PI / 8.0), p.y, OCTAGON_HALF_SIDE * inradius, inradius, height
    )


@func
def prism_bounds(inradius: float, height: float, count: int) -> Bounds:
    """Return the box of the circle through the corners."""
    reach = inradius / cos(PI / float(count))
    return Bounds(vec3(-reach, -0.5 * height, -reach), vec3(reach, 0.5 * height, reach))


def prism_requires(count: int) -> str | None:
    """Return why the number of sides is invalid, or None."""
    return None if count >= 3 else "count must be 3 or more"


@primitive(
    "Prism",
    EXACT,
    bounds=prism_bounds,
    requires=prism_requires,
    width=prism_width,
    along="y",
)
@func
def prism(p: vec3, inradius: float = 0.5, height: float = 1.0, *, count: int = 5) -> float:
    """Upright prism over a regular polygon; one side faces +z.

    Args:
        p: Point.
        inradius: Distance from the axis to the middle of a side.
        height: Full height.
        count: Number of sides, 3 or more.

    Source: the sector that the angle names, turned to z; Inigo Quilez, "2D distance functions"
        (https://iquilezles.org/articles/distfunctions2d/), for the polygons.

    Measured:
        prism((0.0, 0.0, 3.0), 1.0, 4.0, count=5) = 2.0
        prism((0.0, 6.0, 4.0), 1.0, 4.0, count=7) = 5.0
        prism((0.0, 0.0, 0.0), 1.0, 4.0, count=9) = -1.0
    """
    half_side = sin(PI / float(count)) / cos(PI / float(count)) * inradius
    return prism_side(fold_sectors(p.xz, count), p.y, half_side, inradius, height)


@func
def rhombus_prism_bounds(diagonals: vec2, height: float, rounding: float) -> Bounds:
    """Return the box of a rhombus, enlarged by its rounding."""
    reach = vec3(0.5 * diagonals.x + rounding, 0.5 * height, 0.5 * diagonals.y + rounding)
    return Bounds(-reach, reach)


@primitive(
    "RhombusPrism",
    EXACT,
    bounds=rhombus_prism_bounds,
    limits={"diagonals": Limit.POSITIVE},
    width=rhombus_prism_width,
)
@func
def rhombus_prism(
    p: vec3, diagonals: vec2 = DIAGONALS, height: float = 1.0, rounding: float = 0.05
) -> float:
    """Upright prism over a rhombus whose vertical edges are rounded.

    Args:
        p: Point.
        diagonals: Full size along x and z, before rounding.
        height: Full height.
        rounding: Radius of the vertical edges, by which the outline is enlarged.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        rhombus_prism((4.25, 6.0, 0.0), (2.0, 1.0), 4.0, 0.25) = 5.0
        rhombus_prism((0.0, 0.0, 0.0), (8.0, 6.0), 6.0, 0.25) = -2.65
        rhombus_prism((4.0, 0.0, 3.0), (8.0, 6.0), 6.0, 0.0) = 2.4
    """
    q = abs(p.xz) - vec2(0.5 * diagonals.x, 0.0)
    side = vec2(-0.5 * diagonals.x, 0.5 * diagonals.y)
    side_length = length(side)
    direction = side / side_length
    across = q.x * direction.y - q.y * direction.x
    beyond = abs(dot(q, direction) - 0.5 * side_length) - 0.5 * side_length
    # Inside, the nearest point of the side's line always lies on the side.
    outline = length(max(vec2(beyond, across), 0.0)) + min(across, 0.0)
    return inside_both(outline - rounding, abs(p.y) - 0.5 * height)
