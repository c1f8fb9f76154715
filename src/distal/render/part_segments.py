"""Segments of rays through a table of parts: the next surface of any part, and of what is beside.

Input: the tree of the parts' boxes, the distance to each part, and a ray with its side. Output: a
``Hit``. ``part_tree`` has the same for rays from the eye, which may start anywhere.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.boxes import everywhere
from distal.lang import Buffer, func, max, min, select, vec2, vec3, vec4
from distal.render.camera import Ray
from distal.render.march import PASSED, Hit, March
from distal.render.part_tree import first_met, nearest_of_all, segment_of_part
from distal.render.segment import segment


@func
def next_of_parts(
    boxes: Buffer[vec4],
    within: Callable[[vec3, int], float],
    ray: Ray,
    slope: float,
    part: int,
    numbers: March,
    steps: int,
    many_boxes: bool,
) -> Hit:
    """Return the first part along a ray that runs outside of all parts.

    Args:
        boxes: The tree.
        within: The signed distance of a point to a part, within its box.
        ray: Ray.
        slope: As for ``segment``.
        part: The part on which the ray starts; -1 if it starts on none.
        numbers: The parameters of the march.
        steps: Maximum number of evaluations in one part.
        many_boxes: Whether a surface may go on in the boxes of other parts; a constant.
    """

    def meet(of: int, span: vec2, sides: vec3, far: float) -> Hit:
        starts = of == part
        if many_boxes:
            starts = starts or (part >= 0 and span.x <= 0.0)
        leaving = select(starts, slope, 0.0)
        return segment_of_part(within, of, ray, leaving, span, sides, far, numbers, steps)

    return first_met(boxes, meet, ray, numbers)


@func
def segment_of_parts(
    others: Callable[[Ray, float, float, int], Hit],
    others_field: Callable[[vec3], float],
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    within: Callable[[vec3, int], float],
    all_parts: Callable[[vec3], float],
    ray: Ray,
    side: float,
    slope: float,
    part: int,
    numbers: March,
    steps: int,
    many_boxes: bool,
) -> Hit:
    """Return the next surface of the parts and of what is beside them, from a surface.

    A ray inside a solid is followed through the field of all, because a way out of one part may
    lead into another.

    Args:
        others: The next surface of what is beside the parts.
        others_field: Signed distance of what is beside the parts.
        boxes: The tree.
        distance: The signed distance of a point to a part.
        within: The same within its box; other places do not count.
        all_parts: The signed distance of a point to all parts, also within them.
        ray: Ray.
        side: 1 if the ray runs outside, -1 inside.
        slope: As for ``segment``.
        part: The part on which the ray starts; -1 if it starts on another surface.
        numbers: The parameters of the march.
        steps: Maximum number of evaluations in one part.
        many_boxes: Whether a surface may go on in the boxes of other parts; a constant.
    """
    if side < 0.0:

        def field(p: vec3) -> float:
            return min(all_parts(p), others_field(p))

        way = segment(field, ray, side, slope, everywhere(), numbers, steps)
        end = ray.origin + way.t * ray.direction
        nearest = nearest_of_all(boxes, distance, end)
        of = select(nearest.distance <= others_field(end), nearest.part, -1)
        return Hit(way.t, way.found, way.steps, way.side, way.lost, of)
    other = others(ray, side, select(part < 0, slope, 0.0), part)
    far = select(other.found, other.t, numbers.far)
    limited = March(numbers.divisor, numbers.near, far, numbers.threshold, numbers.steepest)
    hit = next_of_parts(boxes, within, ray, slope, part, limited, steps, many_boxes)
    taken = other.steps + hit.steps
    lost = select(hit.found, PASSED, max(hit.lost, other.lost))
    if hit.found or not other.found:
        return Hit(hit.t, hit.found, taken, 1.0, lost, hit.part)
    return Hit(other.t, True, taken, 1.0, PASSED)


@func
def nothing_next(ray: Ray, side: float, slope: float, part: int, numbers: March) -> Hit:
    """Return that a ray meets nothing beside the parts."""
    return Hit(numbers.far, False, 0, side)
