"""Choose the triangles of a picture, and which of them have cuts.

Input: pixels. Output: points of the lattice and cuts, for a price of a bit in squared error. Each
triangle of the lattice gets the smallest squared error that codes of its own give it, without a cut
and with the best one; then triangles are joined from the smallest to the largest wherever that
costs less (Breiman et al. 1984, as Donoho 1999 for wedgelets).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.triangles.lattice import (
    HALVES,
    PARTS,
    QUARTERS,
    Bools,
    Corners,
    Integers,
    LeafTriangles,
    Step,
    TriangleLattice,
    halves_from,
    parity,
    points_of,
)
from distal.triangles.shapes import (
    Floats,
    TriangleShape,
    border_shape_of,
    by_border,
    can_be_cut,
)

Errors = NDArray[np.float64]

# Bits that a triangle costs, and those of a cut: measured on the gallery.
TRIANGLE_BITS: Final = 14.0
CUT_BITS: Final = 8.0
# Codes of its own are freer than those that triangles share: errors of few pixels are too small.
_FREE: Final = 1.5
_LEAST_FREE: Final = 0.5
_MOST_LARGER: Final = 3.0
# Products in one step of the computation, which take 4 bytes each.
_PRODUCTS: Final = 8_000_000


@dataclass(frozen=True, slots=True)
class StepErrors:
    """Squared errors of all triangles of a step.

    Attributes:
        whole: Without a cut.
        cut: With the best cut; infinite if there is none.
        best: The number of that cut.
        pixels: How many pixels a triangle has.
    """

    whole: Errors
    cut: Errors
    best: Integers
    pixels: Integers


def padded(pixels: Floats, lattice: TriangleLattice) -> Floats:
    """Return the pixels of all tiles; those beyond the picture count nowhere."""
    rows, columns = lattice.rows - lattice.height, lattice.columns - lattice.width
    return np.pad(pixels, ((0, rows), (0, columns), (0, 0)), mode="edge")


def squares(pixels: Floats, side: int) -> Floats:
    """Return pixels by square, of shape (rows, columns, side * side, 3)."""
    rows, columns, _ = pixels.shape
    split = pixels.reshape(rows // side, side, columns // side, side, 3).transpose(0, 2, 1, 3, 4)
    return split.reshape(rows // side, columns // side, side * side, 3)


def errors_of(
    pixels: Floats, lattice: TriangleLattice, progress: Callable[[float], None] = lambda _: None
) -> dict[Step, StepErrors]:
    """Return the errors of all triangles of the lattice.

    Args:
        pixels: Of all tiles.
        lattice: The lattice.
        progress: Called with the part that is done.
    """
    steps = list(lattice.steps())
    found: dict[Step, StepErrors] = {}
    for number, (side, kind) in enumerate(steps):
        found[side, kind] = _step_errors(pixels, lattice, side, kind)
        progress((number + 1) / len(steps))
    return found


def _step_errors(pixels: Floats, lattice: TriangleLattice, side: int, kind: int) -> StepErrors:
    values = squares(pixels, side)
    rows, columns = values.shape[:2]
    inside = np.logical_and.outer(
        np.arange(rows) * side < lattice.height, np.arange(columns) * side < lattice.width
    )
    shape = (rows, columns, 4 if kind else 2)
    found = StepErrors(
        np.zeros(shape), np.full(shape, np.inf), np.zeros(shape, int), np.zeros(shape, int)
    )
    odd = parity(rows, columns)
    groups: list[tuple[Bools, tuple[Corners, ...]]] = (
        [(inside, QUARTERS)] if kind else [(inside & (odd == k), HALVES[k]) for k in (0, 1)]
    )
    for squares_of, forms in groups:
        places = np.nonzero(squares_of)
        for part, high, wide in by_border(lattice, side, *places):
            here = places[0][part], places[1][part]
            for number, form in enumerate(forms):
                shaped = border_shape_of(form, side, kind, high, wide)
                if len(shaped.pixels):
                    errors = _errors(shaped, values[here][:, shaped.pixels])
                    found.whole[*here, number] = errors[0]
                    found.pixels[*here, number] = len(shaped.pixels)
                    if can_be_cut(side, kind):
                        found.cut[*here, number], found.best[*here, number] = errors[1:]
    return found


def _errors(shape: TriangleShape, values: Floats) -> tuple[Errors, Errors, Integers]:
    """Return the error without a cut, with the best cut, and that cut's number."""
    choices = len(shape.weights)
    whole = np.empty(len(values))
    cut, best = np.full(len(values), np.inf), np.zeros(len(values), int)
    many = max(1, _PRODUCTS // (9 * choices + 3 * len(shape.pixels)))
    for start in range(0, len(values), many):
        part = values[start : start + many]
        rows = part.transpose(0, 2, 1).reshape(-1, part.shape[1])
        explained = np.square(rows @ shape.basis).reshape(len(part), 3, choices, 3).sum((1, 3))
        total = np.square(part.astype(float)).sum((1, 2))
        errors = np.maximum(total[:, None] - explained, 0.0)
        whole[start : start + many] = errors[:, 0]
        if choices > 1:
            best[start : start + many] = errors[:, 1:].argmin(1)
            cut[start : start + many] = errors[:, 1:].min(1)
    return whole, cut, best


def chosen(
    errors: dict[Step, StepErrors], lattice: TriangleLattice, price: float
) -> tuple[Bools, dict[Step, Integers]]:
    """Return the points to use, and the number of each triangle's cut by step, -1 for none.

    Args:
        errors: The errors of all triangles.
        lattice: The lattice.
        price: Squared error, summed over channels, that is worth a bit.
    """
    split: dict[Step, Bools] = {}
    cuts: dict[Step, Integers] = {}
    below: Errors | None = None
    for step in reversed(list(lattice.steps())):
        found = errors[step]
        whole = found.whole * _larger(found.pixels) + price * TRIANGLE_BITS
        cut = found.cut * _larger(found.pixels) + price * (TRIANGLE_BITS + CUT_BITS)
        cost = np.minimum(whole, cut)
        cuts[step] = np.where(cut < whole, found.best, -1)
        if below is None:
            split[step] = np.zeros(cost.shape, bool)
        else:
            parts = _parts(below) if step[1] else halves_from(below)
            split[step] = parts < cost
            cost = np.minimum(parts, cost)
        below = cost
    return points_of(lattice, split), cuts


def _parts(halves: Errors) -> Errors:
    """Return for each triangle of kind 1 the sum of the two that it is made of."""
    return np.stack(
        [sum(halves[row::2, column::2, k] for row, column, k in parts) for parts in PARTS], -1
    )


def _larger(pixels: Integers) -> Errors:
    """Return by which factor errors grow when triangles share their corners' codes."""
    factor = pixels / np.maximum(pixels - _FREE, _LEAST_FREE)
    return np.where(pixels > _FREE, factor, _MOST_LARGER)


def best_cuts(shape: TriangleShape, values: Floats, codes: Floats, price: float) -> Integers:
    """Return the best cut of each triangle with given codes; -1 for none.

    Args:
        shape: The triangles' shape.
        values: Their pixels, of shape (n, pixels, 3).
        codes: Values of their corners, of shape (n, 3, 3).
        price: Squared error that is worth a bit.
    """
    choices = len(shape.weights)
    found = np.full(len(values), -1)
    if choices == 1 or not len(shape.pixels):
        return found
    columns = shape.weights.transpose(1, 0, 2).reshape(len(shape.pixels), -1)
    products = shape.products.reshape(choices, 9).T.astype(np.float32)
    many = max(1, _PRODUCTS // (9 * choices + 3 * len(shape.pixels)))
    for start in range(0, len(values), many):
        part, corners = values[start : start + many], codes[start : start + many]
        rows = part.transpose(0, 2, 1).reshape(-1, part.shape[1])
        sums = (rows @ columns).reshape(len(part), 3, choices, 3)
        linear = np.einsum("mckj,mjc->mk", sums, corners)
        square = np.einsum("mjc,mic->mji", corners, corners).reshape(len(part), 9) @ products
        errors = square - 2.0 * linear
        errors[:, 1:] += price * CUT_BITS
        found[start : start + many] = errors.argmin(1) - 1
    return found


def first_cuts(leaves: list[LeafTriangles], cuts: dict[Step, Integers]) -> list[Integers]:
    """Return the cut of each triangle that is left."""
    return [
        np.where(
            can_be_cut(each.side, each.kind),
            cuts[each.side, each.kind][each.rows, each.columns, each.number],
            -1,
        )
        for each in leaves
    ]
