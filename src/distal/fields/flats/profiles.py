"""Profiles of machine parts, and distances stored in an image.

Input: a point, and the numbers or the image of a shape. Output: the distance, negative inside.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.constants import PI
from distal.fields.flats.boxes import UNIT_SQUARE, rectangle_bounds
from distal.fields.flats.curved import egg, egg_bounds, uneven_capsule, uneven_capsule_bounds
from distal.fields.flats.edges import disc_bounds, fold_sectors, from_segment
from distal.fields.flats.round import from_arc
from distal.fields.guarantees import EXACT, NOTHING, Bounds2, Limit, primitive
from distal.fields.widths import cam_width, gear_width
from distal.lang import (
    Texture2D,
    abs,
    atan,
    atan2,
    clamp,
    cos,
    floor,
    func,
    ivec2,
    length,
    max,
    min,
    mix,
    select,
    sin,
    sqrt,
    tan,
    texel,
    vec2,
)
from distal.lang import size as size_of

# Height of teeth above the pitch circle, and depth below it, in modules (ISO 53).
ADDENDUM: Final = 1.0
DEDENDUM: Final = 1.25
# Slope of bilinear interpolation between texels that differ by at most their distance.
IMAGE_SLOPE: Final = 1.4142135623730951


def _teeth_are_whole(
    radius: float,
    addendum: float,
    dedendum: float,
    backlash: float,
    count: int,
    pressure_angle: float,
) -> str | None:
    if count < 4:
        return "count must be 4 or more"
    if not 0.0 < pressure_angle < 0.25 * math.pi:
        return "pressure_angle must lie between 0 and pi / 4"
    if 2.0 * dedendum >= count:
        return "the gaps reach the middle: take more teeth or a smaller dedendum"
    tip = (1.0 + 2.0 * addendum / count) / math.cos(pressure_angle)
    roll = math.sqrt(tip * tip - 1.0)
    half = 0.5 * math.pi / count - 0.5 * backlash / radius
    half += math.tan(pressure_angle) - pressure_angle
    root = (1.0 - 2.0 * dedendum / count) / math.cos(pressure_angle)
    foot = math.sqrt(root * root - 1.0) if root > 1.0 else 0.0
    if half - foot + math.atan(foot) >= math.pi / count:
        return "the teeth have no gaps: take fewer teeth or a smaller pressure_angle"
    if half <= roll - math.atan(roll):
        return "the teeth come to points below their tips: take more teeth or less pressure_angle"
    return None


def _nose_stands_out(base: float, nose: float, lift: float) -> str | None:
    if base + lift - nose <= math.fabs(base - nose):
        return "nose must be small enough to stand out of the base circle"
    return None


def _arc_nose_stands_out(base: float, nose: float, lift: float, bulge: float) -> str | None:
    if bulge == 0.0:
        return "bulge must be above 0 (TangentCam has straight flanks)"
    return _nose_stands_out(base, nose, lift)


@func
def gear_bounds(radius: float, addendum: float, count: int) -> Bounds2:
    """Return the square around the tips of the teeth."""
    return disc_bounds(radius * (1.0 + 2.0 * addendum / float(count)))


@primitive(
    "GearProfile",
    EXACT,
    bounds=gear_bounds,
    limits={
        "addendum": Limit.POSITIVE,
        "dedendum": Limit.POSITIVE,
        "pressure_angle": Limit.POSITIVE,
    },
    requires=_teeth_are_whole,
    width=gear_width,
)
@func
def gear_profile(
    p: vec2,
    radius: float = 0.5,
    addendum: float = ADDENDUM,
    dedendum: float = DEDENDUM,
    backlash: float = 0.0,
    count: int = 12,
    *,
    pressure_angle: float = 0.3490658503988659,
) -> float:
    """Gear with involute teeth, one of them at the top; gears with equal teeth mesh.

    Two gears mesh if radius / count and the pressure angle are equal; the distance of their centres
    is then the sum of their radii. Below the base circle of the involutes, the flanks are straight
    lines to the middle; the corners at their feet are sharp.

    Args:
        p: Point.
        radius: Radius of the pitch circle, on which gears roll on each other.
        addendum: Height of the teeth above the pitch circle, in modules (diameter by ``count``).
        dedendum: Depth of the gaps below the pitch circle, in modules.
        backlash: By how much a tooth is narrower, along the pitch circle, than half of the distance
            from tooth to tooth; negative for the gaps of a ring with internal teeth.
        count: Number of teeth.
        pressure_angle: Angle between the normal of a flank and the direction of motion on the pitch
            circle, in radians.

    Source: an involute's normals touch its base circle, so that involutes of one circle are
    parallel curves (Leonhard Euler, 1765); proportions of ISO 53.

    Measured:
        gear_profile((0.0, 5.0), 1.2, 1.0, 1.25, 0.0, 12) = 3.6
        gear_profile((0.0, 0.0), 1.2, 1.0, 1.25, 0.0, 12) = -0.95
        gear_profile((0.13052619222005, 0.99144486137381), 1.0, 1.0, 1.25, 0.0, 12) = 0.0
    """
    module = 2.0 * radius / float(count)
    tip = radius + addendum * module
    root = radius - dedendum * module
    base = radius * cos(pressure_angle)
    # Angles from the tooth's middle to the start of its involute on the base circle, and its ends.
    middle = (
        0.5 * PI / float(count) - 0.5 * backlash / radius + tan(pressure_angle) - pressure_angle
    )
    roll_tip = sqrt(max(tip * tip - base * base, 0.0)) / base
    roll_foot = sqrt(max(root * root - base * base, 0.0)) / base
    at_tip = middle - roll_tip + atan(roll_tip)
    at_foot = middle - roll_foot + atan(roll_foot)
    foot = vec2(sin(at_foot), cos(at_foot))

    q = fold_sectors(p, count)
    from_middle = length(q)
    angle = atan2(q.x, q.y)
    # The tangent to the base circle through q is perpendicular to the flank.
    roll = sqrt(max(from_middle * from_middle - base * base, 0.0)) / base
    turned = angle + roll - atan(roll) - middle
    met = roll - turned
    on_flank = from_middle > base and met > roll_foot and met < roll_tip

    d = length(from_segment(q, root * foot, max(root, base) * foot))
    d = min(d, from_arc(q, tip, at_tip))
    d = select(on_flank, min(d, abs(base * turned)), d)
    d = select(angle > at_foot, min(d, abs(from_middle - root)), d)
    inside = from_middle < root or (from_middle < tip and turned < 0.0)
    return select(inside, -d, d)


@func
def tangent_cam_bounds(base: float, nose: float, lift: float) -> Bounds2:
    """Return the rectangle around both circles."""
    return uneven_capsule_bounds(base, nose, base + lift - nose)


@primitive(
    "TangentCam",
    EXACT,
    bounds=tangent_cam_bounds,
    limits={"base": Limit.POSITIVE, "nose": Limit.POSITIVE, "lift": Limit.POSITIVE},
    requires=_nose_stands_out,
    width=cam_width,
)
@func
def tangent_cam(p: vec2, base: float = 0.4, nose: float = 0.15, lift: float = 0.3) -> float:
    """Cam with straight flanks that rotates about the origin, its nose at the top.

    Args:
        p: Point.
        base: Radius of the base circle.
        nose: Radius of the nose.
        lift: Height of the nose above the base circle.

    Source: two circles and their common tangents.

    Measured:
        tangent_cam((0.0, 6.0), 2.0, 1.0, 1.0) = 3.0
        tangent_cam((0.0, -6.0), 2.0, 1.0, 1.5) = 4.0
        tangent_cam((3.0, 0.5), 1.0, 1.0, 4.0) = 2.0
    """
    return uneven_capsule(p, base, nose, base + lift - nose)


@func
def arc_cam_bounds(base: float, nose: float, lift: float, bulge: float) -> Bounds2:
    """Return the rectangle around both circles and the flanks."""
    return egg_bounds(base, nose, base + lift - nose, bulge)


@primitive(
    "ArcCam",
    EXACT,
    bounds=arc_cam_bounds,
    limits={
        "base": Limit.POSITIVE,
        "nose": Limit.POSITIVE,
        "lift": Limit.POSITIVE,
        "bulge": Limit.FRACTION,
    },
    requires=_arc_nose_stands_out,
    width=cam_width,
)
@func
def arc_cam(
    p: vec2, base: float = 0.4, nose: float = 0.15, lift: float = 0.3, bulge: float = 0.4
) -> float:
    """Cam with convex flanks that rotates about the origin, its nose at the top.

    Args:
        p: Point.
        base: Radius of the base circle.
        nose: Radius of the nose.
        lift: Height of the nose above the base circle.
        bulge: From 0 (exclusive) for nearly straight flanks to 1 for flanks with the radius of half
            the cam's height.

    Source: the egg of two circles.

    Measured:
        arc_cam((0.0, 6.0), 2.0, 1.0, 1.0, 0.5) = 3.0
        arc_cam((0.0, -6.0), 2.0, 1.0, 1.5, 0.25) = 4.0
        arc_cam((3.0, 5.0), 1.0, 1.0, 2.0, 1.0) = 3.0
    """
    return egg(p, base, nose, base + lift - nose, bulge)


@func
def interpolated(image: Texture2D, place: vec2) -> float:
    """Interpolate the first channel between texels bilinearly; unlike ``sample``, differentiable.

    Args:
        image: The image.
        place: Position in texels from the centre of the lower left one.
    """
    corner = floor(place)
    share = place - corner
    at = ivec2(corner)
    low = mix(texel(image, at).x, texel(image, at + ivec2(1, 0)).x, share.x)
    high = mix(texel(image, at + ivec2(0, 1)).x, texel(image, at + ivec2(1, 1)).x, share.x)
    return mix(low, high, share.y)


@primitive("ImageField", NOTHING, slope=IMAGE_SLOPE, bounds=rectangle_bounds, growth=1.0)
@func
def image_field(
    p: vec2, image: Texture2D, size: vec2 = UNIT_SQUARE, value_scale: float = 1.0
) -> float:
    """Shape from distances stored in the first channel of an image.

    Neighboring texels must differ by at most the distance between their centres, and the outermost
    texels must be outside the shape, as in any image of distances.

    Args:
        p: Point.
        image: The distances, negative inside.
        size: Width and height of the image, which is centred at the origin.
        value_scale: Distance of a texel of value 1.

    Source: bilinear interpolation; outside the image the way to it is added.

    Measured:
        image_field((3.0, 0.0), Texture2D([[0.5, 0.5], [0.5, 0.5]]), (2.0, 2.0)) = 3.0
        image_field((0.0, 0.0), Texture2D([[0.0, 1.0], [0.0, 1.0]]), (2.0, 2.0)) = 0.5
        image_field((0.0, 0.5), Texture2D([[1.0, 1.0], [0.0, 0.0]]), (2.0, 2.0), 3.0) = 3.0
    """
    texels = vec2(size_of(image))
    # The centres of the outermost texels bound the interpolated region.
    reach = 0.5 * size * (1.0 - 1.0 / texels)
    inside = clamp(p, -reach, reach)
    return value_scale * interpolated(image, (inside / size + 0.5) * texels - 0.5) + length(
        p - inside
    )
