"""Repetition of a solid around the y axis.

Input: a point, the number of copies, the child's box. Output: the point in the local space of a
copy, the copy's index, and a value that is safe to march. The first copy is the child itself; the
others follow counterclockwise as seen from above.

Limited as in ``cells``, with sectors of an annulus instead of boxes: a copy's box lies within an
angle of the direction to its middle, and beyond some radius from the axis. Both distances, to the
sector's flat side and to its inner radius, have slope 1. Where the set of evaluated copies changes,
the copy that leaves it is as far away as the one that enters.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.constants import PI
from distal.fields.extents import box_distance, drum_distance, hull_of, turned_flat
from distal.fields.guarantees import (
    ENDLESS,
    EXACT_OUTSIDE,
    INSIDE_AND_BOUND,
    LOWER_BOUND,
    UNBOUNDED,
    Bounds,
    Bounds2,
    Growth,
    Site,
    operator,
)
from distal.fields.place.mirrors import kaleidoscope_bounds, outer_radius
from distal.fields.place.solid import rotated_y
from distal.fields.repeat.along import cells_in_line
from distal.fields.repeat.cells import LEAD, ROOM, Nearest
from distal.lang import (
    abs,
    atan2,
    cos,
    dot,
    floor,
    func,
    length,
    mat2,
    max,
    min,
    round,
    select,
    sin,
    struct,
    vec2,
    vec3,
)

# Up to so many copies the hull of their boxes is found; the cylinder's box is at most 4 % larger
# than that of more.
FEW: Final = 12


@struct
class Sector:
    """Sector of a copy: ``x`` and ``z`` of its direction, its half angle, its inner radius."""

    direction: vec2
    half: float
    inner: float


@func
def corner_angle(direction: vec2, corner: vec2) -> float:
    """Return the angle between a direction and a corner."""
    across = direction.x * corner.y - direction.y * corner.x
    return abs(atan2(across, dot(direction, corner)))


@func
def sector_of(bounds: Bounds) -> Sector:
    """Return the sector of the child's box.

    Its half angle is pi if the axis goes through the box.
    """
    low, high = bounds.low.xz, bounds.high.xz
    middle = 0.5 * low + 0.5 * high
    size = length(middle)
    direction = select(size > 0.0, middle / max(size, 1e-12), vec2(1.0, 0.0))
    near = max(corner_angle(direction, low), corner_angle(direction, high))
    far = max(
        corner_angle(direction, vec2(low.x, high.y)), corner_angle(direction, vec2(high.x, low.y))
    )
    inner = length(max(max(low, -high), vec2(0.0)))
    return Sector(direction, select(inner > 0.0, max(near, far), PI), inner)


@func
def in_sector(q: vec3, sector: Sector) -> vec2:
    """Return the coordinates of a point along a copy's middle line, and across it (absolute)."""
    u = sector.direction
    return vec2(q.x * u.x + q.z * u.y, abs(q.z * u.x - q.x * u.y))


@func
def to_side(at: vec2, angle: float) -> float:
    """Return the distance to a half plane from the axis at an angle, positive before it."""
    c, s = cos(angle), sin(angle)
    return select(at.x * c + at.y * s < 0.0, length(at), at.x * s - at.y * c)


@func
def to_own(at: vec2, sector: Sector) -> float:
    """Return the distance to a copy's sector, negative inside."""
    c, s = cos(sector.half), sin(sector.half)
    radius = length(at)
    side = select(at.x * c + at.y * s < 0.0, radius, at.y * c - at.x * s)
    return max(side, sector.inner - radius)


@func
def to_next(at: vec2, angle: float, sector: Sector) -> float:
    """Return the distance to a copy whose sector starts at an angle from the middle line."""
    return max(to_side(at, angle), sector.inner - length(at))


@func
def to_drum(p: vec3, bounds: Bounds) -> float:
    """Return the distance to the cylinder that contains all copies.

    It is needed because the sectors are infinite outwards and upwards.
    """
    return drum_distance(length(p.xz), p.y, outer_radius(bounds), bounds.low.y, bounds.high.y)


