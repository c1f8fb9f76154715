"""The hybrid march for terrain and water: long steps over it, then a search between two of them.

Input: a field that is a height over ground, roughly (positive above), a ray, the height
that all of it stays below. Output: a ``Hit``. Sphere tracing nearly stops where a ray
skims a surface; this one takes long steps and finds the crossing between the last two.

Source: the blog post "Sunset on the sea": steps of the larger of the distance and a length
that grows, then a search that removes from the interval what the field's value at each probe rules
out. The post halves what is left. Here the line through both ends' values gives the next probe (the
rule of false position in its "Illinois" form: Dowell and Jarratt, 1971), and the line through the
last two values the length of a step: fewer probes, and nearer to the surface.
"""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import Field3, abs, clamp, func, max, min, select, struct
from distal.render.camera import Ray
from distal.render.march import Hit, March, crossing

UPRIGHT = 1e-6
# A step is taken to where the line through the last two values meets 0, and past it by this much:
# the next probe should lie below. LONGEST limits it, in safe steps of the field.
PAST = 1.02
LONGEST = 6.0
# The search ends so many thresholds from the surface: the line's last crossing is far nearer.
ENOUGH = 4.0


@struct
class Stride:
    """How a heightfield is stepped over.

    Attributes:
        top: A height that the field lies below everywhere.
        first: The shortest step at the start, for each unit that the start is away (at least 1).
        growth: By what factor it grows with each step.
    """

    top: float = 1.0
    first: float = 0.03
    growth: float = 1.05


STRIDE = Stride()


@struct
class Bracket:
    """Two places on a ray with the surface between them, and the field there.

    Attributes:
        above: The last place known to lie above.
        value_above: The field there.
        below: The first place known to lie below, once there is one.
        value_below: The field there; below 0 once there is one.
        nearest: No surface lies before it.
        farthest: One lies before it.
        fell: Whether the last probe lay below.
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
    """The bracket after a probe; nothing lies nearer to it than ``safe``.

    An end that two probes leave where it is counts half, or it would never move.
    """
    crossed = bracket.value_below < 0.0
    if value < 0.0:
        kept = select(crossed and bracket.fell, 0.5 * bracket.value_above, bracket.value_above)
        return Bracket(bracket.above, kept, t, value, bracket.nearest, t + safe, True)
    kept = select(crossed and not bracket.fell, 0.5 * bracket.value_below, bracket.value_below)
    return Bracket(t, value, bracket.below, kept, t + safe, bracket.farthest, False)


@func
def likely_crossing(bracket: Bracket) -> float:
    """Where the line through both ends' values is 0, within what is not ruled out.

    The ray's start has no value as long as no probe lay above: halfway, then.
    """
    high = select(bracket.value_above > 0.0, bracket.value_above, -bracket.value_below)
    share = high / max(high - bracket.value_below, 1e-30)
    t = bracket.above + share * (bracket.below - bracket.above)
    return clamp(t, bracket.nearest, max(bracket.nearest, bracket.farthest))


@func
def likely_step(bracket: Bracket, t: float, value: float, safe: float) -> float:
    """How far the surface is if the field goes on as since the bracket's probe; 0 if it rises."""
    fall = bracket.value_above - value
    guess = PAST * value * (t - bracket.above) / max(fall, 1e-30)
    return select(fall > 0.0, min(guess, LONGEST * safe), 0.0)


@func
def start_below(ray: Ray, top: float, t: float) -> float:
    """Where a ray from above comes down to ``top``; ``t`` where it starts below."""
    falls = ray.direction.y < -UPRIGHT
    crossing = (top - ray.origin.y) / select(falls, ray.direction.y, -1.0)
    above = ray.origin.y + ray.direction.y * t > top
    return select(above, select(falls, max(crossing, t), 1e30), t)


@func
def end_above(ray: Ray, top: float, t: float) -> float:
    """Where a rising ray leaves ``top`` for good; ``t`` where it does not before."""
    rises = ray.direction.y > UPRIGHT
    crossing = (top - ray.origin.y) / select(rises, ray.direction.y, 1.0)
    return select(rises, min(crossing, t), t)


@func
def march_heightfield(
    field: Field3, ray: Ray, bounds: Bounds, numbers: March, stride: Stride, steps: int
) -> Hit:
    """The first surface along a ray from above.

    Args:
        field: Positive above the ground; strides may pass over what is thinner than they are long.
        ray: Ray.
        bounds: Box that the surface lies in.
        numbers: As for ``march``; ``steps`` of the result counts all evaluations of the field.
        stride: How to step.
        steps: The most evaluations.
    """
    span = crossing(ray, bounds)
    start = start_below(ray, stride.top, max(span.x, numbers.near))
    end = end_above(ray, stride.top, min(span.y, numbers.far))
    t = start
    bracket = Bracket(start, 0.0, end, 0.0, start, end, False)
    found = False
    step = stride.first * max(start, 1.0)
    # Where a ray enters the box it is above: the first probe is a stride further.
    t = select(start > numbers.near and start < end, min(start + step, end), start)
    taken = 0
    for _ in range(steps):
        if t > end:
            break
        taken += 1
        value = field(ray.origin + t * ray.direction)
        tolerance = numbers.threshold * max(t, 1e-3)
        safe = value / numbers.divisor
        guess = likely_step(bracket, t, value, safe)
        bracket = narrowed(bracket, t, value, safe)
        if bracket.value_below < 0.0:
            t = likely_crossing(bracket)
            if abs(value) < ENOUGH * tolerance or bracket.farthest - bracket.nearest < tolerance:
                found = True
                break
        else:
            # The ray's end is looked at too: a surface may lie between it and the last step.
            t = select(t < end, min(t + max(safe, guess, step), end), 2.0 * end + 1.0)
            step *= stride.growth
    # With steps run out between two probes, the likeliest place is the best that is known.
    return Hit(t, found or bracket.value_below < 0.0, taken, 1.0)
