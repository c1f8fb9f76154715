"""Join eight cells into one where their samples say no more than its corners, up to whole bricks.

Input: the samples of bricks and a tolerance. Output: the blocks of 2, 4 and 8 cells a side that the
surface passes through and that are more than one cell. The samples are those of equal cells, so
nothing is lost that these would find. Does not depend on a shape.
"""

from __future__ import annotations

from itertools import product
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from distal.mesh.join_arithmetic import unsaid_by_corners
from distal.mesh.kernels import rows_of
from distal.mesh.lattice import BRICK, keys_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tables import cell_tables

# How often a brick is halved to make its cells.
JOINED_LEVELS: Final = 3
_SAMPLES: Final = BRICK + 1
_THREE: Final = np.array([(x, y, z) for x in range(3) for y in range(3) for z in range(3)])
_FLAT: Final = np.array((_SAMPLES**2, _SAMPLES, 1))
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
    inside = values < 0.0
    flat = values.reshape(len(values), _SAMPLES**3)
    found = []
    for level in range(JOINED_LEVELS):
        half = 1 << level
        wrong = _of_eight(met & ~one)
        met = _of_eight(met)
        one = met & ~wrong
        one &= said_by_corners(inside[:, ::half, ::half, ::half])
        # Triangles of the smallest blocks are measured as densely as samples are, so signs are
        # enough; at a crease the mesh is right where interpolation is not.
        if level:
            brick, *local = np.nonzero(one)
            corner = np.stack(local, axis=1) * (2 * half)
            at = (corner[:, None] + half * _THREE[None]) @ _FLAT
            far = _unsaid(flat[brick[:, None], at], 2 * half * step)
            one[brick, local[0], local[1], local[2]] = far <= tolerance
        brick, *local = np.nonzero(met & ~one)
        places = bricks[brick] * (BRICK // (2 * half)) + np.stack(local, axis=1)
        found.append(keys_of(places))
    return found[2], found[1], found[0]


def _of_eight(cells: Bools) -> Bools:
    """Return for each block of eight whether one of them is true."""
    found = cells[:, 0::2] | cells[:, 1::2]
    found = found[:, :, 0::2] | found[:, :, 1::2]
    return found[..., 0::2] | found[..., 1::2]


def said_by_corners(inside: Bools) -> Bools:
    """Return which blocks have the topology that the signs of their corners have.

    Each other sample must have the sign of a corner of its edge or face, or of any corner in the
    middle; and a block that is one cell has one component and no ambiguous face.

    Args:
        inside: Which samples are inside: three along each axis of a block, of shape
            (n, 2m + 1, 2m + 1, 2m + 1).

    Source: Tao Ju, Frank Losasso, Scott Schaefer, Joe Warren, "Dual Contouring of Hermite Data"
        (2002).
    """
    tables = cell_tables()
    simple = (tables.components[tables.case[:, 0]] == 1) & ~tables.ambiguous.any(axis=1)
    found: Bools = simple[corner_masks(inside[:, ::2, ::2, ::2])]
    # Corners that differ have the sign of the middle among them.
    for axis in range(3):
        planes = np.moveaxis(inside, 1 + axis, 1)[:, ::2].view(np.uint8)
        rows = planes[..., :-1:2] | planes[..., 1::2] << 1 | planes[..., 2::2] << 2
        lines = [rows[:, :, i : rows.shape[2] - 2 + i : 2].astype(np.int16) for i in range(3)]
        said = _SAID[lines[0] | lines[1] << 3 | lines[2] << 6]
        found &= np.moveaxis(said[:, :-1] & said[:, 1:], 1, 1 + axis)
    return found


def _said_planes() -> Bools:
    """Return for the signs of 3 x 3 samples, as bits, whether corners say those of the others."""
    signs = np.arange(1 << 9)[:, None] >> np.arange(9) & 1
    found = np.ones(len(signs), np.bool_)
    for number in (1, 3, 4, 5, 7):
        ends = [(0, 2) if n == 1 else (n,) for n in divmod(number, 3)]
        corners = signs[:, [3 * a + b for a, b in product(*ends)]]
        found &= (corners == signs[:, number, None]).any(axis=1)
    return found


_SAID: Final = _said_planes()


def corner_masks(inside: Bools) -> npt.NDArray[np.uint8]:
    """Return which corners of cells are inside, as bits, from a lattice of samples."""
    bits: Any = inside.view(np.uint8)
    bits = bits[:, :-1] | bits[:, 1:] << 1
    bits = bits[:, :, :-1] | bits[:, :, 1:] << 2
    masks: npt.NDArray[np.uint8] = bits[..., :-1] | bits[..., 1:] << 4
    return masks


def _unsaid(samples: Floats, size: float) -> Floats:
    """Return how far the surface of blocks is from what is interpolated between their corners."""
    if not len(samples):
        return np.empty(0)
    found: Floats = rows_of(unsaid_by_corners, samples, np.full(len(samples), size))
    return found
