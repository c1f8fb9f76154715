"""The operators of repetition on a grid, and its other kinds: intervals, half of space, mirrors.

Input: the scene code of ``repeat``. Output: operators, whose names tell the kind.
"""

from __future__ import annotations

from distal.fields.combine.joins import INSIDE_AND_BOUND
from distal.fields.guarantees import LOWER_BOUND, UNBOUNDED, Bounds, Growth, Limit, Site, operator
from distal.fields.repeat.cells import (
    Copies,
    bounds_in,
    endless,
    limited,
    limited_around,
    limited_around_slope,
    limited_bounds,
    limited_site,
    limited_slope,
    limited_value,
    repeated,
    repeated_around,
    repeated_around_slope,
    repeated_axes,
    repeated_bounds,
    repeated_site,
    repeated_slope,
    repeated_value,
    site_in,
    slope_in,
    value_in,
)
from distal.lang import floor, func, round, vec3

# From one index to another


@func
def interval(
    spacing: vec3,
    first_x: int,
    first_y: int,
    first_z: int,
    last_x: int,
    last_y: int,
    last_z: int,
) -> Copies:
    """Copies whose indices lie between two, both included; copy 0 stands where the child does."""
    first = vec3(float(first_x), float(first_y), float(first_z))
    return Copies(spacing, vec3(0.0), first, vec3(float(last_x), float(last_y), float(last_z)))


