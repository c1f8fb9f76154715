"""Segments of rays: from a place on a surface, or off it, to the next crossing of a signed field.

Input: a field, a ray, the side of the surface on which it runs, and how it leaves the surface on
which it starts. Output: a ``Hit``. The side is a state: it changes only where the field changes its
sign by more than its rounding error. So a path that follows segments is on the side that it
believes to be on, in solids a few rounding errors thick too. A ray that runs out of steps has no
hit.

One loop with one evaluation of the field (drivers write a field out at each place) leaves the
surface, travels and encloses the crossing:

* A step is accepted if the free balls at its ends touch: nothing is between them.
* Near a surface such steps are too short for rays along it. There a step is accepted too if its end
  agrees with the parabola through the last three values to a few rounding errors, and the parabola
  has no root before it. The length of steps follows this error. The first step from a surface is of
  this kind; its parabola is the line given by the slope with which the ray leaves.
* A change of sign encloses the crossing; false position ends at it.

Does not depend on materials, lights or cameras.
"""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    func,
    gradient,
    length,
    max,
    min,
    select,
    sqrt,
    struct,
    vec2,
    vec3,
)
from distal.render.camera import Ray
from distal.render.march import MOST_STEPS, OUT_OF_STEPS, PASSED, TOO_FAR, Hit, March, crossing
from distal.render.normals import unit_or_up

# The rounding error of a field, for each unit of the coordinates and of the ray's length: 2.1 units
# in the last place. Values below it are on neither side.
ROUNDING = 2.5e-7
# A first step is so long that the field is to be as many rounding errors at its end.
START = 64.0
# The largest distance between a value and the parabola, in rounding errors.
AGREEMENT = 3.0
# The longest step by the parabola: in rounding errors, and as a share of the field's box. 30 units
# from the origin the first alone skipped 4e-5 to 6e-4 of a shell and of a gyroid.
REACH = 4096.0
SHARE = 0.002
# It grows by this factor with each such step as long, and with each step after some: a ray along a
# flat face ends too.
WIDENING = 1.25
PATIENCE = 16
# The fraction of the predicted next ball that a step crosses, and the largest predicted radius, as
# a multiple of the previous ball's radius.
RELAXATION = 0.95
LONGEST = 12.0


@struct
class Landing:
    """A place on a surface.

    Attributes:
        p: The place.
        n: The unit normal, outwards.
        slope: |gradient| of the field.
    """

    p: vec3
    n: vec3
    slope: float


@func
def segment(
    field: Field3,
    ray: Ray,
    side: float,
    slope: float,
    bounds: Bounds,
    numbers: March,
    steps: int,
) -> Hit:
    """Return the next crossing of a field along a ray.

    Args:
        field: Signed distance.
        ray: Ray.
        side: 1 if the ray runs outside, -1 inside; 0 if that is not known.
        slope: How fast the absolute value of the field grows along the ray, if the ray starts on a
            surface: a positive number. 0 if it does not start on one.
        bounds: Box around the surface with a margin (``settings.grown_bounds``); rays end at its
            sides.
        numbers: The parameters of the march; ``threshold`` is not used.
        steps: Maximum number of evaluations of the field.
    """
    sides = bounds.high - bounds.low
    extent = max(sides.x, max(sides.y, sides.z))
    return segment_between(field, ray, side, slope, crossing(ray, bounds), extent, numbers, steps)


