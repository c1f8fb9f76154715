"""Floored division of integers, where a target has only division toward zero.

``truncated_quotient`` is never given a divisor of 0 or a quotient out of range: both would be
undefined in GLSL and a trap on x86, which would end the process.
"""

from __future__ import annotations

from distal.lang import func, select, uint
from distal.lang.prelude.hidden import truncated_quotient


@func
def floor_quotient(a: int, b: int) -> int:
    """``a // b``, floored; ``a // 0 = a``, and the most negative int by -1 is itself."""
    # Dividing by 1 in place of 0 already gives the promised a; by -1 it is the negative, wrapped.
    divisor = select(b == 0 or b == -1, 1, b)
    quotient = truncated_quotient(a, divisor)
    rest = a - quotient * divisor
    floored = select(rest != 0 and (rest < 0) != (divisor < 0), quotient - 1, quotient)
    return select(b == -1, -a, floored)


@floor_quotient.overload
def floor_quotient_uint(a: uint, b: uint) -> uint:
    """``a // b``; ``a // 0 = a``."""
    return truncated_quotient(a, select(b == uint(0), uint(1), b))


@func
def floor_remainder(a: int, b: int) -> int:
    """``a % b`` with the sign of ``b``; ``a % 0 = 0``."""
    divisor = select(b == 0 or b == -1, 1, b)
    rest = a - truncated_quotient(a, divisor) * divisor
    return select(rest != 0 and (rest < 0) != (divisor < 0), rest + divisor, rest)


@floor_remainder.overload
def floor_remainder_uint(a: uint, b: uint) -> uint:
    """``a % b``; ``a % 0 = 0``."""
    divisor = select(b == uint(0), uint(1), b)
    return a - truncated_quotient(a, divisor) * divisor
