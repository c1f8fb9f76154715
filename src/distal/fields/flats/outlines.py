"""Outlines of letters and drawings: closed chains of lines and quadratic Bézier curves.

Input: a point, and the edges as data. Curves must be monotonic in y, so that each crosses a
horizontal line once; the code that makes the data splits them (``scene.objects.outlines``). Output:
the distance to the nearest edge, negative where the chains wind around the point.

No class is made from this primitive: only ``scene.objects.outlines`` makes its data.
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
    """Return 1 or -1 if the line crosses the horizontal through ``p`` to its right.

    It is 1 upwards and -1 downwards; 0 if there is no crossing.
    """
    below = start.y <= p.y
    crosses = below != (end.y <= p.y)
    left = turned_from(end - start, p - start) > 0.0
    return select(crosses and left == below, select(below, 1, -1), 0)


@func
def curve_winding(p: vec2, start: vec2, control: vec2, end: vec2) -> int:
    """Return the same as ``line_winding`` for a curve that is monotonic in y.

    The crossing is the root of a quadratic, in the form that is not divided by a difference.
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
    """Return the rectangle around the ends and control points of all edges."""
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
    """Area enclosed by closed chains of lines and quadratic curves.

    Outside, the distance is exact; inside too if no two chains overlap. Where chains overlap, edges
    inside the area also count as surface.

    Args:
        p: Point.
        lines: Start and end of each line.
        curves: Start, control point and end of each curve, one after the other; each curve is
            monotonic in y.
        even_odd: Whether to use the even-odd rule, in which an area enclosed twice is a hole;
            otherwise the nonzero rule.

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
        # A curve lies in the box of its three points; most are too far away to be evaluated.
        beyond = max(max(min(start, control, end) - p, p - max(start, control, end)), vec2(0.0))
        if dot(beyond, beyond) < dot(nearest, nearest):
            nearest = nearer(nearest, from_bezier(p, start, control, end))
    d = length(nearest)
    solid = winding % 2 != 0 if even_odd else winding != 0
    return select(solid, -d, d)


OUTLINE: Final = Primitive("Outline", outline, EXACT_OUTSIDE, bounds=outline_bounds)
