"""The lattice of a mesh: cubic cells, in bricks of eight cells a side, over a box.

Input: a box and the length of a cell. Output: places of lattice points; keys by which bricks are
found. Does not depend on a shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from distal.mesh.solid import Bools, Floats, Integers

DIGIT_OF_FILES: Final = 2.0**-23
DIGIT: Final = 2.0**-52
BRICK: Final = 8  # cells along each side of a brick
# A key has 21 bits for each coordinate, which may be negative for cells beside the lattice.
_SHIFT: Final = 8
_ONES: Final = (1 << 21) - 1
# The lattice begins and ends this many cells beyond the box. Faces of shapes are often at round
# numbers; these shares keep them away from planes of the lattice.
BEFORE: Final = 1.37
BEYOND: Final = 1.11


@dataclass(frozen=True, slots=True)
class Lattice:
    """A lattice over a box.

    Attributes:
        origin: The lowest lattice point.
        step: The length of a cell, in scene units.
        extent: How many bricks there are along each axis.
        digit: The rounding of its places, as a share: that of 32 bits, which files have, or of 64.
    """

    origin: Floats
    step: float
    extent: Integers
    digit: float = DIGIT_OF_FILES

    @staticmethod
    def over(low: Floats, high: Floats, step: float, digit: float = DIGIT_OF_FILES) -> Lattice:
        """Return the lattice over a box.

        Args:
            low: The lowest corner of the box.
            high: Its highest corner.
            step: The length of a cell.
            digit: The rounding of its places, as a share.
        """
        origin = low - BEFORE * step
        cells = (high + BEYOND * step - origin) / step
        return Lattice(origin, step, np.ceil(cells / BRICK).astype(np.int64), digit)

    def places(self, points: npt.NDArray[Any]) -> Floats:
        """Return the places of lattice points; shares of a cell are allowed."""
        return self.origin + np.asarray(points, np.float64) * self.step

    def contains(self, bricks: Integers) -> Bools:
        """Return which bricks belong to the lattice."""
        found: Bools = np.all((bricks >= 0) & (bricks < self.extent), axis=1)
        return found


def keys_of(bricks: Integers) -> Integers:
    """Return a number for each brick, in the order of x, then y, then z."""
    shifted = bricks + _SHIFT
    keys: Integers = (shifted[:, 0] << 42) | (shifted[:, 1] << 21) | shifted[:, 2]
    return keys


def cells_of_keys(keys: Integers) -> Integers:
    """Return the places of bricks or cells, of shape (n, 3), from their keys."""
    return np.stack([keys >> 42, keys >> 21 & _ONES, keys & _ONES], axis=1) - _SHIFT


def ancestors(keys: Integers, levels: int) -> Integers:
    """Return the cell that contains each cell, some levels above, by keys."""
    if levels == 0:
        return keys
    # Each coordinate is shifted in the key, from a multiple of so many units below 0.
    below = max(1, _SHIFT >> levels)
    before, after = (below << levels) - _SHIFT, _SHIFT - below
    ones = (1 << 42) | (1 << 21) | 1
    mask = ones * ((1 << 21 - levels) - 1)
    found: Integers = ((keys + before * ones) >> levels & mask) + after * ones
    return found


def position(keys: Integers, sorted_keys: Integers) -> Integers:
    """Return where keys are in a sorted list of keys; -1 for those that it lacks."""
    if not len(sorted_keys):
        return np.full(len(keys), -1, np.int64)
    at = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
    return np.where(sorted_keys[at] == keys, at, -1)
