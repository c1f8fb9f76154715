"""Numbers as people read them, by JavaScript's rules: a page and a window show the same text.

Input: a finite number. Output: the number rounded in decimal digits, or its text.
"""

from __future__ import annotations

import math
from decimal import ROUND_HALF_UP, Context, Decimal
from typing import Final

SHOWN_DIGITS: Final = 6
_LARGE: Final = 1e21  # JavaScript writes no digits from here on


def fixed(value: float, digits: int) -> float:
    """The number with so many digits after the point; halves go away from 0: ``toFixed``."""
    if abs(value) >= _LARGE:
        return value
    exact = Context(prec=400, rounding=ROUND_HALF_UP)
    return float(Decimal(value).quantize(Decimal(1).scaleb(-digits), context=exact))


def precise(value: float, digits: int) -> float:
    """The number with so many digits in all; halves go away from 0: ``toPrecision``."""
    return float(Context(prec=digits, rounding=ROUND_HALF_UP).create_decimal(value))


def shown(value: float) -> str:
    """The text of a number: six digits at most, without zeros at the end."""
    if not math.isfinite(value):
        return f"{value:g}"
    number = Decimal(repr(precise(float(value), SHOWN_DIGITS))).normalize()
    if number == 0:
        return "0"
    exponent = number.adjusted()
    if -7 < exponent < 21:
        return f"{number:f}"
    mantissa = f"{number.scaleb(-exponent):f}"
    return f"{mantissa}e{exponent:+d}"
