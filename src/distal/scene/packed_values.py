"""Values that a view shows as colors of three bytes (``render.ranges``), and the range of many.

Input: colors. Output: values, indices. ``tools/gen_player.py`` translates this module to TypeScript
for the page's player, so it is written in the subset of Python that this tool supports.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

# The size of the picture whose values are measured.
PROBE_WIDTH: Final = 64
PROBE_HEIGHT: Final = 48
# With fewer values, a view keeps its default range.
FEWEST_VALUES: Final = 8
LOW_SHARE: Final = 0.02
HIGH_SHARE: Final = 0.98


def unpacked(red: float, green: float, blue: float) -> float:
    """Return the value that ``render.ranges.packed`` shows as a color of three bytes."""
    part = (65536.0 * red + 256.0 * green + blue - 8388608.0) / 8388607.0
    size = (float(2.0 ** (48.0 * max(part, -part))) - 1.0) / 65536.0
    return size if part > 0.0 else -size


def rank(count: float, share: float) -> int:
    """Return the index of a percentile in sorted values."""
    return math.floor(share * (count - 1.0) + 0.5)


def widening(values: Sequence[float]) -> float:
    """Return how much the range of sorted values must grow at both ends so that it is not empty."""
    low = values[rank(len(values), LOW_SHARE)]
    high = values[rank(len(values), HIGH_SHARE)]
    return max(0.0, 0.0005 + 0.005 * max(high, -low) - (high - low))


def lowest(values: Sequence[float]) -> float:
    """Return the low end of the range of sorted values."""
    return values[rank(len(values), LOW_SHARE)] - widening(values)


def highest(values: Sequence[float]) -> float:
    """Return the high end of the range of sorted values."""
    return values[rank(len(values), HIGH_SHARE)] + widening(values)


def median(values: Sequence[float]) -> float:
    """Return the value for the middle of the scale: the median of sorted values.

    A picture may give distances to rays that hit nothing too, as large numbers. If most values are
    in the upper half of a range whose ends have a ratio of 8 or more, the median is that of the
    lower half.
    """
    low = lowest(values)
    high = highest(values)
    middle = values[rank(len(values), 0.5)]
    half = 0.5 * (low + high)
    if low <= 0.0 or high < 8.0 * low or middle < half:
        return middle
    count = 0
    for i in range(len(values)):
        if values[i] < half:
            count = count + 1
    return values[rank(count, 0.5)] if count >= FEWEST_VALUES else middle
