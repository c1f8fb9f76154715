"""Shadows: how much of a light's disc is visible from a point.

Input: a field, a point, a light. Output: the visible share, from 0 to 1. There is no noise: a point
has the same shadow on every target and in every frame. Decision 21 has the measurements.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import (
    Field3,
    cos,
    cross,
    func,
    gradient,
    max,
    min,
    normalize,
    select,
    sin,
    sqrt,
    struct,
    vec3,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March
from distal.render.normals import tangent
from distal.render.shadow_ray import Edge, find_edge, share_of_disc

WHITE = vec3(1.0)
SHARPEST = 0.003  # smallest tangent of a light's half angle: sharper shadows would be noisy
NARROW = 0.01  # below this tangent, one ray to the middle of the light is enough
ENOUGH_SAMPLES = 4  # from so many samples of a pixel on, each has one ray to a wide light
MOST_RAYS = 16  # rays to the widest lights, seen by one sample
TURN = 6.28318531
GOLDEN_ANGLE = 2.399963
# How far out points of a disc are, and the radius of the part of it around each, in radii of the
# disc: a search for the least error beside straight edges of all directions (rms .008 with 5 points
# on a circle, .016 with 16 in a sunflower's order), and beside thin plates.
MOST_ON_CIRCLE = 9
CIRCLE = 0.66
CIRCLE_PART = 0.5
SUNFLOWER = 0.97
SUNFLOWER_PART = 1.3


@struct
class Opening:
    """How much of a light is visible.

    Attributes:
        share: From 0, nothing, to 1, all of it.
        lost: Whether the steps of a ray ran out.
        tint: What glass in front of the light lets through.
    """

    share: float
    lost: bool = False
    tint: vec3 = WHITE


@func
def toward_light(light: LightSample, k: int, count: int) -> vec3:
    """Return the unit direction to a point of a light's disc.

    Few points are on a circle, more in a sunflower's order.

    Args:
        light: The light.
        k: The number of the point, from 0.
        count: How many points there are.
    """
    is_circle = count <= MOST_ON_CIRCLE
    place = (float(k) + 0.5) / float(count)
    angle = select(is_circle, TURN * place, GOLDEN_ANGLE * float(k))
    out = light.radius * select(is_circle, CIRCLE, SUNFLOWER * sqrt(place))
    right = tangent(light.direction)
    above = cross(light.direction, right)
    return normalize(light.direction + out * (cos(angle) * right + sin(angle) * above))


@func
def part_of_disc(count: int) -> float:
    """Return the radius of the part of a disc around each of its points, in radii of the disc."""
    return select(count <= MOST_ON_CIRCLE, CIRCLE_PART, SUNFLOWER_PART / sqrt(float(count)))


@func
def soft_shadow(
    field: Field3,
    origin: vec3,
    light: LightSample,
    bounds: Bounds,
    numbers: March,
    steps: int,
    steep: bool = False,
    sample: int = 0,
    samples: int = 1,
) -> Opening:
    """Return the visible fraction of a light: 1 in full light, 0 in full shadow.

    One sample approximates the disc of a narrow light by one ray to its middle: the share that a
    straight edge leaves open, outside or inside of what the ray comes close to (Inigo Quilez, "Soft
    shadows in raymarched SDFs"). If the ray to a wide light is not sure that all or nothing of the
    disc is visible, several rays share the disc. From 4 samples of a pixel on, each sample has one
    ray to its own part of the disc, and their mean is the share.

    Args:
        field: Signed distance.
        origin: Start of the shadow ray.
        light: The light at the point.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        steps: Maximum number of steps of one ray.
        steep: Whether values may be less than distances; a constant.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """

    def slope(p: vec3) -> vec3:
        return gradient(field, p)

    def edge(ray: Ray, width: float, end: float, needs_offset: bool) -> Edge:
        return find_edge(field, slope, ray, width, end, bounds, numbers, steps, steep, needs_offset)

    return opening(edge, origin, light, numbers.far, sample, samples)


@func
def opening(
    edge: Callable[[Ray, float, float, bool], Edge],
    origin: vec3,
    light: LightSample,
    far: float,
    sample: int,
    samples: int,
) -> Opening:
    """Return the visible fraction of a light, from what single rays find; see ``soft_shadow``.

    Args:
        edge: Where the edge of the shadow is, as one ray finds it; takes the ray to the middle of a
            disc, the disc's radius at distance 1, where the ray ends, and whether the edge's
            offset must be known if it is not sure that all or nothing of the disc is visible.
        origin: Start of the shadow ray.
        light: The light at the point.
        far: The distance at which rays end.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """
    end = min(light.distance, far)
    whole = max(light.radius, SHARPEST)
    is_narrow = light.radius < NARROW
    by_sample = samples >= ENOUGH_SAMPLES and not is_narrow
    parts = samples if by_sample else rays_to(light.radius)
    part = part_of_disc(parts)
    is_alone = is_narrow or by_sample
    total = 0.0
    lost = False
    # The first ray goes to the middle of the whole disc, but that of a sample to its own part.
    for k in range(MOST_RAYS + 1):
        ray = Ray(origin, light.direction)
        width = whole
        if k > 0 or by_sample:
            ray = Ray(origin, toward_light(light, sample if by_sample else k - 1, parts))
            width = whole * part
        needs_offset = is_alone or k > 0
        found = edge(ray, width, end, needs_offset)
        lost = lost or found.lost
        share = share_of_disc(found.offset)
        if is_alone or (k == 0 and found.is_sure):
            return Opening(share, lost)
        total += select(k == 0, 0.0, share)
        if k >= parts:
            break
    return Opening(total / float(parts), lost)


@func
def rays_to(radius: float) -> int:
    """Return the number of rays to a light with a disc of this radius, seen by one sample."""
    return 5 if radius <= 0.4 else MOST_RAYS


@func
def above_planes(planes: Field3, origin: vec3, light: LightSample) -> float:
    """Return how much of a light is above planes.

    Args:
        planes: Signed distance of the planes' union.
        origin: A point above the planes.
        light: The light at the point.
    """
    # How far the middle of the disc is above the planes, in radii of the disc.
    radius = max(light.radius, SHARPEST) * light.distance
    return share_of_disc(planes(origin + light.distance * light.direction) / radius)


@func
def shadow_beside_planes(
    field: Field3,
    planes: Field3,
    origin: vec3,
    light: LightSample,
    bounds: Bounds,
    numbers: March,
    steps: int,
    steep: bool,
    sample: int,
    samples: int,
) -> Opening:
    """Return the visible fraction of a light; planes hide what is below them, in closed form.

    Args:
        field: Signed distance without the planes.
        planes: Signed distance of the planes' union.
        origin: Start of the shadow ray, above the planes.
        light: The light at the point.
        bounds: Box around the surface without the planes.
        numbers: The parameters of the march.
        steps: Maximum number of steps of one ray.
        steep: Whether values may be less than distances; a constant.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """
    over = above_planes(planes, origin, light)
    if over <= 0.0:
        return Opening(0.0)
    found = soft_shadow(field, origin, light, bounds, numbers, steps, steep, sample, samples)
    return Opening(min(found.share, over), found.lost)


@func
def no_shadow(origin: vec3, light: LightSample, sample: int, samples: int) -> Opening:
    """Return that all of a light is visible."""
    return Opening(1.0)
