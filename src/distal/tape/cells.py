"""Cells of a region: a grid of them, and their halves.

Input: the ends of cells along each axis; corners of cells. Output: corners of cells, (2, n, size).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Doubles: TypeAlias = NDArray[np.float64]


def grid_of(sides: Sequence[Doubles]) -> Doubles:
    """Return the cells between some numbers along each axis."""
    starts = np.meshgrid(*(side[:-1] for side in sides), indexing="ij")
    ends = np.meshgrid(*(side[1:] for side in sides), indexing="ij")
    return np.stack([np.stack(c, axis=-1).reshape(-1, len(sides)) for c in (starts, ends)])


def halves_of(cells: Doubles, axes: Sequence[int]) -> Doubles:
    """Return the halves of cells along some axes: two for one axis, eight for three."""
    first, last = cells
    middle = (first + last) / 2.0
    parts = []
    for number in range(2 ** len(axes)):
        begin, end = first.copy(), last.copy()
        for bit, axis in enumerate(axes):
            (begin if number >> bit & 1 else end)[:, axis] = middle[:, axis]
        parts.append(np.stack([begin, end]))
    return np.concatenate(parts, axis=1)
