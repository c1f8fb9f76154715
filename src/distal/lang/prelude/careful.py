"""Sine, cosine and tangent for drivers whose own are rough: no bits, no tricks, any GLSL or WGSL.

Shading languages let the sine be off by 2^-11, and some drivers make use of it: SwiftShader's is
off by 1.9e-4 (measured over -10 to 10), which turns a camera far enough to move a checker's edges.
As ``elementary``, after Cody and Waite; but whole turns are found by ``floor``, since compilers of
shaders may cancel what is added to round and taken away again, and a turn is folded onto its
quarter by a magnitude, which costs nothing on a GPU.
"""

from __future__ import annotations

from distal.ir.limits import LARGEST_ANGLE, SMALLEST_COSINE
from distal.lang import abs, clamp, floor, func, select
from distal.lang.prelude.elementary import HALF_PI, INVERSE_PI, PI_HIGH, PI_LOW, sine_near_zero

TURNS = 0.5 * INVERSE_PI
TURN_HIGH = 2.0 * PI_HIGH
TURN_LOW = 2.0 * PI_LOW


@func
def held_angle(x: float) -> float:
    """The angle, up to where floats still tell angles apart."""
    return clamp(x, -LARGEST_ANGLE, LARGEST_ANGLE)


@func
def sine(x: float) -> float:
    """The sine, by the distance to its nearest zero: error below 2.5e-7 for ``abs(x) < 100``."""
    # Whole turns and a quarter: what is left is the angle from the sine's greatest value.
    held = held_angle(x)
    n = floor(held * TURNS + 0.25) + 0.25
    rest = (held - n * TURN_HIGH) - n * TURN_LOW
    return sine_near_zero(HALF_PI - abs(rest))


@func
def cosine(x: float) -> float:
    """The cosine; as the sine."""
    held = held_angle(x)
    n = floor(held * TURNS + 0.5)
    rest = (held - n * TURN_HIGH) - n * TURN_LOW
    return sine_near_zero(HALF_PI - abs(rest))


@func
def tangent(x: float) -> float:
    """The sine over the cosine; finite at the poles."""
    across = cosine(x)
    return sine(x) / select(abs(across) < SMALLEST_COSINE, SMALLEST_COSINE, across)
