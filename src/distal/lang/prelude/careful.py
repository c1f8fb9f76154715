"""Accurate sine and cosine for drivers whose own functions are inaccurate.

Works on any GLSL or WGSL, without access to a float's bits. Shading languages allow an error of
2^-11 for the sine, and some drivers use that: SwiftShader's error is 1.9e-4 (measured over -10 to
10), which turns a camera enough to move the edges of a checker pattern. The method is that of
``elementary``, after Cody and Waite, with two changes: whole turns are found by ``floor``, because
shader compilers may cancel a constant that is added and subtracted for rounding; and ``abs`` maps a
turn to a quarter turn, which costs nothing on a GPU.
"""

from __future__ import annotations

from distal.ir.limits import LARGEST_ANGLE
from distal.lang import abs, clamp, floor, func
from distal.lang.prelude.elementary import HALF_PI, INVERSE_PI, PI_HIGH, PI_LOW, sine_near_zero

TURNS = 0.5 * INVERSE_PI
TURN_HIGH = 2.0 * PI_HIGH
TURN_LOW = 2.0 * PI_LOW


@func
def held_angle(x: float) -> float:
    """Clamp the angle to the range where floats are precise enough to represent angles."""
    return clamp(x, -LARGEST_ANGLE, LARGEST_ANGLE)


@func
def sine(x: float) -> float:
    """Return the sine, from the distance to its nearest zero; error < 2.5e-7 up to 100."""
    # Subtract whole turns and a quarter: ``rest`` is the angle from the sine's maximum.
    held = held_angle(x)
    n = floor(held * TURNS + 0.25) + 0.25
    rest = (held - n * TURN_HIGH) - n * TURN_LOW
    return sine_near_zero(HALF_PI - abs(rest))


@func
def cosine(x: float) -> float:
    """Return the cosine, computed like the sine."""
    held = held_angle(x)
    n = floor(held * TURNS + 0.5)
    rest = (held - n * TURN_HIGH) - n * TURN_LOW
    return sine_near_zero(HALF_PI - abs(rest))
