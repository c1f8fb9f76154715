"""Terrain: the solid below a height that depends on x and z.

Input: a point, and the height from an image or from a flat field (whose value is the height).
Output: the vertical distance to the surface, divided so that it is never more than the true
distance. ``RELIEF`` makes terrain from any flat shape or function.
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import (
    LOWER_BOUND,
    NOTHING,
    UNBOUNDED,
    Bounds,
    Bounds2,
    Growth,
    Limit,
    operator,
    primitive,
)
from distal.lang import (
    Texture2D,
    clamp,
    floor,
    func,
    inversesqrt,
    ivec2,
    length,
    max,
    min,
    mix,
    texel,
    vec2,
    vec3,
)
from distal.lang import size as size_of

GROUND_SIZE: Final = vec2(4.0)
# Neighboring texels of a picture, whose values are between 0 and 1, differ by at most this.
ANY_RISE: Final = vec2(1.0)


@func
def interpolated(image: Texture2D, place: vec2) -> float:
    """Interpolate the first channel bilinearly; ``place`` is in texels from the first centre."""
    last = size_of(image) - 1
    lower = clamp(ivec2(floor(place)), ivec2(0), max(last - 1, ivec2(0)))
    upper = min(lower + 1, last)
    weight = place - vec2(lower)
    bottom = mix(texel(image, lower).x, texel(image, ivec2(upper.x, lower.y)).x, weight.x)
    top = mix(texel(image, ivec2(lower.x, upper.y)).x, texel(image, upper).x, weight.x)
    return mix(bottom, top, weight.y)


@func
def above_height(y: float, height: float, steepness: float) -> float:
    """Return the vertical distance, scaled to the distance from a plane of this steepness."""
    return (y - height) * inversesqrt(1.0 + steepness * steepness)


@primitive(
    "Heightfield",
    LOWER_BOUND,
    limits={"height": Limit.NOT_ZERO, "rise": Limit.NOT_NEGATIVE},
    tier=2,
    measured={"rise": "image"},
)
@func
def heightfield(
    p: vec3,
    image: Texture2D,
    size: vec2 = GROUND_SIZE,
    height: float = 1.0,
    rise: vec2 = ANY_RISE,
) -> float:
    """Terrain from the first channel of an image; its border heights continue without end.

    The bound follows from the data. Between four texels, the derivative of the bilinear
    interpolation along an axis is a weighted mean of the differences of two pairs of neighbors, so
    it is at most the largest difference of neighbors along this axis, divided by their distance.
    The vertical distance is divided by the steepness that follows for both axes together.

    Args:
        p: Point.
        image: The heights. The image lies in the xz plane, its upper side at the smallest z.
        size: Size of the image along x and z, centred at the origin.
        height: Height of a texel of value 1.
        rise: The largest differences of neighboring texels along x and z.

    Source: John C. Hart, "Sphere tracing" (1996), for the bound.

    Measured:
        heightfield((0.0, 3.0, 0.0), Texture2D([[0.5, 0.5]]), (2.0, 2.0), 2.0, (0.0, 0.0)) = 2.0
        heightfield((0.0, 3.0, 0.0), Texture2D([[0.0, 1.0]]), (4.0, 4.0), 1.5, (1.0, 0.0)) = 1.8
        heightfield((9.0, 3.0, 9.0), Texture2D([[0.0, 1.0]]), (4.0, 4.0), 1.5, (1.0, 0.0)) = 1.2
    """
    texels = vec2(size_of(image))
    share = vec2(p.x, -p.z) / size + 0.5
    place = clamp(share * texels - 0.5, vec2(0.0), texels - 1.0)
    steepness = height * length(rise * texels / size)
    return above_height(p.y, height * interpolated(image, place), steepness)


@func
def on_the_ground(p: vec3) -> vec2:
    """Return the point of the image plane above or below p; its upper side is at small z."""
    return vec2(p.x, -p.z)


@func
def relief_value(d: float, p: vec3, slope: float) -> float:
    """Return the distance to the ground whose height is the flat field's value."""
    return above_height(p.y, d, slope)


@func
def relief_slope(slope: float) -> float:
    """Return 1, or no bound if the child has none."""
    return UNBOUNDED if slope >= UNBOUNDED / 1000.0 else 1.0


@func
def relief_bounds(bounds: Bounds2) -> Bounds:
    """Return an infinite box."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED))


RELIEF = operator(
    "relief",
    point=on_the_ground,
    finish=relief_value,
    keeps=NOTHING,
    slope=relief_slope,
    needs="a flat field with a bound on its slope",
    bounds=relief_bounds,
    growth=Growth.HELD,
)
"""Terrain: the values of a flat field, ``Shape2D.from_function(height, slope=…)``, as heights."""
