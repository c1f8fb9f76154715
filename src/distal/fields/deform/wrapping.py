"""Flat shapes around a whole cylinder, as a relief whose pattern closes without a seam.

Input: the field of a flat shape, its rectangle, the point, the number of copies. Output: the
distance to the relief of copies that stand at equal angles, the place in the nearest copy, and the
rules for slope and box. The copies are those of a repetition with the circumference as its period
(``repeat.cells``), so that copies may reach into each other, and an outline as wide as the
circumference meets itself.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.constants import PI
from distal.fields.extents import box_distance
from distal.fields.flats.edges import inside_both
from distal.fields.guarantees import (
    UNBOUNDED,
    Bounds2,
    Growth,
    Limit,
    Site2,
    operator,
)
from distal.fields.lift.round import relief_requirement, wrapped, wrapped_bounds
from distal.fields.repeat.along import cells_in_line
from distal.fields.repeat.cells import Copies, Nearest
from distal.fields.repeat.flat import endless_flat, nearest_copy_flat, slope_in_flat
from distal.fields.repeat.polar import polar_cell
from distal.lang import abs, clamp, func, length, max, min, select, vec2, vec3


@func
def copies_around(radius: float, count: int) -> Copies:
    """Return the copies on the unrolled cylinder, which goes on without end."""
    return endless_flat(vec2(2.0 * PI * radius / float(count), 0.0))


@func
def nearest_around(
    field: Callable[[vec2, vec3], float], p: vec3, radius: float, count: int, bounds: Bounds2
) -> Nearest:
    """Return the nearest copy on the unrolled cylinder; the child gets an index below ``count``."""
    return nearest_copy_flat(
        lambda q, cell: field(q, polar_cell(cell.x, count)),
        wrapped(p, radius),
        copies_around(radius, count),
        bounds,
        1,
        False,
    )


@func
def wrapped_around(
    field: Callable[[vec2, vec3], float],
    p: vec3,
    radius: float,
    height: float,
    count: int,
    bounds: Bounds2,
) -> float:
    """Return the distance to a relief all around a cylinder.

    As ``round.wrapped_value``, but for the gap behind the cylinder, which there is none of.
    """
    inner = radius - 0.5 * height
    outward = length(p.xz)
    margin = 0.5 * inner
    flat = nearest_around(field, p, radius, count, bounds).distance
    near = (inner / radius) * clamp(flat, -margin, margin)
    past_faces = abs(outward - radius) - 0.5 * height
    within = max(past_faces, near * min(outward / inner, 1.0))
    relief = select(outward < inner, within, inside_both(near, past_faces))
    return max(relief, box_distance(p, wrapped_bounds(bounds, radius, height)))


@func
def wrapped_around_site(
    field: Callable[[vec2, vec3], float], p: vec3, radius: float, count: int, bounds: Bounds2
) -> Site2:
    """Return the place in the nearest copy."""
    site = nearest_around(field, p, radius, count, bounds).site
    return Site2(site.p.xy, polar_cell(site.cell.x, count))


@func
def wrapped_around_slope(slope: float, bounds: Bounds2, radius: float, count: int) -> float:
    """Return the slope of the copies, combined inside with that of the fading, 1/2."""
    steepest = slope_in_flat(slope, bounds, copies_around(radius, count), 1)
    return min(length(vec2(steepest, 0.5)), UNBOUNDED)


def around_requirement(radius: float, height: float, count: int) -> str | None:
    """Return why a relief around a cylinder is invalid, or None."""
    return "count must be 1 or more" if count < 1 else relief_requirement(radius, height)


WRAP_AROUND = operator(
    "wrap around cylinder",
    cells=cells_in_line,
    around=wrapped_around,
    site=wrapped_around_site,
    slope=wrapped_around_slope,
    bounds=wrapped_bounds,
    limits={"radius": Limit.POSITIVE, "height": Limit.POSITIVE},
    requires=around_requirement,
    needs="a flat shape that reaches at most 0.9 of the way to the next copy from its middle",
    growth=Growth.HELD,
)
