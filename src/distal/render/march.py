"""Sphere tracing: find the first surface along a ray.

Input: a ray, a field, a box and the parameters of a march. Output: a ``Hit``. The field guarantees
that there is no surface within a ball around each point. A step goes across this ball and on to
where the next ball would touch it if the surface ahead were flat (Bálint and Valasek, "Accelerating
Sphere Tracing", 2018). If the two balls do not touch, the step is taken back (Keinert et al.,
"Enhanced Sphere Tracing", 2014).
"""

from __future__ import annotations

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import Field3, abs, clamp, func, max, min, select, struct, vec2
from distal.render.camera import Ray

# The fraction of the predicted next ball that a step crosses, and the largest predicted radius, as
# a multiple of the previous ball's radius.
RELAXATION = 0.9
LONGEST = 8.0
# When steps run out, the closest approach is a hit if it came within this many thresholds.
FORGIVING = 4.0
# A limit of loops for targets that need a constant one.
MOST_STEPS = 65536

# Why a ray has found no surface.
PASSED = 0  # it left the box, or moved away from the surfaces
OUT_OF_STEPS = 1
TOO_FAR = 2  # the far limit ended it on its way towards a surface


@struct
class March:
    """The parameters of a march.

    Attributes:
        divisor: Distances are divided by it to get a safe step.
        near: Distance along the ray where rays begin.
        far: Distance along the ray where rays end.
        threshold: Largest distance to the surface of a hit, as a fraction of the distance along
            the ray.
        steepest: The largest number by which the field already divides one of its parts (a safe
            field); 1 for other fields.
    """

    divisor: float
    near: float
    far: float
    threshold: float
    steepest: float = 1.0


@struct
class Hit:
    """The end of a ray.

    Attributes:
        t: Distance along the ray, in scene units.
        found: Whether there is a surface.
        steps: Number of evaluations of the field.
        side: -1 if the ray began inside a solid, else 1.
        lost: PASSED, OUT_OF_STEPS or TOO_FAR; PASSED if a surface was found.
        part: The part of a table (``part_tree``) that has the surface; -1 for other surfaces.
    """

    t: float
    found: bool
    steps: int
    side: float
    lost: int = PASSED
    part: int = -1


@func
def crossing(ray: Ray, bounds: Bounds) -> vec2:
    """Return where a ray enters and leaves a box, which may be infinite; x > y if it misses it."""
    tiny = 1e-9
    direction = select(abs(ray.direction) < tiny, ray.direction * 0.0 + tiny, ray.direction)
    near = (bounds.low - ray.origin) / direction
    far = (bounds.high - ray.origin) / direction
    first = min(near, far)
    last = max(near, far)
    return vec2(
        max(first.x, max(first.y, first.z)),
        min(last.x, min(last.y, last.z)),
    )


@func
def march(field: Field3, ray: Ray, bounds: Bounds, numbers: March, steps: int) -> Hit:
    """Return the first surface along a ray.

    Args:
        field: Signed distance.
        ray: Ray.
        bounds: Box around the surface with a margin (``settings.grown_bounds``); rays end at its
            sides.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
    """
    return march_between(field, ray, crossing(ray, bounds), numbers, steps)


@func
def march_between(field: Field3, ray: Ray, span: vec2, numbers: March, steps: int) -> Hit:
    """Return the first surface between two places of a ray.

    Args:
        field: Signed distance.
        ray: Ray.
        span: Where the box around the surface begins and ends, along the ray.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
    """
    t = max(span.x, numbers.near)
    end = min(span.y, numbers.far)
    taken = 0
    side = 1.0
    free = 0.0  # the radius of the free ball around the previous point
    step = 0.0  # from the previous point to this one
    best = UNBOUNDED
    best_t = t
    found = False
    nearing = False
    for i in range(min(steps, MOST_STEPS)):
        if t > end:
            break
        taken += 1
        value = side * field(ray.origin + t * ray.direction)
        if i == 0 and value < 0.0:
            side = -1.0
            value = -value
        d = value / numbers.divisor
        if step > free and d + free < step:
            # The balls do not touch, so a surface may be between them: go back to the edge of the
            # first ball.
            t += free - step
            step = free
        else:
            # A hit depends on the value, not on the safe step: where the field is steep, the
            # safe step is small far away from the surface too. A value that a safe field has
            # divided counts as the distance along the ray at which the last two values predict
            # the surface, but not as more than the undivided value.
            remaining = clamp(step / max(free - d, 1e-9), 1.0, numbers.steepest)
            error = value * remaining / max(t, 1e-3)
            if error < best:
                best = error
                best_t = t
            # A ray that leaves the surface on which it starts has not hit it.
            if error < numbers.threshold and (d < free or value <= 0.0):
                found = True
                # Go to where the line through the last two values is 0.
                beyond = d * step / max(free - d, 1e-9)
                best_t = t + clamp(beyond, 0.0, FORGIVING * numbers.threshold * t)
                break
            # The ball that would touch this one if the surface ahead were flat.
            nearing = d < free
            touching = d * (step - free + d) / max(step + free - d, 1e-9)
            step = d + select(step > 0.0, RELAXATION * clamp(touching, 0.0, LONGEST * d), 0.0)
            free = d
            t += step
            if t > end and t - step + free < end:
                # The free ball ends before the ray does: try the longer step at the ray's end.
                step += end - t
                t = end
    # An early near miss is not a hit: the ray passed that surface.
    ran_out = taken == steps and not found and t < end and best_t > 0.7 * t
    if ran_out and best < FORGIVING * numbers.threshold:
        found = True
    lost = PASSED
    if not found:
        cut_short = t > end and numbers.far < span.y and nearing
        lost = select(t > end, select(cut_short, TOO_FAR, PASSED), OUT_OF_STEPS)
    return Hit(best_t, found, taken, side, lost)
