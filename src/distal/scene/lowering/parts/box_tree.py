"""A tree of boxes, in the form that ``render.part_tree`` walks.

Input: boxes. Output: an array with two rows of four numbers for each box of the tree, parents
first. The boxes of a parent's two children are the halves of its parts, divided where its box is
longest.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

# How much larger than its part a box is, for the rounding of 32-bit numbers: for each unit of its
# corners' coordinates, and of its size.
OF_PLACE: Final = 2e-6
OF_SIZE: Final = 1e-4


def box_tree(low: Floats, high: Floats, parts: Whole) -> NDArray[np.float32]:
    """Return the tree of boxes around parts.

    Args:
        low: The low corners (n, 3).
        high: The high corners (n, 3).
        parts: The number of each part (n,), exact as a 32-bit float.

    Returns:
        An array (2 * (2n - 1), 4): (low corner, box that follows), (high corner, part or -1).
    """
    count = len(low)
    margin = OF_SIZE * (high - low) + OF_PLACE * np.maximum(np.abs(low), np.abs(high))
    low, high = low - margin, high + margin
    middles = 0.5 * (low + high)
    made = np.empty((2 * count - 1, 2, 4))
    order = np.arange(count)
    first, size, place = np.array([0]), np.array([count]), np.array([0])
    while True:
        made[place, 0, :3] = np.minimum.reduceat(low[order], first)
        made[place, 1, :3] = np.maximum.reduceat(high[order], first)
        made[place, 0, 3] = place + 2 * size - 1
        made[place, 1, 3] = -1.0
        if size.max() == 1:
            break
        order = _sorted_within(middles, order, first, size)
        first, size, place = _halves(first, size, place)
    made[place, 1, 3] = parts[order]
    return _rounded_out(made.reshape(-1, 4))


def _sorted_within(middles: Floats, order: Whole, first: Whole, size: Whole) -> Whole:
    """Return the order of the parts, sorted within each box along its longest side."""
    here = middles[order]
    extent = np.maximum.reduceat(here, first) - np.minimum.reduceat(here, first)
    axis = np.repeat(np.argmax(extent, axis=1), size)
    group = np.repeat(np.arange(len(first)), size)
    along = here[np.arange(len(order)), axis]
    return order[np.lexsort((along, group))]


def _halves(first: Whole, size: Whole, place: Whole) -> tuple[Whole, Whole, Whole]:
    """Return the children of all boxes of several parts; boxes of one part stay."""
    lower = size - size // 2
    upper = size // 2
    pairs = np.stack([np.ones_like(upper), upper > 0], axis=1).astype(bool).ravel()
    is_leaf = size == 1
    firsts = np.stack([first, first + lower], axis=1).ravel()[pairs]
    sizes = np.stack([lower, upper], axis=1).ravel()[pairs]
    lower_place = np.where(is_leaf, place, place + 1)
    places = np.stack([lower_place, place + 2 * lower], axis=1).ravel()[pairs]
    return firsts, sizes, places


def _rounded_out(rows: Any) -> NDArray[np.float32]:
    """Return the rows in 32 bits; the margin is larger than the rounding."""
    found: NDArray[np.float32] = rows.astype(np.float32)
    return found
