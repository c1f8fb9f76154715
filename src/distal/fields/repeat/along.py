"""Repetition of a solid along a line, on the sides of a rectangle, and at given positions.

Input: a point, the arrangement of the copies, the child's box. Output: the distance to the nearest
copy, limited as in ``cells`` by the copies that are not evaluated, and the point in this copy.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.extents import box_distance, diameter
from distal.fields.guarantees import (
    EXACT_OUTSIDE,
    INSIDE_AND_BOUND,
    LOWER_BOUND,
    UNBOUNDED,
    Bounds,
    Growth,
    Limit,
    Site,
    operator,
)
from distal.fields.repeat.cells import (
    ROOM,
    Copies,
    Nearest,
    bounds_in,
    distance_to_box,
    distance_to_others,
    half_of,
    middle_of,
    slope_in,
    to_others,
)
from distal.fields.repeat.varied import cells_of_copies
from distal.lang import (
    Buffer,
    abs,
    clamp,
    dot,
    func,
    length,
    max,
    min,
    round,
    select,
    size,
    vec2,
    vec3,
)

# Along a line


@func
def line_step(start: vec3, end: vec3, count: int) -> vec3:
    """Return the vector from one copy to the next."""
    return (end - start) / (float(count) - 1.0)


@func
def line_index(p: vec3, start: vec3, end: vec3, count: int, bounds: Bounds) -> float:
    """Return the index of the copy whose middle is nearest."""
    step = line_step(start, end, count)
    along = dot(p - start - middle_of(bounds), step) / dot(step, step)
    return clamp(round(along), 0.0, float(count) - 1.0)


@func
def cells_in_line(count: int) -> Bounds:
    """Return the first and the last index of a number of copies."""
    return Bounds(vec3(0.0), vec3(float(count) - 1.0, 0.0, 0.0))


@func
def along_line(p: vec3, start: vec3, end: vec3, count: int, bounds: Bounds) -> Site:
    """Return the place in the nearest of ``count`` copies from ``start`` to ``end``."""
    index = line_index(p, start, end, count, bounds)
    return Site(p - start - index * line_step(start, end, count), vec3(index, 0.0, 0.0))


@func
def along_line_value(
    d: float, p: vec3, start: vec3, end: vec3, count: int, bounds: Bounds
) -> float:
    """Return the value, limited by the other copies, each in a cylinder around the line.

    A cylinder is as long as the box along the line, and contains the ball around the box. Beyond
    the box around all copies, the value is at least the distance to it.
    """
    step = line_step(start, end, count)
    spacing = length(step)
    unit = step / spacing
    index = line_index(p, start, end, count, bounds)
    away = p - start - index * step - middle_of(bounds)
    along = dot(away, unit)
    distance = abs(along)
    half = dot(abs(unit), half_of(bounds))
    ahead = index >= float(count) - 1.0 if along > 0.0 else index <= 0.0
    gap = spacing + (distance if ahead else -distance) - half
    outside = length(away - along * unit) - 0.5 * diameter(bounds)
    beyond = vec2(distance - half, outside)
    own = length(max(beyond, vec2(0.0))) + min(max(beyond.x, beyond.y), 0.0)
    safe = min(max(d, own), length(max(vec2(gap, outside), vec2(0.0))))
    return max(safe, box_distance(p, along_line_bounds(bounds, start, end)))


@func
def along_line_slope(slope: float, bounds: Bounds, start: vec3, end: vec3, count: int) -> float:
    """Return the child's slope if the child is shorter along the line than a step."""
    step = line_step(start, end, count)
    spacing = length(step)
    room = 0.5 * spacing - dot(abs(step) / spacing, half_of(bounds))
    return select(room < ROOM * spacing, UNBOUNDED, max(slope, 1.0))


@func
def along_line_bounds(bounds: Bounds, start: vec3, end: vec3) -> Bounds:
    """Return the box around the first and the last copy."""
    return Bounds(bounds.low + min(start, end), bounds.high + max(start, end))


# Around a rectangle


@func
def ring(spacing: vec2, count_x: int, count_z: int) -> Copies:
    """Return the block of copies whose outermost ones are the ring."""
    last = vec3(float(count_x) - 1.0, 0.0, float(count_z) - 1.0)
    apart = vec3(spacing.x, 0.0, spacing.y)
    return Copies(apart, -0.5 * last * apart, vec3(0.0), last)


@func
def on_side(
    field: Callable[[vec3, vec3], float],
    p: vec3,
    copies: Copies,
    bounds: Bounds,
    index: vec3,
    free: vec3,
) -> Nearest:
    """Return one copy on a side of the rectangle, limited by the others on that side.

    Args:
        field: The child.
        p: The point.
        copies: The block.
        bounds: The child's box.
        index: The index of the copy.
        free: 1 along the side, 0 across it.
    """
    q = p - copies.origin - index * copies.spacing
    away = q - middle_of(bounds)
    half = half_of(bounds)
    along = Copies(copies.spacing * free, copies.origin, copies.first, copies.last)
    gap = to_others(away, half, along, index, 0, True)
    d = max(field(q, index), distance_to_box(away, half))
    return Nearest(min(d, distance_to_others(away, half, gap)), Site(q, index))


