"""Shadows and occlusion among many parts: only those that are near count.

Input: a tree of boxes around parts, and a field of what is beside them. Output: the visible share of
a light, the share of ambient light.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.boxes import hull
from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import Buffer, func, max, min, vec3, vec4
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March
from distal.render.part_tree import distance_to_listed, parts_along, parts_around
from distal.render.shade import Shading, occlusion_in
from distal.render.shadows import SHARPEST, Opening, above_planes, soft_shadow

# Rays to the points of a light's disc look so far beside its middle, in radii.
WIDEST = 1.25


@func
def shadow_of_parts(
    others: Callable[[vec3], float],
    others_bounds: Bounds,
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    origin: vec3,
    light: LightSample,
    numbers: March,
    steps: int,
    has_others: bool,
    steep: bool,
    sample: int,
    samples: int,
) -> Opening:
    """Return the visible fraction of a light: only the parts in its cone count.

    Args:
        others: Signed distance of what is beside the parts.
        others_bounds: The box around that.
        boxes: The tree.
        distance: The signed distance of a point to a part.
        origin: Start of the shadow ray.
        light: The light at the point.
        numbers: The parameters of the march.
        steps: Maximum number of steps of one ray.
        has_others: Whether anything is beside the parts; a constant.
        steep: Whether values may be less than distances; a constant.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """
    axis = Ray(origin, light.direction)
    end = min(light.distance, numbers.far)
    width = WIDEST * max(light.radius, SHARPEST)
    near = parts_along(boxes, distance, axis, width, numbers.threshold, end, steps)
    if near.hidden:
        return Opening(0.0)
    if near.count == 0 and not has_others:
        return Opening(1.0)

    def nearest(p: vec3) -> float:
        d = distance_to_listed(boxes, distance, near, p, UNBOUNDED)
        if has_others:
            d = min(d, others(p))
        return d

    bounds = near.bounds
    if has_others:
        bounds = hull(bounds, others_bounds)
    return soft_shadow(nearest, origin, light, bounds, numbers, steps, steep, sample, samples)


@func
def shadow_of_parts_and_planes(
    others: Callable[[vec3], float],
    others_bounds: Bounds,
    planes: Callable[[vec3], float],
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    origin: vec3,
    light: LightSample,
    numbers: March,
    steps: int,
    has_others: bool,
    steep: bool,
    sample: int,
    samples: int,
) -> Opening:
    """As ``shadow_of_parts``; planes hide what is below them, in closed form."""
    over = above_planes(planes, origin, light)
    if over <= 0.0:
        return Opening(0.0)
    found = shadow_of_parts(
        others, others_bounds, boxes, distance, origin, light, numbers, steps, has_others, steep,
        sample, samples,
    )  # fmt: skip
    return Opening(min(found.share, over), found.lost)


@func
def occlusion_of_parts(
    others: Callable[[vec3], float],
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    p: vec3,
    n: vec3,
    slope: float,
    look: Shading,
    numbers: March,
    has_others: bool,
    steep: bool,
) -> float:
    """Return the fraction of ambient light that reaches a point: only parts within reach count.

    Args:
        others: Signed distance of what is beside the parts.
        boxes: The tree.
        distance: The signed distance of a point to a part.
        p: Point on a surface or just above it.
        n: Unit normal.
        slope: |gradient| of the field at the point.
        look: How far to search for surfaces.
        numbers: The parameters of the march.
        has_others: Whether anything is beside the parts; a constant.
        steep: Whether values may be less than distances; a constant.
    """
    reach = look.occlusion * max(slope, 1.0)
    near = parts_around(boxes, p, reach)

    def nearest(q: vec3) -> float:
        d = distance_to_listed(boxes, distance, near, q, reach)
        if has_others:
            d = min(d, others(q))
        return d

    return occlusion_in(nearest, p, n, slope, look, numbers, steep)
