"""Operators of two shapes: unions, cuts, morphs, displacement.

Input: two distances. Output: the distance of the result, and the rules for its slope, its box and
its material. Blends are declared in ``blends``.
"""

from __future__ import annotations

from distal.fields.extents import Boxes, moved_out, overlap
from distal.fields.guarantees import (
    EXACT,
    EXACT_OUTSIDE,
    INSIDE_AND_BOUND,
    UNBOUNDED,
    Growth,
    Limit,
    operator,
)
from distal.fields.widths import clearance_width
from distal.lang import abs, clamp, func, max, min, mix, select

# Materials of combinations


@func
def first_shows(a: float, b: float) -> float:
    """Return 0, no share of ``b``: the result has the first shape's material."""
    return 0.0


@func
def farther_shows(a: float, b: float) -> float:
    """Return the share of ``b`` in an intersection: 1 if its surface bounds the result."""
    return select(a < b, 1.0, 0.0)


@func
def cutter_shows(a: float, b: float) -> float:
    """Return the share of ``b`` in a difference: 1 on its surface, which is seen from inside."""
    return select(a < -b, 1.0, 0.0)


# Boxes of combinations


@func
def first_box(bounds_a: Boxes, bounds_b: Boxes) -> Boxes:
    """Return the first shape's box: the operator adds nothing outside it."""
    return bounds_a


@func
def endless(bounds: Boxes) -> Boxes:
    """Return an infinite box."""
    everything = bounds
    everything.low = bounds.low * 0.0 - UNBOUNDED
    everything.high = bounds.high * 0.0 + UNBOUNDED
    return everything


@func
def complement(d: float) -> float:
    """Return the complement: everything outside the shape."""
    return -d


@func
def union(a: float, b: float) -> float:
    """Return what is in either shape."""
    return min(a, b)


@func
def intersection(a: float, b: float) -> float:
    """Return what is in both shapes."""
    return max(a, b)


@func
def difference(a: float, b: float) -> float:
    """Return what is in the first shape but not in the second."""
    return max(a, -b)


@func
def xor(a: float, b: float) -> float:
    """Return what is in exactly one of the shapes."""
    return max(min(a, b), -max(a, b))


@func
def clearance(a: float, b: float, gap: float) -> float:
    """Return the first shape without everything within ``gap`` of the second."""
    return max(a, gap - b)


@func
def morph(a: float, b: float, t: float) -> float:
    """Interpolate between two shapes: the first at t = 0, the second at t = 1."""
    return mix(a, b, t)


@func
def morph_mix(a: float, b: float, t: float) -> float:
    """Return the share of ``b``."""
    return t


@func
def displaced(a: float, b: float, height: float) -> float:
    """Move the first shape's surface outwards by the second field times ``height``.

    The field is clamped to -1 to 1; otherwise there would be no box.
    """
    return a - height * clamp(b, -1.0, 1.0)


@func
def displaced_slope(slope_a: float, slope_b: float, height: float) -> float:
    """Return the sum of slopes, the field's multiplied by the height."""
    return slope_a + abs(height) * slope_b


@func
def displaced_bounds(
    bounds_a: Boxes, bounds_b: Boxes, height: float, side_growth_a: float
) -> Boxes:
    """Return the first shape's box, enlarged by the height."""
    return moved_out(bounds_a, abs(height), side_growth_a)


@func
def carved(a: float, b: float, depth: float) -> float:
    """Cut the second shape ``depth`` deep into the surface of the first (engraved text)."""
    return max(a, min(a + depth, -b))


@func
def embossed(a: float, b: float, height: float) -> float:
    """Raise the second shape by ``height`` on the surface of the first."""
    return min(a, max(a - height, b))


@func
def embossed_mix(a: float, b: float, height: float) -> float:
    """Return the share of ``b``: 1 on the raised part."""
    return select(max(a - height, b) < a, 1.0, 0.0)


@func
def embossed_bounds(bounds_a: Boxes, bounds_b: Boxes, height: float, side_growth_a: float) -> Boxes:
    """Return the first shape's box, enlarged by the height."""
    return moved_out(bounds_a, height, side_growth_a)


# A difference is exact inside only if the first shape is exact inside and the second outside. A
# union stays exact outside, an intersection inside; an exclusive or needs both of both shapes.
UNION = operator(
    "union",
    combine=union,
    keeps=EXACT_OUTSIDE,
    growth=Growth.KEPT,
)
INTERSECTION = operator(
    "intersection",
    combine=intersection,
    mix=farther_shows,
    keeps=INSIDE_AND_BOUND,
    bounds=overlap,
    growth=Growth.CORNERED,
)
DIFFERENCE = operator(
    "difference",
    combine=difference,
    mix=cutter_shows,
    keeps_exact=INSIDE_AND_BOUND,
    bounds=first_box,
    growth=Growth.FIRST,
    cuts=True,
)
XOR = operator(
    "xor",
    combine=xor,
    keeps_exact=EXACT,
    growth=Growth.KEPT,
)
COMPLEMENT = operator(
    "complement",
    finish=complement,
    keeps_exact=EXACT,
    bounds=endless,
    growth=Growth.HELD,
)
CLEARANCE = operator(
    "clearance",
    combine=clearance,
    mix=first_shows,
    bounds=first_box,
    limits={"gap": Limit.NOT_NEGATIVE},
    growth=Growth.FIRST,
    width=clearance_width,
)
MORPH = operator(
    "morph",
    combine=morph,
    mix=morph_mix,
    limits={"t": Limit.FRACTION},
    growth=Growth.KEPT,
)
DISPLACE = operator(
    "displace",
    combine=displaced,
    mix=first_shows,
    slope=displaced_slope,
    bounds=displaced_bounds,
    growth=Growth.FIRST,
)
CARVE = operator(
    "carve",
    combine=carved,
    mix=first_shows,
    bounds=first_box,
    limits={"depth": Limit.NOT_NEGATIVE},
    growth=Growth.FIRST,
)
EMBOSS = operator(
    "emboss",
    combine=embossed,
    mix=embossed_mix,
    bounds=embossed_bounds,
    limits={"height": Limit.NOT_NEGATIVE},
    growth=Growth.FIRST,
)
