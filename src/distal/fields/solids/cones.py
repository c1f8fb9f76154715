"""Cones: with a tip, truncated, rounded, infinite; upright or between two points.

Input: a point and the numbers of a shape. Output: the distance. Each cone is computed from its
profile, in coordinates of the distance from the axis and the height above the middle.
"""

from __future__ import annotations

from distal.fields.chords import in_cone
from distal.fields.constants import TINY
from distal.fields.guarantees import EXACT, INSIDE_AND_BOUND, UNBOUNDED, Bounds, Limit, primitive
from distal.fields.solids.axes import (
    HIGH_END,
    LOW_END,
    UPWARD,
    apart,
    around_axis,
    around_y,
    axis_direction,
    balls_bounds,
    below_a_turn,
    discs_bounds,
    upright_bounds,
)
from distal.fields.widths import (
    cone_between_width,
    cone_width,
    end_radii_width,
    ends_width,
    frustum_between_width,
    frustum_width,
)
from distal.lang import abs, clamp, cos, dot, func, length, max, min, select, sin, sqrt, vec2, vec3


@func
def inside_cone(q: vec2, angle: float) -> float:
    """Return the distance to the region within ``angle`` of the downward axis, for q.x >= 0."""
    s = sin(angle)
    c = cos(angle)
    beside = q.x * c + q.y * s
    # If the side is not nearest, the tip is.
    tip = length(q)
    return select(q.x * s > q.y * c, beside, select(beside > 0.0, tip, -tip))


@primitive(
    "InfiniteCone",
    EXACT,
    requires=below_a_turn,
    width=UNBOUNDED,
)
@func
def infinite_cone(p: vec3, *, opening: float = 1.0) -> float:
    """Infinite cone that opens downwards from its tip at the origin.

    Args:
        p: Point.
        opening: Whole angle between opposite sides in radians, below 2 pi.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        infinite_cone((0.0, 5.0, 0.0), opening=1.0) = 5.0
        infinite_cone((0.0, -2.0, 0.0), opening=1.0471975511965976) = -1.0
        infinite_cone((3.0, -1.0, 0.0), opening=1.5707963267948966) = 1.4142135623730951
    """
    return inside_cone(around_y(p), 0.5 * opening)


@func
def capped_cone_profile(q: vec2, bottom: float, top: float, height: float) -> float:
    """Return the distance to a truncated cone.

    ``q`` is the distance from the axis and the height above the middle.
    """
    half = 0.5 * height
    slant = vec2(top - bottom, height)
    offset = vec2(q.x - bottom, q.y + half)
    side = offset - slant * clamp(dot(offset, slant) / dot(slant, slant), 0.0, 1.0)
    end_radius = select(q.y < 0.0, bottom, top)
    end = vec2(max(q.x - end_radius, 0.0), abs(q.y) - half)
    nearest = length(select(dot(end, end) < dot(side, side), end, side))
    inside = offset.x * slant.y < offset.y * slant.x and end.y < 0.0
    return select(inside, -nearest, nearest)


@func
def capped_cone_bounds(bottom: float, top: float, height: float) -> Bounds:
    """Return the box of an upright truncated cone."""
    return upright_bounds(max(bottom, top), -0.5 * height, 0.5 * height)


def capped_cone_requires(bottom: float, top: float) -> str | None:
    """Return why both radii cannot be 0, or None."""
    return None if bottom > 0.0 or top > 0.0 else "bottom or top must be above 0"


@func
def capped_cone_chord(p: vec3, direction: vec3, bottom: float, top: float, height: float) -> vec2:
    """Return the part of a line inside."""
    return in_cone(p, direction, UPWARD, bottom, top, height)


@primitive(
    "CappedCone",
    EXACT,
    chord=capped_cone_chord,
    bounds=capped_cone_bounds,
    limits={"bottom": Limit.NOT_NEGATIVE, "top": Limit.NOT_NEGATIVE},
    requires=capped_cone_requires,
    width=frustum_width,
)
@func
def capped_cone(p: vec3, bottom: float = 0.6, top: float = 0.3, height: float = 1.0) -> float:
    """Upright truncated cone (frustum), centred at the origin.

    Args:
        p: Point.
        bottom: Radius at the lower end.
        top: Radius at the upper end.
        height: Full height.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        capped_cone((0.0, 3.0, 0.0), 1.0, 0.5, 2.0) = 2.0
        capped_cone((4.0, -5.0, 0.0), 1.0, 0.5, 2.0) = 5.0
        capped_cone((1.0, 0.0, 0.0), 0.5, 0.5, 2.0) = 0.5
    """
    return capped_cone_profile(around_y(p), bottom, top, height)


