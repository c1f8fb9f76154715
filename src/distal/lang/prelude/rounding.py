"""Rounding of floats, and remainders."""

from __future__ import annotations

from distal.ir.limits import SMALLEST_DIVISOR
from distal.lang import Floats, abs, floor, func, max, min, select
from distal.lang.prelude.hidden import nearer_zero


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
    """Return ``x - floor(x)``, below 1 also where the difference is rounded up to 1."""
    return min(x - floor(x), nearer_zero(1.0))


@func
def remainder(a: Floats, b: Floats) -> Floats:
    """Return the floored remainder, from 0 to the float next to ``b``; 0 if b is 0.

    The quotient may be rounded up to a whole number, and the product may be exact or rounded: the
    difference can be a little below 0, or ``b`` itself.
    """
    is_zero = abs(b) < SMALLEST_DIVISOR
    divisor = select(is_zero, 1.0, b)
    end = select(is_zero, 0.0, nearer_zero(b))
    rest = a - divisor * floor(a / divisor)
    return min(max(rest, min(end, 0.0)), max(end, 0.0))
