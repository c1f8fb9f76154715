"""Elementary functions for the CPU in 32 bits: polynomials without branches, accurate to a few ulp.

They take much of the time of a picture, and make results independent of a machine's mathematics
library. ``tools/fit_elementary.py`` computed the coefficients (minimax fits of relative error) and
documents the method. Arguments are first reduced to the fitted interval after W. J. Cody and
W. Waite, "Software Manual for the Elementary Functions" (1980): a whole multiple of the period is
subtracted in two parts, the first with so few bits that its product with the multiple is exact.

Rounding to whole numbers adds and subtracts 1.5 * 2^23, whose last bit has the value 1: the low
bits of the sum then hold the whole number, and are used for sign and exponent. This, and building
floats from bits, works in 32 bits only; in 64-bit precision the backend computes these intrinsics
itself. The errors given below are measured (``tests/parity/test_elementary.py``), in units of the
last place. Arguments are already clamped where the table of intrinsics requires it
(``distal.ir.limits``).
"""

from __future__ import annotations

from distal.ir.limits import LARGEST_POWER, SMALLEST, SMALLEST_COSINE
from distal.lang import (
    abs,
    cos,
    exp,
    exp2,
    float_bits_to_int,
    func,
    int_bits_to_float,
    max,
    min,
    select,
    sin,
    sqrt,
)
from distal.lang.prelude.hidden import raw_atan2, raw_power

ROUNDER = 12582912.0  # 1.5 * 2^23
BITS_OF_HALF_ROOT = 0x3F3504F3  # of sqrt(1/2): where the fraction's interval starts

# The fit is 2.606103e-06; with that, a fused multiply-add can return 1 + 2^-23.
SINE_9 = 2.6058e-06
INVERSE_PI = 0.3183098861837907
PI = 3.141592653589793
HALF_PI = 1.5707963267948966
PI_HIGH = 3.140625  # 8 bits
PI_LOW = 0.0009676535897932385
HALF_PI_HIGH = 1.5703125
HALF_PI_LOW = 0.00048382679489661923
LOG2_E = 1.4426950408889634
LOG_2_HIGH = 0.693359375  # 9 bits
LOG_2_LOW = -0.00021219444005469057


@func
def sine_near_zero(r: float) -> float:
    """Return the sine for ``abs(r) <= pi / 2``."""
    s = r * r
    p = -0.00019809778 + s * SINE_9
    p = 0.008333069 + s * p
    p = -0.1666666 + s * p
    return r + r * s * p


@func
def sine(x: float) -> float:
    """Return the sine: error below 1e-7 for ``abs(x) < 100``, 1e-6 for ``abs(x) < 10000``.

    Up to 2^22 the error is below the distance between neighboring floats, and the reduced angle is
    below 2.1, so that the polynomial stays within -1 and 1.
    """
    shifted = x * INVERSE_PI + ROUNDER
    n = shifted - ROUNDER
    r = (x - n * PI_HIGH) - n * PI_LOW
    # An odd multiple of pi changes the sign.
    sign = float_bits_to_int(shifted) << 31
    return int_bits_to_float(float_bits_to_int(sine_near_zero(r)) ^ sign)


@func
def cosine(x: float) -> float:
    """Return the cosine, from the distance to its nearest zero; errors like those of the sine."""
    shifted = (x * INVERSE_PI + 0.5) + ROUNDER
    n = (shifted - ROUNDER) - 0.5
    r = (x - n * PI_HIGH) - n * PI_LOW
    # With n = m - 1/2 and m a whole number, cos(n pi + r) is (-1)^m sin(r).
    sign = float_bits_to_int(shifted) << 31
    return int_bits_to_float(float_bits_to_int(sine_near_zero(r)) ^ sign)


@func
def tangent(x: float) -> float:
    """Return the tangent: tan(r), or -1 / tan(r), with r = x minus a multiple of pi / 2."""
    shifted = x * (2.0 * INVERSE_PI) + ROUNDER
    n = shifted - ROUNDER
    r = (x - n * HALF_PI_HIGH) - n * HALF_PI_LOW
    s = r * r
    p = 0.00310965 + s * 0.009391076
    p = 0.024437124 + s * p
    p = 0.053409096 + s * p
    p = 0.1333883 + s * p
    p = 0.33333156 + s * p
    t = r + r * s * p
    pole = select(abs(t) < SMALLEST_COSINE, SMALLEST_COSINE, t)
    return select((float_bits_to_int(shifted) & 1) == 0, t, -1.0 / pole)