@func
def capped_cone_between_bounds(
    start: vec3, end: vec3, start_radius: float, end_radius: float
) -> Bounds:
    """Return the box around the two ends."""
    return discs_bounds(start, end, start_radius, end_radius)


def capped_cone_between_requires(
    start: vec3, end: vec3, start_radius: float, end_radius: float
) -> str | None:
    """Return why both radii cannot be 0, or None."""
    if start_radius > 0.0 or end_radius > 0.0:
        return apart(start, end)
    return "start_radius or end_radius must be above 0"


@func
def capped_cone_between_chord(
    p: vec3, direction: vec3, start: vec3, end: vec3, start_radius: float, end_radius: float
) -> vec2:
    """Return the part of a line inside."""
    axis = axis_direction(start, end)
    height = max(length(end - start), TINY)
    return in_cone(p - 0.5 * (start + end), direction, axis, start_radius, end_radius, height)


@primitive(
    "CappedConeBetween",
    EXACT,
    chord=capped_cone_between_chord,
    bounds=capped_cone_between_bounds,
    limits={"start_radius": Limit.NOT_NEGATIVE, "end_radius": Limit.NOT_NEGATIVE},
    requires=capped_cone_between_requires,
    width=frustum_between_width,
)
@func
def capped_cone_between(
    p: vec3,
    start: vec3 = LOW_END,
    end: vec3 = HIGH_END,
    start_radius: float = 0.6,
    end_radius: float = 0.3,
) -> float:
    """Truncated cone (frustum) whose ends are centred at two points.

    Args:
        p: Point.
        start: Centre of one end.
        end: Centre of the other end.
        start_radius: Radius at ``start``.
        end_radius: Radius at ``end``.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        capped_cone_between((5.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0, 0.5) = 3.0
        capped_cone_between((-4.0, 4.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0, 0.5) = 5.0
        capped_cone_between((1.0, 0.0, 1.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5, 0.5) = 0.5
    """
    return capped_cone_profile(
        around_axis(p, start, end), start_radius, end_radius, max(length(end - start), TINY)
    )


@func
def cone_bounds(radius: float, height: float) -> Bounds:
    """Return the box of an upright cone."""
    return upright_bounds(radius, -0.5 * height, 0.5 * height)


@func
def cone_chord(p: vec3, direction: vec3, radius: float, height: float) -> vec2:
    """Return the part of a line inside."""
    return in_cone(p, direction, UPWARD, radius, 0.0, height)


@primitive(
    "Cone",
    EXACT,
    bounds=cone_bounds,
    chord=cone_chord,
    width=cone_width,
)
@func
def cone(p: vec3, radius: float = 0.5, height: float = 1.0) -> float:
    """Upright cone with its tip at the top.

    Args:
        p: Point.
        radius: Radius of the base; ``height * tan(0.5 * opening)`` for an opening at the tip.
        height: Full height; the origin is at half of it.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cone((0.0, 3.0, 0.0), 1.0, 2.0) = 2.0
        cone((4.0, -5.0, 0.0), 1.0, 2.0) = 5.0
        cone((0.0, -0.75, 0.0), 1.0, 2.0) = -0.25
    """
    return capped_cone_profile(around_y(p), radius, 0.0, height)


@func
def cone_cheap_growth(radius: float, height: float) -> float:
    """Return the growth: how far the tip or the rim moves if side and base move by 1."""
    side = length(vec2(height, radius))
    return max(side / radius, length(vec2((side + radius) / height, 1.0)))


@primitive(
    "ConeCheap",
    INSIDE_AND_BOUND,
    bounds=cone_bounds,
    growth=cone_cheap_growth,
    chord=cone_chord,
    width=cone_width,
)
@func
def cone_cheap(p: vec3, radius: float = 0.5, height: float = 1.0) -> float:
    """Upright cone as the maximum of side and base; a lower bound beyond tip and rim.

    Args:
        p: Point.
        radius: Radius of the base.
        height: Full height; the origin is at half of it.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cone_cheap((0.0, 3.0, 0.0), 1.0, 2.0) = 0.8944271909999159
        cone_cheap((0.0, -3.0, 0.0), 1.0, 2.0) = 2.0
        cone_cheap((0.0, -0.75, 0.0), 1.0, 2.0) = -0.25
    """
    half = 0.5 * height
    # Distance to the side, from the tip: its normal is (height, radius), normalised.
    beside = (length(p.xz) * height + (p.y - half) * radius) / length(vec2(height, radius))
    return max(beside, -half - p.y)


@func
def cone_between_bounds(start: vec3, end: vec3, radius: float) -> Bounds:
    """Return the box around the base and the tip."""
    return discs_bounds(start, end, radius, 0.0)


