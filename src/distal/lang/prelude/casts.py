"""float to integer with every case settled, where a target leaves some undefined."""

from __future__ import annotations

from distal.lang import func, select, uint
from distal.lang.prelude.hidden import saturated_int, saturated_uint

INT_END = 2147483648.0
UINT_END = 4294967296.0
LARGEST_INT = 2147483647
SMALLEST_INT = -2147483648
LARGEST_UINT = 4294967295


@func
def float_to_int(x: float) -> int:
    """Toward zero; beyond the range the nearest int; 0 for NaN, which fails every comparison."""
    inside = select(x > -INT_END and x < INT_END, x, 0.0)
    least = select(x <= -INT_END, SMALLEST_INT, saturated_int(inside))
    return select(x >= INT_END, LARGEST_INT, least)


@func
def float_to_uint(x: float) -> uint:
    """Toward zero; beyond the range the nearest uint; 0 for NaN."""
    inside = select(x > 0.0 and x < UINT_END, x, 0.0)
    return select(x >= UINT_END, uint(LARGEST_UINT), saturated_uint(inside))