@func
def tangent_by_quotient(x: float) -> float:
    """Return the target's sine divided by its cosine; finite at the poles, unlike its tangent."""
    across = cos(x)
    return sin(x) / select(abs(across) < SMALLEST_COSINE, SMALLEST_COSINE, across)


@func
def scaled_by_power_of_2(x: float, shifted: float) -> float:
    """Return ``x`` * 2^n; n, in the low bits of ``shifted``, is from -127 (result 0) to 128."""
    return x * int_bits_to_float((float_bits_to_int(shifted) + 127) << 23)


@func
def exponential(x: float) -> float:
    """Return e^x up to x = 88, relative error below 1e-7; 0 below x = -87.6."""
    held = max(x, -88.0)
    shifted = held * LOG2_E + ROUNDER
    n = shifted - ROUNDER
    r = (held - n * LOG_2_HIGH) - n * LOG_2_LOW
    p = 0.008368677 + r * 0.0013820735
    p = 0.041668266 + r * p
    p = 0.16666521 + r * p
    p = 0.49999994 + r * p
    return scaled_by_power_of_2(1.0 + (r + r * r * p), shifted)


@func
def exponential_base_2(x: float) -> float:
    """Return 2^x up to x = 127, relative error below 2e-7; 0 below x = -126.5."""
    held = max(x, -127.0)
    shifted = held + ROUNDER
    f = held - (shifted - ROUNDER)
    p = 0.0013390807 + f * 0.00015326454
    p = 0.009618506 + f * p
    p = 0.0555036 + f * p
    p = 0.24022648 + f * p
    p = 0.6931472 + f * p
    return scaled_by_power_of_2(1.0 + f * p, shifted)


@func
def logarithm_near_one(f: float) -> float:
    """Return log(1 + f) for 1 + f from sqrt(1/2) to sqrt(2)."""
    p = -0.14267501 + f * 0.08701546
    p = 0.14914362 + f * p
    p = -0.16577569 + f * p
    p = 0.19963105 + f * p
    p = -0.25001338 + f * p
    p = 0.3333391 + f * p
    s = f * f
    return f + s * (f * p - 0.5)


@func
def exponent_of(x: float) -> int:
    """Return the exponent for which the fraction is from sqrt(1/2) to sqrt(2)."""
    return (float_bits_to_int(x) - BITS_OF_HALF_ROOT) >> 23


@func
def fraction_of(x: float, exponent: int) -> float:
    """Return ``x`` divided by 2^exponent."""
    return int_bits_to_float(float_bits_to_int(x) - (exponent << 23))


@func
def logarithm(x: float) -> float:
    """Return the natural logarithm of a positive normal number."""
    exponent = exponent_of(x)
    n = float(exponent)
    r = logarithm_near_one(fraction_of(x, exponent) - 1.0)
    return n * LOG_2_HIGH + (n * LOG_2_LOW + r)


@func
def logarithm_base_2(x: float) -> float:
    """Return the logarithm to base 2 of a positive normal number."""
    exponent = exponent_of(x)
    r = logarithm_near_one(fraction_of(x, exponent) - 1.0)
    return float(exponent) + r * LOG2_E


@func
def power(x: float, y: float) -> float:
    """Return 2^(y log2(x)); for x <= 0 (or tiny): 1, 0 or the largest value, depending on y."""
    # -1e30, far below every real logarithm, yields these three values; 0 times it is 0.
    return exp2(y * select(x < SMALLEST, -1e30, logarithm_base_2(x)))


@func
def guarded_power(x: float, y: float) -> float:
    """Return the target's power where it is defined; 0 ** 0 = 1; 0 ** negative is LARGEST_POWER."""
    at_zero = select(y == 0.0, 1.0, select(y < 0.0, LARGEST_POWER, 0.0))
    power = min(raw_power(max(x, SMALLEST), y), LARGEST_POWER)
    return select(x < SMALLEST, at_zero, power)


