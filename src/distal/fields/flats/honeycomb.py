"""Hexagonal cells that fill the plane: a honeycomb of thin walls.

Input: a point, the width of the cells and the thickness of the walls. Output: the distance to the
walls, exact outside.
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import EXACT_OUTSIDE, Limit, primitive
from distal.fields.widths import wall_width
from distal.lang import abs, dot, func, max, round, select, vec2

ROOT_THREE_QUARTERS: Final = 0.8660254037844386


def _walls_leave_holes(cell_size: float, wall: float) -> str | None:
    return None if wall < cell_size else "wall must be below cell_size"


@func
def hexagon_reach(q: vec2) -> float:
    """Return how far a point is from the middle of a hexagon, towards its nearest side.

    Two sides face along y.
    """
    s = abs(q)
    return max(s.y, ROOT_THREE_QUARTERS * s.x + 0.5 * s.y)


@func
def hexagon_cell(p: vec2, cell_size: float) -> vec2:
    """Return the point relative to the middle of the hexagonal cell that contains it.

    The middles are those of two grids of rectangles, of which the nearer is chosen.

    Args:
        p: Point.
        cell_size: Distance between opposite sides of a cell.
    """
    step = vec2(2.0 * ROOT_THREE_QUARTERS * cell_size, cell_size)
    first = p - step * round(p / step)
    moved = p - 0.5 * step
    second = moved - step * round(moved / step)
    return select(dot(second, second) < dot(first, first), second, first)


@primitive(
    "Honeycomb",
    EXACT_OUTSIDE,
    limits={"wall": Limit.POSITIVE},
    requires=_walls_leave_holes,
    width=wall_width,
)
@func
def honeycomb(p: vec2, cell_size: float = 0.3, wall: float = 0.05) -> float:
    """Infinite honeycomb: the walls between hexagonal holes, one of which is at the origin.

    Args:
        p: Point.
        cell_size: Distance between the middles of adjacent cells, along y and at 60 degrees to it.
        wall: Thickness of the walls, below ``cell_size``.

    Source: the hexagon around the nearest point of a triangular grid.

    Measured:
        honeycomb((0.0, 0.0), 1.0, 0.25) = 0.375
        honeycomb((0.0, 0.5), 1.0, 0.25) = -0.125
        honeycomb((0.4330127018922193, 1.0), 1.0, 0.25) = 0.0
    """
    q = hexagon_cell(p, cell_size)
    return 0.5 * (cell_size - wall) - hexagon_reach(q)
