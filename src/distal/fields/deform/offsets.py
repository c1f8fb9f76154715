"""Operators on the value of a shape alone (rounding, offsets, shells), and cuts by a plane.

Input: a distance. Output: the distance of the new surface, its box, its guarantees. Does not depend
on other shapes.

A surface that is moved outwards by r is where the old field is r. The box is enlarged by r times
the growth (``guarantees``), because a field may be far less than the distance there.

A lower bound is not kept when the surface is moved: it says nothing about values inside and near
the surface.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from distal.fields.extents import Boxes, at_least_one, moved_out
from distal.fields.guarantees import (
    EXACT_OUTSIDE,
    INSIDE_AND_BOUND,
    Growth,
    Guarantee,
    Limit,
    Operator,
    operator,
)
from distal.fields.widths import eroded_width, offset_width, rounded_width, shell_width
from distal.lang import abs, dot, func, max, vec2, vec3

INSIDE_ALONE = frozenset({Guarantee.EXACT_INSIDE})
OUTSIDE_ALONE = frozenset({Guarantee.EXACT_OUTSIDE})


@func
def rounded(d: float, radius: float) -> float:
    """Move the surface outwards by ``radius``, which makes every edge round."""
    return d - radius


@func
def rounded_bounds(bounds: Boxes, radius: float, side_growth: float) -> Boxes:
    """Return the box, enlarged by the radius."""
    return moved_out(bounds, radius, side_growth)


@func
def offset_value(d: float, distance: float) -> float:
    """Move the surface by ``distance``, outwards if it is above 0."""
    return d - distance


@func
def offset_bounds(bounds: Boxes, distance: float, side_growth: float) -> Boxes:
    """Return the box, enlarged as the surface is; it is never reduced."""
    return moved_out(bounds, max(distance, 0.0), side_growth)


@func
def eroded(d: float, distance: float) -> float:
    """Move the surface inwards by ``distance``."""
    return d + distance


@func
def shell_inner(d: float, thickness: float) -> float:
    """Return a hollow shape whose wall lies inside the surface."""
    return max(d, -d - thickness)


@func
def shell_center(d: float, thickness: float) -> float:
    """Return a hollow shape whose wall has the surface as its middle."""
    return abs(d) - 0.5 * thickness


@func
def shell_outer(d: float, thickness: float) -> float:
    """Return a hollow shape whose wall lies outside the surface."""
    return max(d - thickness, -d)


@func
def shell_center_bounds(bounds: Boxes, thickness: float, side_growth: float) -> Boxes:
    """Return the box, enlarged by half of the wall."""
    return moved_out(bounds, 0.5 * thickness, side_growth)


@func
def shell_outer_bounds(bounds: Boxes, thickness: float, side_growth: float) -> Boxes:
    """Return the box, enlarged by the wall."""
    return moved_out(bounds, thickness, side_growth)


@func
def kept_below(d: float, p: vec3, normal: vec3, offset: float) -> float:
    """Return the part behind a plane: the side that its normal points away from."""
    return max(d, dot(p, normal) - offset)


@func
def kept_above(d: float, p: vec3, normal: vec3, offset: float) -> float:
    """Return the part in front of a plane: the side that its normal points to."""
    return max(d, offset - dot(p, normal))


@func
def kept_below_flat(d: float, p: vec2, normal: vec2, offset: float) -> float:
    """Return the part behind a line: the side that its normal points away from."""
    return max(d, dot(p, normal) - offset)


@func
def kept_above_flat(d: float, p: vec2, normal: vec2, offset: float) -> float:
    """Return the part in front of a line: the side that its normal points to."""
    return max(d, offset - dot(p, normal))


ROUND = operator(
    "round",
    finish=rounded,
    keeps=OUTSIDE_ALONE,
    keeps_exact=EXACT_OUTSIDE,
    bounds=rounded_bounds,
    limits={"radius": Limit.NOT_NEGATIVE},
    growth=Growth.KEPT,
    fills=True,
    width=rounded_width,
)
OFFSET = operator(
    "offset",
    finish=offset_value,
    bounds=offset_bounds,
    growth=Growth.KEPT,
    fills=True,
    width=offset_width,
)
DILATE = operator(
    "dilate",
    finish=offset_value,
    keeps=OUTSIDE_ALONE,
    keeps_exact=EXACT_OUTSIDE,
    bounds=offset_bounds,
    limits={"distance": Limit.NOT_NEGATIVE},
    growth=Growth.KEPT,
    fills=True,
    width=offset_width,
)
ERODE = operator(
    "erode",
    finish=eroded,
    keeps=INSIDE_ALONE,
    limits={"distance": Limit.NOT_NEGATIVE},
    growth=Growth.KEPT,
    width=eroded_width,
)
THICK = {"thickness": Limit.POSITIVE}
SHELL_INNER = operator(
    "shell inner",
    finish=shell_inner,
    keeps_exact=EXACT_OUTSIDE,
    limits=THICK,
    growth=Growth.KEPT,
    width=shell_width,
)
SHELL_CENTER = operator(
    "shell center",
    finish=shell_center,
    keeps_exact=EXACT_OUTSIDE,
    bounds=shell_center_bounds,
    limits=THICK,
    growth=Growth.KEPT,
    fills=True,
    width=shell_width,
)
SHELL_OUTER = operator(
    "shell outer",
    finish=shell_outer,
    keeps_exact=EXACT_OUTSIDE,
    bounds=shell_outer_bounds,
    limits=THICK,
    growth=Growth.KEPT,
    fills=True,
    width=shell_width,
)
CUT: Final[Mapping[str, Any]] = {
    "keeps": INSIDE_AND_BOUND,
    "growth": Growth.KEPT,
    "slope": at_least_one,
    "limits": {"normal": Limit.UNIT},
}
# What a person cuts away to look inside: no author writes it, so it has no name in the library.
SECTION = Operator("section", finish=kept_below, **CUT)
SPLIT_BELOW = operator("split below", finish=kept_below, **CUT)
SPLIT_ABOVE = operator("split above", finish=kept_above, **CUT)
SPLIT_BELOW_FLAT = operator("flat split below", finish=kept_below_flat, **CUT)
SPLIT_ABOVE_FLAT = operator("flat split above", finish=kept_above_flat, **CUT)