@func
def polar_bounds(bounds: Bounds, count: int) -> Bounds:
    """Return the box around all copies: the hull of their boxes if they are few."""
    around = kaleidoscope_bounds(bounds)
    if count <= FEW:
        plan = Bounds2(bounds.low.xz, bounds.high.xz)
        sides = plan
        for i in range(1, FEW):
            if i < count:
                angle = float(i) * (2.0 * PI / float(count))
                c, s = cos(angle), sin(angle)
                sides = hull_of(sides, turned_flat(plan, mat2(vec2(c, s), vec2(-s, c))))
        low = max(around.low, vec3(sides.low.x, bounds.low.y, sides.low.y))
        high = min(around.high, vec3(sides.high.x, bounds.high.y, sides.high.y))
        return Bounds(low, high)
    return around


@func
def to_copies(p: vec3, bounds: Bounds, count: int) -> float:
    """Return the distance to a solid that contains all copies: their cylinder within their box."""
    if count <= FEW:
        return max(to_drum(p, bounds), box_distance(p, polar_bounds(bounds, count)))
    return to_drum(p, bounds)


@func
def polar_index(p: vec3, count: int, sector: Sector) -> float:
    """Return the index of the copy whose middle is nearest by angle.

    It is from minus to plus half the count.
    """
    u = sector.direction
    angle = atan2(p.x * u.y - p.z * u.x, p.x * u.x + p.z * u.y)
    return round(angle * (float(count) / (2.0 * PI)))


@func
def turned_by(p: vec3, index: float, count: int) -> vec3:
    """Return the point in the local space of a copy."""
    return rotated_y(p, index * (2.0 * PI / float(count)))


@func
def polar_cell(index: float, count: int) -> vec3:
    """Return the index of a copy, from 0 to below ``count``, as a cell."""
    n = float(count)
    return vec3(index - n * floor(index / n), 0.0, 0.0)


@func
def polar_site(p: vec3, index: float, count: int) -> Site:
    """Return the place in a copy; its index is from 0 to below ``count``."""
    return Site(turned_by(p, index, count), polar_cell(index, count))


# One sector


@func
def repeated_polar(p: vec3, count: int, bounds: Bounds) -> Site:
    """Return the place in the nearest sector."""
    return polar_site(p, polar_index(p, count, sector_of(bounds)), count)


@func
def repeated_polar_value(d: float, p: vec3, count: int, bounds: Bounds) -> float:
    """Return the value, limited by the other sectors; at least the distance to the cylinder."""
    if count < 2:
        return max(d, to_copies(p, bounds, count))
    sector = sector_of(bounds)
    at = in_sector(turned_by(p, polar_index(p, count, sector), count), sector)
    others = to_next(at, 2.0 * PI / float(count) - sector.half, sector)
    return max(min(max(d, to_own(at, sector)), others), to_copies(p, bounds, count))


@func
def sector_slope(slope: float, bounds: Bounds, free: float) -> float:
    """Return the child's slope, or 1; no bound if its sector is larger than ``free``."""
    sector = sector_of(bounds)
    outer = outer_radius(bounds)
    crowded = sector.half > free or sector.inner <= 1e-3 * outer or outer > ENDLESS
    return select(crowded, UNBOUNDED, max(slope, 1.0))


@func
def repeated_polar_slope(slope: float, bounds: Bounds, count: int) -> float:
    """Return the child's slope if the child fits between the half planes of its sector."""
    if count < 2:
        return max(slope, 1.0)
    return sector_slope(slope, bounds, PI / float(count) * (1.0 - 2.0 * ROOM))


# Several sectors


@func
def nearest_polar(
    field: Callable[[vec3, vec3], float], p: vec3, count: int, bounds: Bounds, neighbors: int
) -> Nearest:
    """Return the nearest of the copies around the point, limited by those not evaluated."""
    sector = sector_of(bounds)
    index = polar_index(p, count, sector)
    own = turned_by(p, index, count)
    u = sector.direction
    # the next sector on the point's side is rotated in the same direction
    toward = select(own.x * u.y - own.z * u.x < 0.0, -1.0, 1.0)
    nearest = UNBOUNDED
    chosen = index
    for i in range(0 if neighbors == 1 else -1, 2):
        there = index + float(i) * toward
        q = turned_by(p, there, count)
        d = max(field(q, polar_cell(there, count)), to_own(in_sector(q, sector), sector))
        if d < nearest:
            nearest = d
            chosen = there
    at = in_sector(own, sector)
    step = 2.0 * PI / float(count)
    if neighbors == 1 and count > 2:
        behind = to_next(vec2(at.x, -at.y), step - sector.half, sector)
        nearest = min(nearest, behind)
    if neighbors == 2 and count > 3:
        nearest = min(nearest, to_next(at, 2.0 * step - sector.half, sector))
    return Nearest(max(nearest, to_copies(p, bounds, count)), polar_site(p, chosen, count))