@func
def arc_sine_near_zero(t: float, s: float) -> float:
    """Return the arc sine of ``t`` up to 1/2; ``s`` is the square of ``t``."""
    p = 0.024184741 + s * 0.0421584
    p = 0.045469154 + s * p
    p = 0.074953094 + s * p
    p = 0.16666752 + s * p
    return t + t * s * p


@func
def arc_sine(x: float) -> float:
    """Return the arc sine; above 1/2 by asin(a) = pi/2 - 2 asin(sqrt((1 - a) / 2))."""
    a = abs(x)
    large = a > 0.5
    s = select(large, 0.5 - 0.5 * a, a * a)
    q = arc_sine_near_zero(select(large, sqrt(s), a), s)
    r = select(large, HALF_PI - 2.0 * q, q)
    return select(x < 0.0, -r, r)


@func
def arc_cosine(x: float) -> float:
    """Return the arc cosine, accurate also near 1 and -1."""
    a = abs(x)
    large = a > 0.5
    s = select(large, 0.5 - 0.5 * a, a * a)
    q = arc_sine_near_zero(select(large, sqrt(s), a), s)
    near_end = select(x < 0.0, PI - 2.0 * q, 2.0 * q)
    near_zero = select(x < 0.0, HALF_PI + q, HALF_PI - q)
    return select(large, near_end, near_zero)


@func
def arc_tangent_up_to_one(t: float) -> float:
    """Return the arc tangent for ``t`` from 0 to 1."""
    s = t * t
    p = -0.01636355 + s * 0.0029195533
    p = 0.043205086 + s * p
    p = -0.07551675 + s * p
    p = 0.10665771 + s * p
    p = -0.14211002 + s * p
    p = 0.19993767 + s * p
    p = -0.33333153 + s * p
    return t + t * s * p


@func
def arc_tangent(x: float) -> float:
    """Return the arc tangent; above 1 by atan(a) = pi/2 - atan(1/a)."""
    a = abs(x)
    large = a > 1.0
    q = arc_tangent_up_to_one(select(large, 1.0 / a, a))
    r = select(large, HALF_PI - q, q)
    return select(x < 0.0, -r, r)


@func
def arc_tangent_2(y: float, x: float) -> float:
    """Return the angle of (x, y); 0 for (0, 0)."""
    across = abs(x)
    up = abs(y)
    # The smallest normal float replaces 0, so that (0, 0) has the angle of (1, 0).
    q = arc_tangent_up_to_one(min(across, up) / max(max(across, up), SMALLEST))
    first = select(up > across, HALF_PI - q, q)
    r = select(x < 0.0, PI - first, first)
    return select(y < 0.0, -r, r)


@func
def guarded_arc_tangent_2(y: float, x: float) -> float:
    """Return the target's atan2 where it is defined; 0 for (0, 0)."""
    across = select(x == 0.0 and y == 0.0, 1.0, x)
    return raw_atan2(y, across)


@func
def hyperbolic_sine(x: float) -> float:
    """Return (e^x - e^-x) / 2; a polynomial below 1, where the difference would lose digits."""
    s = x * x
    p = 0.0083302725 + s * 0.00020373041
    p = 0.16666716 + s * p
    e = exp(x)
    return select(abs(x) < 1.0, x + x * s * p, 0.5 * e - 0.5 / e)


@func
def hyperbolic_cosine(x: float) -> float:
    """Return (e^x + e^-x) / 2."""
    e = exp(x)
    return 0.5 * e + 0.5 / e


@func
def hyperbolic_tangent(x: float) -> float:
    """Return 1 - 2 / (e^2x + 1); a polynomial below 5/8, where the difference would lose digits."""
    s = x * x
    p = 0.020628167 + s * -0.0056922967
    p = -0.053736515 + s * p
    p = 0.13331406 + s * p
    p = -0.3333328 + s * p
    return select(abs(x) < 0.625, x + x * s * p, 1.0 - 2.0 / (exp(2.0 * x) + 1.0))
