"""Shadows and occlusion among many parts: only those that are near count.

Input: a tree of boxes around parts, and a field of what is beside them. Output: the visible share
of a light, the share of ambient light.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.boxes import hull
from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import Buffer, func, gradient, length, max, min, select, vec3, vec4
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March
from distal.render.part_lists import nearest_listed, parts_along, parts_around
from distal.render.part_tree import NearestPart
from distal.render.shade import Shading, occlusion_in
from distal.render.shadow_ray import OPEN, Edge, find_edge
from distal.render.shadows import SHARPEST, Opening, above_planes, opening


@func
def edge_of_parts(
    others: Callable[[vec3], float],
    others_bounds: Bounds,
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    ray: Ray,
    width: float,
    end: float,
    numbers: March,
    steps: int,
    has_others: bool,
    steep: bool,
    some_sharp: bool,
    needs_offset: bool,
) -> Edge:
    """Return where the edge of a shadow is, as one ray among parts finds it.

    A part that alone hides the disc decides. For the sharpest lights, whose edges are as narrow as
    pixels, the part that comes closest to the ray does: the edge is beside the parts, half a radius
    away. Otherwise the ray is marched through the parts that may hide some of it, if there are any.

    Args:
        others: Signed distance of what is beside the parts.
        others_bounds: The box around that.
        boxes: The tree.
        distance: The signed distance of a point to a part.
        ray: The ray to the middle of the disc.
        width: Radius of the disc at distance 1.
        end: Distance along the ray where it ends.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
        has_others: Whether anything is beside the parts; a constant.
        steep: Whether values may be less than distances; a constant.
        some_sharp: Whether a light may be as sharp as ``SHARPEST``; a constant.
        needs_offset: Whether the offset must be known where it is not sure what is visible.
    """
    may_be_sharp = some_sharp and not has_others and not steep
    is_sharp = may_be_sharp and width <= SHARPEST
    hides = select(is_sharp, 0.0, -1.0)
    start = numbers.threshold
    near = parts_along(boxes, distance, ray, width, start, end, hides, steps, may_be_sharp)
    if near.hidden:
        return Edge(-OPEN, True, False)
    if is_sharp:
        return Edge(2.0 * near.share - 1.0, near.share >= 1.0, False)
    listed = near.listed
    own = near.own
    if own.others == 0 and not has_others:
        return Edge(OPEN, True, False)
    if own.others != 0 and not needs_offset:
        return Edge(0.0, False, False)

    def found_at(p: vec3) -> NearestPart:
        return nearest_listed(boxes, distance, listed, own, p, UNBOUNDED)

    def nearest(p: vec3) -> float:
        d = found_at(p).distance
        if has_others:
            d = min(d, others(p))
        return d

    def slope(p: vec3) -> vec3:
        found = found_at(p)
        if has_others and others(p) < found.distance:
            return gradient(others, p)
        part = max(found.part, 0)

        def of_part(q: vec3) -> float:
            return distance(q, part)

        return gradient(of_part, p)

    bounds = near.bounds
    if has_others:
        bounds = hull(bounds, others_bounds)
    return find_edge(nearest, slope, ray, width, end, bounds, numbers, steps, steep, needs_offset)


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
    some_sharp: bool,
    sample: int,
    samples: int,
) -> Opening:
    """Return the visible fraction of a light among parts; see ``soft_shadow``.

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
        some_sharp: Whether a light may be as sharp as ``SHARPEST``; a constant.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """

    def edge(ray: Ray, width: float, end: float, needs_offset: bool) -> Edge:
        return edge_of_parts(
            others, others_bounds, boxes, distance, ray, width, end, numbers, steps, has_others,
            steep, some_sharp, needs_offset,
        )  # fmt: skip

    return opening(edge, origin, light, numbers.far, sample, samples)


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
    some_sharp: bool,
    sample: int,
    samples: int,
) -> Opening:
    """As ``shadow_of_parts``; planes hide what is below them, in closed form."""
    over = above_planes(planes, origin, light)
    if over <= 0.0:
        return Opening(0.0)
    found = shadow_of_parts(
        others, others_bounds, boxes, distance, origin, light, numbers, steps, has_others, steep,
        some_sharp, sample, samples,
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

    Parts that stand still have a grid in most scenes (``part_grid``), which is faster.

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
    listed = near.listed
    own = near.own

    def nearest(q: vec3) -> float:
        # The surface at p is not farther away.
        most = max(slope, 1.0) * length(q - p)
        d = nearest_listed(boxes, distance, listed, own, q, most).distance
        if has_others:
            d = min(d, others(q))
        return d

    return occlusion_in(nearest, p, n, slope, look, numbers, steep)
