"""Metaballs: balls that blend into each other where they are close.

Input: a point, the balls (centre and radius) as data, and the softness of the blend. Output: a
lower bound of the distance, with slope 1.
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import LOWER_BOUND, Bounds, Limit, primitive
from distal.lang import Buffer, abs, exp2, func, length, log2, max, min, select, size, vec3, vec4

SHARP: Final = 1e-12


@func
def metaballs_bounds(balls: Buffer[vec4], softness: float) -> Bounds:
    """Return the box around all balls, enlarged by the most that the blend adds."""
    low = balls[0].xyz - balls[0].w
    high = balls[0].xyz + balls[0].w
    for i in range(1, size(balls)):
        low = min(low, balls[i].xyz - balls[i].w)
        high = max(high, balls[i].xyz + balls[i].w)
    swelling = softness * log2(float(size(balls)))
    return Bounds(low - swelling, high + swelling)


@primitive(
    "Metaballs",
    LOWER_BOUND,
    bounds=metaballs_bounds,
    limits={"softness": Limit.NOT_NEGATIVE},
    tier=2,
    growth=1.0,
)
@func
def metaballs(p: vec3, balls: Buffer[vec4], softness: float = 0.1) -> float:
    """Balls that blend into each other; their order has no effect.

    Args:
        p: Point.
        balls: Centre of each ball, with its radius as fourth number.
        softness: How far the surface moves outwards where two balls are equally near, in scene
            units.

    Source: James Blinn, "A Generalization of Algebraic Surface Drawing" (1982), with a density that
    falls off by the distance from each ball, so that its logarithm is a distance.

    Measured:
        metaballs((0.0, 3.0, 4.0), Buffer([(0.0, 0.0, 0.0, 2.0)]), 0.5) = 3.0
        metaballs((0.0, 4.0, 0.0), Buffer([(-3.0, 0.0, 0.0, 1.0), (3.0, 0.0, 0.0, 1.0)]), 0.5) = 3.5
        metaballs((0.0, 0.0, 0.0), Buffer([(1.0, 0.0, 0.0, 0.5), (0.0, 2.0, 0.0, 1.5)]), 0.0) = 0.5
    """
    sharpness = 1.0 / max(softness, SHARP)
    nearest = length(p - balls[0].xyz) - balls[0].w
    # The sum of all densities, divided by that of the nearest ball so far.
    total = 1.0
    for i in range(1, size(balls)):
        d = length(p - balls[i].xyz) - balls[i].w
        share = exp2(-abs(d - nearest) * sharpness)
        total = select(d < nearest, total * share + 1.0, total + share)
        nearest = min(nearest, d)
    return nearest - softness * log2(total)
