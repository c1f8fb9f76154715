"""A tree of boxes, in the form that ``render.part_tree`` walks.

Input: boxes. Output: an order of the tree, and an array with two rows of four numbers for each box
of it, parents first. The boxes of a parent's two children are the halves of its parts, divided
where its box is longest, the lower half first. Boxes of parts that move fill the same order again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

# How much larger than its part a box is, for the rounding of 32-bit numbers: for each unit of its
# corners' coordinates, and of its size.
OF_PLACE: Final = 2e-6
OF_SIZE: Final = 1e-4


@dataclass(frozen=True, slots=True)
class BoxTree:
    """The order of a tree of boxes, which other boxes of the same parts may fill.

    Boxes have numbers in which the two boxes in a parent are neighbors, the lowest boxes last.

    Attributes:
        leaves: The number of each part's own box (n,).
        parents: From the lowest boxes to the first: the numbers of boxes with two others in them,
            and the number of the first of these others.
        order: The number of the box at each place of the tree.
        links: Of the box at each place, the place of the one that follows if it is skipped, and
            its part; of a box around others -1 - (axis + 4 * place of the box around it), where
            the axis is the one along which it is divided.
    """

    leaves: Whole
    parents: Sequence[tuple[Whole | slice, int]]
    order: Whole
    links: NDArray[np.float32]

    def filled(self, low: Floats, high: Floats) -> NDArray[np.float32]:
        """Return the tree around boxes.

        Args:
            low: The low corners (n, 3).
            high: The high corners (n, 3).

        Returns:
            An array (2 * (2n - 1), 4): (low corner, box that follows), (high corner, part or as
            ``links``).
        """
        margin = OF_SIZE * (high - low) + OF_PLACE * np.maximum(np.abs(low), np.abs(high))
        own = np.zeros((len(low), 8), np.float32)
        # One operation for both corners: the larger of high is the smaller of -high.
        own[:, 0:3] = low - margin
        own[:, 4:7] = -(high + margin)
        boxes = np.empty((len(self.order), 8), np.float32)
        boxes[self.leaves] = own
        end = len(boxes)
        for numbers, begin in self.parents:
            boxes[numbers] = np.minimum(boxes[begin:end:2], boxes[begin + 1 : end : 2])
            end = begin
        made = boxes[self.order]
        np.negative(made[:, 4:7], out=made[:, 4:7])
        made[:, 3], made[:, 7] = self.links
        return made.reshape(-1, 4)


def box_tree(low: Floats, high: Floats, parts: Whole) -> BoxTree:
    """Return the order of a tree of boxes around parts.

    Args:
        low: The low corners (n, 3).
        high: The high corners (n, 3).
        parts: The number of each part (n,), exact as a 32-bit float.
    """
    count = len(low)
    middles = 0.5 * (low + high)
    links = np.empty((2, 2 * count - 1))
    parents: list[tuple[Whole | slice, int]] = []
    at = np.empty(2 * count - 1, np.int64)
    order = np.arange(count)
    first, size, place, around = (np.array([n]) for n in (0, count, 0, 0))
    at[0], made = 0, 1
    while True:
        links[0, place] = place + 2 * size - 1
        if size.max() == 1:
            break
        apart = size > 1
        above = at[place[apart]]
        whole = slice(int(above[0]), int(above[-1]) + 1)
        is_whole = whole.stop - whole.start == len(above)
        parents.append((whole if is_whole else above, made))
        within, axis = sorted_within(middles[order], first, size)
        order = order[within]
        links[1, place[apart]] = -1 - (axis + 4 * around)[apart]
        is_new = np.repeat(apart, 1 + apart)
        around = np.where(is_new, np.repeat(place, 1 + apart), np.repeat(around, 1 + apart))
        first, size, inner = _halves(first, size, place)
        fresh = inner[is_new]
        at[fresh] = made + np.arange(len(fresh))
        made += len(fresh)
        place = inner
    links[1, place] = parts[order]
    leaves = np.empty(count, np.int64)
    leaves[order] = at[place]
    return BoxTree(leaves, parents[::-1], at, links.astype(np.float32))


def sorted_within(middles: Floats, first: Whole, size: Whole) -> tuple[Whole, Whole]:
    """Return the order of points, sorted within each group along its longest side, and that axis.

    Args:
        middles: The points (n, 3), group by group.
        first: Where each group begins.
        size: How many points it has.
    """
    extent = np.maximum.reduceat(middles, first) - np.minimum.reduceat(middles, first)
    axis = np.argmax(extent, axis=1)
    along = middles[np.arange(len(middles)), np.repeat(axis, size)]
    return np.lexsort((along, np.repeat(np.arange(len(first)), size))), axis


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
