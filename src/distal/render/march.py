"""Sphere tracing: along a ray to the nearest surface.

Each step goes as far as the field promises no surface, and on to where the next ball would touch
were the surface ahead flat (Bálint and Valasek, "Accelerating Sphere Tracing", 2018); when the two
balls do not touch, the step is taken back (Keinert et al., "Enhanced Sphere Tracing", 2014).
"""

from __future__ import annotations

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import Field3, abs, clamp, func, max, min, select, struct, vec2
from distal.render.camera import Ray

# How much of the ball that is guessed to come next is stepped over, and the largest it may be, in
# radii of the one before.
RELAXATION = 0.9
LONGEST = 8.0
# When steps run out, the closest approach is a hit if it came within so many thresholds.
FORGIVING = 4.0


@struct
class March:
    """The numbers of a march.

    ``divisor``: what distances are divided by for a safe step. ``near`` and ``far``: where rays
    begin and end. ``threshold``: how near is a hit, as a share of the way along the ray.
    """

    divisor: float
    near: float
    far: float
    threshold: float


@struct
class Hit:
    """Where a ray ended: how far along, whether at a surface, after how many steps.

    ``side`` is -1 when the ray began inside.
    """

    t: float
    found: bool
    steps: int
    side: float


@func
def crossing(ray: Ray, bounds: Bounds) -> vec2:
    """Where a ray enters and leaves a box, of infinite sides too; empty (x > y) if it passes by."""
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
    """The first surface along a ray.

    ``bounds`` have room around the surface (``settings.grown_bounds``): rays end at their sides.
    """
    span = crossing(ray, bounds)
    t = max(span.x, numbers.near)
    end = min(span.y, numbers.far)
    taken = 0
    side = 1.0
    free = 0.0  # the radius of the free ball around the point before
    step = 0.0  # from that point to this one
    best = UNBOUNDED
    best_t = t
    found = False
    for i in range(steps):
        if t > end:
            break
        taken += 1
        value = side * field(ray.origin + t * ray.direction)
        if i == 0 and value < 0.0:
            side = -1.0
            value = -value
        d = value / numbers.divisor
        if step > free and d + free < step:
            # The balls do not touch: something may lie between. Back to the first one's edge.
            t += free - step
            step = free
        else:
            # A hit is judged by the value itself: where the field is steep its share is far away.
            error = value / max(t, 1e-3)
            if error < best:
                best = error
                best_t = t
            if error < numbers.threshold:
                found = True
                # On to where the line through the last two values meets 0.
                beyond = d * step / max(free - d, 1e-9)
                best_t = t + clamp(beyond, 0.0, FORGIVING * numbers.threshold * t)
                break
            # The ball that would touch this one, if the surface ahead were flat.
            touching = d * (step - free + d) / max(step + free - d, 1e-9)
            step = d + select(step > 0.0, RELAXATION * clamp(touching, 0.0, LONGEST * d), 0.0)
            free = d
            t += step
            if t > end and t - step + free < end:
                # The promise ends before the ray does: the longer step is tried at the ray's end.
                step += end - t
                t = end
    # A near miss long before the ray ran out of steps is none: that surface was passed.
    ran_out = taken == steps and not found and t < end and best_t > 0.7 * t
    if ran_out and best < FORGIVING * numbers.threshold:
        found = True
    return Hit(best_t, found, taken, side)
