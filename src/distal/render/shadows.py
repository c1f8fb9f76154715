"""Shadows: how much of a light's disc is visible from a point.

Input: a field, a point, a light. Output: the visible share, from 0 to 1. There is no noise: a point
has the same shadow on every target and in every frame. Decision 21 has the measurements.
"""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    cos,
    cross,
    dot,
    func,
    gradient,
    length,
    max,
    min,
    mix,
    normalize,
    select,
    sin,
    smoothstep,
    sqrt,
    struct,
    vec2,
    vec3,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import MOST_STEPS, March, crossing
from distal.render.normals import tangent

SHARPEST = 0.003  # smallest tangent of a light's half angle: sharper shadows would be noisy
NARROW = 0.01  # below this tangent, one ray to the middle of the light is enough
ENOUGH_SAMPLES = 4  # from so many samples of a pixel on, each has one ray to a wide light
MOST_RAYS = 16  # rays to the widest lights, seen by one sample
TURN = 6.28318531
GOLDEN_ANGLE = 2.399963
# How far out points of a disc are, and the radius of the part of it around each, in radii of the
# disc: a search for the least error beside straight edges of all directions (rms .006 with 9 points
# on a circle, .016 with 16 in a sunflower's order), and beside thin plates.
MOST_ON_CIRCLE = 9
CIRCLE = 0.66
CIRCLE_PART = 0.5
SUNFLOWER = 0.97
SUNFLOWER_PART = 1.3

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
# Two steps with slopes along the ray that differ by less are steps towards a flat surface, which is
# there if this part of the distance to it, or less, is left after a step to it.
ALIKE = 0.02
PREDICTED = 0.5
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

# The share of a light below which an unfinished ray counts as hidden.
UNSEEN = 0.02
# The distance of the closest surface before there is any.
OPEN = 1e9

# Where the next point of a shadow ray is.
OUTSIDE = 0
INSIDE = 1
MIDDLE = 2  # in the middle of a chord whose two ends are known


@struct
class Opening:
    """How much of a light is visible.

    Attributes:
        share: From 0, nothing, to 1, all of it.
        lost: Whether the steps of a ray ran out.
    """

    share: float
    lost: bool = False


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
def outline_offset(field: Field3, ray: Ray, entered: float, left: float) -> float:
    """Return the tangent of the angle from a ray through a solid to the solid's outline.

    The two faces are taken as flat: as the ray turns, its chord shrinks by a known rate, and the
    outline is where nothing is left of it. Parallel faces have no outline.

    Args:
        field: Signed distance, of any slope.
        ray: The ray.
        entered: Distance along it where it enters the solid.
        left: Distance where it leaves.
    """
    inset = INSET * (left - entered)
    front = gradient(field, ray.origin + (entered + inset) * ray.direction)
    back = gradient(field, ray.origin + (left - inset) * ray.direction)
    ahead = min(dot(front, ray.direction), -1e-3 * length(front))
    behind = max(dot(back, ray.direction), 1e-3 * length(back))
    turned = entered / min(ahead, -1e-9) * front - left / max(behind, 1e-9) * back
    rate = length(turned - dot(turned, ray.direction) * ray.direction)
    return (left - entered) / max(rate, 1e-9)


