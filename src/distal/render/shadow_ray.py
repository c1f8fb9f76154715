"""One ray towards a light: where the edge of the shadow is.

Input: a field, a ray, the radius of the light's disc. Output: an ``Edge``. There is no noise: a ray
finds the same on every target and in every frame. Decision 21 has the measurements.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    func,
    length,
    max,
    min,
    mix,
    select,
    smoothstep,
    sqrt,
    struct,
    vec2,
    vec3,
)
from distal.lang.functions import apart
from distal.render.camera import Ray
from distal.render.march import MOST_STEPS, March, crossing
from distal.render.segment import ROUNDING, rounding_of

# A ray that is nearer to a surface than this fraction of its length is in it; late on its way it
# takes steps of at least the other fraction, or it would end before it reaches farther surfaces.
NEARLY = 0.0003
HURRY = 0.02
# A ray goes on towards a surface by this part of the longest step that no surface can be hidden in
# if the field is linear; so many free distances at most, where the field grows.
RELAXED = 0.8
LONGEST = 4.0
# A ray along a surface, with a slope below this, takes steps of this part of the disc's radius.
SLIGHT = 0.1
# Where two free balls touch this close to the ray, in radii, the ray goes back to look there.
NEAR_MISS = 0.5
# Two steps with slopes along the ray that differ by less are steps towards a flat surface. If the
# ray starts beside it, closer than the last fraction of the ray's length, it is there if the second
# part of the distance, or less, is left.
ALIKE = 0.02
PREDICTED = 0.5
BESIDE_SURFACE = 0.003
# The middle of a chord between two flat faces is as deep as the entry predicts, half as deep in a
# ball near its outline: above the second part the faces count as flat, below the first as a ball's.
ROUND = 0.6
FLAT = 0.85
# Where normals of the faces are taken, as a part of the chord from its ends.
INSET = 0.05
# A ray with a shorter chord and a smaller slope at the entry grazes something.
GRAZING = 0.08
# The least |gradient| by which a value is divided.
FLATTEST = 0.3

# The middle between faces that cancel is at most so many rounding errors from them; another place
# without an inside is beside an edge. The least step, in rounding errors: a ray may start at 0.
TOUCHED = 4.0
LEAST = 16.0

# So many solids with flat faces are followed along a ray. What is behind the first is looked for if
# the edge of the shadow has at least this offset: more than .06 of the disc is beside the solid.
MOST_SOLIDS = 2
BESIDE = -0.7
# The share of a light below which an unfinished ray counts as hidden.
UNSEEN = 0.02
# The distance of the closest surface before there is any.
OPEN = 1e9

# Where the next point of a shadow ray is.
OUTSIDE = 0
INSIDE = 1
MIDDLE = 2  # in the middle of a chord whose two ends are known


@struct
class Edge:
    """The edge of a shadow, as one ray finds it.

    Attributes:
        offset: Its distance from the ray, in radii of the light's disc: 1 or more if the whole disc
            is visible, 0 if a straight edge is in the middle, -1 or less if nothing is.
        is_sure: Whether all or nothing of the disc is visible, with nothing small in front of it.
        lost: Whether the steps of the ray ran out.
    """

    offset: float
    is_sure: bool
    lost: bool


@func
def share_of_disc(s: float) -> float:
    """Return how much of a disc an edge leaves open that is ``s`` radii from its middle."""
    c = clamp(s, -1.0, 1.0)
    return 0.25 * (1.0 + c) * (1.0 + c) * (2.0 - c)


@func
def step_outside(value: float, slope: float, before: float, width: float) -> float:
    """Return the step of a shadow ray to its next point.

    A longer step than the free distance is taken back if the two free balls do not touch.

    Args:
        value: The free distance.
        slope: The growth of the field along the ray, over the last step.
        before: The growth over the step before.
        width: Radius of the light's disc here.
    """
    if slope > 0.0:
        touching = min((1.0 + slope) / max(1.0 - slope, 0.1), LONGEST)
        return value * (1.0 + RELAXED * touching)
    if slope < -0.005 and abs(slope - before) < ALIKE:
        return value / -slope  # Newton's step to a flat surface
    if value > 3.0 * width:
        return value * (1.0 + RELAXED * (1.0 + slope) / (1.0 - slope))
    return value


@func
def passing(free: float, value: float, step: float) -> vec2:
    """Return where a ray passes the point that two free balls touch, and how far from it.

    Args:
        free: Radius of the first ball.
        value: Radius of the second.
        step: Distance between their middles, along the ray.

    Returns:
        The distance from the first middle along the ray, and the distance of the point from the
        ray; that is very large if the ray does not pass it between the two.

    Source: Sebastian Aaltonen's estimate, "GPU-Based Clay Simulation and Ray-Tracing Tech in
        Claybook" (2018).
    """
    along = (step * step + free * free - value * value) / max(2.0 * step, 1e-9)
    squared = free * free - along * along
    is_between = along > 0.0 and along < step and squared > 0.0
    return vec2(along, select(is_between, sqrt(max(squared, 0.0)), OPEN))


@func
def outline_offset(slope: Callable[[vec3], vec3], ray: Ray, entered: float, left: float) -> float:
    """Return the tangent of the angle from a ray through a solid to the solid's outline.

    The two faces are taken as flat: as the ray turns, its chord shrinks by a known rate, and the
    outline is where nothing is left of it. Parallel faces have no outline.

    Args:
        slope: The gradient of a signed distance, of any length.
        ray: The ray.
        entered: Distance along it where it enters the solid.
        left: Distance where it leaves.
    """
    inset = INSET * (left - entered)
    front = vec3(0.0)
    back = vec3(0.0)
    # A loop: drivers write out the field for each place in the code that asks it.
    for side in range(2):
        t = select(side == 0, entered + inset, left - inset)
        found = slope(ray.origin + t * ray.direction)
        front = select(side == 0, found, front)
        back = found
    ahead = min(dot(front, ray.direction), -1e-3 * length(front))
    behind = max(dot(back, ray.direction), 1e-3 * length(back))
    turned = entered / min(ahead, -1e-9) * front - left / max(behind, 1e-9) * back
    rate = length(turned - dot(turned, ray.direction) * ray.direction)
    return (left - entered) / max(rate, 1e-9)


@struct
class Passage:
    """A shadow ray up to the first solid with two flat faces that it goes through.

    Attributes:
        share: Distance of the closest surface, in radii of the light's disc there.
        closest: Distance along the ray where that is.
        chord: Where the ray enters and leaves the solid, and how flat the faces are, 0 to 1; or 0.
        t: Distance along the ray where it ended.
    """

    share: float
    closest: float
    chord: vec3
    t: float


@func
def pass_surfaces(
    field: Field3,
    ray: Ray,
    width: float,
    start: float,
    last: float,
    numbers: March,
    steps: int,
) -> Passage:
    """March along a shadow ray until it is hidden or comes out of a solid with two flat faces.

    Args:
        field: Signed distance.
        ray: The ray to the middle of the disc.
        width: Radius of the disc at distance 1.
        start: Distance along the ray where it starts.
        last: Distance along the ray where it ends.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
    """
    t = start
    share = OPEN  # by the closest surface outside, or by the depth
    chord = vec3(0.0)  # begin, end and flatness of the chord between two flat faces
    closest = t
    lift = 0.0  # the distance at the first point, if the ray starts beside a surface
    free = 0.0  # the distance at the previous point
    step = 0.0  # from the previous point to this one
    least = 0.0  # the least step that was allowed there
    slope = 1.0
    entry = 0.0  # the slope along the ray where it went in, and the place
    entered = 0.0
    left = 0.0  # where it came out; the next point is the middle of the chord
    count = 0  # points inside
    state = OUTSIDE
    seen = vec2(OPEN, t)  # share and closest before the ray came towards the surface ahead
    is_deep = False  # whether a point of the chord is certainly inside
    is_leaving = False  # the ray runs away from faces that cancel
    nearby = rounding_of(ray.origin)
    for i in range(min(steps, MOST_STEPS)):
        if t > last or share <= -1.0 or chord.y > chord.x:
            break
        p = ray.origin + t * ray.direction
        value = field(p) / numbers.divisor
        if i == 0 and value < BESIDE_SURFACE * last:
            lift = value
        noise = nearby + ROUNDING * t
        if state == OUTSIDE and slope >= 0.0:
            seen = vec2(share, closest)
        is_leaving = is_leaving and slope >= 0.0
        if value < share * width * t and not is_leaving:
            share = value / (width * t)
            closest = t
        is_deep = state != OUTSIDE and (is_deep or value < -noise)
        if state == MIDDLE:
            # How flat the two faces are, from 0 to 1.
            flat = smoothstep(ROUND, FLAT, -value / max(entry * (t - entered), 1e-9))
            is_long = t - entered > 2.0 * NEARLY * t
            if not is_deep and value < TOUCHED * noise:
                # Nothing is inside and nothing beside: faces that cancel, not a solid.
                share = seen.x
                closest = seen.y
                is_leaving = True
                slope = 1.0
            elif is_deep and flat > 0.0 and (is_long or entry * numbers.steepest > GRAZING):
                chord = vec3(entered, 2.0 * t - entered, select(is_long, flat, 1.0))
            t = left
            free = 0.0
            step = 0.0
            state = OUTSIDE
        elif (
            state == OUTSIDE
            and step > max(free, least)
            and value + free < step
            and not (
                abs(value) < max(NEARLY * t, select(free <= lift, PREDICTED * free, 0.0))
                and abs((value - free) / step - slope) < ALIKE
            )
        ):
            # The two free balls do not touch, and it is not the surface that was predicted: go back
            # to the edge of the first.
            t += free - step
            step = free
        else:
            before = slope
            is_last = False
            slope = select(
                step > 0.0, (value - free) / max(step, 1e-9), select(value < 0.0, -1.0, 1.0)
            )
            if state == OUTSIDE and before < 0.0 and slope > before + ALIKE and value > 0.0:
                # The ray has passed something between the last two points.
                passed = passing(free, value, step)
                at = t - step + passed.x
                if passed.y < share * width * at:
                    if passed.y < NEAR_MISS * min(free, value):
                        t = at
                        step = passed.x
                        slope = before
                        continue
                    share = passed.y / (width * at)
                    closest = at
            free = value
            if state == OUTSIDE and value < NEARLY * t and slope < 0.0:
                state = INSIDE
                count = 0
                entry = clamp(-slope, 1e-3, 1.0)
                entered = t + value / entry
            if state == INSIDE and value > 0.0 and slope > 0.0:
                left = t
                inside = t - value / entry - entered
                if inside > 4.0 * NEARLY * t or not is_deep:
                    state = MIDDLE
                    step = 0.5 * inside - (t - entered)
                else:
                    state = OUTSIDE
                    if entry * numbers.steepest > GRAZING:
                        chord = vec3(entered, entered + inside, 1.0)
            if state == INSIDE:
                count += 1
                step = max(abs(value), max(NEARLY, 0.1 * width * float(count)) * t)
                step = min(step, max(0.15 * t, abs(value)))
            elif state == OUTSIDE:
                is_along = abs(slope) < SLIGHT and abs(slope - before) < ALIKE
                least = max(NEARLY, select(is_along, SLIGHT * width, 0.0)) * t + LEAST * noise
                if 3 * i > 2 * steps:
                    least = HURRY * t
                step = max(step_outside(value, slope, before, width * t), least)
                if t + step > last and t + value < last:
                    # The free ball ends before the ray does: try the longer step at the ray's end,
                    # exactly, or rounding would end the ray before it is tried.
                    step = last - t
                    is_last = True
            t = select(is_last, last, t + step)
    return Passage(share, closest, chord, t)


@apart
@func
def find_edge(
    field: Field3,
    slope: Callable[[vec3], vec3],
    ray: Ray,
    width: float,
    end: float,
    bounds: Bounds,
    numbers: March,
    steps: int,
    steep: bool,
    needs_offset: bool,
) -> Edge:
    """Return where the edge of a shadow is, as one ray to the middle of a light's disc finds it.

    Args:
        field: Signed distance.
        slope: Its gradient.
        ray: The ray to the middle of the disc.
        width: Radius of the disc at distance 1.
        end: Distance along the ray where it ends.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
        steep: Whether values may be less than distances; a constant.
        needs_offset: Whether ``offset`` must be known where ``is_sure`` is false.
    """
    # A ray beside the box is dimmed too, by what is within the disc's radius there.
    corner = max(abs(bounds.low - ray.origin), abs(bounds.high - ray.origin))
    margin = width * min(length(corner), end)
    span = crossing(ray, Bounds(bounds.low - margin, bounds.high + margin))
    last = min(end, span.y)
    start = max(span.x, 0.0)
    offset = OPEN
    is_sure = True
    lost = False
    for _ in range(MOST_SOLIDS):
        found = pass_surfaces(field, ray, width, start, last, numbers, steps)
        share = found.share
        if steep and share < 1.0 and share > -1.0:
            # The local gradient makes a distance of a value that is too small.
            p = ray.origin + found.closest * ray.direction
            share = share / true_slope(length(slope(p)) / numbers.divisor, numbers)
        through = found.chord.y > found.chord.x
        if through:
            is_sure = False
        if through and needs_offset:
            across = outline_offset(slope, ray, found.chord.x, found.chord.y) / width
            share = min(share, mix(min(share, 0.0), -across, found.chord.z))
        offset = min(offset, share)
        # A ray that ran out of steps is lost if what it has not seen could change the picture.
        lost = lost or (not through and found.t <= last and share_of_disc(offset) > UNSEEN)
        if offset <= BESIDE or not through or not needs_offset:
            break
        # The ray goes through something, but part of the disc is beside it: what is behind?
        start = found.t
    return Edge(offset, is_sure and abs(offset) >= 1.0, lost)


@func
def true_slope(steepness: float, numbers: March) -> float:
    """Return |gradient| of a field at a point, within the bounds by which values are divided.

    Dividing by it makes a distance of a value near the surface.

    Args:
        steepness: |gradient|.
        numbers: The parameters of the march.
    """
    return max(steepness, FLATTEST / numbers.steepest)
