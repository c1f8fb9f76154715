"""Join eight cells into one where their samples say no more than its corners, up to whole bricks.

Input: the samples of bricks and a tolerance. Output: the blocks of 2, 4 and 8 cells a side that the
surface passes through and that are more than one cell. The samples are those of equal cells, so
nothing is lost that these would find. Does not depend on a shape.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from distal.mesh.join_arithmetic import unsaid_by_corners
from distal.mesh.kernels import rows_of
from distal.mesh.lattice import BRICK, keys_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tables import CORNERS, cell_tables

# How often a brick is halved to make its cells.
JOINED_LEVELS: Final = 3
_SAMPLES: Final = BRICK + 1
_THREE: Final = np.array([(x, y, z) for x in range(3) for y in range(3) for z in range(3)])
_FLAT: Final = np.array((_SAMPLES**2, _SAMPLES, 1))
_CORNERS: Final = np.array([18 * x + 6 * y + 2 * z for x, y, z in CORNERS])
Blocks = tuple[Integers, Integers, Integers]


def separate_blocks(
    bricks: Integers,
    values: Floats,
    masks: npt.NDArray[np.uint8],
    step: float,
    tolerance: float,
) -> Blocks:
    """Return the keys of the blocks that are more than one cell, from the largest to the smallest.

    Args:
        bricks: The bricks, of shape (n, 3).
        values: Their samples, of shape (n, 9, 9, 9).
        masks: The masks of their cells, of shape (n, 8, 8, 8).
        step: The length of a cell.
        tolerance: How far the surface may move.
    """
    met = (masks != 0) & (masks != 255)
    one = met
    flat = values.reshape(len(values), _SAMPLES**3)
    found = []
    for level in range(JOINED_LEVELS):
        half = 1 << level
        wrong = _of_eight(met & ~one)
        met = _of_eight(met)
        one = met & ~wrong
        brick, *local = np.nonzero(one)
        corner = np.stack(local, axis=1) * (2 * half)
        at = (corner[:, None] + half * _THREE[None]) @ _FLAT
        samples = flat[brick[:, None], at]
        far = _unsaid(samples, 2 * half * step)
        # Triangles of the smallest blocks are measured as densely as samples are, so signs are
        # enough; at a crease the mesh is right where interpolation is not.
        joins = (far >= 0.0) & ((far <= tolerance) | (level == 0))
        one[brick, local[0], local[1], local[2]] = joins
        brick, *local = np.nonzero(met & ~one)
        places = bricks[brick] * (BRICK // (2 * half)) + np.stack(local, axis=1)
        found.append(keys_of(places))
    return found[2], found[1], found[0]


def _of_eight(cells: Bools) -> Bools:
    """Return for each block of eight whether one of them is true."""
    found = cells[:, 0::2] | cells[:, 1::2]
    found = found[:, :, 0::2] | found[:, :, 1::2]
    return found[..., 0::2] | found[..., 1::2]


def _unsaid(samples: Floats, size: float) -> Floats:
    """Return how far the surface of blocks is from what corners say; -1 for those that stay apart.

    A block that is one cell has one component and no ambiguous face.
    """
    if not len(samples):
        return np.empty(0)
    tables = cell_tables()
    inside = samples[:, _CORNERS] < 0.0
    mask = np.packbits(inside, axis=1, bitorder="little")[:, 0]
    simple = (tables.components[tables.case[:, 0]] == 1) & ~tables.ambiguous.any(axis=1)
    found = np.full(len(samples), -1.0)
    rows = np.flatnonzero(simple[mask])
    if len(rows):
        found[rows] = rows_of(unsaid_by_corners, samples[rows], np.full(len(rows), size))
    return found
