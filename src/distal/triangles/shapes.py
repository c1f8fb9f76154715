"""The pixels of a triangle by its form, and the weights of its corners in each.

Input: a form of triangle of the lattice, its side and a cut. Output: which pixels of its square it
covers, and how much of each corner's code each pixel has. The weights are the colors that the scene
code of ``arithmetic.py`` gives to a triangle whose corners have the unit vectors as codes.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.runtime_access import executor
from distal.triangles import arithmetic
from distal.triangles.lattice import Corners, Integers, TriangleLattice

Floats = NDArray[np.float32]

# Triangles of so many pixels have cuts: smaller ones gain less than the cut's bytes.
LEAST_CUT_PX: Final = 8
MOST_CUT_PX: Final = 2048
# Corner, and the two places, of each cut.
CUTS: Final = tuple(
    (corner, first, second)
    for corner in range(3)
    for first in range(arithmetic.PLACES)
    for second in range(arithmetic.PLACES)
)


def can_be_cut(side: int, kind: int) -> bool:
    """Return whether triangles of a step can have cuts."""
    return LEAST_CUT_PX <= side * side // (4 if kind else 2) <= MOST_CUT_PX


class TriangleShape:
    """The triangles of one form and size, with the same pixels in the picture.

    Attributes:
        pixels: Numbers of the covered pixels in the square, row by row.
        weights: Of shape (cuts + 1, pixels, 3): without a cut, then for each cut of ``CUTS``.
        products: Of shape (cuts + 1, 3, 3): sums of products of two corners' weights.
        basis: Of shape (pixels, (cuts + 1) * 3): orthonormal, spans each choice's weights.
    """

    def __init__(self, pixels: Integers, weights: Floats) -> None:
        self.pixels = pixels
        self.weights = weights
        self.products = np.einsum("kni,knj->kij", weights, weights).astype(float)
        # Corners without a pixel have no weight: a small number keeps the matrix regular.
        least = 1e-6 * np.trace(self.products, axis1=1, axis2=2) + 1e-9
        factors = np.linalg.inv(
            np.linalg.cholesky(self.products + np.eye(3) * least[:, None, None])
        )
        basis = np.einsum("kni,kji->nkj", weights, factors)
        self.basis: Floats = basis.astype(np.float32).reshape(len(pixels), 3 * len(weights))

    @classmethod
    def of(cls, form: Corners, side: int, *, cut: bool) -> TriangleShape:
        """Return the triangles of a form, all of whose pixels are in the picture."""
        corners = np.array(form)[:, ::-1] * side
        y, x = np.divmod(np.arange(side * side), side)
        places = np.stack([x + arithmetic.MIDDLE[0], y + arithmetic.MIDDLE[1]], 1)
        # What a rasterizer does: the position within the triangle.
        frame = np.linalg.inv((corners[:2] - corners[2]).T)
        first = (places - corners[2]) @ frame.T
        inner = np.concatenate([first, 1.0 - first.sum(1, keepdims=True)], 1)
        pixels: Integers = np.flatnonzero((inner > 0.0).all(1))
        return cls(pixels, _weights(corners, inner[pixels], cut=cut))


@cache
def shape_of(form: Corners, side: int, kind: int) -> TriangleShape:
    """Return the shape of triangles of a form and a size."""
    return TriangleShape.of(form, side, cut=can_be_cut(side, kind))


@lru_cache(maxsize=512)  # all forms of all sides at the borders of one picture
def border_shape_of(form: Corners, side: int, kind: int, rows: int, columns: int) -> TriangleShape:
    """Return the shape of triangles whose square has so many rows and columns in the picture."""
    whole = shape_of(form, side, kind)
    if rows >= side and columns >= side:
        return whole
    row, column = np.divmod(whole.pixels, side)
    kept = (row < rows) & (column < columns)
    return TriangleShape(whole.pixels[kept], whole.weights[:, kept])


def by_border(
    lattice: TriangleLattice, side: int, rows: Integers, columns: Integers
) -> Iterator[tuple[NDArray[np.bool_], int, int]]:
    """Yield groups of squares that have the same rows and columns in the picture.

    Args:
        lattice: The lattice.
        side: The side of the squares.
        rows: The row of each square.
        columns: The column of each square.

    Yields:
        Which squares; how many rows and columns of pixels they have.
    """
    low = (rows + 1) * side > lattice.height
    right = (columns + 1) * side > lattice.width
    for at_bottom in (False, True):
        for at_right in (False, True):
            chosen = (low == at_bottom) & (right == at_right)
            if chosen.any():
                yield (
                    chosen,
                    lattice.height % side if at_bottom else side,
                    lattice.width % side if at_right else side,
                )


def _weights(corners: NDArray[np.float64], inner: NDArray[np.float64], *, cut: bool) -> Floats:
    """Return the weights of the corners in each pixel, for each choice of a cut."""
    weights = np.empty((1 + len(CUTS) * cut, len(inner), 3), np.float32)
    for first in range(3 if cut else 1):
        # The scene code cuts off its first corner: turned, each corner is the first.
        turned = [(first + k) % 3 for k in range(3)]
        chosen = np.array([c[1:] for c in CUTS if c[0] == first] if cut else [], float)
        if first == 0:
            chosen = np.concatenate([[(-1.0, -1.0)], chosen.reshape(-1, 2)])
        found = np.empty((len(chosen), len(inner), 3), np.float32)
        found[:, :, turned] = _turned_weights(corners[turned], inner[:, turned], chosen)
        start = 0 if first == 0 else 1 + first * len(CUTS) // 3
        weights[start : start + len(chosen)] = found
    return weights


def _turned_weights(
    corners: NDArray[np.float64], inner: NDArray[np.float64], cuts: NDArray[np.float64]
) -> Floats:
    a, b, c = np.eye(3)
    ends = [(_called(arithmetic.cut_distance, p, *corners, cuts)) for p in corners]
    away = np.stack(ends, 1) @ inner.T
    codes = [
        np.stack([_called(arithmetic.outer_code, np.int32(k), a, b, c, cut) for cut in cuts[:2]])
        for k in range(3)
    ]
    # All cuts have the same codes beyond them; the first row may be the triangle without a cut.
    rows = np.minimum(np.arange(len(cuts)), 1)
    outer = np.stack([code[np.minimum(rows, len(code) - 1)] for code in codes], 1)
    outer = np.einsum("nj,kjc->knc", inner, outer)
    mixed = _called(
        arithmetic.mixed_code,
        outer.reshape(-1, 3),
        np.broadcast_to(a, outer.shape).reshape(-1, 3),
        away.reshape(-1),
        1.0,
    )
    found: Floats = mixed.reshape(outer.shape)
    return found


def _called(function: Any, *values: Any) -> Any:
    plain = [v if isinstance(v, float | np.int32) else np.asarray(v, np.float32) for v in values]
    return executor().call(function, tuple(plain), {}, device="reference")
