"""The hybrid march for terrain and water: long steps over it, then bisection.

What flows in: a field that is a height over ground, roughly (positive above), a ray, the height
that all of it stays below. What flows out: a ``Hit``. Sphere tracing nearly stops where a ray
skims a surface; this one strides on and finds the crossing between its last two steps.

Source: the founding blog's "Sunset on the sea": steps of the larger of the distance and a length
that grows, then bisection that uses the field's value at each probe.
"""

from __future__ import annotations

from distal.fields.claims import Bounds
from distal.lang import Field3, abs, func, max, min, select, struct
from distal.render.camera import Ray
from distal.render.march import Hit, March, crossing

UPRIGHT = 1e-6


@struct
class Stride:
    """How a heightfield is stepped over.

    Attributes:
        top: A height that the field lies below everywhere.
        first: The shortest step at the start.
        growth: By what factor it grows with each step.
    """

    top: float = 1.0
    first: float = 0.05
    growth: float = 1.05


STRIDE = Stride()


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
    above = start  # the last place known to lie above
    below = end  # once crossed, the first known to lie below
    crossed = False
    found = False
    step = stride.first
    taken = 0
    for _ in range(steps):
        if t > end:
            break
        taken += 1
        d = field(ray.origin + t * ray.direction) / numbers.divisor
        if abs(d) < numbers.threshold * max(t, 1e-3):
            found = True
            break
        if d < 0.0:
            crossed = True
            below = t
        else:
            above = t
        if crossed:
            # Nothing lies nearer than |d|: that much of the interval is gone, on the probe's side.
            above = select(d > 0.0, min(above + d, below), above)
            below = select(d < 0.0, max(below + d, above), below)
            t = 0.5 * (above + below)
        else:
            t += max(d, step)
            step *= stride.growth
    # With steps run out between two probes, their middle is the best that is known.
    return Hit(t, found or crossed, taken, 1.0)
