"""The operator around a shape that differs from cell to cell: it holds bounds for all cells.

Input: a box, a slope, a divisor and growths, as numbers. Output: an operator that changes nothing
but the bounds, which are these numbers (``scene.lowering.varied_cells`` computes them).
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import EXACT, Bounds, Growth, Operator
from distal.fields.repeat.cells import Copies
from distal.lang import func

# The operator's numbers, in the order of ``scene.lowering.bounds.PACKED``.
BOUNDS_IN_CELLS: Final = ("slope", "divisor", "low", "high", "growth", "side_growth")
IN_CELLS: Final = Operator("varied", keeps=EXACT, growth=Growth.KEPT)


@func
def cells_of_copies(copies: Copies) -> Bounds:
    """Return the least and the largest index of the copies of a repetition."""
    return Bounds(copies.first, copies.last)
