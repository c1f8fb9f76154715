"""Format numbers by JavaScript's rules, so that a page and a window show the same text.

Input: a finite number. Output: the number rounded to decimal digits, or its text.
"""

from __future__ import annotations

import math
from decimal import ROUND_HALF_UP, Context, Decimal
from typing import Final

SHOWN_DIGITS: Final = 6
_LARGE: Final = 1e21  # from here on, JavaScript's toFixed rounds no digits


def fixed(value: float, digits: int) -> float:
    """Round to a number of digits after the point, halves away from 0, like ``toFixed``."""
    if abs(value) >= _LARGE:
        return value
    exact = Context(prec=400, rounding=ROUND_HALF_UP)
    return float(Decimal(value).quantize(Decimal(1).scaleb(-digits), context=exact))


def precise(value: float, digits: int) -> float:
    """Round to a number of significant digits, halves away from 0, like ``toPrecision``."""
    return float(Context(prec=digits, rounding=ROUND_HALF_UP).create_decimal(value))


def shown(value: float) -> str:
    """Return the text of a number: at most six digits, without trailing zeros."""
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
