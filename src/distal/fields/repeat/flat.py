"""Repetition of a flat shape: on a grid, mirrored, around the origin, at given positions.

Input: a point of the plane. Output: the same as that of ``cells`` and ``polar`` for solids; the
functions here call those, with the plane as a slice of space that is not repeated across it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.guarantees import (
    EXACT_OUTSIDE,
    INSIDE_AND_BOUND,
    LOWER_BOUND,
    UNBOUNDED,
    Bounds,
    Bounds2,
    Growth,
    Site,
    Site2,
    operator,
)
from distal.fields.repeat.along import cells_in_line
from distal.fields.repeat.cells import (
    Copies,
    Nearest,
    bounds_in,
    counted,
    endless,
    nearest_copy,
    site_in,
    slope_in,
    value_in,
    width_of_copies,
)
from distal.fields.repeat.grid import (
    SPACING,
    CellFunctions,
    block_requirement,
    count_requirement,
    one_cell,
    repeated_mirrored,
    several_cells,
)
from distal.fields.repeat.polar import (
    POLAR_FITTING,
    POLAR_SMALLER,
    nearest_of_all_polar,
    nearest_polar,
    polar_around_requirement,
    polar_bounds,
    polar_requirement,
    repeated_polar,
    repeated_polar_around_slope,
    repeated_polar_slope,
    repeated_polar_value,
)
from distal.lang import Buffer, func, max, min, size, vec2, vec3


@func
def in_space(p: vec2) -> vec3:
    """Return a point of the plane as a point of the plane z = 0."""
    return vec3(p, 0.0)


@func
def slab(bounds: Bounds2) -> Bounds:
    """Return a rectangle as a box that is infinite along z."""
    return Bounds(vec3(bounds.low, -UNBOUNDED), vec3(bounds.high, UNBOUNDED))


@func
def flat_site(site: Site) -> Site2:
    """Return a place in space as a place in the plane."""
    return Site2(site.p.xy, site.cell)


@func
def flat_bounds(bounds: Bounds) -> Bounds2:
    """Return the x and y sides of a box."""
    return Bounds2(bounds.low.xy, bounds.high.xy)


# On a grid


@func
def endless_flat(spacing: vec2) -> Copies:
    """Return copies that are infinite to all sides."""
    return endless(in_space(spacing))


@func
def counted_flat(spacing: vec2, count_x: int = 1, count_y: int = 1) -> Copies:
    """Return a block of copies around the origin; indices start at 0."""
    return counted(in_space(spacing), count_x, count_y, 1)


@func
def site_in_flat(p: vec2, copies: Copies, bounds: Bounds2) -> Site2:
    """Return the point in the local plane of the nearest copy, and that copy's index."""
    return flat_site(site_in(in_space(p), copies, slab(bounds)))


@func
def value_in_flat(d: float, p: vec2, copies: Copies, bounds: Bounds2, limited: bool) -> float:
    """Return the value of the nearest copy, limited by the others."""
    return value_in(d, in_space(p), copies, slab(bounds), limited)


@func
def slope_in_flat(slope: float, bounds: Bounds2, copies: Copies, neighbors: int) -> float:
    """Return the child's slope, or 1 if larger; no bound if there is no gap."""
    return slope_in(slope, slab(bounds), copies, neighbors)


@func
def bounds_in_flat(bounds: Bounds2, copies: Copies) -> Bounds2:
    """Return the rectangle around all copies."""
    return flat_bounds(bounds_in(slab(bounds), copies))


@func
def width_of_flat_copies(child_width: float, copies: Copies, bounds: Bounds2) -> float:
    """Return the width of a repetition: of the shape, or of the gap between copies."""
    return width_of_copies(child_width, copies, slab(bounds))


@func
def nearest_copy_flat(
    field: Callable[[vec2, vec3], float],
    p: vec2,
    copies: Copies,
    bounds: Bounds2,
    neighbors: int,
    limited: bool,
) -> Nearest:
    """Return the nearest of the copies around the point, limited by those not evaluated."""
    return nearest_copy(
        lambda q, cell: field(q.xy, cell), in_space(p), copies, slab(bounds), neighbors, limited
    )


@func
def nearest_copy_distance_flat(
    field: Callable[[vec2, vec3], float],
    p: vec2,
    copies: Copies,
    bounds: Bounds2,
    neighbors: int,
    limited: bool,
) -> float:
    """Return the distance to the nearest of the copies around the point."""
    return nearest_copy_flat(field, p, copies, bounds, neighbors, limited).distance


