"""The file of a picture as triangles to pixels: the reference for WebGL.

Input: bytes. Output: an array. The formulas are those of ``arithmetic.py``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from distal.foreign_files import reading
from distal.lang.runtime_access import executor
from distal.triangles import arithmetic
from distal.triangles.fitting import weights_of
from distal.triangles.lattice import leaves_of
from distal.triangles.range_coder import CoderError
from distal.triangles.shapes import CUTS
from distal.triangles.stream import Description, read


def decode(data: bytes) -> NDArray[np.uint8]:
    """Return the pixels of a picture as triangles, of shape (height, width, 3).

    Raises:
        CoderError: The bytes are no such picture.
    """
    with reading("triangles", "this", len(data), error=CoderError):
        return _decoded(read(data))


def _decoded(found: Description) -> NDArray[np.uint8]:
    lattice = found.lattice
    leaves = leaves_of(lattice, found.used)
    numbers = {cut: number for number, cut in enumerate(CUTS)}
    cuts = [
        np.array(
            [
                numbers.get(found.cuts.get(tuple(row), (-1, 0, 0)), -1)
                for row in each.points.tolist()
            ]
        )
        for each in leaves
    ]
    codes = weights_of(lattice, leaves, cuts).shown(found.codes)
    display = executor().call(arithmetic.display_values, (codes,), {}, device="reference")
    shape = (lattice.height, lattice.width, 3)
    levels: NDArray[np.uint8] = np.rint(display * 255.0).astype(np.uint8).reshape(shape)
    return levels
