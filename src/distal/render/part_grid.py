"""Occlusion among many parts by a grid of distances, without a search.

Input: the distances to all parts at the points of a grid (``scene.lowering.distance_grid``), and a
field of what is beside the parts. Output: the share of ambient light.

Distances are whole levels from 0 to 255. The grid is a buffer of whole numbers: how many levels the
side of a cell has, the level of distance 0, then one number for each point, along x, then y, then
z. Its four bytes are the levels of this point, of the next along x, of the next along y, and of the
next along both, so that two numbers are the eight corners of a cell.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.lang import Buffer, clamp, floor, func, length, max, min, mix, struct, vec3
from distal.render.march import March
from distal.render.shade import Shading, occlusion_in

# The numbers before those of the points.
HEAD: Final = 2


@struct
class GridPlace:
    """Where a grid is.

    Attributes:
        low: Its low corner.
        cell: The side of a cell.
        points: How many points are along each axis.
    """

    low: vec3
    cell: float
    points: vec3


@func
def level_between(levels: Buffer[int], point: int, part: vec3) -> float:
    """Return the level at a place between four points, in the plane of their z.

    Args:
        levels: The grid.
        point: The number of the first point.
        part: Where the place is, in cells from the first point.
    """
    four = levels[HEAD + point]
    near = mix(float(four & 255), float((four >> 8) & 255), part.x)
    far = mix(float((four >> 16) & 255), float((four >> 24) & 255), part.x)
    return mix(near, far, part.y)


@func
def grid_distance(levels: Buffer[int], place: GridPlace, p: vec3) -> float:
    """Return the distance to all parts, interpolated.

    Outside of the grid it is the distance at the nearest point of the grid, and that to this point:
    never less than the interpolated distance.

    Args:
        levels: The grid.
        place: Where it is.
        p: The point.
    """
    at = (p - place.low) * (1.0 / place.cell)
    inside = clamp(at, vec3(0.0), place.points - 1.0)
    first = min(floor(inside), place.points - 2.0)
    part = inside - first
    layer = place.points.x * place.points.y
    point = int(first.x + place.points.x * first.y + layer * first.z)
    below = level_between(levels, point, part)
    above = level_between(levels, point + int(layer), part)
    cells = (mix(below, above, part.z) - float(levels[1])) / float(levels[0])
    return place.cell * (cells + length(at - inside))


@func
def occlusion_by_grid(
    others: Callable[[vec3], float],
    levels: Buffer[int],
    place: GridPlace,
    p: vec3,
    n: vec3,
    slope: float,
    look: Shading,
    numbers: March,
    has_others: bool,
    steep: bool,
) -> float:
    """Return the fraction of ambient light that reaches a point.

    Args:
        others: Signed distance of what is beside the parts.
        levels: The grid.
        place: Where it is.
        p: Point on a surface or just above it.
        n: Unit normal.
        slope: |gradient| of the field at the point.
        look: How far to search for surfaces.
        numbers: The parameters of the march.
        has_others: Whether anything is beside the parts; a constant.
        steep: Whether values may be less than distances; a constant.
    """

    def nearest(q: vec3) -> float:
        # The surface at p is not farther away.
        d = min(grid_distance(levels, place, q), max(slope, 1.0) * length(q - p))
        if has_others:
            d = min(d, others(q))
        return d

    return occlusion_in(nearest, p, n, slope, look, numbers, steep)
