"""Telling NaN and infinity from numbers.

The bit tests hold whatever a driver assumes about arithmetic; the comparisons are for GLSL ES
1.00, which cannot see a float's bits, and where nothing is promised.
"""

from __future__ import annotations

from distal.lang import abs, float_bits_to_int, func

MAGNITUDE_BITS = 0x7FFFFFFF
INFINITY_BITS = 0x7F800000
LARGEST_FLOAT = 3.4028234663852886e38


@func
def is_nan(x: float) -> bool:
    """True when the exponent is full and the fraction is not zero."""
    return (float_bits_to_int(x) & MAGNITUDE_BITS) > INFINITY_BITS


@func
def is_infinite(x: float) -> bool:
    """True when the exponent is full and the fraction is zero."""
    return (float_bits_to_int(x) & MAGNITUDE_BITS) == INFINITY_BITS


@func
def is_unordered(x: float) -> bool:
    """True when ``x`` is neither below, at nor above 0, as only NaN is."""
    return not (x < 0.0 or x >= 0.0)


@func
def is_beyond_range(x: float) -> bool:
    """True when the magnitude is above every finite float."""
    return abs(x) > LARGEST_FLOAT
