"""Averages of periodic and clamped functions over an interval, in closed form.

Input: the middle and the width of an interval. Output: the mean of the function over it, which is
its value at the middle if the width is 0. Patterns compute their averages over footprints by these.
"""

from __future__ import annotations

from distal.lang import abs, clamp, exp, floor, func, max, min, select, sin, vec3

PI = 3.14159265358979
# In shorter intervals, differences of integrals would be rounding errors.
SHORTEST = 1e-4
# exp(-0.3 w^2) follows, for lines of w cells, the least-squares factor between the mean of gradient
# noise along a line and its value in the middle: 0.98, 0.93, 0.77, 0.58, 0.43 were measured at w =
# 0.25, 0.5, 1, 1.5, 2. Beyond, it falls faster, because values that stand for many cells shimmer.
NOISE_FADE = 0.3


@func
def square_wave(x: vec3) -> vec3:
    """Return 1 from 0 to 1 and -1 from 1 to 2, with a period of 2, for each component."""
    return 1.0 - 2.0 * (floor(x) % 2.0)


@func
def triangle_wave(x: vec3) -> vec3:
    """Return the integral of ``square_wave`` from 0: 0 at 0, 1 at 1, 0 at 2."""
    return 1.0 - abs(1.0 - x % 2.0)


@func
def square_mean(x: vec3, width: vec3) -> vec3:
    """Return the mean of ``square_wave`` over an interval, for each component."""
    half = 0.5 * width
    mean = (triangle_wave(x + half) - triangle_wave(x - half)) / max(width, SHORTEST)
    return select(width < SHORTEST, square_wave(x), mean)


@func
def ramp_integral(x: float) -> float:
    """Return the integral of ``clamp(x, 0, 1)`` from 0."""
    inside = clamp(x, 0.0, 1.0)
    return 0.5 * inside * inside + max(x - 1.0, 0.0)


@func
def ramp_mean(x: float, width: float) -> float:
    """Return the mean of ``clamp(x, 0, 1)`` over an interval."""
    # Beyond its corners the ramp is constant; nearer to them, integrals have smaller errors.
    near = clamp(x, -width, 1.0 + width)
    half = 0.5 * width
    mean = (ramp_integral(near + half) - ramp_integral(near - half)) / max(width, SHORTEST)
    return select(width < SHORTEST, clamp(x, 0.0, 1.0), mean)


@func
def wave_fade(width: float) -> float:
    """Return the factor by which a mean over an interval reduces a sine of period 1."""
    angle = PI * abs(width)
    return select(angle < 1e-3, 1.0, sin(angle) / max(angle, 1e-3))


@func
def noise_fade(width: float) -> float:
    """Return the factor by which a mean over an interval reduces gradient noise with cells of 1."""
    return exp(-NOISE_FADE * min(width, 10.0) * min(width, 10.0))