@func
def find_edge(
    field: Field3,
    ray: Ray,
    width: float,
    end: float,
    bounds: Bounds,
    numbers: March,
    steps: int,
    steep: bool,
) -> Edge:
    """Return where the edge of a shadow is, as one ray to the middle of a light's disc finds it.

    Args:
        field: Signed distance.
        ray: The ray to the middle of the disc.
        width: Radius of the disc at distance 1.
        end: Distance along the ray where it ends.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
        steep: Whether values may be less than distances; a constant.
    """
    # A ray beside the box is dimmed too, by what is within the disc's radius there.
    corner = max(abs(bounds.low - ray.origin), abs(bounds.high - ray.origin))
    margin = width * min(length(corner), end)
    span = crossing(ray, Bounds(bounds.low - margin, bounds.high + margin))
    last = min(end, span.y)
    t = max(span.x, 0.0) + numbers.threshold
    share = OPEN  # by the closest surface outside, or by the depth
    outline = OPEN  # by the outlines of what the ray goes through
    closest = t
    free = 0.0  # the distance at the previous point
    step = 0.0  # from the previous point to this one
    least = 0.0  # the least step that was allowed there
    slope = 1.0
    entry = 0.0  # the slope along the ray where it went in, and the place
    entered = 0.0
    left = 0.0  # where it came out; the next point is the middle of the chord
    count = 0  # points inside
    state = OUTSIDE
    for i in range(min(steps, MOST_STEPS)):
        if t > last or min(share, outline) <= -1.0:
            break
        p = ray.origin + t * ray.direction
        value = field(p) / numbers.divisor
        if value < share * width * t:
            share = value / (width * t)
            closest = t
        if state == MIDDLE:
            # How flat the two faces are, from 0 to 1.
            flat = smoothstep(ROUND, FLAT, -value / max(entry * (t - entered), 1e-9))
            if flat > 0.0:
                across = outline_offset(field, ray, entered, 2.0 * t - entered) / width
                outline = min(outline, mix(min(share, 0.0), -across, flat))
            t = left
            free = 0.0
            step = 0.0
            state = OUTSIDE
        elif (
            state == OUTSIDE
            and step > max(free, least)
            and value + free < step
            and not (
                abs(value) < max(NEARLY * t, PREDICTED * free)
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
                chord = t - value / entry - entered
                if chord > 4.0 * NEARLY * t:
                    state = MIDDLE
                    step = 0.5 * chord - (t - entered)
                else:
                    state = OUTSIDE
                    if entry * numbers.steepest > GRAZING:
                        across = outline_offset(field, ray, entered, entered + chord) / width
                        outline = min(outline, -across)
            if state == INSIDE:
                count += 1
                step = max(abs(value), max(NEARLY, 0.1 * width * float(count)) * t)
                step = min(step, 0.15 * t + 2.0 * numbers.threshold)
            elif state == OUTSIDE:
                is_along = abs(slope) < SLIGHT and abs(slope - before) < ALIKE
                least = max(NEARLY, select(is_along, SLIGHT * width, 0.0)) * t
                if 3 * i > 2 * steps:
                    least = HURRY * t
                step = max(step_outside(value, slope, before, width * t), least)
                if t + step > last and t + value < last:
                    # The free ball ends before the ray does: try the longer step at the ray's end,
                    # exactly, or rounding would end the ray before it is tried.
                    step = last - t
                    is_last = True
            t = select(is_last, last, t + step)
    # A ray that ran out of steps is lost if what it has not seen could change the picture.
    lost = t <= last and share_of_disc(min(share, outline)) > UNSEEN
    if steep and share < 1.0 and share > -1.0:
        # The local gradient makes a distance of a value that is too small.
        p = ray.origin + closest * ray.direction
        share = share / true_slope(length(gradient(field, p)) / numbers.divisor, numbers)
    return Edge(min(share, outline), abs(share) >= 1.0 and outline >= OPEN, lost)


@func
def true_slope(steepness: float, numbers: March) -> float:
    """Return |gradient| of a field at a point, within the bounds by which values are divided.

    Dividing by it makes a distance of a value near the surface.

    Args:
        steepness: |gradient|.
        numbers: The parameters of the march.
    """
    return max(steepness, FLATTEST / numbers.steepest)


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

    One sample approximates the light's disc by one ray to its middle: the share that a straight
    edge leaves open, by the closest approach to the ray, outside or inside (Inigo Quilez, "Soft
    shadows in raymarched SDFs"). A ray through two faces of something has no such edge: for a
    narrow light it counts as hidden. If the ray to a wide light does not show all of the disc or
    nothing, 9 rays or more share the disc. From 4 samples of a pixel on, each sample has one ray to
    its own part of the disc, and their mean is the share.

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
    end = min(light.distance, numbers.far)
    whole = max(light.radius, SHARPEST)
    middle = Ray(origin, light.direction)
    if light.radius < NARROW:
        only = find_edge(field, middle, whole, end, bounds, numbers, steps, steep)
        return Opening(share_of_disc(only.offset), only.lost)
    by_sample = samples >= ENOUGH_SAMPLES
    parts = samples if by_sample else rays_to(light.radius)
    count = 1 if by_sample else parts
    part = part_of_disc(parts)
    total = 0.0
    lost = False
    ray = middle
    # The first ray goes to the middle of the whole disc.
    for k in range(MOST_RAYS + 1):
        if k > count:
            break
        width = select(k == 0, whole, whole * part)
        found = find_edge(field, ray, width, end, bounds, numbers, steps, steep)
        lost = lost or found.lost
        if k == 0 and found.is_sure:
            return Opening(share_of_disc(found.offset), lost)
        total += select(k == 0, 0.0, share_of_disc(found.offset))
        ray = Ray(origin, toward_light(light, sample if by_sample else k, parts))
    return Opening(total / float(count), lost)


@func
def rays_to(radius: float) -> int:
    """Return the number of rays to a light with a disc of this radius, seen by one sample."""
    return 9 if radius <= 0.4 else MOST_RAYS


@func
def share_of_disc(s: float) -> float:
    """Return how much of a disc an edge leaves open that is ``s`` radii from its middle."""
    c = clamp(s, -1.0, 1.0)
    return 0.25 * (1.0 + c) * (1.0 + c) * (2.0 - c)


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
    # How far the middle of the disc is above the planes, in radii of the disc.
    radius = max(light.radius, SHARPEST) * light.distance
    over = share_of_disc(planes(origin + light.distance * light.direction) / radius)
    if over <= 0.0:
        return Opening(0.0)
    found = soft_shadow(field, origin, light, bounds, numbers, steps, steep, sample, samples)
    return Opening(min(found.share, over), found.lost)


@func
def no_shadow(origin: vec3, light: LightSample, sample: int, samples: int) -> Opening:
    """Return that all of a light is visible."""
    return Opening(1.0)