@func
def repeated_polar_around(
    field: Callable[[vec3, vec3], float], p: vec3, count: int, bounds: Bounds, neighbors: int
) -> float:
    """Return the distance to the nearest of the copies around the point."""
    return nearest_polar(field, p, count, bounds, neighbors).distance


@func
def repeated_polar_around_site(
    field: Callable[[vec3, vec3], float], p: vec3, count: int, bounds: Bounds, neighbors: int
) -> Site:
    """Return the place in the nearest copy."""
    return nearest_polar(field, p, count, bounds, neighbors).site


@func
def repeated_polar_around_slope(slope: float, bounds: Bounds, count: int, neighbors: int) -> float:
    """Return the child's slope if the evaluated copies are nearer than others."""
    reach = 1.0 if neighbors == 1 else 1.5
    free = min(2.0 * PI / float(count) * reach * (1.0 - LEAD), 0.49 * PI)
    return sector_slope(slope, bounds, free)


# All copies


@func
def nearest_of_all_polar(field: Callable[[vec3, vec3], float], p: vec3, count: int) -> Nearest:
    """Return the nearest of all copies; each copy is evaluated."""
    nearest = UNBOUNDED
    chosen = 0.0
    for i in range(count):
        d = field(turned_by(p, float(i), count), vec3(float(i), 0.0, 0.0))
        if d < nearest:
            nearest = d
            chosen = float(i)
    return Nearest(nearest, polar_site(p, chosen, count))


@func
def repeated_polar_all(field: Callable[[vec3, vec3], float], p: vec3, count: int) -> float:
    """Return the distance to the nearest of all copies."""
    return nearest_of_all_polar(field, p, count).distance


@func
def repeated_polar_all_site(field: Callable[[vec3, vec3], float], p: vec3, count: int) -> Site:
    """Return the place in the nearest of all copies."""
    return nearest_of_all_polar(field, p, count).site


def polar_requirement(count: int) -> str | None:
    """Return why the count is invalid, or None."""
    return None if count >= 1 else "count must be 1 or more"


def polar_around_requirement(count: int, neighbors: int) -> str | None:
    """Return why the count and the neighbors are invalid, or None."""
    if neighbors not in (1, 2):
        return "neighbors must be 0, 1 or 2"
    return None if count > neighbors else f"count must be {neighbors + 1} or more"


POLAR_FITTING = (
    "a shape beside the y axis whose box fits in its sector, with a little room: set neighbors=1 "
    "for a wider one, neighbors='all' for one that reaches the axis, or kaleidoscope for one that "
    "is symmetric in its sector"
)
POLAR_SMALLER = (
    "a shape beside the y axis, narrower than the sectors that are evaluated and less than half a "
    "turn wide; neighbors='all' takes any shape"
)
REPEAT_POLAR = operator(
    "repeat polar",
    cells=cells_in_line,
    point=repeated_polar,
    finish=repeated_polar_value,
    keeps=INSIDE_AND_BOUND,
    slope=repeated_polar_slope,
    bounds=polar_bounds,
    requires=polar_requirement,
    needs=POLAR_FITTING,
    growth=Growth.HELD,
)
REPEAT_POLAR_NEIGHBORS = operator(
    "repeat polar neighbors",
    cells=cells_in_line,
    around=repeated_polar_around,
    site=repeated_polar_around_site,
    keeps=LOWER_BOUND,
    slope=repeated_polar_around_slope,
    bounds=polar_bounds,
    requires=polar_around_requirement,
    needs=POLAR_SMALLER,
    growth=Growth.HELD,
)
REPEAT_POLAR_ALL = operator(
    "repeat polar all",
    cells=cells_in_line,
    around=repeated_polar_all,
    site=repeated_polar_all_site,
    keeps=EXACT_OUTSIDE,
    bounds=polar_bounds,
    requires=polar_requirement,
    growth=Growth.TURNED,
)