@func
def nearest_on_ring(
    field: Callable[[vec3, vec3], float], p: vec3, copies: Copies, bounds: Bounds
) -> Nearest:
    """Return the nearer copy of two: on the side across x and on that across z.

    Both sides are those that the point is nearest to.
    """
    away = p - middle_of(bounds)
    steps = vec3(
        (away.x - copies.origin.x) / copies.spacing.x,
        0.0,
        (away.z - copies.origin.z) / copies.spacing.z,
    )
    index = clamp(round(steps), copies.first, copies.last)
    end_x = copies.last.x if away.x > 0.0 else 0.0
    end_z = copies.last.z if away.z > 0.0 else 0.0
    row = on_side(field, p, copies, bounds, vec3(index.x, 0.0, end_z), vec3(1.0, 0.0, 0.0))
    column = on_side(field, p, copies, bounds, vec3(end_x, 0.0, index.z), vec3(0.0, 0.0, 1.0))
    half = half_of(bounds)
    above = max(abs(away.y) - half.y, 0.0)
    beyond = abs(away.xz) - copies.origin.xz - half.xz
    opposite = length(vec2(max(min(beyond.x, beyond.y), 0.0), above))
    best = column if column.distance < row.distance else row
    # A side that is not evaluated counts as infinite, which is wrong beyond the box of all copies.
    block = bounds_in(bounds, copies)
    return Nearest(max(min(best.distance, opposite), box_distance(p, block)), best.site)


@func
def around_ring(
    field: Callable[[vec3, vec3], float], p: vec3, copies: Copies, bounds: Bounds
) -> float:
    """Return the distance to the copies on the border of a block."""
    return nearest_on_ring(field, p, copies, bounds).distance


@func
def around_ring_site(
    field: Callable[[vec3, vec3], float], p: vec3, copies: Copies, bounds: Bounds
) -> Site:
    """Return the place in the nearest copy; its index is that in the block."""
    return nearest_on_ring(field, p, copies, bounds).site


# At given positions


@func
def nearest_at(field: Callable[[vec3, vec3], float], p: vec3, positions: Buffer[vec3]) -> Nearest:
    """Return the nearest of all copies; each copy is evaluated."""
    nearest = UNBOUNDED
    site = Site(p, vec3(0.0))
    for i in range(size(positions)):
        q = p - positions[i]
        index = vec3(float(i), 0.0, 0.0)
        d = field(q, index)
        if d < nearest:
            nearest = d
            site = Site(q, index)
    return Nearest(nearest, site)


@func
def at_positions(field: Callable[[vec3, vec3], float], p: vec3, positions: Buffer[vec3]) -> float:
    """Return the distance to the copies at the positions."""
    return nearest_at(field, p, positions).distance


@func
def at_positions_site(
    field: Callable[[vec3, vec3], float], p: vec3, positions: Buffer[vec3]
) -> Site:
    """Return the place in the nearest copy; its index is that of the position."""
    return nearest_at(field, p, positions).site


@func
def cells_at(positions: Buffer[vec3]) -> Bounds:
    """Return the first and the last index of the positions."""
    return cells_in_line(size(positions))


@func
def at_positions_bounds(bounds: Bounds, positions: Buffer[vec3]) -> Bounds:
    """Return the box around all copies."""
    low = positions[0]
    high = positions[0]
    for i in range(1, size(positions)):
        low = min(low, positions[i])
        high = max(high, positions[i])
    return Bounds(bounds.low + low, bounds.high + high)


def line_requirement(start: tuple[float, ...], end: tuple[float, ...], count: int) -> str | None:
    """Return why a line of copies is invalid, or None."""
    if count < 2:
        return "count must be 2 or more"
    return "start and end must be different points" if tuple(start) == tuple(end) else None


def ring_requirement(count_x: int, count_z: int) -> str | None:
    """Return why a ring of copies is invalid, or None."""
    return None if min(count_x, count_z) >= 2 else "each count must be 2 or more"


REPEAT_LINE = operator(
    "repeat line",
    cells=cells_in_line,
    point=along_line,
    finish=along_line_value,
    keeps=INSIDE_AND_BOUND,
    slope=along_line_slope,
    bounds=along_line_bounds,
    requires=line_requirement,
    needs="a shape shorter along the line than the way from copy to copy, with a little room",
    growth=Growth.HELD,
)
REPEAT_RING = operator(
    "repeat ring",
    cells=cells_of_copies,
    copies=ring,
    around=around_ring,
    site=around_ring_site,
    fixed={"neighbors": 0},
    keeps=LOWER_BOUND,
    slope=slope_in,
    bounds=bounds_in,
    limits={"spacing": Limit.POSITIVE},
    requires=ring_requirement,
    needs="a shape whose box is smaller than the spacing, with a little room",
    growth=Growth.HELD,
)
REPEAT_AT = operator(
    "repeat at",
    cells=cells_at,
    around=at_positions,
    site=at_positions_site,
    keeps=EXACT_OUTSIDE,
    bounds=at_positions_bounds,
    growth=Growth.KEPT,
)
