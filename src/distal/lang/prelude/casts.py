"""Conversion from float to integer, for targets that leave it undefined for some inputs."""

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
    """Round toward zero, clamp to the range of int; 0 for NaN, as NaN fails every comparison."""
    inside = select(x > -INT_END and x < INT_END, x, 0.0)
    least = select(x <= -INT_END, SMALLEST_INT, saturated_int(inside))
    return select(x >= INT_END, LARGEST_INT, least)


@func
def float_to_uint(x: float) -> uint:
    """Round toward zero, clamp to the range of uint; 0 for NaN."""
    inside = select(x > 0.0 and x < UINT_END, x, 0.0)
    return select(x >= UINT_END, uint(LARGEST_UINT), saturated_uint(inside))
