"""Reconstruction filters: where a sample of a pixel lies, and how much it counts.

Input: two random numbers. Output: an offset from the middle of the pixel, whose distribution is the
filter, and a weight: 1, or for a filter with negative lobes its sign times the integral of its
absolute value. The mean of weighted samples is the filtered picture. Does not depend on scenes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.lang import abs, cos, func, log, max, select, sign, sin, sqrt, struct, vec2

# The names of the filters; a filter's number is its index.
NAMES: Final = ("tent", "box", "gaussian", "blackman-harris", "mitchell")
SIGNED: Final = frozenset(("mitchell",))
TENT: Final = 0
BOX: Final = 1
GAUSSIAN: Final = 2
BLACKMAN_HARRIS: Final = 3

FULL_TURN = 6.28318530717959
# Standard deviation of the Gaussian, in pixels.
DEVIATION = 0.5
# Half the width of the window of Blackman and Harris, in pixels.
HALF_WINDOW = 2.0
WINDOW_0 = 0.35875
WINDOW_1 = 0.48829
WINDOW_2 = 0.14128
WINDOW_3 = 0.01168
# Mitchell's filter (B = C = 1/3) has a zero at 8/7 and ends at 2. Integrals of its absolute value
# from 0 to the zero, and to the end.
LOBE_END = 8.0 / 7.0
NEGATIVE = (2.0 * (6.0 / 7.0) ** 3 - 1.75 * (6.0 / 7.0) ** 4) / 18.0
TO_ZERO = 0.5 + NEGATIVE
WHOLE = 0.5 + 2.0 * NEGATIVE
# Halvings of an interval, to 24 bits of its length.
HALVINGS = 24


@struct
class SamplePlace:
    """A sample of a pixel.

    Attributes:
        offset: From the middle of the pixel, in pixels.
        weight: How much the sample counts.
    """

    offset: vec2
    weight: float


@func
def tent(x: float) -> float:
    """Map a uniform number from -1 to 1 to an offset from -1 to 1 with a tent distribution."""
    return sign(x) * (1.0 - sqrt(max(1.0 - abs(x), 0.0)))


@func
def gaussian(u: vec2) -> vec2:
    """Return an offset with a normal distribution, by the method of Box and Muller.

    Source: G. E. P. Box and Mervin E. Muller, "A Note on the Generation of Random Normal Deviates"
        (1958).
    """
    radius = DEVIATION * sqrt(-2.0 * log(max(1.0 - u.x, 1e-9)))
    angle = FULL_TURN * u.y
    return vec2(radius * cos(angle), radius * sin(angle))


@func
def window_integral(x: float) -> float:
    """Return the integral of the window of Blackman and Harris from its middle.

    Args:
        x: A place from 0, the middle, to 1, the end, where the integral is 0.5.

    Source: Fredric Harris, "On the Use of Windows for Harmonic Analysis with the Discrete Fourier
        Transform" (1978), four terms, 92 dB.
    """
    half_turn = 0.5 * FULL_TURN
    s = sin(half_turn * x)
    c = cos(half_turn * x)
    twice = 2.0 * s * c
    thrice = s * (4.0 * c * c - 1.0)
    waves = WINDOW_1 * s + WINDOW_2 * 0.5 * twice + WINDOW_3 / 3.0 * thrice
    return 0.5 * x + waves / (FULL_TURN * WINDOW_0)


@func
def mitchell_integral(x: float) -> float:
    """Return the integral of the absolute value of Mitchell's filter from 0 to ``x``, 0 to 2.

    Source: Don Mitchell and Arun Netravali, "Reconstruction Filters in Computer Graphics" (1988),
        B = C = 1/3.
    """
    near = x * (16.0 / 18.0 + x * x * (x * (7.0 / 24.0) - 4.0 / 6.0))
    # Beyond 1 the filter is (2 - x)^2 (8 - 7 x) / 18.
    y = 2.0 - x
    rest = y * y * y * (2.0 - 1.75 * y) / 18.0
    beyond = select(x < LOBE_END, TO_ZERO - NEGATIVE + rest, WHOLE - rest)
    return select(x < 1.0, near, beyond)


@func
def inverse(integral: Callable[[float], float], value: float, end: float) -> float:
    """Return where a growing function reaches a value, between 0 and ``end``, by halving.

    Args:
        integral: The function.
        value: The value.
        end: The end of the interval.
    """
    low = 0.0
    width = end
    for _ in range(HALVINGS):
        width = 0.5 * width
        low = select(integral(low + width) < value, low + width, low)
    return low + 0.5 * width


@func
def blackman_harris(x: float) -> float:
    """Map a uniform number from -1 to 1 to an offset with the window's distribution."""
    return sign(x) * HALF_WINDOW * inverse(window_integral, 0.5 * abs(x), 1.0)


@func
def mitchell(x: float) -> float:
    """Map a uniform number from -1 to 1 to an offset distributed as the filter's absolute value."""
    return sign(x) * inverse(mitchell_integral, WHOLE * abs(x), 2.0)


@func
def place_by_filter(u: vec2, filter: int) -> SamplePlace:
    """Return the place of a sample.

    Args:
        u: Two random numbers in [0, 1).
        filter: The number of the filter; a constant.
    """
    uniform = 2.0 * u - 1.0
    if filter == TENT:
        return SamplePlace(vec2(tent(uniform.x), tent(uniform.y)), 1.0)
    if filter == BOX:
        return SamplePlace(u - 0.5, 1.0)
    if filter == GAUSSIAN:
        return SamplePlace(gaussian(u), 1.0)
    if filter == BLACKMAN_HARRIS:
        return SamplePlace(vec2(blackman_harris(uniform.x), blackman_harris(uniform.y)), 1.0)
    offset = vec2(mitchell(uniform.x), mitchell(uniform.y))
    outside = (abs(offset.x) > LOBE_END) != (abs(offset.y) > LOBE_END)
    return SamplePlace(offset, select(outside, -4.0, 4.0) * WHOLE * WHOLE)
