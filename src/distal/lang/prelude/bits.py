"""Tests for NaN and infinity.

The tests of bits are right even if a driver assumes that NaN and infinity never occur. The
comparisons are for GLSL ES 1.00, which cannot read a float's bits and gives no guarantee.
"""

from __future__ import annotations

from distal.lang import abs, float_bits_to_int, func

MAGNITUDE_BITS = 0x7FFFFFFF
INFINITY_BITS = 0x7F800000
LARGEST_FLOAT = 3.4028234663852886e38


@func
def is_nan(x: float) -> bool:
    """Return whether the exponent bits are all 1 and the fraction is not zero."""
    return (float_bits_to_int(x) & MAGNITUDE_BITS) > INFINITY_BITS


@func
def is_infinite(x: float) -> bool:
    """Return whether the exponent bits are all 1 and the fraction is zero."""
    return (float_bits_to_int(x) & MAGNITUDE_BITS) == INFINITY_BITS


@func
def is_unordered(x: float) -> bool:
    """Return whether ``x`` is neither below, equal to nor above 0, which is true of NaN only."""
    return not (x < 0.0 or x >= 0.0)


@func
def is_beyond_range(x: float) -> bool:
    """Return whether the magnitude is above every finite float."""
    return abs(x) > LARGEST_FLOAT