@func
def nearest_copy_site_flat(
    field: Callable[[vec2, vec3], float],
    p: vec2,
    copies: Copies,
    bounds: Bounds2,
    neighbors: int,
    limited: bool,
) -> Site2:
    """Return the place in the cell of the nearest copy."""
    return flat_site(nearest_copy_flat(field, p, copies, bounds, neighbors, limited).site)


@func
def mirrored_cells(p: vec2, spacing: vec2) -> Site2:
    """Return the place in its cell; every other cell is mirrored."""
    return flat_site(repeated_mirrored(in_space(p), in_space(spacing)))


@func
def mirrored_cells_bounds(bounds: Bounds2, spacing: vec2) -> Bounds2:
    """Return a rectangle that is infinite along the repeated axes."""
    return flat_bounds(bounds_in(slab(bounds), endless(in_space(spacing))))


# Around the origin: the plane is mapped to the xz plane, with y along -z


@func
def on_ground(p: vec2) -> vec3:
    """Return a point of the plane in the xz plane; rotations keep their direction."""
    return vec3(p.x, 0.0, -p.y)


@func
def column(bounds: Bounds2) -> Bounds:
    """Return a rectangle as a box on the xz plane, infinite along y."""
    low, high = bounds.low, bounds.high
    return Bounds(vec3(low.x, -UNBOUNDED, -high.y), vec3(high.x, UNBOUNDED, -low.y))


@func
def off_ground(p: vec3) -> vec2:
    """Return a point of the xz plane as a point of the plane."""
    return vec2(p.x, -p.z)


@func
def polar_flat_bounds(bounds: Bounds2, count: int) -> Bounds2:
    """Return the rectangle around all copies."""
    box = polar_bounds(column(bounds), count)
    return Bounds2(
        off_ground(vec3(box.low.x, 0.0, box.high.z)), off_ground(vec3(box.high.x, 0.0, box.low.z))
    )


@func
def repeated_polar_flat(p: vec2, count: int, bounds: Bounds2) -> Site2:
    """Return the place in the nearest sector."""
    site = repeated_polar(on_ground(p), count, column(bounds))
    return Site2(off_ground(site.p), site.cell)


@func
def repeated_polar_flat_value(d: float, p: vec2, count: int, bounds: Bounds2) -> float:
    """Return the value, limited by the other sectors."""
    return repeated_polar_value(d, on_ground(p), count, column(bounds))


@func
def repeated_polar_flat_slope(slope: float, bounds: Bounds2, count: int) -> float:
    """Return the child's slope if the child fits between the lines of its sector."""
    return repeated_polar_slope(slope, column(bounds), count)


@func
def repeated_polar_flat_around(
    field: Callable[[vec2, vec3], float], p: vec2, count: int, bounds: Bounds2, neighbors: int
) -> float:
    """Return the distance to the nearest of the copies around the point."""
    found = nearest_polar(
        lambda q, cell: field(off_ground(q), cell), on_ground(p), count, column(bounds), neighbors
    )
    return found.distance


@func
def repeated_polar_flat_site(
    field: Callable[[vec2, vec3], float], p: vec2, count: int, bounds: Bounds2, neighbors: int
) -> Site2:
    """Return the place in the nearest copy."""
    found = nearest_polar(
        lambda q, cell: field(off_ground(q), cell), on_ground(p), count, column(bounds), neighbors
    )
    return Site2(off_ground(found.site.p), found.site.cell)


@func
def repeated_polar_flat_around_slope(
    slope: float, bounds: Bounds2, count: int, neighbors: int
) -> float:
    """Return the child's slope if the evaluated copies are nearer than others."""
    return repeated_polar_around_slope(slope, column(bounds), count, neighbors)


@func
def repeated_polar_flat_all(field: Callable[[vec2, vec3], float], p: vec2, count: int) -> float:
    """Return the distance to the nearest of all copies."""
    return nearest_of_all_polar(
        lambda q, cell: field(off_ground(q), cell), on_ground(p), count
    ).distance


@func
def repeated_polar_flat_all_site(
    field: Callable[[vec2, vec3], float], p: vec2, count: int
) -> Site2:
    """Return the place in the nearest of all copies."""
    site = nearest_of_all_polar(
        lambda q, cell: field(off_ground(q), cell), on_ground(p), count
    ).site
    return Site2(off_ground(site.p), site.cell)


# At given positions


