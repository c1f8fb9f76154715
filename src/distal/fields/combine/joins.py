"""Shapes made of two others: unions, cuts, morphs, displacement.

Input: two distances. Output: the distance of the result, and the rules of its
slope, its box and its material. Blends are declared in ``blends``.
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
from distal.lang import abs, clamp, func, max, min, mix, select

# Materials of combinations


@func
def first_shows(a: float, b: float) -> float:
    """No share for ``b``: what the operator makes belongs to the first shape."""
    return 0.0


@func
def farther_shows(a: float, b: float) -> float:
    """The share of ``b`` in an intersection: the face that ends the shape."""
    return select(a < b, 1.0, 0.0)


@func
def cutter_shows(a: float, b: float) -> float:
    """The share of ``b`` in a difference: its face, seen from inside."""
    return select(a < -b, 1.0, 0.0)


# Boxes of combinations


@func
def first_box(bounds_a: Boxes, bounds_b: Boxes) -> Boxes:
    """The first shape's box: nothing is added to it."""
    return bounds_a


@func
def endless(bounds: Boxes) -> Boxes:
    """The box of a shape without end."""
    everything = bounds
    everything.low = bounds.low * 0.0 - UNBOUNDED
    everything.high = bounds.high * 0.0 + UNBOUNDED
    return everything


@func
def complement(d: float) -> float:
    """Everything but the shape."""
    return -d


@func
def union(a: float, b: float) -> float:
    """What is in either."""
    return min(a, b)


@func
def intersection(a: float, b: float) -> float:
    """What is in both."""
    return max(a, b)


@func
def difference(a: float, b: float) -> float:
    """The first without the second."""
    return max(a, -b)


@func
def xor(a: float, b: float) -> float:
    """What is in one and not in the other."""
    return max(min(a, b), -max(a, b))


@func
def clearance(a: float, b: float, gap: float) -> float:
    """The first without the second and all within ``gap`` of it: room for it to fit."""
    return max(a, gap - b)


@func
def morph(a: float, b: float, t: float) -> float:
    """Between two shapes: the first at t = 0, the second at t = 1."""
    return mix(a, b, t)


@func
def morph_mix(a: float, b: float, t: float) -> float:
    """The share of ``b``."""
    return t


@func
def displaced(a: float, b: float, height: float) -> float:
    """The first shape's surface moved out by the second field, times ``height``.

    The field counts from -1 to 1; what it has beyond is cut off, or there would be no box.
    """
    return a - height * clamp(b, -1.0, 1.0)


@func
def displaced_slope(slope_a: float, slope_b: float, height: float) -> float:
    """The field's slope counts by the height."""
    return slope_a + abs(height) * slope_b


@func
def displaced_bounds(
    bounds_a: Boxes, bounds_b: Boxes, height: float, side_growth_a: float
) -> Boxes:
    """The first shape's box, moved out by the height."""
    return moved_out(bounds_a, abs(height), side_growth_a)


@func
def carved(a: float, b: float, depth: float) -> float:
    """The second shape's form cut ``depth`` deep into the surface of the first (engraved text)."""
    return max(a, min(a + depth, -b))


@func
def embossed(a: float, b: float, height: float) -> float:
    """The second shape's form raised by ``height`` on the surface of the first."""
    return min(a, max(a - height, b))


@func
def embossed_mix(a: float, b: float, height: float) -> float:
    """The share of ``b``: all of what is raised."""
    return select(max(a - height, b) < a, 1.0, 0.0)


@func
def embossed_bounds(bounds_a: Boxes, bounds_b: Boxes, height: float, side_growth_a: float) -> Boxes:
    """The first shape's box, moved out by the height."""
    return moved_out(bounds_a, height, side_growth_a)


# Of a shape exact inside, cut by one exact outside, the inside is exact; only then. In a union the
# outside stays exact, in an intersection the inside; an exclusive or swaps the two.
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