@func
def in_interval(
    p: vec3,
    spacing: vec3,
    bounds: Bounds,
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> Site:
    """The place in the nearest cell of the interval."""
    return site_in(p, interval(spacing, first_x, first_y, first_z, last_x, last_y, last_z), bounds)


@func
def in_interval_value(
    d: float,
    p: vec3,
    spacing: vec3,
    bounds: Bounds,
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> float:
    """The value, safe for the other cells."""
    copies = interval(spacing, first_x, first_y, first_z, last_x, last_y, last_z)
    return value_in(d, p, copies, bounds, True)


@func
def in_interval_slope(
    slope: float,
    bounds: Bounds,
    spacing: vec3,
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> float:
    """The child's, where it fits in its cell."""
    copies = interval(spacing, first_x, first_y, first_z, last_x, last_y, last_z)
    return slope_in(slope, bounds, copies, 0)


@func
def in_interval_bounds(
    bounds: Bounds,
    spacing: vec3,
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> Bounds:
    """The box around the interval."""
    return bounds_in(bounds, interval(spacing, first_x, first_y, first_z, last_x, last_y, last_z))


# From the child on, to one side


@func
def onward(spacing: vec3) -> Copies:
    """Copies from index 0 on, without end."""
    return Copies(spacing, vec3(0.0), vec3(0.0), vec3(UNBOUNDED) * repeated_axes(spacing))


@func
def repeated_half(p: vec3, spacing: vec3, bounds: Bounds) -> Site:
    """The place in the nearest cell of half of space."""
    return site_in(p, onward(spacing), bounds)


@func
def repeated_half_value(d: float, p: vec3, spacing: vec3, bounds: Bounds) -> float:
    """The value, safe for the other cells."""
    return value_in(d, p, onward(spacing), bounds, True)


@func
def repeated_half_slope(slope: float, bounds: Bounds, spacing: vec3) -> float:
    """The child's, where it fits in its cell."""
    return slope_in(slope, bounds, onward(spacing), 0)


@func
def repeated_half_bounds(bounds: Bounds, spacing: vec3) -> Bounds:
    """Without end to one side of the repeated axes."""
    return bounds_in(bounds, onward(spacing))


# Mirrored


@func
def repeated_mirrored(p: vec3, spacing: vec3) -> Site:
    """The place in its cell, every other one mirrored: where two cells meet there is no jump.

    For a child that is symmetric in its cell this is plain repetition, at the lowest cost.
    """
    axes = repeated_axes(spacing)
    index = round(p / (spacing + 1.0 - axes)) * axes
    odd = index - 2.0 * floor(0.5 * index)
    return Site((p - index * spacing) * (1.0 - 2.0 * odd), index)


@func
def repeated_mirrored_bounds(bounds: Bounds, spacing: vec3) -> Bounds:
    """Without end along the repeated axes."""
    return bounds_in(bounds, endless(spacing))


def neighbours_requirement(neighbours: int) -> str | None:
    """Why so many neighbours cannot be asked, or None."""
    return None if neighbours in (1, 2) else "neighbours must be 0, 1 or 2"


def count_requirement(count_x: int = 1, count_y: int = 1, count_z: int = 1) -> str | None:
    """Why there would be no copies, or None."""
    return None if min(count_x, count_y, count_z) >= 1 else "each count must be 1 or more"


def limited_requirement(
    neighbours: int, count_x: int = 1, count_y: int = 1, count_z: int = 1
) -> str | None:
    """Why a block with neighbours cannot be, or None."""
    return neighbours_requirement(neighbours) or count_requirement(count_x, count_y, count_z)


def interval_requirement(
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> str | None:
    """Why there would be no copies, or None."""
    ends = ((first_x, last_x), (first_y, last_y), (first_z, last_z))
    return None if all(a <= b for a, b in ends) else "the last index must not be below the first"


SPACING = {"spacing": Limit.NOT_NEGATIVE}
FITTING = (
    "a shape whose box is smaller than the spacing, with a little room: set neighbours=1 for a "
    "larger one, or mirrored=True for one that is symmetric in its cell"
)
SMALLER = (
    "a shape smaller than the cells that are asked: its box may reach 0.9 spacings from its middle "
    "with neighbours=1, 1.4 with neighbours=2"
)
REPEAT = operator(
    "repeat",
    point=repeated,
    finish=repeated_value,
    keeps=INSIDE_AND_BOUND,
    slope=repeated_slope,
    bounds=repeated_bounds,
    limits=SPACING,
    needs=FITTING,
    growth=Growth.HELD,
)
REPEAT_NEIGHBOURS = operator(
    "repeat neighbours",
    around=repeated_around,
    site=repeated_site,
    keeps=LOWER_BOUND,
    slope=repeated_around_slope,
    bounds=repeated_bounds,
    limits=SPACING,
    requires=neighbours_requirement,
    needs=SMALLER,
    growth=Growth.HELD,
)
REPEAT_MIRRORED = operator(
    "repeat mirrored",
    point=repeated_mirrored,
    keeps=LOWER_BOUND,
    bounds=repeated_mirrored_bounds,
    limits=SPACING,
    growth=Growth.KEPT,
)
REPEAT_LIMITED = operator(
    "repeat limited",
    point=limited,
    finish=limited_value,
    keeps=INSIDE_AND_BOUND,
    slope=limited_slope,
    bounds=limited_bounds,
    limits=SPACING,
    requires=count_requirement,
    needs=FITTING,
    growth=Growth.HELD,
)
REPEAT_LIMITED_NEIGHBOURS = operator(
    "repeat limited neighbours",
    around=limited_around,
    site=limited_site,
    keeps=LOWER_BOUND,
    slope=limited_around_slope,
    bounds=limited_bounds,
    limits=SPACING,
    requires=limited_requirement,
    needs=SMALLER,
    growth=Growth.HELD,
)
REPEAT_INTERVAL = operator(
    "repeat interval",
    point=in_interval,
    finish=in_interval_value,
    keeps=INSIDE_AND_BOUND,
    slope=in_interval_slope,
    bounds=in_interval_bounds,
    limits=SPACING,
    requires=interval_requirement,
    needs=FITTING,
    growth=Growth.HELD,
)
REPEAT_HALF = operator(
    "repeat half",
    point=repeated_half,
    finish=repeated_half_value,
    keeps=INSIDE_AND_BOUND,
    slope=repeated_half_slope,
    bounds=repeated_half_bounds,
    limits=SPACING,
    needs=FITTING,
    growth=Growth.HELD,
)