@func
def at_positions_flat(
    field: Callable[[vec2, vec3], float], p: vec2, positions: Buffer[vec2]
) -> float:
    """Return the distance to the copies at the positions."""
    nearest = UNBOUNDED
    for i in range(size(positions)):
        nearest = min(nearest, field(p - positions[i], vec3(float(i), 0.0, 0.0)))
    return nearest


@func
def at_positions_flat_site(
    field: Callable[[vec2, vec3], float], p: vec2, positions: Buffer[vec2]
) -> Site2:
    """Return the place in the nearest copy; its index is that of the position."""
    nearest = UNBOUNDED
    site = Site2(p, vec3(0.0))
    for i in range(size(positions)):
        q = p - positions[i]
        index = vec3(float(i), 0.0, 0.0)
        d = field(q, index)
        if d < nearest:
            nearest = d
            site = Site2(q, index)
    return site


@func
def cells_at_flat(positions: Buffer[vec2]) -> Bounds:
    """Return the first and the last index of the positions."""
    return cells_in_line(size(positions))


@func
def at_positions_flat_bounds(bounds: Bounds2, positions: Buffer[vec2]) -> Bounds2:
    """Return the rectangle around all copies."""
    low = positions[0]
    high = positions[0]
    for i in range(1, size(positions)):
        low = min(low, positions[i])
        high = max(high, positions[i])
    return Bounds2(bounds.low + low, bounds.high + high)


def count_requirement_flat(count_x: int = 1, count_y: int = 1) -> str | None:
    """Return why the counts are invalid, or None."""
    return count_requirement(count_x, count_y)


def block_requirement_flat(neighbors: int, count_x: int = 1, count_y: int = 1) -> str | None:
    """Return why a block with neighbors is invalid, or None."""
    return block_requirement(neighbors, count_x, count_y)


FLAT: Final = CellFunctions(
    site_in_flat,
    value_in_flat,
    slope_in_flat,
    bounds_in_flat,
    nearest_copy_distance_flat,
    nearest_copy_site_flat,
    width_of_flat_copies,
)
REPEAT_FLAT = one_cell("flat repeat", FLAT, endless_flat, limited=False)
REPEAT_NEIGHBORS_FLAT = several_cells("flat repeat neighbors", FLAT, endless_flat, limited=False)
REPEAT_LIMITED_FLAT = one_cell(
    "flat repeat limited", FLAT, counted_flat, requires=count_requirement_flat
)
REPEAT_LIMITED_NEIGHBORS_FLAT = several_cells(
    "flat repeat limited neighbors", FLAT, counted_flat, requires=block_requirement_flat
)
REPEAT_MIRRORED_FLAT = operator(
    "flat repeat mirrored",
    point=mirrored_cells,
    keeps=LOWER_BOUND,
    bounds=mirrored_cells_bounds,
    limits=SPACING,
    growth=Growth.KEPT,
)
REPEAT_POLAR_ALL_FLAT = operator(
    "flat repeat polar all",
    cells=cells_in_line,
    around=repeated_polar_flat_all,
    site=repeated_polar_flat_all_site,
    keeps=EXACT_OUTSIDE,
    bounds=polar_flat_bounds,
    requires=polar_requirement,
    growth=Growth.TURNED,
)
REPEAT_POLAR_FLAT = operator(
    "flat repeat polar",
    cells=cells_in_line,
    point=repeated_polar_flat,
    finish=repeated_polar_flat_value,
    keeps=INSIDE_AND_BOUND,
    slope=repeated_polar_flat_slope,
    bounds=polar_flat_bounds,
    requires=polar_requirement,
    needs=POLAR_FITTING.replace("the y axis", "the origin"),
    growth=Growth.HELD,
)
REPEAT_POLAR_NEIGHBORS_FLAT = operator(
    "flat repeat polar neighbors",
    cells=cells_in_line,
    around=repeated_polar_flat_around,
    site=repeated_polar_flat_site,
    keeps=LOWER_BOUND,
    slope=repeated_polar_flat_around_slope,
    bounds=polar_flat_bounds,
    requires=polar_around_requirement,
    needs=POLAR_SMALLER.replace("the y axis", "the origin"),
    growth=Growth.HELD,
)
REPEAT_AT_FLAT = operator(
    "flat repeat at",
    cells=cells_at_flat,
    around=at_positions_flat,
    site=at_positions_flat_site,
    keeps=EXACT_OUTSIDE,
    bounds=at_positions_flat_bounds,
    growth=Growth.KEPT,
)
