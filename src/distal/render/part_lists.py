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
    max,
    min,
    select,
    sqrt,
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
        share: How close the parts come to a ray, in radii of a cone around it; -1 if it may go
            through one.
    """

    listed: PartList
    own: OwnParts
    bounds: Bounds
    hidden: bool = False
    share: float = OPEN


@func
def share_beside(
    distance: Callable[[vec3, int], float],
    part: int,
    ray: Ray,
    width: float,
    span: vec2,
    hides: float,
    steps: int,
    may_be_sharp: bool,
) -> vec2:
    """Return how close a part comes to a ray, in radii of a cone around it.

    Args:
        distance: The signed distance of a point to a part.
        part: The part.
        ray: The axis of the cone.
        width: Radius of the cone at distance 1.
        span: Where the box around the part begins and ends, along the ray.
        hides: The share at which the part hides the cone: the march ends there.
        steps: Maximum number of steps.
        may_be_sharp: Whether the second number is needed; a constant.

    Returns:
        The least share at the points of the march. If it is 2 or more, no point of the part is in
        the cone: the value is at least half as large between two points as at the first of them.
        And the least share between them (as ``passing``); -1 if the ray may go through the part.
    """
    t = span.x
    share = OPEN
    height = OPEN  # squared
    is_torn = False  # a thin wall may be between two points
    free = 0.0
    step = 0.0
    falls = False  # whether the values fall so fast that the next may be behind a surface
    for _ in range(min(steps, MOST_STEPS)):
        if t > span.y or share <= hides:
            break
        d = distance(ray.origin + t * ray.direction, part)
        radius = width * max(t, 1e-6)
        share = min(share, d / radius)
        onward = max(abs(d), max(width, NEARLY) * t)
        t += onward
        if may_be_sharp:
            long = 2.0 * step * step
            along = step * step + free * free - d * d
            rest = 2.0 * long * free * free - along * along
            is_between = along > 0.0 and along < long
            at_touch = rest / max(2.0 * long * radius * radius, 1e-30)
            height = select(is_between and rest >= 0.0, min(height, at_touch), height)
            is_torn = is_torn or (is_between and rest < 0.0 and falls)
            falls = d * step < (free - d) * onward
            free = d
            step = onward
    closest = share
    if may_be_sharp:
        closest = select(is_torn or share < 0.0, -1.0, min(share, sqrt(height)))
    return vec2(share, closest)


@func
def parts_along(
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    ray: Ray,
    width: float,
    start: float,
    end: float,
    hides: float,
    steps: int,
    may_be_sharp: bool,
) -> NearParts:
    """Return the parts that may hide a part of a cone.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        ray: The axis of the cone.
        width: Radius of the cone at distance 1.
        start: Distance along the ray where it begins.
        end: Distance along the ray where it ends.
        hides: The share at which a part hides the cone: -1; 0 if it does as soon as the ray goes
            through it.
        steps: Maximum number of steps in one part.
        may_be_sharp: Whether ``hides`` may be 0; a constant.
    """
    inverse = inverse_of(ray.direction)
    listed = [0] * MOST_LISTED
    count = 0
    own = 0
    others = 0
    hidden = False
    least = OPEN
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
        # Never less than the length, and more by a seventh at most, without a root.
        longest = max(farthest.x, max(farthest.y, farthest.z))
        margin = width * min(longest + farthest.x + farthest.y + farthest.z, 2.0 * end)
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
                    shares = share_beside(
                        distance, part, ray, width, span, hides, steps, may_be_sharp
                    )
                    share = shares.x
                    least = min(least, shares.y)
                    hidden = share <= hides
                    if may_be_sharp:
                        hidden = select(hides < 0.0, share, least) <= hides
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
    return NearParts(PartList(count, listed), OwnParts(own, others), around, hidden, least)


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