@func
def cone_between_chord(p: vec3, direction: vec3, start: vec3, end: vec3, radius: float) -> vec2:
    """Return the part of a line inside."""
    axis = axis_direction(start, end)
    height = max(length(end - start), TINY)
    return in_cone(p - 0.5 * (start + end), direction, axis, radius, 0.0, height)


@primitive(
    "ConeBetween",
    EXACT,
    bounds=cone_between_bounds,
    requires=apart,
    chord=cone_between_chord,
    width=cone_between_width,
)
@func
def cone_between(
    p: vec3, start: vec3 = LOW_END, end: vec3 = HIGH_END, radius: float = 0.5
) -> float:
    """Cone given by the centre of its base and its tip.

    Args:
        p: Point.
        start: Centre of the base.
        end: Tip.
        radius: Radius of the base.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        cone_between((5.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = 3.0
        cone_between((-4.0, 4.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = 5.0
        cone_between((0.25, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0) = -0.25
    """
    return capped_cone_profile(
        around_axis(p, start, end), radius, 0.0, max(length(end - start), TINY)
    )


@func
def round_cone_profile(q: vec2, bottom: float, top: float, height: float) -> float:
    """Return the distance to two balls and the cone tangent to both.

    ``q`` is the distance from the axis and the height. The normal of the cone's side is (cosine,
    sine); planes through the balls' centres along this normal separate the points nearest to a ball
    from those nearest to the side.
    """
    # Beyond -1 or 1, one ball contains the other and is the whole shape.
    sine = clamp((bottom - top) / max(height, TINY), -1.0, 1.0)
    cosine = sqrt(1.0 - sine * sine)
    low = q.y + 0.5 * height
    along = low * cosine - q.x * sine
    at_bottom = length(vec2(q.x, low)) - bottom
    at_top = length(vec2(q.x, low - height)) - top
    beside = q.x * cosine + low * sine - bottom
    only_top = sine <= -1.0
    upper = select(along >= cosine * height, at_top, beside)
    return select(along <= 0.0 and not only_top, at_bottom, upper)


@func
def round_cone_bounds(bottom: float, top: float, length: float) -> Bounds:
    """Return the box around two balls, one above the other."""
    half = 0.5 * length
    return upright_bounds(
        max(bottom, top), min(-half - bottom, half - top), max(half + top, bottom - half)
    )


@primitive(
    "RoundCone",
    EXACT,
    bounds=round_cone_bounds,
    limits={"bottom": Limit.POSITIVE, "top": Limit.POSITIVE, "length": Limit.NOT_NEGATIVE},
    width=ends_width,
)
@func
def round_cone(p: vec3, bottom: float = 0.5, top: float = 0.25, length: float = 1.0) -> float:
    """Cone with rounded ends: two balls, one above the other, and the cone tangent to both.

    Args:
        p: Point.
        bottom: Radius of the lower ball.
        top: Radius of the upper ball.
        length: Distance between the balls' centres.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        round_cone((0.0, 3.0, 0.0), 1.0, 0.5, 2.0) = 1.5
        round_cone((0.0, -5.0, 3.0), 1.0, 0.5, 2.0) = 4.0
        round_cone((2.0, 0.0, 0.0), 0.5, 0.5, 2.0) = 1.5
    """
    return round_cone_profile(around_y(p), bottom, top, length)


@func
def round_cone_between_bounds(
    start: vec3, end: vec3, start_radius: float, end_radius: float
) -> Bounds:
    """Return the box around the two balls."""
    return balls_bounds(start, end, start_radius, end_radius)


@primitive(
    "RoundConeBetween",
    EXACT,
    bounds=round_cone_between_bounds,
    limits={"start_radius": Limit.POSITIVE, "end_radius": Limit.POSITIVE},
    width=end_radii_width,
)
@func
def round_cone_between(
    p: vec3,
    start: vec3 = LOW_END,
    end: vec3 = HIGH_END,
    start_radius: float = 0.5,
    end_radius: float = 0.25,
) -> float:
    """Cone with rounded ends: balls around two points, and the cone tangent to both.

    Args:
        p: Point.
        start: Centre of one ball.
        end: Centre of the other.
        start_radius: Radius at ``start``.
        end_radius: Radius at ``end``.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        round_cone_between((4.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0, 0.5) = 1.5
        round_cone_between((-3.0, 4.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0, 0.5) = 4.0
        round_cone_between((1.0, 0.0, 2.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5, 0.5) = 1.5
    """
    return round_cone_profile(
        around_axis(p, start, end), start_radius, end_radius, length(end - start)
    )
