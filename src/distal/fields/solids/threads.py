"""Screw threads around the y axis, and the holes that they fit into.

Input: a point and the sizes of a thread. Output: a lower bound of the distance. The outline is that
of ISO metric threads (ISO 68-1): flanks at 60 degrees to each other, the tips cut off flat by an
eighth of the height of the full triangle, the grooves filled flat by a quarter.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.constants import HALF_ROOT, PI, TAU
from distal.fields.flats.edges import length_of
from distal.fields.flats.teeth import below_teeth
from distal.fields.guarantees import LOWER_BOUND, Bounds, Limit, primitive
from distal.fields.widths import thread_width
from distal.lang import abs, atan2, func, length, max, min, select, sqrt, vec2, vec3

# Depth of a thread for a pitch of 1: 5/8 of the height sqrt(3)/2 of the full triangle.
DEPTH: Final = 0.625 * 0.5 * math.sqrt(3.0)
# Half widths of crests and roots for a pitch of 1: their full widths are 1/8 and 1/4.
HALF_CREST: Final = 0.0625
HALF_ROOT_WIDTH: Final = 0.125
# The largest share of the outline's gradient along the axis, squared: on a flank, cos(30 deg).
ALONG: Final = 0.75


def _pitch_fits(diameter: float, pitch: float, length: float, bevel: float) -> str | None:
    if 2.0 * pitch > diameter:
        return "pitch may be at most half of diameter"
    if 2.0 * bevel >= min_of(diameter, length):
        return "bevel must be below half of diameter and half of length"
    return None


def _hole_fits(diameter: float, pitch: float) -> str | None:
    return "pitch may be at most half of diameter" if 2.0 * pitch > diameter else None


def min_of(a: float, b: float) -> float:
    """Return the smaller of two numbers; ``min`` is that of scene code here."""
    return a if a < b else b


@func
def minor_radius(diameter: float, pitch: float) -> float:
    """Return the radius at the bottom of the grooves."""
    return 0.5 * diameter - DEPTH * pitch


@func
def thread_steepest(diameter: float, pitch: float) -> float:
    """Return the bound on the gradient of the outline's distance, wound around the axis.

    A step around the axis at radius r moves the point along the outline by pitch / (2 pi r) times
    the step. Values are limited where r is below half of the minor radius (see ``wound``).
    """
    rise = pitch / (PI * minor_radius(diameter, pitch))
    return sqrt(1.0 + ALONG * rise * rise)


@func
def wound(p: vec3, diameter: float, pitch: float, left: bool) -> float:
    """Return the distance to an infinite thread in the half plane through the axis.

    Deeper inside than half of the minor radius it is constant: points with larger values are at
    least that far from the axis, because the value is above minus the depth below the grooves.
    """
    turns = pitch * atan2(p.z, p.x) / TAU
    along = p.y + select(left, -turns, turns)
    q = vec2(along, length(p.xz) - 0.5 * diameter)
    outline = below_teeth(q, HALF_CREST * pitch, HALF_ROOT_WIDTH * pitch, pitch, DEPTH * pitch)
    return max(outline, -0.5 * minor_radius(diameter, pitch))


@func
def thread_bounds(diameter: float, length: float) -> Bounds:
    """Return the box of the cylinder around the thread."""
    reach = vec3(0.5 * diameter, 0.5 * length, 0.5 * diameter)
    return Bounds(-reach, reach)


@func
def thread_side_growth(diameter: float, pitch: float) -> float:
    """Return the growth of the sides: the factor by which the outline's distance is divided."""
    return thread_steepest(diameter, pitch)


@func
def thread_growth(diameter: float, pitch: float) -> float:
    """Return the growth: that of a side, and that past an end at the same time."""
    return length(vec2(thread_steepest(diameter, pitch), 1.0))


