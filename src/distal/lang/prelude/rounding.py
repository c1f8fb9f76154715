"""Rounding of floats, and remainders."""

from __future__ import annotations

from distal.ir.limits import SMALLEST_DIVISOR
from distal.lang import Floats, abs, floor, func, select


@func
def round_half_even(x: float) -> float:
    """Round to the nearest whole number, halves to even; for targets without ``roundEven``."""
    below = floor(x)
    over = x - below
    odd = below - 2.0 * floor(below * 0.5) > 0.5
    return select(over > 0.5 or (over == 0.5 and odd), below + 1.0, below)


@func
def truncate(x: float) -> float:
    """Return the whole part, rounded toward zero."""
    whole = floor(abs(x))
    return select(x < 0.0, -whole, whole)


@func
def fraction(x: Floats) -> Floats:
    """Return ``x - floor(x)``: from 0 to 1; exactly 1 occurs for tiny negative x, by rounding."""
    return x - floor(x)


@func
def remainder(a: Floats, b: Floats) -> Floats:
    """Return the floored remainder with the sign of ``b``, as Python's ``%``; 0 if b is 0."""
    is_zero = abs(b) < SMALLEST_DIVISOR
    divisor = select(is_zero, 1.0, b)
    return select(is_zero, 0.0, a - divisor * floor(a / divisor))
