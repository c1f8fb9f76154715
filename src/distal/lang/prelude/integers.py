"""Floored division of integers, where a target has only division toward zero.

``truncated_quotient`` never gets a divisor of 0 or a quotient out of range: both are undefined in
GLSL, and on x86 they raise an exception that would end the process.
"""

from __future__ import annotations

from distal.lang import func, select, uint
from distal.lang.prelude.hidden import truncated_quotient


@func
def floor_quotient(a: int, b: int) -> int:
    """Return ``a // b``, floored; ``a // 0 = a``, and the most negative int by -1 is itself."""
    # Divisor 1 instead of 0 gives a, as required; instead of -1 it avoids an overflow.
    divisor = select(b == 0 or b == -1, 1, b)
    quotient = truncated_quotient(a, divisor)
    rest = a - quotient * divisor
    floored = select(rest != 0 and (rest < 0) != (divisor < 0), quotient - 1, quotient)
    return select(b == -1, -a, floored)


@floor_quotient.overload
def floor_quotient_uint(a: uint, b: uint) -> uint:
    """Return ``a // b``; ``a // 0 = a``."""
    return truncated_quotient(a, select(b == uint(0), uint(1), b))


@func
def floor_remainder(a: int, b: int) -> int:
    """Return ``a % b`` with the sign of ``b``; ``a % 0 = 0``."""
    divisor = select(b == 0 or b == -1, 1, b)
    rest = a - truncated_quotient(a, divisor) * divisor
    return select(rest != 0 and (rest < 0) != (divisor < 0), rest + divisor, rest)


@floor_remainder.overload
def floor_remainder_uint(a: uint, b: uint) -> uint:
    """Return ``a % b``; ``a % 0 = 0``."""
    divisor = select(b == uint(0), uint(1), b)
    return a - truncated_quotient(a, divisor) * divisor
