"""One of two shapes, by a condition that may change; and nothing, a field without a surface.

Input: two distances and a condition. Output: the distance of the shape that the condition selects.
The object model evaluates that shape only (``scene.lowering.selection``): its slope, box and
material are the result's.
"""

from __future__ import annotations

from typing import Final

from distal.fields.chords import missed
from distal.fields.extents import Boxes
from distal.fields.guarantees import (
    EXACT,
    Bounds,
    Bounds2,
    Growth,
    Operator,
    Primitive,
)
from distal.lang import func, select, vec2, vec3

# The distance to nothing. Its square and its cube are finite in 32 bits; as a corner of a box it is
# less than ``ENDLESS``, because nothing is empty, not infinite.
NOWHERE: Final = 1e12


@func
def either(a: float, b: float, second: bool) -> float:
    """Return the second distance if the condition holds, else the first."""
    return select(second, b, a)


@func
def share_of_second(a: float, b: float, second: bool) -> float:
    """Return the share of ``b``: all or nothing."""
    return select(second, 1.0, 0.0)


@func
def box_if(bounds: Boxes, exists: bool) -> Boxes:
    """Return a box, or one that contains no point: its high corner is below its low one."""
    chosen = bounds
    chosen.low = select(exists, bounds.low, bounds.low * 0.0 + NOWHERE)
    chosen.high = select(exists, bounds.high, bounds.high * 0.0 - NOWHERE)
    return chosen


@func
def nothing(p: vec3) -> float:
    """Return the distance to nothing."""
    return NOWHERE


@func
def chord_of_nothing(p: vec3, direction: vec3) -> vec2:
    """Return the chord of a line in nothing: it misses."""
    return missed()


@func
def nothing_flat(p: vec2) -> float:
    """Return the distance to nothing in the plane."""
    return NOWHERE


@func
def no_room() -> Bounds:
    """Return an empty box: nothing takes up no space."""
    return Bounds(vec3(0.0), vec3(0.0))


@func
def no_room_flat() -> Bounds2:
    """Return a rectangle without a size."""
    return Bounds2(vec2(0.0), vec2(0.0))


# These three are not in the catalogue: authors write ``select``, ``choose`` and ``shown``.
SELECT = Operator(
    "select",
    combine=either,
    mix=share_of_second,
    keeps=EXACT,
    growth=Growth.KEPT,
)
NOTHING = Primitive("nothing", nothing, EXACT, 0.0, no_room, chord=chord_of_nothing)
NOTHING_FLAT = Primitive("nothing", nothing_flat, EXACT, 0.0, no_room_flat)
NOTHINGS: Final = frozenset((NOTHING, NOTHING_FLAT))
