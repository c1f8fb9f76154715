"""Pixels to the file of a picture as triangles.

Input: an array, and how large the file may be or what a bit is worth. Output: bytes. The triangles
are chosen (``choosing.py``), their points get the codes of the smallest squared error and cuts are
chosen again for these codes, in turn (``fitting.py``), and ``stream.py`` writes them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.runtime_access import executor
from distal.triangles import arithmetic
from distal.triangles.choosing import (
    StepErrors,
    best_cuts,
    chosen,
    errors_of,
    first_cuts,
    padded,
    squares,
)
from distal.triangles.fitting import fitted, weights_of
from distal.triangles.lattice import (
    MOST_SIDE,
    Integers,
    LeafTriangles,
    Step,
    TriangleLattice,
    lattice_of,
    leaves_of,
)
from distal.triangles.shapes import CUTS, Floats, border_shape_of, by_border
from distal.triangles.stream import Cut, Description, Triangle, written

# Codes and cuts are chosen in turn so many times: more gains less than .05 dB.
ROUNDS: Final = 3
# The step of codes, for a price of a bit: measured on the gallery.
_STEP: Final = 0.45
# Prices of a bit, in squared error, between which a file's size is searched.
CHEAPEST: Final = 0.5
DEAREST: Final = 3e6
_SEARCHES: Final = 8
_NEAR: Final = 0.97

Progress = Callable[[float], None]


def encode(
    array: Any,
    *,
    most_bytes: int | None = None,
    price: float = 600.0,
    progress: Progress = lambda _: None,
) -> bytes:
    """Return a picture as triangles.

    Args:
        array: Display values, uint8, of shape (height, width), (height, width, 3) or, opaque,
            (height, width, 4); at most 4,096 pixels a side.
        most_bytes: How large the file may be: the best one that is no larger is searched.
        price: Without ``most_bytes``: squared error, of levels and summed over channels, that is
            worth a bit. The smaller, the larger and better the file.
        progress: Called with the part that is done, from 0 to 1.

    Raises:
        TypeError: The array is not of uint8.
        ValueError: It has no such shape, is transparent or too large, or no file is so small.
    """
    pixels = checked(array)
    if not 0.0 < price < math.inf:
        raise ValueError(f"a bit is worth a squared error above 0, not {price!r:.40}")
    work = TriangleEncoding(pixels, lambda part: progress(0.5 * part))
    if most_bytes is None:
        found = work.file(price)
    else:
        found = within(work, most_bytes, lambda part: progress(0.5 + 0.5 * part))
    progress(1.0)
    return found


def checked(array: Any) -> NDArray[np.uint8]:
    """Return pixels of shape (height, width, 3).

    Raises:
        TypeError: The array is not of uint8.
        ValueError: It has another shape, is transparent or too large.
    """
    found = np.asarray(array)
    if found.dtype != np.uint8:
        raise TypeError(f"pixels are of uint8, from 0 to 255, not {found.dtype}")
    if found.ndim == 2:
        found = np.repeat(found[..., None], 3, -1)
    if found.ndim != 3 or found.shape[2] not in (3, 4) or 0 in found.shape:
        raise ValueError(f"a picture has the shape (height, width, 3), not {found.shape}")
    if max(found.shape) > MOST_SIDE:
        height, width = found.shape[:2]
        raise ValueError(
            f"a picture as triangles has at most {MOST_SIDE} pixels a side, not {width}x{height}:"
            " scale it"
        )
    if found.shape[2] == 4 and (found[..., 3] < 255).any():
        raise ValueError("a picture as triangles is opaque: put it on a color first")
    return found[..., :3]


def within(work: TriangleEncoding, most_bytes: int, progress: Progress = lambda _: None) -> bytes:
    """Return the best file that is no larger.

    Args:
        work: The picture.
        most_bytes: How large the file may be.
        progress: Called with the part that is done.

    Raises:
        ValueError: No file is so small.
    """
    low, high = math.log(CHEAPEST), math.log(DEAREST)
    best: bytes | None = None
    # A file of a typical price, then by halves of the logarithm.
    trial = math.log(600.0)
    for number in range(_SEARCHES):
        file = work.file(math.exp(trial))
        progress((number + 1) / _SEARCHES)
        if len(file) <= most_bytes:
            if best is None or len(file) > len(best):
                best = file
            high = trial
            if len(file) >= _NEAR * most_bytes:
                break
        else:
            low = trial
        # Bytes are about inverse to the root of the price.
        guess = trial + 1.7 * math.log(len(file) / most_bytes)
        trial = guess if low < guess < high else 0.5 * (low + high)
    if best is None:
        best = work.file(DEAREST)
        if len(best) > most_bytes:
            raise ValueError(
                f"this picture as triangles has {len(best)} bytes at least, not {most_bytes}"
            )
    return best


class TriangleEncoding:
    """A picture whose triangles have been measured; files of several sizes come from it.

    Attributes:
        lattice: The lattice.
        triangles: How many triangles the last file has.
    """

    def __init__(self, pixels: NDArray[np.uint8], progress: Progress = lambda _: None) -> None:
        height, width, _ = pixels.shape
        self.lattice: TriangleLattice = lattice_of(width, height)
        self.triangles = 0
        self._pixels: Floats = pixels.astype(np.float32)
        self._tiles = padded(self._pixels, self.lattice)
        self._errors: dict[Step, StepErrors] = errors_of(self._tiles, self.lattice, progress)

    def file(self, price: float) -> bytes:
        """Return the file for a price of a bit."""
        used, numbers = chosen(self._errors, self.lattice, price)
        leaves = leaves_of(self.lattice, used)
        cuts = first_cuts(leaves, numbers)
        values = self._first_values()
        rows = self._pixels.reshape(-1, 3)
        for number in range(ROUNDS):
            if number:
                cuts = self._cuts(leaves, values, price)
            values = fitted(weights_of(self.lattice, leaves, cuts), rows, values, used)
        self.triangles = sum(len(each.rows) for each in leaves)
        codes = executor().call(
            arithmetic.color_code, (values.astype(np.float32),), {}, device="reference"
        )
        step = min(255, max(1, round(4.0 * _STEP * math.sqrt(price))))
        return written(
            Description(self.lattice, step, used, _named(leaves, cuts), codes.astype(float))
        )

    def _first_values(self) -> NDArray[np.float64]:
        """Return for each point the mean of the four pixels around it."""
        wide = np.pad(self._tiles, ((1, 1), (1, 1), (0, 0)), mode="edge")
        four = wide[:-1, :-1] + wide[1:, :-1] + wide[:-1, 1:] + wide[1:, 1:]
        return (four / 4.0).reshape(-1, 3).astype(float)

    def _cuts(
        self, leaves: list[LeafTriangles], values: NDArray[np.float64], price: float
    ) -> list[Integers]:
        by_side: dict[int, Floats] = {}
        found = []
        for each in leaves:
            if each.side not in by_side:
                by_side[each.side] = squares(self._tiles, each.side)
            values_of = values[each.points].astype(np.float32)
            numbers = np.full(len(each.rows), -1)
            for part, high, wide in by_border(self.lattice, each.side, each.rows, each.columns):
                shape = border_shape_of(each.form, each.side, each.kind, high, wide)
                pixels = by_side[each.side][each.rows[part], each.columns[part]][:, shape.pixels]
                numbers[part] = best_cuts(shape, pixels, values_of[part], price)
            found.append(numbers)
        return found


def _named(leaves: list[LeafTriangles], cuts: list[Integers]) -> dict[Triangle, Cut]:
    """Return the cuts by the corners of their triangles."""
    found: dict[Triangle, Cut] = {}
    for each, numbers in zip(leaves, cuts, strict=True):
        for place in np.flatnonzero(numbers >= 0).tolist():
            a, b, c = each.points[place].tolist()
            found[a, b, c] = CUTS[numbers[place]]
    return found
