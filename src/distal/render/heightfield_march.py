"""The hybrid march for terrain and water: long steps above it, then a search between two steps.

Input: a field that is roughly the height above ground (positive above), a ray, and a height that
the whole surface stays below. Output: a ``Hit``. Sphere tracing becomes very slow where a ray
passes close to a surface; this march takes long steps and finds the crossing between the last two.

Source: the blog post "Sunset on the sea": each step is the larger of the distance and a growing
length; then a search narrows the interval, using the field's value at each probe. The post halves
the rest of the interval. Here the next probe is where the line through the values at both ends is 0
(the rule of false position in its "Illinois" form: Dowell and Jarratt, 1971), and the line through
the last two values determines the length of a step: fewer probes, and closer to the surface.
"""

from __future__ import annotations

from distal.fields.guarantees import ENDLESS, Bounds
from distal.lang import Field3, abs, clamp, func, max, min, select, struct
from distal.render.camera import Ray
from distal.render.march import MOST_STEPS, OUT_OF_STEPS, PASSED, Hit, March, crossing

UPRIGHT = 1e-6
# A step goes to where the line through the last two values is 0, times this factor, so that the
# next probe is likely below the surface. LONGEST limits the step, in safe steps of the field.
PAST = 1.02
LONGEST = 6.0
# A ray that starts between the surface's highest and lowest places has steps as if it had come from
# so many times this height away.
HEIGHTS = 2.5


@struct
class Stride:
    """The steps of the hybrid march.

    Attributes:
        top: A height that the surface is below everywhere.
        first: The shortest step at the start, as a share of the distance to the start or of a part
            of the surface's height; later, of the radius of a free ball on the way.
        growth: The factor by which the shortest step grows with each step.
    """

    top: float = 1.0
    first: float = 0.03
    growth: float = 1.05


STRIDE = Stride()


@struct
class Bracket:
    """Two places on a ray with the surface between them, and the field's values there.

    Attributes:
        above: The last place known to be above the surface.
        value_above: The field there.
        below: The first place known to be below the surface, once there is one.
        value_below: The field there; negative once there is one.
        nearest: There is no surface before this place.
        farthest: There is a surface before this place.
        fell: Whether the last probe was below the surface.
    """

    above: float
    value_above: float
    below: float
    value_below: float
    nearest: float
    farthest: float
    fell: bool


@func
def narrowed(bracket: Bracket, t: float, value: float, safe: float) -> Bracket:
    """Return the bracket after a probe at ``t``; there is no surface within ``safe`` of the probe.

    The value of an end that two probes have left unchanged is halved; otherwise the end might
    never move.
    """
    crossed = bracket.value_below < 0.0
    if value < 0.0:
        kept = select(crossed and bracket.fell, 0.5 * bracket.value_above, bracket.value_above)
        return Bracket(bracket.above, kept, t, value, bracket.nearest, t + safe, True)
    kept = select(crossed and not bracket.fell, 0.5 * bracket.value_below, bracket.value_below)
    return Bracket(t, value, bracket.below, kept, t + safe, bracket.farthest, False)


@func
def likely_crossing(bracket: Bracket) -> float:
    """Return where the line through the values at both ends is 0, within the possible interval.

    The start of the ray has no value until a probe lies above; until then, use the middle.
    """
    high = select(bracket.value_above > 0.0, bracket.value_above, -bracket.value_below)
    share = high / max(high - bracket.value_below, 1e-30)
    t = bracket.above + share * (bracket.below - bracket.above)
    return clamp(t, bracket.nearest, max(bracket.nearest, bracket.farthest))


@func
def likely_step(bracket: Bracket, t: float, value: float, safe: float) -> float:
    """Return the distance to the surface by linear extrapolation; 0 if the field rises.

    Args:
        bracket: Has the previous probe.
        t: Place of the current probe.
        value: The field there.
        safe: The safe step there.
    """
    fall = bracket.value_above - value
    guess = PAST * value * (t - bracket.above) / max(fall, 1e-30)
    return select(fall > 0.0, min(guess, LONGEST * safe), 0.0)


@func
def start_below(ray: Ray, top: float, t: float) -> float:
    """Return where a ray from above reaches height ``top``; ``t`` if it starts below."""
    falls = ray.direction.y < -UPRIGHT
    crossing = (top - ray.origin.y) / select(falls, ray.direction.y, -1.0)
    above = ray.origin.y + ray.direction.y * t > top
    return select(above, select(falls, max(crossing, t), 1e30), t)


@func
def end_above(ray: Ray, top: float, t: float) -> float:
    """Return where a rising ray reaches height ``top``; at most ``t``."""
    rises = ray.direction.y > UPRIGHT
    crossing = (top - ray.origin.y) / select(rises, ray.direction.y, 1.0)
    return select(rises, min(crossing, t), t)


@func
def march_heightfield(
    field: Field3, ray: Ray, bounds: Bounds, numbers: March, stride: Stride, steps: int
) -> Hit:
    """Return the first surface along a ray from above.

    Args:
        field: Positive above the ground; steps may miss parts that are thinner than the step.
        ray: Ray.
        bounds: Box that the surface lies in.
        numbers: As for ``march``; ``steps`` of the result counts all evaluations of the field.
        stride: The lengths of steps.
        steps: Maximum number of evaluations.
    """
    span = crossing(ray, bounds)
    start = start_below(ray, stride.top, max(span.x, numbers.near))
    end = end_above(ray, stride.top, min(span.y, numbers.far))
    t = start
    bracket = Bracket(start, 0.0, end, 0.0, start, end, False)
    found = False
    height = stride.top - bounds.low.y
    step = stride.first * max(start, select(height < ENDLESS, HEIGHTS * height, 0.0))
    # A ray is above the surface where it enters the box: the first probe is one step further.
    t = select(start > numbers.near and start < end, min(start + step, end), start)
    taken = 0
    for _ in range(min(steps, MOST_STEPS)):
        if t > end:
            break
        taken += 1
        value = field(ray.origin + t * ray.direction)
        tolerance = numbers.threshold * t
        safe = value / numbers.divisor
        guess = likely_step(bracket, t, value, safe)
        bracket = narrowed(bracket, t, value, safe)
        if bracket.value_below < 0.0:
            t = likely_crossing(bracket)
            if abs(value) < tolerance or bracket.farthest - bracket.nearest < tolerance:
                found = True
                break
        else:
            # The end of the ray is probed too: there may be a surface between it and the last step.
            step = max(step, stride.first * safe)
            t = select(t < end, min(t + max(safe, guess, step), end), 2.0 * end + 1.0)
            step *= stride.growth
    # If the steps run out between two probes, the current estimate is the best known place.
    found = found or bracket.value_below < 0.0
    lost = select(found or t > end, PASSED, OUT_OF_STEPS)
    return Hit(t, found, taken, 1.0, lost)