@primitive(
    "Thread",
    LOWER_BOUND,
    bounds=thread_bounds,
    growth=thread_growth,
    side_growth=thread_side_growth,
    limits={"diameter": Limit.POSITIVE, "length": Limit.POSITIVE},
    requires=_pitch_fits,
    width=thread_width,
)
@func
def thread(
    p: vec3,
    diameter: float = 0.6,
    pitch: float = 0.1,
    length: float = 1.0,
    bevel: float = 0.06,
    left: bool = False,
) -> float:
    """Rod around the y axis with an external screw thread of the ISO metric outline.

    ``MetricThread`` knows the pitches of the usual sizes.

    Args:
        p: Point.
        diameter: Outer (nominal) diameter, over the crests.
        pitch: Distance from crest to crest, at most half of ``diameter``.
        length: Full length of the rod.
        bevel: Size of the chamfers at 45 degrees at both ends.
        left: Whether the thread is left-handed.

    Source: ISO 68-1 (basic profile); the distance to it in the half plane through the axis, divided
        by the bound on its slope.

    Measured:
        thread((3.0, 0.0, 0.0), 6.0, 1.0, 16.0, 0.0) = 0.0
        thread((2.4587341, 0.5, 0.0), 6.0, 1.0, 16.0, 0.0) = 0.0
        thread((0.0, 9.5, 0.0), 6.0, 1.0, 16.0, 0.5) = 1.5
    """
    outward = length_of(p.xz)
    past = abs(p.y) - 0.5 * length
    edge = HALF_ROOT * (outward - 0.5 * diameter + past + bevel)
    turned = wound(p, diameter, pitch, left) / thread_steepest(diameter, pitch)
    return max(turned, max(past, edge))


@func
def tapped_hole_bounds(
    diameter: float,
    pitch: float,
    length: float,
    gap: float,
    countersink: float,
    through: bool,
) -> Bounds:
    """Return the box of the cylinder around the hole with its mouths."""
    radius = 0.5 * diameter + gap + countersink
    high = 0.5 * length + pitch
    low = select(through, high, 0.5 * length)
    return Bounds(vec3(-radius, -low, -radius), vec3(radius, high, radius))


@primitive(
    "TappedHole",
    LOWER_BOUND,
    bounds=tapped_hole_bounds,
    growth=thread_growth,
    side_growth=thread_side_growth,
    limits={
        "diameter": Limit.POSITIVE,
        "length": Limit.POSITIVE,
        "gap": Limit.NOT_NEGATIVE,
    },
    requires=_hole_fits,
    width=thread_width,
)
@func
def tapped_hole(
    p: vec3,
    diameter: float = 0.6,
    pitch: float = 0.1,
    length: float = 1.0,
    gap: float = 0.01,
    countersink: float = 0.02,
    left: bool = False,
    through: bool = True,
) -> float:
    """Internal screw thread around the y axis, to subtract from a part ``length`` thick.

    It is the ``Thread`` of the same numbers, moved outwards by the gap. The mouth widens at
    45 degrees. Beyond the mouth the hole goes on for one pitch, so that it cuts the face cleanly.

    Args:
        p: Point.
        diameter: Nominal diameter: that of the ``Thread`` that fits.
        pitch: Distance from crest to crest, at most half of ``diameter``.
        length: Full length of the thread; the faces of the part are at half of it.
        gap: Gap between the two threads, in a half plane through the axis.
        countersink: How much wider than the thread the mouth is, on each side.
        left: Whether the thread is left-handed.
        through: Whether the hole has two mouths; otherwise it ends flat at its lower end.

    Source: ISO 68-1 (basic profile), which internal and external threads share.

    Measured:
        tapped_hole((3.0, 0.0, 0.0), 6.0, 1.0, 16.0, 0.0, 0.0) = 0.0
        tapped_hole((0.0, 12.0, 0.0), 6.0, 1.0, 16.0, 0.2, 0.5) = 3.0
        tapped_hole((0.0, -10.0, 0.0), 6.0, 1.0, 16.0, 0.2, 0.5, False, False) = 2.0
    """
    outward = length_of(p.xz)
    turned = (wound(p, diameter, pitch, left) - gap) / thread_steepest(diameter, pitch)
    half = 0.5 * length
    height = select(through, abs(p.y), p.y)
    radius = 0.5 * diameter + gap + countersink
    mouth = max(outward - radius, HALF_ROOT * (outward - radius + half - height))
    ends = max(height - half - pitch, select(through, -half, -half - p.y))
    return max(min(turned, mouth), ends)
