"""Flat shapes with sides made of circular arcs: lenses, moons, hearts, eggs and capsules.

Input: a point and the numbers of a shape. Output: the distance, negative inside.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.constants import HALF_ROOT, TINY
from distal.fields.flats.edges import LEFT, RIGHT, centred_bounds, length_of, nearer, turned_from
from distal.fields.guarantees import EXACT, Bounds2, Limit, primitive
from distal.fields.widths import (
    cross_width,
    ends_width,
    half_width,
    heart_width,
    moon_width,
    segment_width,
)
from distal.lang import abs, dot, func, length, max, min, select, sqrt, vec2, vec3

# Height of the heart whose square has diagonal 1: the square, with half a disc on each upper side.
HEART_HEIGHT: Final = 1.1035533905932737  # 3/4 + sqrt(1/8)
HEART_REACH: Final = 0.6035533905932737  # 1/4 + sqrt(1/8)
HEART_LOBE: Final = 0.3535533905932738  # sqrt(1/8)


def _is_upright(width: float, height: float) -> str | None:
    return "width may be at most height" if width > height else None


def _is_flat(width: float, height: float) -> str | None:
    return "height may be at most width" if height > width else None


def _lens_is_long(start: tuple[float, ...], end: tuple[float, ...], width: float) -> str | None:
    square = (start[0] - end[0]) ** 2 + (start[1] - end[1]) ** 2
    return "width may be at most the way from start to end" if width**2 > square else None


def _circles_cross(radius: float, cut_radius: float, shift: float) -> str | None:
    if not math.fabs(radius - cut_radius) < shift < radius + cut_radius:
        return "the two circles must cross"
    return None


def _sides_touch_both(bottom: float, top: float, length: float) -> str | None:
    if length <= math.fabs(bottom - top):
        return "length must be more than the difference of the radii"
    return None


def _egg_is_convex(bottom: float, top: float, length: float, bulge: float) -> str | None:
    if bulge == 0.0:
        return "bulge must be above 0 (UnevenCapsule has straight sides)"
    return _sides_touch_both(bottom, top, length)


def _bars_are_thin(span: float, thickness: float) -> str | None:
    return "thickness may be at most half of span" if 2.0 * thickness > span else None


@func
def lens_bounds(width: float, height: float) -> Bounds2:
    """Return the rectangle of this width and height."""
    return centred_bounds(0.5 * vec2(width, height))


@primitive(
    "Vesica",
    EXACT,
    bounds=lens_bounds,
    requires=_is_upright,
    width=half_width,
)
@func
def vesica(p: vec2, width: float = 0.6, height: float = 1.0) -> float:
    """Lens: the intersection of two equal discs, with its tips on the y axis.

    Args:
        p: Point.
        width: Width of the lens, at most the height.
        height: Distance between the tips.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        vesica((0.0, 0.0), 2.0, 4.0) = -1.0
        vesica((0.0, 5.0), 2.0, 4.0) = 3.0
        vesica((3.0, 0.0), 2.0, 4.0) = 2.0
    """
    half = 0.5 * vec2(width, height)
    # Distance of the centre of the right side's circle to the left of the y axis.
    offset = (half.y * half.y - half.x * half.x) / (2.0 * half.x)
    q = abs(p)
    beyond_tip = (q.y - half.y) * offset > half.y * q.x
    past_side = length(vec2(q.x + offset, q.y)) - (offset + half.x)
    return select(beyond_tip, length(vec2(q.x, q.y - half.y)), past_side)


@func
def oriented_vesica_bounds(start: vec2, end: vec2, width: float) -> Bounds2:
    """Return the rectangle around the disc that contains the tips and the sides."""
    middle = 0.5 * (start + end)
    reach = 0.5 * length(end - start)
    wide = 0.5 * width
    return Bounds2(
        max(middle - reach, min(start, end) - wide), min(middle + reach, max(start, end) + wide)
    )


@primitive(
    "OrientedVesica",
    EXACT,
    bounds=oriented_vesica_bounds,
    requires=_lens_is_long,
    width=half_width,
)
@func
def oriented_vesica(p: vec2, start: vec2 = LEFT, end: vec2 = RIGHT, width: float = 0.5) -> float:
    """Lens with its tips at two given points.

    Args:
        p: Point.
        start: First tip.
        end: Second tip.
        width: Full width in the middle, at most the distance between the tips.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        oriented_vesica((0.0, 0.0), (-2.0, 0.0), (2.0, 0.0), 2.0) = -1.0
        oriented_vesica((5.0, 0.0), (-2.0, 0.0), (2.0, 0.0), 2.0) = 3.0
        oriented_vesica((0.0, 3.0), (-2.0, 0.0), (2.0, 0.0), 2.0) = 2.0
    """
    along = end - start
    height = length(along)
    direction = along / max(height, TINY)
    q = p - 0.5 * (start + end)
    return vesica(vec2(turned_from(direction, q), dot(q, direction)), width, height)


@func
def moon_bounds(radius: float, cut_radius: float, shift: float) -> Bounds2:
    """Return the rectangle around the left side and as far right as the shape extends."""
    across = (radius * radius - cut_radius * cut_radius + shift * shift) / (2.0 * shift)
    corner = sqrt(max(radius * radius - across * across, 0.0))
    high = select(across > 0.0, radius, corner)
    return Bounds2(vec2(-radius, -high), vec2(max(across, shift - cut_radius), high))


@primitive(
    "Moon",
    EXACT,
    bounds=moon_bounds,
    limits={"cut_radius": Limit.POSITIVE, "shift": Limit.POSITIVE},
    requires=_circles_cross,
    width=moon_width,
)
@func
def moon(p: vec2, radius: float = 0.7, cut_radius: float = 0.6, shift: float = 0.4) -> float:
    """Moon: a disc around the origin minus a second disc to its right.

    Args:
        p: Point.
        radius: Radius of the disc.
        cut_radius: Radius of the disc that is subtracted.
        shift: Distance of the second centre to the right; the circles must intersect.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        moon((-7.0, 0.0), 5.0, 5.0, 6.0) = 2.0
        moon((2.0, 0.0), 5.0, 5.0, 6.0) = 1.0
        moon((6.0, 8.0), 5.0, 5.0, 6.0) = 5.0
    """
    across = (radius * radius - cut_radius * cut_radius + shift * shift) / (2.0 * shift)
    corner = vec2(across, sqrt(max(radius * radius - across * across, 0.0)))
    centre = vec2(shift, 0.0)
    q = vec2(p.x, abs(p.y))
    past_circle = length(q) - radius
    past_cut = cut_radius - length(q - centre)
    on_circle = past_circle > 0.0 and turned_from(corner, q) > 0.0
    on_cut = past_cut > 0.0 and turned_from(corner - centre, q - centre) > 0.0
    past = max(past_circle, past_cut)
    elsewhere = select(past > 0.0, length(q - corner), past)
    return select(on_circle, past_circle, select(on_cut, past_cut, elsewhere))


@primitive(
    "CircleCross",
    EXACT,
    bounds=lens_bounds,
    requires=_is_flat,
    width=segment_width,
)
@func
def circle_cross(p: vec2, width: float = 1.0, height: float = 0.8) -> float:
    """Star with four points and concave sides made of circular arcs.

    Args:
        p: Point.
        width: Distance from the left to the right point, where the sides are horizontal.
        height: Distance from the lower to the upper point, at most the width.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        circle_cross((0.0, 0.0), 2.0, 2.0) = -0.41421356237309515
        circle_cross((3.0, 0.0), 2.0, 2.0) = 2.0
        circle_cross((4.0, 4.0), 2.0, 2.0) = 5.0
    """
    half = 0.5 * vec2(width, height)
    # The circle is tangent to the x axis at the right point and passes through the upper one.
    radius = dot(half, half) / (2.0 * half.y)
    q = abs(p)
    before = q.x < half.x and (q.y - half.y) * half.x < q.x * (radius - half.y)
    from_points = length(nearer(q - vec2(half.x, 0.0), q - vec2(0.0, half.y)))
    return select(before, radius - length(q - vec2(half.x, radius)), from_points)


@func
def heart_bounds(height: float) -> Bounds2:
    """Return the rectangle around the heart."""
    return centred_bounds(height * vec2(HEART_REACH / HEART_HEIGHT, 0.5))


@primitive(
    "Heart",
    EXACT,
    bounds=heart_bounds,
    width=heart_width,
)
@func
def heart(p: vec2, height: float = 1.0) -> float:
    """Heart: a square standing on its corner, with half a disc on each upper side.

    Args:
        p: Point.
        height: Distance from the tip to the top; the middle between them is the origin.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        heart((0.0, -2.5), 4.0) = 0.5
        heart((0.0, -0.5), 1.0) = 0.0
        heart((0.0, 0.44822330470336313), 1.1035533905932737) = 0.0
    """
    scale = height / HEART_HEIGHT
    # Coordinates in units of the square's diagonal, from its lowest corner.
    q = vec2(abs(p.x), p.y + 0.5 * height) / scale
    past_lobe = length(q - vec2(0.25, 0.75)) - HEART_LOBE
    from_side = q - vec2(0.5 * max(q.x + q.y, 0.0))
    from_rest = length(nearer(q - vec2(0.0, 1.0), from_side))
    below = select(q.y > q.x, -from_rest, from_rest)
    return scale * select(q.x + q.y > 1.0, past_lobe, below)


@func
def uneven_capsule_bounds(bottom: float, top: float, length: float) -> Bounds2:
    """Return the rectangle around both circles."""
    reach = max(bottom, top)
    return Bounds2(vec2(-reach, -bottom), vec2(reach, length + top))


@primitive(
    "UnevenCapsule",
    EXACT,
    bounds=uneven_capsule_bounds,
    limits={"bottom": Limit.POSITIVE, "top": Limit.NOT_NEGATIVE},
    requires=_sides_touch_both,
    width=ends_width,
)
@func
def uneven_capsule(p: vec2, bottom: float = 0.4, top: float = 0.2, length: float = 0.6) -> float:
    """Two discs, one above the other, and the region between their common tangents.

    Args:
        p: Point.
        bottom: Radius of the lower disc, around the origin.
        top: Radius of the upper disc.
        length: Distance between the centres, more than the difference of the radii.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        uneven_capsule((0.0, -5.0), 2.0, 1.0, 4.0) = 3.0
        uneven_capsule((0.0, 8.0), 2.0, 1.0, 4.0) = 3.0
        uneven_capsule((3.0, 2.0), 1.0, 1.0, 4.0) = 2.0
    """
    q = vec2(abs(p.x), p.y)
    # The tangent's normal is (rise, lean).
    lean = (bottom - top) / length
    rise = sqrt(max(1.0 - lean * lean, 0.0))
    along = q.y * rise - q.x * lean
    past_top = length_of(vec2(q.x, q.y - length)) - top
    past_side = q.x * rise + q.y * lean - bottom
    upper = select(along > length * rise, past_top, past_side)
    return select(along < 0.0, length_of(q) - bottom, upper)


@func
def egg_side(bottom: float, top: float, length: float, bulge: float) -> vec3:
    """Return centre (x, y) and radius (z) of the circle of the right side."""
    radius = 0.5 * (length + bottom + top) / bulge
    to_bottom = radius - bottom
    to_top = radius - top
    below = (to_top * to_top - to_bottom * to_bottom - length * length) / (2.0 * length)
    return vec3(-sqrt(max(to_bottom * to_bottom - below * below, 0.0)), -below, radius)


@func
def egg_bounds(bottom: float, top: float, length: float, bulge: float) -> Bounds2:
    """Return the rectangle around both circles and the sides."""
    side = egg_side(bottom, top, length, bulge)
    reach = select(side.y > 0.0 and side.y < length, side.x + side.z, max(bottom, top))
    return Bounds2(vec2(-reach, -bottom), vec2(reach, length + top))


@primitive(
    "Egg",
    EXACT,
    bounds=egg_bounds,
    limits={"bottom": Limit.POSITIVE, "top": Limit.POSITIVE, "bulge": Limit.FRACTION},
    requires=_egg_is_convex,
    width=ends_width,
)
@func
def egg(
    p: vec2, bottom: float = 0.4, top: float = 0.2, length: float = 0.4, bulge: float = 0.6
) -> float:
    """Egg: two discs, one above the other, with convex sides tangent to both.

    Args:
        p: Point.
        bottom: Radius of the lower disc, around the origin.
        top: Radius of the upper disc.
        length: Distance between the centres, more than the difference of the radii.
        bulge: From 0 (exclusive) for nearly straight sides to 1 for sides with the radius of half
            the egg's height.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/).

    Measured:
        egg((0.0, 1.0), 1.0, 1.0, 2.0, 1.0) = -2.0
        egg((3.0, 5.0), 1.0, 1.0, 2.0, 1.0) = 3.0
        egg((0.0, -5.0), 2.0, 1.0, 2.0, 0.5) = 3.0
    """
    side = egg_side(bottom, top, length, bulge)
    q = vec2(abs(p.x), p.y)
    # The lines from the side's centre through the discs' centres separate the three circles.
    below = turned_from(side.xy, q) > 0.0
    upper = vec2(0.0, length)
    above = turned_from(side.xy - upper, q - upper) < 0.0
    centre = select(below, vec2(0.0), select(above, upper, side.xy))
    radius = select(below, bottom, select(above, top, side.z))
    return length_of(q - centre) - radius


@func
def rounded_x_bounds(span: float, thickness: float) -> Bounds2:
    """Return the square around the discs at the four ends."""
    reach = HALF_ROOT * 0.5 * (span - thickness) + 0.5 * thickness
    return centred_bounds(vec2(reach))


@primitive(
    "RoundedX",
    EXACT,
    bounds=rounded_x_bounds,
    limits={"span": Limit.POSITIVE},
    requires=_bars_are_thin,
    width=cross_width,
)
@func
def rounded_x(p: vec2, span: float = 1.2, thickness: float = 0.25) -> float:
    """X of two bars with round ends along the diagonals.

    Args:
        p: Point.
        span: Length of each bar, including its ends.
        thickness: Full width of each bar, at most half of its length.

    Source: its edge and its end in one eighth of the plane.

    Measured:
        rounded_x((0.0, 0.0), 4.0, 2.0) = -1.4142135623730951
        rounded_x((3.0, 3.0), 4.0, 2.0) = 2.2426406871192848
        rounded_x((0.0, 1.4142135623730951), 4.0, 2.0) = 0.0
    """
    end = 0.5 * (span - thickness)
    radius = 0.5 * thickness
    q = abs(p)
    along = HALF_ROOT * (q.x + q.y)
    across = HALF_ROOT * abs(q.x - q.y)
    past_end = length(vec2(along - end, across)) - radius
    from_side = length(vec2(along - max(along, radius), across - radius))
    past_side = select(across < radius, -from_side, from_side)
    return select(along > end, past_end, past_side)
