"""Rounding a float and what is left of it."""

from __future__ import annotations

from distal.lang import Floats, abs, floor, func, select


@func
def round_half_even(x: float) -> float:
    """The nearest whole number, halves to the even one; for targets without ``roundEven``."""
    below = floor(x)
    over = x - below
    odd = below - 2.0 * floor(below * 0.5) > 0.5
    return select(over > 0.5 or (over == 0.5 and odd), below + 1.0, below)


@func
def truncate(x: float) -> float:
    """The whole part, toward zero."""
    whole = floor(abs(x))
    return select(x < 0.0, -whole, whole)


@func
def fraction(x: Floats) -> Floats:
    """What floor leaves: in [0, 1), but for tiny negative x, where it rounds to 1."""
    return x - floor(x)


@func
def remainder(a: Floats, b: Floats) -> Floats:
    """A floored remainder, with the sign of ``b``: Python's ``%`` of floats."""
    return a - b * floor(a / b)
