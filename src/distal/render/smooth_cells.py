"""Smooth unions of many shapes: a grid of cells, each with the list of the members that matter.

Input: the grid, functions of a member, a point. Output: the distance to the union, its surface. The
other members cannot change the value anywhere in the cell, so values are those of the whole union
(``scene.lowering.smooth``).

The grid is one buffer of whole numbers. It has two levels: a number for each block of 4 x 4 x 4
cells, then for some blocks one for each cell. A number is the place of a list, or -1 - the place of
the block's cells. A list is a count, then the members: the numbers of their rows, in the order in
which they are joined.

Source: Barbier et al., "Lipschitz Pruning: Hierarchical Simplification of Primitive-Based SDFs",
Eurographics 2025.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from distal.lang import Buffer, clamp, dot, func, length, max, select, struct, vec2, vec3
from distal.render.material import Surface, mix_surfaces

Attribute = TypeVar("Attribute", Surface, float)


@struct
class CellGrid:
    """A grid of cells around a smooth union.

    Attributes:
        low: The low corner.
        high: The high corner.
        per_unit: Cells for each unit of length.
        across: Blocks along x.
        up: Blocks along y.
        all: The place of the list of all members.
    """

    low: vec3
    high: vec3
    per_unit: float
    across: int
    up: int
    all: int


@func
def list_at(cells: Buffer[int], grid: CellGrid, p: vec3) -> int:
    """Return the place of the list of the cell that a point is in; outside, of the nearest one.

    Args:
        cells: The cells and their lists.
        grid: The grid.
        p: The point.
    """
    place = (clamp(p, grid.low, grid.high) - grid.low) * grid.per_unit
    most = (grid.high - grid.low) * grid.per_unit - 0.5
    place = clamp(place, vec3(0.0), most)
    x = int(place.x)
    y = int(place.y)
    z = int(place.z)
    block = cells[(x >> 2) + grid.across * ((y >> 2) + grid.up * (z >> 2))]
    inner = cells[max(-1 - block, 0) + (x & 3) + 4 * ((y & 3) + 4 * (z & 3))]
    return select(block < 0, inner, block)


@func
def blended(
    cells: Buffer[int],
    distance: Callable[[vec3, int], float],
    joined: Callable[[vec3, int, float], float],
    first: int,
    p: vec3,
) -> float:
    """Return the signed distance of a point to the union of the members of a list.

    Args:
        cells: The cells and their lists.
        distance: The signed distance of a point to a member.
        joined: The same of the union of a member and what is joined before, given its distance.
        first: The place of the list.
        p: The point.
    """
    d = distance(p, cells[first + 1])
    for i in range(2, cells[first] + 1):
        d = joined(p, cells[first + i], d)
    return d


@func
def distance_by_cells(
    cells: Buffer[int],
    distance: Callable[[vec3, int], float],
    joined: Callable[[vec3, int, float], float],
    grid: CellGrid,
    steepest: float,
    exact: bool,
    p: vec3,
) -> float:
    """Return the signed distance of a point to a smooth union.

    Outside of the grid, where the value is not that of the union, it is a bound: the surface is in
    the grid, which is convex, so the square of its distance is at least the sum of those from p to
    the nearest point q of the grid and from q to the surface. It continues the values inside, and
    its slope is not larger.

    Args:
        cells: The cells and their lists.
        distance: The signed distance of a point to a member.
        joined: The same of the union of a member and what is joined before, given its distance.
        grid: The grid.
        steepest: Lipschitz bound (slope) of all members.
        exact: Whether values outside of the grid are those of the union, too; a constant.
        p: The point.
    """
    nearest = clamp(p, grid.low, grid.high)
    beyond = dot(p - nearest, p - nearest)
    place = list_at(cells, grid, nearest)
    if exact:
        return blended(cells, distance, joined, select(beyond > 0.0, grid.all, place), p)
    d = blended(cells, distance, joined, place, nearest)
    return select(beyond > 0.0, length(vec2(steepest * length(p - nearest), max(d, 0.0))), d)


@func
def mixed_along(
    cells: Buffer[int],
    distance: Callable[[vec3, int], float],
    joined: Callable[[vec3, int, float], float],
    share: Callable[[vec3, int, float], float],
    first: int,
    of_first: Attribute,
    shown: Callable[[vec3, int], Attribute],
    mixed: Callable[[Attribute, Attribute, float], Attribute],
    p: vec3,
) -> Attribute:
    """Return an attribute of a smooth union at a point: those of a list's members, mixed in turn.

    Args:
        cells: The cells and their lists.
        distance: The signed distance of a point to a member.
        joined: The same of the union of a member and what is joined before, given its distance.
        share: The share of a member in this union, 0 to 1.
        first: The place of the list.
        of_first: The attribute of the first member.
        shown: The attribute of a member.
        mixed: The attribute of what is joined before, mixed with that of a member by its share.
        p: The point.
    """
    found = of_first
    d = distance(p, cells[first + 1])
    for i in range(2, cells[first] + 1):
        member = cells[first + i]
        found = mixed(found, shown(p, member), share(p, member, d))
        d = joined(p, member, d)
    return found


@func
def surface_by_cells(
    cells: Buffer[int],
    distance: Callable[[vec3, int], float],
    joined: Callable[[vec3, int, float], float],
    share: Callable[[vec3, int, float], float],
    shown: Callable[[vec3, int], Surface],
    grid: CellGrid,
    p: vec3,
) -> Surface:
    """Return the surface of a smooth union at a point: the members' surfaces, mixed as they blend.

    Args:
        cells: The cells and their lists.
        distance: The signed distance of a point to a member.
        joined: The same of the union of a member and what is joined before, given its distance.
        share: The share of a member in this union, 0 to 1.
        shown: The surface of a member.
        grid: The grid.
        p: The point.
    """
    first = list_at(cells, grid, p)
    of_first = shown(p, cells[first + 1])
    return mixed_along(cells, distance, joined, share, first, of_first, shown, mix_surfaces, p)


@func
def number_by_cells(
    cells: Buffer[int],
    distance: Callable[[vec3, int], float],
    joined: Callable[[vec3, int, float], float],
    share: Callable[[vec3, int, float], float],
    shown: Callable[[vec3, int], float],
    grid: CellGrid,
    p: vec3,
) -> float:
    """Return the number of the member with the larger share, of each two that are joined.

    Args:
        cells: The cells and their lists.
        distance: The signed distance of a point to a member.
        joined: The same of the union of a member and what is joined before, given its distance.
        share: The share of a member in this union, 0 to 1.
        shown: The number of a member.
        grid: The grid.
        p: The point.
    """

    def larger(before: float, number: float, part: float) -> float:
        return select(part > 0.5, number, before)

    first = list_at(cells, grid, p)
    of_first = shown(p, cells[first + 1])
    return mixed_along(cells, distance, joined, share, first, of_first, shown, larger, p)
