"""Lines with a width along waves and spirals, and the "cool S".

Input: a point and the numbers of a curve. Output: the distance to the region that a disc covers as
it moves along the curve.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from distal.fields.constants import PI
from distal.fields.flats.curves import from_arc_pair
from distal.fields.flats.edges import centred_bounds, disc_bounds, from_segment, nearer
from distal.fields.flats.round import from_arc
from distal.fields.guarantees import (
    EXACT_OUTSIDE,
    UNBOUNDED,
    Approximation,
    Bounds2,
    Limit,
    primitive,
)
from distal.fields.widths import growing_spiral_width, spiral_width, thickness_width
from distal.lang import (
    abs,
    clamp,
    cos,
    exp,
    func,
    length,
    log,
    max,
    min,
    mod,
    round,
    select,
    sin,
    vec2,
)

# Number of pieces per turn of a spiral; each piece is two parabolas.
SPIRAL_PIECES: Final = 12
STEEPEST_WAVE: Final = 5.0 / 3.0 * math.pi
# Of the S with half height 1: the distance of its vertical lines, and the height of their ends.
COOL_S_STEP: Final = 0.4
COOL_S_LOW: Final = 0.2
COOL_S_HIGH: Final = 0.6


def _arcs_are_apart(opening: float) -> str | None:
    if opening > STEEPEST_WAVE:
        return "opening may be at most 5/3 pi: there neighboring arcs touch"
    return None


def _turns_once(inner: float, outer: float, turns: int) -> str | None:
    if turns < 1:
        return "turns must be 1 or more"
    return "outer must be more than inner" if outer <= inner else None


@func
def circle_wave_bounds(radius: float, thickness: float, opening: float) -> Bounds2:
    """Return the bounds of the arcs' height; infinite to the left and right."""
    high = radius * (1.0 - cos(0.5 * opening)) + 0.5 * thickness
    return Bounds2(vec2(-UNBOUNDED, -high), vec2(UNBOUNDED, high))


@primitive(
    "CircleWave",
    EXACT_OUTSIDE,
    bounds=circle_wave_bounds,
    requires=_arcs_are_apart,
    width=thickness_width,
)
@func
def circle_wave(
    p: vec2, radius: float = 0.25, *, thickness: float = 0.05, opening: float = 3.6
) -> float:
    """Infinite wave of circular arcs along the x axis, with a crest at x = 0.

    Args:
        p: Point.
        radius: Radius of the arcs' middle line.
        thickness: Full width of the line.
        opening: Whole angle of an arc in radians, at its centre, from one crossing of the axis to
            the next; at most 5/3 pi, where adjacent arcs touch.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        circle_wave((0.0, 4.0), 1.0, thickness=1.0, opening=3.141592653589793) = 2.5
        circle_wave((2.0, -4.0), 1.0, thickness=1.0, opening=3.141592653589793) = 2.5
        circle_wave((4.0, 0.0), 1.0, thickness=0.5, opening=3.141592653589793) = 0.75
    """
    half = 0.5 * opening
    quarter = radius * sin(half)
    depth = radius * cos(half)
    # Mirror the point to between a crest's centre and the next trough's; measure from both centres.
    x = abs(mod(p.x + 2.0 * quarter, 4.0 * quarter) - 2.0 * quarter)
    crest = from_arc(vec2(x, p.y + depth), radius, half)
    trough = from_arc(vec2(2.0 * quarter - x, depth - p.y), radius, half)
    return min(crest, trough) - 0.5 * thickness


@func
def cool_s_bounds(height: float, thickness: float) -> Bounds2:
    """Return the rectangle around the S."""
    return centred_bounds(0.5 * vec2(height * COOL_S_STEP, height) + 0.5 * thickness)


@primitive(
    "CoolS",
    EXACT_OUTSIDE,
    bounds=cool_s_bounds,
    width=thickness_width,
)
@func
def cool_s(p: vec2, height: float = 1.0, thickness: float = 0.03) -> float:
    """The "cool S", a figure of 14 straight lines that pupils draw.

    Args:
        p: Point.
        height: Distance from the lower to the upper tip, along the middle of the lines.
        thickness: Full width of the lines.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/), for the figure; here its lines in one half,
    which half a turn brings onto the other.

    Measured:
        cool_s((0.0, 3.0), 2.0, 0.5) = 1.75
        cool_s((3.0, 0.4), 2.0, 0.5) = 2.35
        cool_s((0.0, 0.0), 2.0, 0.25) = 0.016421356237309517
    """
    scale = 0.5 * height
    q = select(p.y < 0.0, -p, p) / scale
    column = q.x - COOL_S_STEP * clamp(round(q.x / COOL_S_STEP), -1.0, 1.0)
    nearest = vec2(column, q.y - clamp(q.y, COOL_S_LOW, COOL_S_HIGH))
    roof = from_segment(vec2(abs(q.x), q.y), vec2(0.0, 1.0), vec2(COOL_S_STEP, COOL_S_HIGH))
    # Two lines go down to the right through both halves; a third ends at the second.
    left = from_segment(q, vec2(-COOL_S_STEP, COOL_S_LOW), vec2(0.0, -COOL_S_LOW))
    right = from_segment(q, vec2(0.0, COOL_S_LOW), vec2(COOL_S_STEP, -COOL_S_LOW))
    hidden = from_segment(q, vec2(COOL_S_STEP, COOL_S_LOW), vec2(0.5 * COOL_S_STEP, 0.0))
    nearest = nearer(nearer(nearest, roof), nearer(left, nearer(right, hidden)))
    return scale * length(nearest) - 0.5 * thickness