@func
def segment_between(
    field: Field3,
    ray: Ray,
    side: float,
    slope: float,
    span: vec2,
    extent: float,
    numbers: March,
    steps: int,
) -> Hit:
    """Return the next crossing of a field between two places of a ray.

    Args:
        field: Signed distance.
        ray: Ray.
        side: As for ``segment``.
        slope: As for ``segment``.
        span: Where the box around the surface begins and ends, along the ray.
        extent: The longest side of that box.
        numbers: The parameters of the march; ``threshold`` is not used.
        steps: Maximum number of evaluations of the field.
    """
    starts = slope > 0.0
    end = min(span.y, numbers.far)
    scale = 1.0 / numbers.divisor
    size = abs(ray.origin.x) + abs(ray.origin.y) + abs(ray.origin.z)
    # The last accepted place, the value there, its first and second divided differences along the
    # ray, and the length of the last accepted step.
    t = select(starts, 0.0, max(span.x, numbers.near))
    free = 0.0
    rise = slope * scale
    bend = 0.0
    last = 0.0
    noise = ROUNDING * (size + t)
    reach = min(REACH * noise, SHARE * extent)
    step = select(starts, clamp(START * noise / max(rise, 1e-6), noise, max(reach, noise)), 0.0)
    # A crossing in a first step as short as this is the next face.
    shortest = 4.0 * noise / max(rise, 1e-3)
    # If high > 0, the crossing is between t and t + high, where the value is -below.
    high = 0.0
    below = 0.0
    around = side
    found = False
    taken = 0
    for _ in range(min(steps, MOST_STEPS)):
        if t > end:
            break
        at = t + step
        value = scale * field(ray.origin + at * ray.direction)
        taken += 1
        if around == 0.0:
            around = select(value < 0.0, -1.0, 1.0)
        value = around * value
        noise = ROUNDING * (size + at)
        if high > 0.0:
            # False position; an end that stays a second time counts half (Illinois). ``rise`` is
            # the sign of the last value.
            up = value > 0.0
            below = select(up, select(rise > 0.0, 0.5, 1.0) * below, -value)
            free = select(up, value, select(rise < 0.0, 0.5, 1.0) * free)
            t = select(up, at, t)
            high = select(up, high - step, step)
            rise = select(up, 1.0, -1.0)
            if abs(value) < 0.25 * noise or high < 0.5 * noise:
                found = True
                t = at
                high = 0.0
                break
        else:
            error = abs(value - (free + step * (rise + bend * (step + last))))
            near = free < reach
            agrees = near and error <= AGREEMENT * noise
            crossed = value < -noise
            touching = step <= free + abs(value) + 2.0 * noise
            growth = step_growth(error, noise)
            leaving = starts and last == 0.0 and step > shortest
            if crossed and (touching or (near and not leaving)):
                high = step
                below = -value
                rise = 0.0
                # Within a few rounding errors of its end: the line through both values is enough.
                if agrees and below * step <= 16.0 * noise * (free + below):
                    found = True
                    break
            if not crossed and (touching or agrees):
                inverse = 1.0 / max(step * (step + last), 1e-30)
                steeper = (value - free) * ((step + last) * inverse)
                bend = select(last > 0.0, (steeper - rise) * (step * inverse), 0.0)
                rise = steeper
                last = step
                t = at
                free = max(value, 0.0)
                step = next_step(free, rise, bend, last, min(reach, growth * last), noise)
                reach *= select(taken > PATIENCE or last > 0.9 * reach, WIDENING, 1.0)
                if t + step > end:
                    if t >= end or t + free > end:
                        t = end + 1.0
                        break
                    step = end - t
            elif high == 0.0:
                # Taken back: shorter, but as long as the free ball.
                step = max(select(near, min(growth, 0.5) * step, free), max(free, 2.0 * noise))
        if high > 0.0:
            step = high * clamp(free / max(free + below, 1e-30), 0.02, 0.98)
    lost = PASSED
    if high > 0.0:
        found = True
        t += high * (free / max(free + below, 1e-30))
    elif not found:
        cut_short = t > end and numbers.far < span.y and rise < 0.0
        lost = select(t > end, select(cut_short, TOO_FAR, PASSED), OUT_OF_STEPS)
    return Hit(clamp(t, 0.0, max(end, 0.0)), found, taken, around, lost)


@func
def step_growth(error: float, noise: float) -> float:
    """Return how much longer the next step may be, by the error of the last and the rounding error.

    The error of a parabola grows with the third power of the step.
    """
    return clamp(AGREEMENT * noise / (0.5 * AGREEMENT * noise + 0.7 * error), 0.25, 2.0)


@func
def next_step(
    free: float, rise: float, bend: float, last: float, longest: float, noise: float
) -> float:
    """Return the length of the next step.

    The longer of two: to where the ball there touches the free ball here, if the surface ahead is
    flat (Bálint and Valasek, "Accelerating Sphere Tracing", 2018); and, up to a limit, to where the
    parabola through the last values is a few rounding errors below 0.

    Args:
        free: The last value.
        rise: The first divided difference of the last two values along the ray.
        bend: The second of the last three; 0 if there are only two.
        last: The length of the last step; 0 if there was none.
        longest: The limit of a step by the parabola.
        noise: The rounding error of a value.
    """
    fall = -(rise + bend * last)
    above = free + 3.0 * noise
    root = fall * fall - 4.0 * bend * above
    down = fall + sqrt(max(root, 0.0))
    falls = root > 0.0 and down > 0.0
    # One division for both.
    flat = max(1.0 - rise, 1e-3)
    steep = max(down, 1e-6)
    inverse = 1.0 / (flat * steep)
    touching = free * clamp((1.0 + rise) * steep * inverse, 0.0, LONGEST)
    ball = free + select(last > 0.0, RELAXATION * touching, 0.0)
    ahead = select(falls, min(longest, 2.0 * above * flat * inverse), longest)
    return max(max(ball, ahead), 2.0 * noise)


@func
def landing(field: Field3, ray: Ray, hit: Hit) -> Landing:
    """Return the place on the surface at the end of a segment, within a rounding error of it.

    The length of a ray is rounded, and so is the place that it gives: far more than the place's own
    coordinates if the ray is long. A step along the normal corrects that. The gradient is that just
    before the hit: many fields have none on the surface itself.

    Args:
        field: Signed distance.
        ray: The ray of the segment.
        hit: Its end, at a surface.
    """
    p = ray.origin
    noise = ROUNDING * (abs(p.x) + abs(p.y) + abs(p.z) + hit.t)
    p += (hit.t - 4.0 * noise) * ray.direction
    steepest = gradient(field, p)
    squared = max(dot(steepest, steepest), 1e-12)
    return Landing(p - steepest * (field(p) / squared), unit_or_up(steepest), length(steepest))
