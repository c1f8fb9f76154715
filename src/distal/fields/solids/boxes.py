"""Solids with right angles: boxes, frames of boxes, and an octant of space.

Input: a point and the numbers of a shape. Output: the distance. Sizes are full sizes, from side to
side.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from distal.fields.chords import in_box
from distal.fields.constants import HALF_ROOT, ROOT_THREE
from distal.fields.guarantees import (
    EXACT,
    EXACT_OUTSIDE,
    INSIDE_AND_BOUND,
    UNBOUNDED,
    Bounds,
    Limit,
    primitive,
)
from distal.fields.widths import box_width, chamfered_box_width, frame_width
from distal.lang import abs, func, length, max, min, select, sqrt, vec2, vec3

UNIT_CUBE: Final = vec3(1.0)


@primitive(
    "Corner",
    EXACT,
    width=UNBOUNDED,
)
@func
def corner(p: vec3) -> float:
    """The octant of space where x, y and z are negative.

    Args:
        p: Point.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        corner((2.0, 3.0, 6.0)) = 7.0
        corner((-1.0, 0.5, -4.0)) = 0.5
        corner((-1.0, -0.25, -2.0)) = -0.25
    """
    return length(max(p, 0.0)) + min(max(p.x, p.y, p.z), 0.0)


@func
def box_bounds(size: vec3) -> Bounds:
    """Return the box itself."""
    return Bounds(-0.5 * size, 0.5 * size)


@func
def box_chord(p: vec3, direction: vec3, size: vec3) -> vec2:
    """Return the part of a line inside."""
    return in_box(p, direction, 0.5 * size)


@primitive(
    "Box",
    EXACT,
    bounds=box_bounds,
    chord=box_chord,
    endless=("size",),
    width=box_width,
    along="xyz",
)
@func
def box(p: vec3, size: vec3 = UNIT_CUBE) -> float:
    """Box with sides along the axes, centred at the origin.

    Args:
        p: Point.
        size: Full size along x, y and z; ``math.inf`` along an axis without an end.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        box((1.5, 0.0, 0.0), (1.0, 2.0, 3.0)) = 1.0
        box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)) = -0.5
        box((2.5, 4.0, 7.5), (1.0, 2.0, 3.0)) = 7.0
    """
    return corner(abs(p) - 0.5 * size)


@primitive(
    "BoxCheap",
    INSIDE_AND_BOUND,
    bounds=box_bounds,
    growth=ROOT_THREE,
    side_growth=1.0,
    chord=box_chord,
    endless=("size",),
    width=box_width,
    along="xyz",
)
@func
def box_cheap(p: vec3, size: vec3 = UNIT_CUBE) -> float:
    """Box without a square root; outside, next to edges and corners, a lower bound.

    An offset keeps its edges sharp.

    Args:
        p: Point.
        size: Full size along x, y and z; ``math.inf`` along an axis without an end.

    Source: Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), the Chebyshev distance.

    Measured:
        box_cheap((1.5, 0.0, 0.0), (1.0, 2.0, 3.0)) = 1.0
        box_cheap((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)) = -0.5
        box_cheap((2.5, 4.0, 7.5), (1.0, 2.0, 3.0)) = 6.0
    """
    q = abs(p) - 0.5 * size
    return max(q.x, q.y, q.z)


def _fits_every_side(what: str, reach: float, size: Iterable[float]) -> str | None:
    if 2.0 * reach > sorted(size)[0]:
        return f"{what} must be at most half of the smallest size"
    return None


def round_box_requires(size: tuple[float, ...], rounding: float) -> str | None:
    """Return why the rounding is too large, or None."""
    return _fits_every_side("rounding", rounding, size)


@primitive(
    "RoundBox",
    EXACT,
    bounds=box_bounds,
    requires=round_box_requires,
    endless=("size",),
    width=box_width,
)
@func
def round_box(p: vec3, size: vec3 = UNIT_CUBE, rounding: float = 0.1) -> float:
    """Box with rounded edges; the full size does not change.

    Args:
        p: Point.
        size: Full size along x, y and z; ``math.inf`` along an axis without an end.
        rounding: Radius of the edges, at most half of the smallest size.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        round_box((1.5, 0.0, 0.0), (1.0, 2.0, 3.0), 0.25) = 1.0
        round_box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), 0.25) = -0.5
        round_box((2.25, 3.75, 7.25), (1.0, 2.0, 3.0), 0.25) = 6.75
    """
    return box(p, size - 2.0 * rounding) - rounding


def chamfer_box_requires(size: vec3, bevel: float) -> str | None:
    """Return why the bevel is too large, or None."""
    return _fits_every_side("bevel", bevel, size)


@primitive(
    "ChamferBox",
    INSIDE_AND_BOUND,
    bounds=box_bounds,
    requires=chamfer_box_requires,
    growth=1.0,
    width=chamfered_box_width,
)
@func
def chamfer_box(p: vec3, size: vec3 = UNIT_CUBE, bevel: float = 0.1) -> float:
    """Box with edges chamfered at 45 degrees; outside a lower bound.

    Args:
        p: Point.
        size: Full size along x, y and z.
        bevel: Width that is cut off each face, at most half of the smallest size.

    Source: the box and twelve planes; Inigo Quilez, "Distance functions"
        (https://iquilezles.org/articles/distfunctions/), for the box.

    Measured:
        chamfer_box((2.0, 0.0, 0.0), (2.0, 2.0, 2.0), 0.5) = 1.0
        chamfer_box((0.75, 0.75, 0.0), (2.0, 2.0, 2.0), 0.5) = 0.0
        chamfer_box((0.0, 0.0, 0.0), (2.0, 2.0, 2.0), 0.5) = -1.0
    """
    q = abs(p) - 0.5 * size
    two_largest = q.x + q.y + q.z - min(q.x, q.y, q.z)
    return max(corner(q), (two_largest + bevel) * HALF_ROOT)


def box_frame_requires(size: vec3, thickness: float) -> str | None:
    """Return why the beams are too thick, or None."""
    return _fits_every_side("thickness", thickness, size)


@primitive(
    "BoxFrame",
    EXACT,
    bounds=box_bounds,
    requires=box_frame_requires,
    width=frame_width,
)
@func
def box_frame(p: vec3, size: vec3 = UNIT_CUBE, thickness: float = 0.1) -> float:
    """The twelve edges of a box as beams with a square cross-section.

    Args:
        p: Point.
        size: Full size along x, y and z.
        thickness: Width of a beam, at most half of the smallest size.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/);
        made exact inside.

    Measured:
        box_frame((0.0, 0.0, 0.0), (2.0, 2.0, 2.0), 0.25) = 1.0606601717798212
        box_frame((0.875, 0.875, 0.0), (2.0, 2.0, 2.0), 0.25) = -0.125
        box_frame((3.0, 4.0, 7.0), (2.0, 2.0, 2.0), 0.25) = 7.0
    """
    q = abs(p) - 0.5 * size
    hollow = q + thickness
    # Squares of the distances of p beyond the outer and inner sides of a beam, along each axis.
    beyond_ends = max(q, 0.0) * max(q, 0.0)
    beyond_sides = max(q, max(-hollow, 0.0)) * max(q, max(-hollow, 0.0))
    along_x = beyond_ends.x + beyond_sides.y + beyond_sides.z
    along_y = beyond_sides.x + beyond_ends.y + beyond_sides.z
    along_z = beyond_sides.x + beyond_sides.y + beyond_ends.z
    outside = sqrt(min(along_x, along_y, along_z))
    # Inside, the nearest of the outer faces and of the inner edges of the three openings.
    inward = max(hollow, 0.0) * max(hollow, 0.0)
    window = min(inward.x + inward.y, inward.y + inward.z, inward.z + inward.x)
    inside = max(q.x, q.y, q.z, -sqrt(window))
    # On the surface only one of the two has a gradient.
    return select(outside > 0.0, outside, min(inside, 0.0))


def round_frame_requires(size: vec3, thickness: float) -> str | None:
    """Return why the bars are too thick, or None."""
    return _fits_every_side("thickness", thickness, size)


@primitive(
    "RoundFrame",
    EXACT_OUTSIDE,
    bounds=box_bounds,
    limits={"thickness": Limit.NOT_NEGATIVE},
    requires=round_frame_requires,
    width=frame_width,
)
@func
def round_frame(p: vec3, size: vec3 = UNIT_CUBE, thickness: float = 0.1) -> float:
    """The twelve edges of a box as round bars with balls at the corners.

    Inside, near a corner, the distance to the surface is more than the value.

    Args:
        p: Point.
        size: Full size along x, y and z, including the bars.
        thickness: Diameter of a bar, at most half of the smallest size.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/),
        the box frame with beams of no thickness, grown.

    Measured:
        round_frame((0.0, 0.0, 0.0), (2.25, 2.25, 2.25), 0.25) = 1.2892135623730951
        round_frame((1.0, 1.0, 0.0), (2.25, 2.25, 2.25), 0.25) = -0.125
        round_frame((3.0, 4.0, 7.0), (2.25, 2.25, 2.25), 0.25) = 6.875
    """
    q = abs(p) - 0.5 * (size - thickness)
    square = q * q
    beyond_ends = max(q, 0.0) * max(q, 0.0)
    along_x = beyond_ends.x + square.y + square.z
    along_y = square.x + beyond_ends.y + square.z
    along_z = square.x + square.y + beyond_ends.z
    return sqrt(min(along_x, along_y, along_z)) - 0.5 * thickness
