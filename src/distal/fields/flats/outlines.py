"""Outlines of letters and drawings: closed chains of lines and of quadratic Bézier curves.

Input: a point, and the edges as data. Curves must rise or fall all the way, so that each
crosses a level once; whoever makes the data splits them (``scene.outlines``). Output: the
distance to the nearest edge, negative where the chains go around.

No class is made of this primitive: only ``scene.objects.outlines`` writes its data.
"""

from __future__ import annotations

from typing import Final

from distal.fields.flats.curves import from_bezier
from distal.fields.flats.edges import from_segment, nearer, turned_from
from distal.fields.guarantees import EXACT_OUTSIDE, Bounds2, Primitive
from distal.lang import Buffer, abs, dot, func, length, max, min, select, size, sqrt, vec2, vec4

SMALLEST: Final = 1e-30


@func
def line_winding(p: vec2, start: vec2, end: vec2) -> int:
    """1 or -1 where the line crosses the level of ``p`` to its right, upward or downward."""
    below = start.y <= p.y
    crosses = below != (end.y <= p.y)
    left = turned_from(end - start, p - start) > 0.0
    return select(crosses and left == below, select(below, 1, -1), 0)


@func
def curve_winding(p: vec2, start: vec2, control: vec2, end: vec2) -> int:
    """As ``line_winding``, for a curve that rises or falls all the way.

    The place of crossing is the root of a quadratic, in the form that divides by no difference.
    """
    below = start.y <= p.y
    crosses = below != (end.y <= p.y)
    bend = start.y - 2.0 * control.y + end.y
    half = control.y - start.y
    rest = start.y - p.y
    root = sqrt(max(half * half - bend * rest, 0.0))
    divisor = abs(half) + root
    t = min(abs(rest) / max(divisor, SMALLEST), 1.0)
    x = start.x + (2.0 * (control.x - start.x) + (start.x - 2.0 * control.x + end.x) * t) * t
    return select(crosses and p.x < x, select(below, 1, -1), 0)


@func
def outline_bounds(lines: Buffer[vec4], curves: Buffer[vec2]) -> Bounds2:
    """The rectangle around all edges' ends and control points."""
    low = curves[0]
    high = curves[0]
    for i in range(1, size(curves)):
        low = min(low, curves[i])
        high = max(high, curves[i])
    for i in range(size(lines)):
        low = min(low, min(lines[i].xy, lines[i].zw))
        high = max(high, max(lines[i].xy, lines[i].zw))
    return Bounds2(low, high)


@func
def outline(p: vec2, lines: Buffer[vec4], curves: Buffer[vec2], even_odd: bool = False) -> float:
    """What closed chains of lines and quadratic curves go around.

    Outside the distance is exact; inside too where no two chains overlap. Where they do, edges that
    lie inside count as well.

    Args:
        p: Point.
        lines: Start and end of each line.
        curves: Start, control point and end of each curve, one after the other; each rises or falls
            all the way.
        even_odd: Whether what is gone around twice is a hole; else it is solid, unless it is gone
            around as often the other way.

    Source: the nearest edge, and the winding number by the edges that cross the level of ``p`` to
    its right.
    """
    nearest = p - lines[0].xy
    winding = 0
    for i in range(size(lines)):
        line = lines[i]
        nearest = nearer(nearest, from_segment(p, line.xy, line.zw))
        winding += line_winding(p, line.xy, line.zw)
    for i in range(size(curves) // 3):
        start = curves[3 * i]
        control = curves[3 * i + 1]
        end = curves[3 * i + 2]
        winding += curve_winding(p, start, control, end)
        # A curve lies in the box of its three points: most are too far away to be asked.
        beyond = max(max(min(start, control, end) - p, p - max(start, control, end)), vec2(0.0))
        if dot(beyond, beyond) < dot(nearest, nearest):
            nearest = nearer(nearest, from_bezier(p, start, control, end))
    d = length(nearest)
    solid = winding % 2 != 0 if even_odd else winding != 0
    return select(solid, -d, d)


OUTLINE: Final = Primitive("Outline", outline, EXACT_OUTSIDE, bounds=outline_bounds)
