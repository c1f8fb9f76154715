"""Operators that repeat a solid on a grid: infinite, limited, interval, half, mirrored.

Input: the functions of ``cells``, and for each kind a function from its numbers to ``Copies``.
Output: operators. ``one_cell`` and ``several_cells`` also declare those of flat shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from distal.fields.guarantees import (
    INSIDE_AND_BOUND,
    LOWER_BOUND,
    Bounds,
    Growth,
    Limit,
    Operator,
    Requirement,
    Site,
    operator,
)
from distal.fields.repeat.cells import (
    bounds_in,
    counted,
    endless,
    interval,
    nearest_copy_distance,
    nearest_copy_site,
    onward,
    repeated_axes,
    site_in,
    slope_in,
    value_in,
    width_of_copies,
)
from distal.fields.repeat.varied import cells_of_copies
from distal.lang import floor, func, round, vec3
from distal.lang.functions import Func

SPACING: Final = {"spacing": Limit.NOT_NEGATIVE}
FITS_CELL: Final = (
    "a shape whose box is smaller than the spacing, with a little room: set neighbors=1 for a "
    "larger one, or mirrored=True for one that is symmetric in its cell"
)
FITS_NEIGHBORS: Final = (
    "a shape smaller than the cells that are evaluated: its box may reach 0.9 spacings from its "
    "middle with neighbors=1, 1.4 with neighbors=2"
)


@dataclass(frozen=True, slots=True)
class CellFunctions:
    """The functions of ``cells`` for solids, or their counterparts in the plane."""

    site: Func
    value: Func
    slope: Func
    bounds: Func
    nearest_distance: Func
    nearest_site: Func
    width: Func


def one_cell(
    name: str,
    functions: CellFunctions,
    copies: Func,
    *,
    limited: bool = True,
    requires: Requirement | None = None,
) -> Operator:
    """Declare a repetition that evaluates the child in the nearest cell only.

    Args:
        name: Name of the operator.
        functions: The functions for solids or for flat shapes.
        copies: ``(*numbers) -> Copies``: the copies that exist.
        limited: Whether the set of copies is finite on any side.
        requires: Returns why numbers contradict each other, or None.
    """
    return operator(
        name,
        cells=cells_of_copies,
        copies=copies,
        point=functions.site,
        finish=functions.value,
        fixed={"neighbors": 0, "limited": limited},
        width=functions.width,
        keeps=INSIDE_AND_BOUND,
        slope=functions.slope,
        bounds=functions.bounds,
        limits=SPACING,
        requires=requires,
        needs=FITS_CELL,
        growth=Growth.HELD,
    )


def neighbors_requirement(neighbors: int) -> str | None:
    """Return why the number of neighbors is invalid, or None."""
    return None if neighbors in (1, 2) else "neighbors must be 0, 1 or 2"


def several_cells(
    name: str,
    functions: CellFunctions,
    copies: Func,
    *,
    limited: bool = True,
    requires: Requirement = neighbors_requirement,
) -> Operator:
    """Declare a repetition that also evaluates the child in cells around the nearest.

    Its number ``neighbors`` is 1 or 2. Arguments as for ``one_cell``.
    """
    return operator(
        name,
        cells=cells_of_copies,
        copies=copies,
        around=functions.nearest_distance,
        site=functions.nearest_site,
        fixed={"limited": limited},
        width=functions.width,
        keeps=LOWER_BOUND,
        slope=functions.slope,
        bounds=functions.bounds,
        limits=SPACING,
        requires=requires,
        needs=FITS_NEIGHBORS,
        growth=Growth.HELD,
    )


@func
def repeated_mirrored(p: vec3, spacing: vec3) -> Site:
    """Return the place in its cell, mirrored in every other one: continuous at borders.

    For a child that is symmetric in its cell this is a plain repetition, at the lowest cost.
    """
    axes = repeated_axes(spacing)
    index = round(p / (spacing + 1.0 - axes)) * axes
    odd = index - 2.0 * floor(0.5 * index)
    return Site((p - index * spacing) * (1.0 - 2.0 * odd), index)


@func
def repeated_mirrored_bounds(bounds: Bounds, spacing: vec3) -> Bounds:
    """Return a box that is infinite along the repeated axes."""
    return bounds_in(bounds, endless(spacing))


def count_requirement(count_x: int = 1, count_y: int = 1, count_z: int = 1) -> str | None:
    """Return why the counts are invalid, or None."""
    return None if min(count_x, count_y, count_z) >= 1 else "each count must be 1 or more"


def block_requirement(
    neighbors: int, count_x: int = 1, count_y: int = 1, count_z: int = 1
) -> str | None:
    """Return why a block with neighbors is invalid, or None."""
    return neighbors_requirement(neighbors) or count_requirement(count_x, count_y, count_z)


def interval_requirement(
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> str | None:
    """Return why the indices are invalid, or None."""
    ends = ((first_x, last_x), (first_y, last_y), (first_z, last_z))
    return None if all(a <= b for a, b in ends) else "the last index must not be below the first"


SOLID: Final = CellFunctions(
    site_in,
    value_in,
    slope_in,
    bounds_in,
    nearest_copy_distance,
    nearest_copy_site,
    width_of_copies,
)
REPEAT = one_cell("repeat", SOLID, endless, limited=False)
REPEAT_NEIGHBORS = several_cells("repeat neighbors", SOLID, endless, limited=False)
REPEAT_MIRRORED = operator(
    "repeat mirrored",
    point=repeated_mirrored,
    keeps=LOWER_BOUND,
    bounds=repeated_mirrored_bounds,
    limits=SPACING,
    growth=Growth.KEPT,
)
REPEAT_LIMITED = one_cell("repeat limited", SOLID, counted, requires=count_requirement)
REPEAT_LIMITED_NEIGHBORS = several_cells(
    "repeat limited neighbors", SOLID, counted, requires=block_requirement
)
REPEAT_INTERVAL = one_cell("repeat interval", SOLID, interval, requires=interval_requirement)
REPEAT_HALF = one_cell("repeat half", SOLID, onward)
