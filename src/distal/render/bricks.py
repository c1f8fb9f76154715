"""Bricks: boxes side by side, each with the short program of the values of a tree within it.

Input: a grid of bricks, the value of a program at a point (``render.pieces``). Output: the value of
the tree at any point, the program that has it. The grid is a buffer of whole numbers: the program
of each brick, a part as in ``render.pieces``; x fastest, then y.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import Buffer, clamp, func, length, max, min, select, struct, vec2, vec3


@struct
class BrickGrid:
    """A grid of bricks.

    Attributes:
        low: The low corner.
        high: The high corner.
        per_unit: Bricks for each unit of length along each axis.
        across: Bricks along x.
        up: Bricks along y.
        deep: Bricks along z.
        whole: The program of the whole tree.
    """

    low: vec3
    high: vec3
    per_unit: vec3
    across: int
    up: int
    deep: int
    whole: int


@func
def brick_at(bricks: Buffer[int], grid: BrickGrid, p: vec3) -> int:
    """Return the program of the brick that a point of the grid is in.

    Args:
        bricks: The programs.
        grid: The grid.
        p: The point.
    """
    place = (p - grid.low) * grid.per_unit
    x = min(int(place.x), grid.across - 1)
    y = min(int(place.y), grid.up - 1)
    z = min(int(place.z), grid.deep - 1)
    return bricks[x + grid.across * (y + grid.up * z)]


@func
def program_at(bricks: Buffer[int], grid: BrickGrid, p: vec3) -> int:
    """Return the program that has the tree's value at a point.

    Args:
        bricks: The programs.
        grid: The grid.
        p: The point.
    """
    nearest = clamp(p, grid.low, grid.high)
    is_beyond = length(p - nearest) > 0.0
    return select(is_beyond, grid.whole, brick_at(bricks, grid, nearest))


@func
def value_by_bricks(
    bricks: Buffer[int],
    value: Callable[[vec3, int], float],
    grid: BrickGrid,
    steepest: float,
    exact: bool,
    p: vec3,
) -> float:
    """Return the value of the tree at a point.

    Outside of the grid, where it may be a bound, the surface is in the grid, which is convex: the
    square of its distance is at least the sum of those from p to the nearest point q of the grid
    and from q to the surface. It continues the values inside, and its slope is not larger.

    Args:
        bricks: The programs.
        value: The value of a program at a point.
        grid: The grid.
        steepest: Lipschitz bound (slope) of the tree.
        exact: Whether values outside of the grid are those of the tree, too; a constant.
        p: The point.
    """
    if exact:
        return value(p, program_at(bricks, grid, p))
    nearest = clamp(p, grid.low, grid.high)
    d = value(nearest, brick_at(bricks, grid, nearest))
    beyond = length(p - nearest)
    return select(beyond > 0.0, length(vec2(steepest * beyond, max(d, 0.0))), d)
