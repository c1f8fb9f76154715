"""Many parts in one field: a tree of boxes around them, and what is found through it.

Input: the tree, and the distance to each part. Output: distances, hits, lists of the parts near a
ray or a point. A part is the number of its row in a table (``scene.lowering.parts``).

The tree is a buffer with two vec4 for each box, parents first: (low corner, number of the box that
follows if this one is skipped), (high corner, part). For a box around others the last number is
negative: -1 - (axis + 4 * number of the box around it). Its first child is the lower one along the
axis. So a walk needs no stack, and a ray can meet near boxes first. ``anywhere`` makes it one walk
for all pixels that the CPU computes together: numbers of boxes and rows are scalars then.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.boxes import everywhere
from distal.fields.guarantees import UNBOUNDED
from distal.lang import (
    Buffer,
    abs,
    dot,
    func,
    length,
    max,
    min,
    select,
    size,
    struct,
    vec2,
    vec3,
    vec4,
)
from distal.lang.prelude.hidden import anywhere
from distal.render.camera import Ray
from distal.render.march import OUT_OF_STEPS, PASSED, Hit, March
from distal.render.segment import segment, segment_between

# Rounding errors of a place, for each unit of its coordinates.
ROUNDING = 2e-6
# No tree has more boxes in one another.
MOST_DEPTH = 64
# The margin around the boxes of parts, for each unit of the distance: rounding errors.
MARGIN = 1e-5


@struct
class NearestPart:
    """The part nearest to a point.

    Attributes:
        distance: Its distance.
        part: The part; -1 if none is near enough.
    """

    distance: float
    part: int


@struct
class TreePlace:
    """A place of a walk through a tree.

    Attributes:
        box: The number of a box.
        around: That of the box around it; 0 for the first.
        beside: That of the other box in that one, if rays meet it later; else 0.
    """

    box: int
    around: int
    beside: int


@struct
class Children:
    """The two boxes in a box.

    Attributes:
        near: The number of the one that rays meet first.
        far: That of the other.
    """

    near: int
    far: int


@func
def beyond_box(p: vec3, low: vec4, high: vec4) -> float:
    """Return the square of the distance of a point from a box; 0 inside."""
    beyond = max(max(low.xyz - p, p - high.xyz), 0.0)
    return dot(beyond, beyond)


@func
def beyond_sides(p: vec3, low: vec4, high: vec4) -> float:
    """Return how far a point is beyond the farthest side of a box; less than 0 inside."""
    beyond = max(low.xyz - p, p - high.xyz)
    return max(beyond.x, max(beyond.y, beyond.z))


@func
def squared(distance: float) -> float:
    """Return the square of the distance that a search is limited to; 0 for a negative one."""
    limit = max(distance, 0.0)
    return limit * limit


@func
def inverse_of(direction: vec3) -> vec3:
    """Return 1 / direction, with a large number in place of infinity."""
    tiny = 1e-9
    return 1.0 / select(abs(direction) < tiny, direction * 0.0 + tiny, direction)


@func
def span_in_box(origin: vec3, inverse: vec3, low: vec3, high: vec3) -> vec2:
    """Return where a ray enters and leaves a box; x > y if it misses it.

    Args:
        origin: Where the ray starts.
        inverse: 1 / direction.
        low: The low corner.
        high: The high corner.
    """
    near = (low - origin) * inverse
    far = (high - origin) * inverse
    first = min(near, far)
    last = max(near, far)
    return vec2(
        max(first.x, max(first.y, first.z)),
        min(last.x, min(last.y, last.z)),
    )


@func
def box_count(boxes: Buffer[vec4]) -> int:
    """Return the number of boxes of a tree."""
    return size(boxes) // 2


@func
def is_first_nearer(boxes: Buffer[vec4], p: vec3, first: int, second: int) -> bool:
    """Return whether the first of two boxes is nearer to a point.

    Args:
        boxes: The tree.
        p: The point.
        first: The number of a box.
        second: The number of the other box.
    """
    to_first = beyond_box(p, boxes[2 * first], boxes[2 * first + 1])
    to_second = beyond_box(p, boxes[2 * second], boxes[2 * second + 1])
    return to_first < to_second


@func
def nearest_part(
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    p: vec3,
    limit: float,
    begins_near: bool,
) -> NearestPart:
    """Return the part nearest to a point.

    A search that begins near goes down to a leaf near the point first, whose distance limits the
    rest. Both are one loop, so that the distance of a part stands in the code once.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        p: The point.
        limit: Parts that are farther away do not count.
        begins_near: Whether the search begins near the point; the same for all pixels.
    """
    best = limit
    part = -1
    descends = begins_near
    box = 0
    for _ in range(2 * box_count(boxes)):
        if box >= box_count(boxes):
            break
        low = boxes[2 * box]
        high = boxes[2 * box + 1]
        following = int(low.w)
        of = int(high.w)
        if descends and of < 0:
            following = int(boxes[2 * (box + 1)].w)
            if anywhere(is_first_nearer(boxes, p, box + 1, following)):
                following = box + 1
        elif anywhere(descends or beyond_box(p, low, high) <= squared(best)):
            if of < 0:
                following = box + 1
            else:
                d = distance(p, of)
                part = select(d < best, of, part)
                best = min(d, best)
                if descends:
                    following = 0
                    descends = False
        box = following
    return NearestPart(best, part)


@func
def nearest_of_all(
    boxes: Buffer[vec4], distance: Callable[[vec3, int], float], p: vec3
) -> NearestPart:
    """Return the part nearest to a point, at any distance.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        p: The point.
    """
    return nearest_part(boxes, distance, p, UNBOUNDED, True)


@func
def distance_to_all(boxes: Buffer[vec4], distance: Callable[[vec3, int], float], p: vec3) -> float:
    """Return the signed distance of a point to all parts.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        p: The point.
    """
    return nearest_of_all(boxes, distance, p).distance


@func
def part_at(boxes: Buffer[vec4], distance: Callable[[vec3, int], float], p: vec3) -> int:
    """Return the number of the part nearest to a point.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part.
        p: The point.
    """
    return nearest_of_all(boxes, distance, p).part


@func
def distance_to_parts(
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    field: Callable[[vec3, int], float],
    p: vec3,
) -> float:
    """Return the value of the field of the part nearest to a point.

    Args:
        boxes: The tree.
        distance: The signed distance of a point to a part, by which the part is found.
        field: The field of a part; the same as ``distance`` if its values are distances.
        p: The point.
    """
    return field(p, part_at(boxes, distance, p))


@func
def segment_of_part(
    distance: Callable[[vec3, int], float],
    part: int,
    ray: Ray,
    slope: float,
    span: vec2,
    sides: vec3,
    far: float,
    numbers: March,
    steps: int,
) -> Hit:
    """Return where a ray from outside enters one part.

    Args:
        distance: The signed distance of a point to a part.
        part: The part.
        ray: Ray.
        slope: As for ``segment``; 0 if the ray does not start on this part.
        span: Where the box around the part begins and ends, along the ray.
        sides: The lengths of the box's sides.
        far: The distance along the ray where it ends.
        numbers: The other parameters of the march.
        steps: Maximum number of evaluations of the field.
    """

    def field(p: vec3) -> float:
        return distance(p, part)

    limited = March(numbers.divisor, numbers.near, far, numbers.threshold, numbers.steepest)
    extent = max(sides.x, max(sides.y, sides.z))
    return segment_between(field, ray, 1.0, slope, span, extent, limited, steps)


@func
def meet_part(
    chord: Callable[[vec3, vec3, int], vec2], part: int, ray: Ray, far: float, numbers: March
) -> Hit:
    """Return where a ray from outside enters a part, in closed form.

    A ray that starts on the surface, by rounding just below it, has entered if it goes on inside.

    Args:
        chord: Where a line enters and leaves a part.
        part: The part.
        ray: Ray.
        far: The distance along the ray where it ends.
        numbers: The other parameters of the march.
    """
    ends = chord(ray.origin, ray.direction, part)
    p = abs(ray.origin)
    noise = ROUNDING * (p.x + p.y + p.z)
    t = max(ends.x, numbers.near)
    is_ahead = ends.x >= numbers.near - noise and ends.y > numbers.near + noise
    return Hit(t, ends.x <= ends.y and is_ahead and t < far, 1, 1.0)


@func
def octant_of(direction: vec3) -> int:
    """Return a bit for each axis along which any of the rays runs downwards."""
    octant = 0
    if anywhere(direction.x < 0.0):
        octant += 1
    if anywhere(direction.y < 0.0):
        octant += 2
    if anywhere(direction.z < 0.0):
        octant += 4
    return octant


@func
def children_of(boxes: Buffer[vec4], box: int, octant: int) -> Children:
    """Return the two boxes in a box, in the order in which rays meet them.

    Args:
        boxes: The tree.
        box: The number of the box around them.
        octant: As ``octant_of``.
    """
    code = ~int(boxes[2 * box + 1].w)
    lower = box + 1
    upper = int(boxes[2 * lower].w)
    is_downwards = (octant >> (code & 3)) & 1 == 1
    near = select(is_downwards, upper, lower)
    return Children(near, lower + upper - near)


@func
def next_box(boxes: Buffer[vec4], here: TreePlace, octant: int) -> TreePlace:
    """Return the box that rays meet after one and all that is in it.

    Args:
        boxes: The tree.
        here: The box.
        octant: As ``octant_of``.
    """
    if here.beside > 0:
        return TreePlace(here.beside, here.around, 0)
    box = here.around
    for _ in range(MOST_DEPTH):
        if box == 0:
            break
        around = (~int(boxes[2 * box + 1].w)) >> 2
        children = children_of(boxes, around, octant)
        if box == children.near:
            return TreePlace(children.far, around, 0)
        box = around
    return TreePlace(box_count(boxes), 0, 0)


@func
def first_met(
    boxes: Buffer[vec4],
    meet: Callable[[int, vec2, vec3, float], Hit],
    ray: Ray,
    numbers: March,
) -> Hit:
    """Return the first part along a ray that runs outside of all parts.

    Each part is met alone, inside of its box, and only up to the nearest hit so far.

    Args:
        boxes: The tree.
        meet: Where the ray enters a part, by its number, where its box begins and ends along the
            ray, the sides of the box, and the distance where the ray ends.
        ray: Ray.
        numbers: The parameters of the march.
    """
    margin = MARGIN * farthest_box(boxes, ray, numbers)
    inverse = inverse_of(ray.direction)
    octant = octant_of(ray.direction)
    found = -1
    t = numbers.far
    taken = 0
    lost = PASSED
    here = TreePlace(0, 0, 0)
    for _ in range(box_count(boxes)):
        box = here.box
        if box >= box_count(boxes):
            break
        low = boxes[2 * box]
        high = boxes[2 * box + 1]
        of = int(high.w)
        goes_on = True
        span = span_in_box(ray.origin, inverse, low.xyz - margin, high.xyz + margin)
        meets = span.x <= span.y and span.x < t and span.y >= numbers.near
        if anywhere(meets):
            if of < 0:
                children = children_of(boxes, box, octant)
                here = TreePlace(children.near, box, children.far)
                goes_on = False
            elif meets:
                hit = meet(of, span, high.xyz - low.xyz, t * (1.0 + MARGIN + numbers.threshold))
                taken += hit.steps
                lost = max(lost, select(hit.lost == OUT_OF_STEPS, OUT_OF_STEPS, PASSED))
                # Of surfaces at one place the first part's is met, in whatever order they come.
                least = select(of < found, t * (1.0 + MARGIN), t * (1.0 - MARGIN))
                if hit.found and hit.t < select(found < 0, t, least):
                    found = of
                    t = hit.t
        if goes_on:
            here = next_box(boxes, here, octant)
    return Hit(t, found >= 0, taken, 1.0, select(found >= 0, PASSED, lost), found)


@func
def farthest_box(boxes: Buffer[vec4], ray: Ray, numbers: March) -> float:
    """Return how far a ray may run among the parts, to which rounding errors are in proportion."""
    farthest = max(abs(boxes[0].xyz - ray.origin), abs(boxes[1].xyz - ray.origin))
    return min(length(farthest), numbers.far)


@func
def trace_parts(
    boxes: Buffer[vec4],
    within: Callable[[vec3, int], float],
    chord: Callable[[vec3, vec3, int], vec2],
    has_chord: Callable[[int], bool],
    ray: Ray,
    numbers: March,
    steps: int,
    some_chords: bool,
) -> Hit:
    """March to the first part along a ray that starts outside of all parts.

    A part with a chord is met in closed form.

    Args:
        boxes: The tree.
        within: The signed distance of a point to a part, within its box.
        chord: Where a line enters and leaves a part.
        has_chord: Whether that is known of a part.
        ray: Ray.
        numbers: The parameters of the march.
        steps: Maximum number of steps in one part.
        some_chords: Whether it is known of any part; a constant.
    """

    def meet(of: int, span: vec2, sides: vec3, far: float) -> Hit:
        if some_chords and has_chord(of):
            return meet_part(chord, of, ray, far, numbers)
        return segment_of_part(within, of, ray, 0.0, span, sides, far, numbers, steps)

    return first_met(boxes, meet, ray, numbers)


@func
def first_of_parts(
    others: Callable[[Ray], Hit],
    others_field: Callable[[vec3], float],
    boxes: Buffer[vec4],
    distance: Callable[[vec3, int], float],
    within: Callable[[vec3, int], float],
    all_parts: Callable[[vec3], float],
    chord: Callable[[vec3, vec3, int], vec2],
    has_chord: Callable[[int], bool],
    ray: Ray,
    numbers: March,
    steps: int,
    some_chords: bool,
) -> Hit:
    """March to the first surface of the parts and of what is beside them.

    A ray that starts inside a solid is marched through the field of all, because a way out of one
    part may lead into another.

    Args:
        others: The first surface of what is beside the parts.
        others_field: Signed distance of what is beside the parts.
        boxes: The tree.
        distance: The signed distance of a point to a part.
        within: The same within its box; other places do not count.
        all_parts: The signed distance of a point to all parts, also within them.
        chord: Where a line enters and leaves a part.
        has_chord: Whether that is known of a part.
        ray: Ray.
        numbers: The parameters of the march.
        steps: Maximum number of steps in one part.
        some_chords: Whether it is known of any part; a constant.
    """
    other = others(ray)
    way = other
    inside = other.side < 0.0
    p = ray.origin
    # First the parts around the origin, then the part at the end of a way out of them.
    for i in range(2):
        at_end = i == 1
        limit = select(at_end, UNBOUNDED, 0.0)
        nearest = nearest_part(boxes, distance, p, limit, at_end)
        if at_end:
            part = select(nearest.distance <= others_field(p), nearest.part, -1)
            return Hit(way.t, way.found, way.steps, way.side, way.lost, part)
        inside = inside or nearest.part >= 0
        if not inside:
            break

        def field(q: vec3) -> float:
            return min(all_parts(q), others_field(q))

        way = segment(field, ray, 0.0, 0.0, everywhere(), numbers, steps)
        p = ray.origin + way.t * ray.direction
    far = select(other.found, other.t, numbers.far)
    limited = March(numbers.divisor, numbers.near, far, numbers.threshold, numbers.steepest)
    hit = trace_parts(boxes, within, chord, has_chord, ray, limited, steps, some_chords)
    taken = other.steps + hit.steps
    lost = select(hit.found, PASSED, max(hit.lost, other.lost))
    if hit.found or not other.found:
        return Hit(hit.t, hit.found, taken, 1.0, lost, hit.part)
    return Hit(other.t, True, taken, 1.0, PASSED)


@func
def nothing_else(ray: Ray, numbers: March) -> Hit:
    """Return that a ray meets nothing beside the parts."""
    return Hit(numbers.far, False, 0, 1.0)
