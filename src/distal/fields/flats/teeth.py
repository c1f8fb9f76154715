"""Straight-sided teeth in a row: the rack that a gear runs on, and the outline of screw threads.

Input: a point and the sizes of the teeth. Output: the exact distance to the region below the teeth.
``solids.threads`` winds the same outline around a cylinder.
"""

from __future__ import annotations

import math

from distal.fields.constants import PI
from distal.fields.flats.edges import from_segment, nearer
from distal.fields.guarantees import INSIDE_AND_BOUND, Bounds2, Limit, primitive
from distal.fields.widths import rack_width
from distal.lang import abs, clamp, func, length, max, round, select, tan, vec2


@func
def below_teeth(p: vec2, half_crest: float, half_root: float, pitch: float, depth: float) -> float:
    """Return the exact distance to the region below an infinite row of teeth, negative inside.

    The crests are at y = 0, one of them at x = 0; the roots are at y = -depth.

    Args:
        p: Point.
        half_crest: Half of a crest's width.
        half_root: Half of a root's width.
        pitch: Distance from tooth to tooth.
        depth: Depth of the roots.
    """
    u = abs(p.x - pitch * round(p.x / pitch))
    q = vec2(u, p.y)
    foot = 0.5 * pitch - half_root
    crest = from_segment(q, vec2(0.0), vec2(half_crest, 0.0))
    flank = from_segment(q, vec2(half_crest, 0.0), vec2(foot, -depth))
    root = from_segment(q, vec2(foot, -depth), vec2(0.5 * pitch, -depth))
    d = length(nearer(nearer(crest, flank), root))
    share = clamp((u - half_crest) / (foot - half_crest), 0.0, 1.0)
    return select(p.y < -depth * share, -d, d)


def _rack_is_whole(
    module: float, base: float, backlash: float, tip_gap: float, count: int, pressure_angle: float
) -> str | None:
    if count < 1:
        return "count must be 1 or more"
    if not 0.0 < pressure_angle < 0.25 * math.pi:
        return "pressure_angle must lie between 0 and pi / 4"
    lean = math.tan(pressure_angle)
    if 0.25 * math.pi * module - 0.5 * backlash <= lean * module:
        return "the teeth come to points: take less pressure_angle or backlash"
    if 0.25 * math.pi * module <= (1.0 + tip_gap) * lean * module - 0.5 * backlash:
        return "the gaps come to points: take less pressure_angle or tip_gap"
    return None


@func
def rack_bounds(module: float, base: float, tip_gap: float, count: int) -> Bounds2:
    """Return the rectangle from the bottom of the base to the tips of the teeth."""
    half = 0.5 * PI * module * float(count)
    return Bounds2(vec2(-half, -(1.0 + tip_gap) * module - base), vec2(half, module))


@primitive(
    "RackProfile",
    INSIDE_AND_BOUND,
    bounds=rack_bounds,
    growth=1.4142135623730951,
    side_growth=1.0,
    limits={
        "module": Limit.POSITIVE,
        "base": Limit.POSITIVE,
        "backlash": Limit.NOT_NEGATIVE,
        "tip_gap": Limit.NOT_NEGATIVE,
        "pressure_angle": Limit.POSITIVE,
    },
    requires=_rack_is_whole,
    width=rack_width,
)
@func
def rack_profile(
    p: vec2,
    module: float = 0.1,
    base: float = 0.15,
    backlash: float = 0.0,
    tip_gap: float = 0.25,
    count: int = 8,
    *,
    pressure_angle: float = 0.3490658503988659,
) -> float:
    """Toothed rack along x, teeth upwards, its pitch line at y = 0; gears of equal module mesh.

    A tooth or a gap is at x = 0, if ``count`` is odd or even; the ends are in the middle of gaps.

    Args:
        p: Point.
        module: Size of the teeth: their distance divided by pi; they are this high above the pitch
            line.
        base: Thickness of the bar below the teeth.
        backlash: By how much a tooth is narrower on the pitch line than half of the tooth distance.
        tip_gap: Depth of the gaps beyond the teeth of the other part, in modules.
        count: Number of teeth.
        pressure_angle: Angle of the flanks from the y axis, in radians.

    Source: the basic rack of ISO 53, with sharp corners.

    Measured:
        rack_profile((0.0, 3.0), 1.0, 1.5, 0.0, 0.25, 5) = 2.0
        rack_profile((0.0, -3.75), 1.0, 1.5, 0.0, 0.25, 4) = 1.0
        rack_profile((0.7853981633974483, 0.0), 1.0, 1.5, 0.0, 0.25, 5) = 0.0
    """
    distance = PI * module
    lean = tan(pressure_angle)
    half = 0.25 * distance - 0.5 * backlash
    half_crest = half - lean * module
    half_root = 0.5 * distance - half - lean * (1.0 + tip_gap) * module
    depth = (2.0 + tip_gap) * module
    # An even number of teeth has a gap in the middle.
    middle = 0.5 * distance * float((count + 1) % 2)
    teeth = below_teeth(vec2(p.x + middle, p.y - module), half_crest, half_root, distance, depth)
    bottom = -(1.0 + tip_gap) * module - base - p.y
    return max(max(teeth, bottom), abs(p.x) - 0.5 * distance * float(count))