@func
def spiral_bounds(outer: float, radius: float) -> Bounds2:
    """Return the square around the last turn."""
    return disc_bounds(outer + radius)


@func
def from_spiral(p: vec2, turns: int, radius_at: Callable[[float], vec2]) -> vec2:
    """Return the vector from the nearest point of a counterclockwise spiral to p.

    The spiral starts on the x axis.

    Args:
        p: Point.
        turns: Number of whole turns.
        radius_at: Distance from the middle as a function of the angle, and its derivative.
    """
    step = 2.0 * PI / float(SPIRAL_PIECES)
    start = vec2(radius_at(0.0).x, 0.0)
    leaving = step * vec2(radius_at(0.0).y, radius_at(0.0).x)
    nearest = p - start
    closest = length(nearest)
    for i in range(SPIRAL_PIECES * turns):
        angle = float(i + 1) * step
        out = vec2(cos(angle), sin(angle))
        r = radius_at(angle)
        end = r.x * out
        arriving = step * (r.y * out + r.x * vec2(-out.y, out.x))
        # A piece lies within the disc around its middle that contains its ends and control points.
        middle = 0.5 * (start + end)
        first = length(start + 0.25 * leaving - middle)
        second = length(end - 0.25 * arriving - middle)
        reach = max(max(first, second), length(end - middle))
        if length(p - middle) - reach < closest:
            nearest = nearer(nearest, from_arc_pair(p, start, leaving, end, arriving))
            closest = length(nearest)
        start = end
        leaving = arriving
    return nearest


@primitive(
    "ArchimedeanSpiral",
    EXACT_OUTSIDE,
    bounds=spiral_bounds,
    limits={"inner": Limit.NOT_NEGATIVE, "outer": Limit.POSITIVE},
    requires=_turns_once,
    approximates=Approximation("a spiral", 1.2e-4),
    width=spiral_width,
)
@func
def archimedean_spiral(
    p: vec2, inner: float = 0.1, outer: float = 1.0, turns: int = 3, radius: float = 0.04
) -> float:
    """Spiral line with a constant distance between turns, counterclockwise from the x axis.

    The distance is exact for the approximation by 24 parabolas per turn, whose deviation is below
    1e-3 of the outer radius (measured).

    Args:
        p: Point.
        inner: Distance from the middle at the start.
        outer: Distance from the middle at the end, more than at the start.
        turns: Number of whole turns.
        radius: Half of the line's width.

    Source: Archimedes, "On Spirals".

    Measured:
        archimedean_spiral((5.0, 0.0), 0.5, 2.5, 2, 0.25) = 2.25
        archimedean_spiral((2.5, 0.0), 0.5, 2.5, 2, 0.25) = -0.25
        archimedean_spiral((-1.0, 0.0), 0.5, 2.5, 2, 0.25) = -0.25
    """
    growth = (outer - inner) / (2.0 * PI * float(turns))
    return (
        length(from_spiral(p, turns, lambda angle: vec2(inner + growth * angle, growth))) - radius
    )


@primitive(
    "LogarithmicSpiral",
    EXACT_OUTSIDE,
    bounds=spiral_bounds,
    limits={"inner": Limit.POSITIVE, "outer": Limit.POSITIVE},
    requires=_turns_once,
    approximates=Approximation("a spiral", 1.7e-4),
    width=growing_spiral_width,
)
@func
def logarithmic_spiral(
    p: vec2, inner: float = 0.05, outer: float = 1.0, turns: int = 3, radius: float = 0.02
) -> float:
    """Spiral line whose radius grows by a constant factor per turn.

    It turns counterclockwise from the x axis. The distance is exact for the approximation by 24
    parabolas per turn, whose deviation is below 1e-3 of the outer radius (measured).

    Args:
        p: Point.
        inner: Distance from the middle at the start.
        outer: Distance from the middle at the end, more than at the start.
        turns: Number of whole turns.
        radius: Half of the line's width.

    Source: Jacob Bernoulli, "Spira mirabilis" (1692).

    Measured:
        logarithmic_spiral((1.0, 0.0), 0.25, 1.0, 2, 0.125) = -0.125
        logarithmic_spiral((0.5, 0.0), 0.25, 1.0, 2, 0.125) = -0.125
        logarithmic_spiral((-2.0, 0.0), 1.0, 16.0, 2, 0.125) = -0.125
    """
    growth = log(outer / inner) / (2.0 * PI * float(turns))
    return (
        length(
            from_spiral(
                p,
                turns,
                lambda angle: inner * exp(growth * angle) * vec2(1.0, growth),
            )
        )
        - radius
    )
