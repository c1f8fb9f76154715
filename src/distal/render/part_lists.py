"""Lists of the parts near a ray or a point.

Input: a tree of boxes (``part_tree``), the distance to each part, a ray or a point. Output: a list,
and the distance to the nearest part of a list. Shadows and occlusion look at a few points near one
another, so they search the tree once.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import (
    Buffer,
    abs,
    array,
    func,
    length,
    max,
    min,
    select,
    struct,
    vec2,
    vec3,
    vec4,
)
from distal.lang.prelude.hidden import anywhere
from distal.render.camera import Ray
from distal.render.march import MOST_STEPS
from distal.render.part_tree import (
    NearestPart,
    beyond_box,
    box_count,
    inverse_of,
    is_first_nearer,
    span_in_box,
    squared,
)
from distal.render.shadow_ray import NEARLY, OPEN

# The most parts that a list has; where more are near, the whole tree is searched.
MOST_LISTED = 32


@struct
class PartList:
    """The parts near any of the rays or points that are computed together.

    Attributes:
        count: How many there are.
        boxes: The numbers of their boxes in the tree, of ``MOST_LISTED`` at most.
    """

    count: int
    boxes: array[int, 32]  # type: ignore[valid-type]


@struct
class OwnParts:
    """Which parts are near a ray or a point.

    Attributes:
        listed: A bit for each place in the list.
        others: If the list is not complete: the bits of the parts' boxes, modulo 32. So few of the
            others count too.
    """

    listed: int
    others: int


@struct
class NearParts:
    """The parts near a ray or a point.

    The list is that of all rays that the CPU computes together, so that all read the same rows; a
    ray's own parts are bits, so that its result does not depend on the others.

    Attributes:
        listed: The parts near any ray.
        own: Which parts are near this ray.
        bounds: The box around them.
        hidden: Whether one part alone hides all of a cone.
    """

    listed: PartList
    own: OwnParts
    bounds: Bounds
    hidden: bool = False


@func
def share_beside(
    distance: Callable[[vec3, int], float],
    part: int,
    ray: Ray,
    width: float,
    span: vec2,
    steps: int,
) -> float:
    """Return how close a part comes to a ray, in radii of a cone around it.

    If it is 2 or more, no point of the part is in the cone: the value is at least half as large
    between two points of the march as at the first. If it is -1 or less, the part hides the whole
    cone.

    Args:
        distance: The signed distance of a point to a part.
        part: The part.
        ray: The axis of the cone.
        width: Radius of the cone at distance 1.
        span: Where the box around the part begins and ends, along the ray.
        steps: Maximum number of steps.
    """
    t = span.x
    share = OPEN
    for _ in range(min(steps, MOST_STEPS)):
        if t > span.y or share <= -1.0:
            break
        d = distance(ray.origin + t * ray.direction, part)
        share = min(share, d / (width * max(t, 1e-6)))
        t += max(abs(d), max(width, NEARLY) * t)
    return share


@func
def parts_along(
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    ray: Ray,
    width: float,
    start: float,
    end: float,
    steps: int,
) -> NearParts:
    """Return the parts that may hide a part of a cone.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        ray: The axis of the cone.
        width: Radius of the cone at distance 1.
        start: Distance along the ray where it begins.
        end: Distance along the ray where it ends.
        steps: Maximum number of steps in one part.
    """
    inverse = inverse_of(ray.direction)
    listed = [0] * MOST_LISTED
    count = 0
    own = 0
    others = 0
    hidden = False
    around_low = vec3(UNBOUNDED)
    around_high = vec3(-UNBOUNDED)
    box = 0
    for _ in range(box_count(boxes)):
        if box >= box_count(boxes):
            break
        low = boxes[2 * box]
        high = boxes[2 * box + 1]
        following = int(low.w)
        farthest = max(abs(low.xyz - ray.origin), abs(high.xyz - ray.origin))
        margin = 2.0 * width * min(length(farthest), end)
        span = span_in_box(ray.origin, inverse, low.xyz - margin, high.xyz + margin)
        span = vec2(max(span.x, start), min(span.y, end))
        meets = span.x <= span.y and not hidden
        if anywhere(meets):
            part = int(high.w)
            if part < 0:
                following = box + 1
            else:
                share = OPEN
                if meets:
                    share = share_beside(distance, part, ray, width, span, steps)
                    hidden = share <= -1.0
                beside = share < 2.0 and not hidden
                if anywhere(beside):
                    around_low = select(beside, min(around_low, low.xyz), around_low)
                    around_high = select(beside, max(around_high, high.xyz), around_high)
                    if count < MOST_LISTED:
                        listed[count] = box
                        own = select(beside, own | (1 << count), own)
                    others = select(beside, others | (1 << (box & 31)), others)
                    count += 1
        box = following
    around = Bounds(around_low, around_high)
    return NearParts(PartList(count, listed), OwnParts(own, others), around, hidden)


@func
def parts_around(boxes: Buffer[vec4], p: vec3, reach: float) -> NearParts:
    """Return the parts whose boxes are near a point.

    Args:
        boxes: The tree.
        p: The point.
        reach: The largest distance.
    """
    listed = [0] * MOST_LISTED
    count = 0
    own = 0
    others = 0
    around_low = vec3(UNBOUNDED)
    around_high = vec3(-UNBOUNDED)
    box = 0
    for _ in range(box_count(boxes)):
        if box >= box_count(boxes):
            break
        low = boxes[2 * box]
        high = boxes[2 * box + 1]
        following = int(low.w)
        meets = beyond_box(p, low, high) <= squared(reach)
        if anywhere(meets):
            if int(high.w) < 0:
                following = box + 1
            else:
                around_low = min(around_low, low.xyz)
                around_high = max(around_high, high.xyz)
                if count < MOST_LISTED:
                    listed[count] = box
                    own = select(meets, own | (1 << count), own)
                others = select(meets, others | (1 << (box & 31)), others)
                count += 1
        box = following
    around = Bounds(around_low, around_high)
    return NearParts(PartList(count, listed), OwnParts(own, others), around)


@func
def nearest_listed(
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    listed: PartList,
    own: OwnParts,
    p: vec3,
    limit: float,
) -> NearestPart:
    """Return the part nearest to a point, of those near a ray or another point.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        listed: The list.
        own: The parts that count.
        p: The point.
        limit: Parts that are farther away do not count.
    """
    is_whole = listed.count > MOST_LISTED
    best = limit
    part = -1
    # A search of the whole tree begins at a leaf near the point, as that of ``nearest_part``.
    descends = is_whole
    box = 0
    for i in range(2 * box_count(boxes) if is_whole else listed.count):
        if not is_whole:
            box = listed.boxes[i]
        elif box >= box_count(boxes):
            break
        low = boxes[2 * box]
        high = boxes[2 * box + 1]
        following = int(low.w)
        of = int(high.w)
        bit = select(is_whole, own.others >> (box & 31), own.listed >> i) & 1
        counts = bit == 1 or of < 0 or descends
        if descends and of < 0:
            following = int(boxes[2 * (box + 1)].w)
            if anywhere(is_first_nearer(boxes, p, box + 1, following)):
                following = box + 1
        elif anywhere(descends or (counts and beyond_box(p, low, high) <= squared(best))):
            if of < 0:
                following = box + 1
            else:
                d = select(counts, distance(p, of), best)
                part = select(d < best, of, part)
                best = min(best, d)
                if descends:
                    following = 0
                    descends = False
        box = following
    return NearestPart(best, part)
