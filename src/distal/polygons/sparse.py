"""Signed distances to a mesh in bricks near its surface, without the rest of the grid.

Input: a mesh, the spacing of the samples, how to find the inside. Output: as ``distances``, for
grids that do not fit as a whole. Corners of bricks are a grid of their own, 8 times as wide, whose
distances ``distances`` computes. Samples of a brick have a border of one, copied from the bricks
about it, so that the same code compares neighbors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import need
from distal.polygons import arithmetic
from distal.polygons.bricks import (
    ABOUT,
    CELLS,
    MOST_NUMBERS,
    REACH,
    SIDE,
    BrickSamples,
    KnownBricks,
    assembled,
    bricks_along,
    numbers_of,
)
from distal.polygons.cells import Boxes, boxes_of_pieces, sorted_into_met_cells
from distal.polygons.distances import (
    AUTO,
    NORMALS,
    UNSIGNED,
    WINDING,
    MeshOnGrid,
    box_and_spacing,
    first_node,
    joined_on_grid,
    nodes_along,
    signed,
    widened,
)
from distal.polygons.inside import (
    ROUNDED,
    filled,
    is_contradictory,
    signs_by_normals,
    signs_by_winding,
)
from distal.polygons.kernels import run
from distal.polygons.topology import EdgeTopology, Joined, topology
from distal.polygons.tree import tree_buffers
from distal.polygons.triangles import SourceTriangles

_PADDED: Final = SIDE + 2
_OWN: Final = (slice(None), *(slice(1, -1),) * 3)
# Of a brick a step away: its samples, and where they are among those of this one.
_COPIED: Final = {-1: (slice(0, 2), slice(8, 10)), 1: (slice(9, 11), slice(1, 3))}
_SAME: Final = (slice(1, -1), slice(1, -1))
_ROWS: Final = 2**18  # compared at once
# Bytes that a brick costs at the peak, if it has samples, and if not.
_STORED_BYTES: Final = 60_000
_BRICK_BYTES: Final = 100


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BrickDistances(MeshOnGrid):
    """Signed distances in bricks.

    Attributes:
        bricks: The distances, in the unit of the mesh.
    """

    bricks: BrickSamples


def brick_distances(
    mesh: SourceTriangles, spacing: float | None = None, sign: str = AUTO
) -> BrickDistances | None:
    """Return the signed distances to a mesh in bricks, as ``distances``.

    Returns:
        The distances; None if holes have to be closed that are larger than a cell, because the
        surface that closes them is known on a whole grid only.

    Raises:
        LoadError: The mesh has no size or no inside, or there are too many bricks.
    """
    low, high, step = box_and_spacing(mesh, spacing)
    nodes = nodes_along(high - low, step)
    origin = first_node(low, high, step)  # the samples of both ways are in the same places
    x, y, z = map(bricks_along, nodes)
    samples = (CELLS * x + 1, CELLS * y + 1, CELLS * z + 1)
    found = joined_on_grid(mesh, origin, step)
    _check_area(found, (z, y, x), step)
    boxes = boxes_of_pieces(found.corners)
    places = np.argwhere(_near_bricks(boxes, (z, y, x)))
    _check_count(len(places), (z, y, x), step)
    joints = topology(found)
    grid = _Bricks(places)
    nearest, values = _nearest(found, boxes, samples, grid)
    own = values[:-1][_OWN]
    wide = signed(_coarser(found), joints, (x + 1, y + 1, z + 1), sign)
    inside = _inside(found, joints, nearest, own, grid, wide)
    if wide[1] == NORMALS and sign == AUTO and is_contradictory(inside, own):
        wide = signed(_coarser(found), joints, (x + 1, y + 1, z + 1), WINDING)
        inside = _inside(found, joints, nearest, own, grid, wide)
    corners, method, turned = wide
    if method == WINDING and is_contradictory(inside, own):
        return None
    near = np.where(inside, -own, own)
    # Away from the surface distances are up to .13 of their spacing too large (decision 62), and
    # the middle of a brick is .87 of it from its corners: together one brick.
    known = KnownBricks(places, near, corners * np.float32(CELLS), float(CELLS))
    bricks = assembled(known, (1.0, 1.0, 1.0), float(REACH), samples)
    bricks = _scaled(bricks, step, math.prod((x, y, z)))
    joints = replace(joints, volume=joints.volume * step**3)
    return BrickDistances(
        low=origin,
        spacing=step,
        topology=joints,
        sign=method,
        turned=turned,
        left_out=found.left_out,
        bricks=bricks,
    )


def _scaled(bricks: BrickSamples, step: float, count: int) -> BrickSamples:
    """Return bricks in another unit; the first ``count`` numbers say which ones are stored."""
    numbers = bricks.numbers
    numbers[count:] *= np.float32(step)
    # As single floats: the sides of bricks have exactly this number.
    return replace(bricks, reach=float(np.float32(bricks.reach) * np.float32(step)))


def _check_area(mesh: Joined, bricks: tuple[int, int, int], step: float) -> None:
    """Check that there are not many times too many bricks, before they are counted."""
    a, b, c = (corner.astype(np.float64) for corner in mesh.corners)
    area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    sides = area / (CELLS * CELLS)
    # A plane through a brick has an area of at most 1.3 of its sides; with the bricks beside it,
    # an inclined plane has about 2.6 for each.
    _check_count(int(sides / 1.3), bricks, step, likely=int(sides * 2.6))


def _check_count(stored: int, bricks: tuple[int, int, int], step: float, likely: int = 0) -> None:
    """Check that bricks are not too many.

    Args:
        stored: How many are stored at least.
        bricks: How many there are along each axis.
        step: The spacing.
        likely: How many are stored about, if that is more.
    """
    if numbers_of(bricks, stored) > MOST_NUMBERS:
        needed = numbers_of(bricks, max(stored, likely))
        enough = 1.1 * step * math.sqrt(needed / MOST_NUMBERS)
        raise LoadError(
            f"a spacing of {step:g} needs {needed:,} numbers near the surface, more than "
            f"{MOST_NUMBERS:,}: a spacing of {enough:.3g} is enough"
        )
    need(
        stored * _STORED_BYTES + math.prod(bricks) * _BRICK_BYTES,
        f"a spacing of {step:g} needs {numbers_of(bricks, stored):,} numbers near the surface",
    )


def _near_bricks(boxes: Boxes, shape: tuple[int, int, int]) -> NDArray[np.bool_]:
    """Return which bricks have a place within ``REACH`` of the box of a piece of a triangle."""
    low, high, _ = boxes
    # Cell i lies between the nodes i - 1 and i.
    first = np.maximum((low - 1 - REACH) // CELLS, 0)
    last = np.minimum(-(-(high + REACH) // CELLS) - 1, np.array(shape[::-1]) - 1)
    pairs = np.unique(np.concatenate([first, last], axis=1), axis=0)
    first, last = pairs[:, :3], pairs[:, 3:]
    near = np.zeros(shape, bool)
    most = (last - first).max(axis=0) + 1
    for x, y, z in np.ndindex(*most.tolist()):
        at = np.minimum(first + np.array((x, y, z)), last)
        near[at[:, 2], at[:, 1], at[:, 0]] = True
    return near


def _coarser(mesh: Joined) -> Joined:
    """Return a mesh in units of bricks."""
    part = np.float32(1.0 / CELLS)
    first, second, third = mesh.corners
    return replace(
        mesh, points=mesh.points * part, corners=(first * part, second * part, third * part)
    )


class _Bricks:
    """Some bricks of a grid, and how arrays of theirs are continued into their borders.

    An array has a row for each brick, with a border of one sample, and one row more, which stays
    0: the brick that is not there.
    """

    def __init__(self, places: NDArray[np.int64]) -> None:
        self.places = places
        count = len(places)
        index = np.full(tuple(places.max(axis=0) + 3), count)
        z, y, x = places.T + 1
        index[z, y, x] = np.arange(count)
        self._about = [(step, index[z + step[0], y + step[1], x + step[2]]) for step in ABOUT]
        self._index = index

    def array(self, value: Any, dtype: Any) -> NDArray[Any]:
        """Return an array with one value everywhere."""
        return np.full((len(self.places) + 1, *(_PADDED,) * 3), value, dtype)

    def continue_(self, array: NDArray[Any], is_changed: NDArray[np.bool_]) -> None:
        """Copy what is known, which is not 0, to the borders of the bricks about.

        Args:
            array: An array; changed in place. A sample of several bricks is the same in all.
            is_changed: In which bricks it has changed.
        """
        for step, about in self._about:
            mine = np.flatnonzero(is_changed[about])
            to, there = zip(*(_COPIED.get(s, _SAME) for s in step), strict=True)
            found, kept = array[(about[mine], *there)], array[(mine, *to)]
            np.copyto(kept, found, where=found != 0)
            array[(mine, *to)] = kept

    def scatter(self, nodes: NDArray[np.int64], *pairs: tuple[NDArray[Any], NDArray[Any]]) -> None:
        """Write values of nodes to all bricks that have them.

        Args:
            nodes: (n, 3) along z, y and x.
            pairs: An array, and the values of the nodes.
        """
        for back in np.ndindex(2, 2, 2):
            brick = nodes // CELLS - back
            local = nodes - brick * CELLS
            rows = self._index[tuple(np.minimum(brick + 1, np.array(self._index.shape) - 1).T)]
            kept = (local <= CELLS).all(axis=1) & (rows < len(self.places))
            at = (rows[kept], *(local[kept] + 1).T)
            for array, values in pairs:
                array[at] = values[kept]

    def nodes_at(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return places along x, y and z of elements of an array without its borders counted."""
        brick, z, y, x = np.unravel_index(rows, (len(self.places) + 1, *(_PADDED,) * 3))
        local = np.stack([x, y, z], axis=1) - 1
        found: NDArray[np.int64] = self.places[brick][:, ::-1] * CELLS + local
        return found


def _nearest(
    mesh: Joined, boxes: Boxes, samples: tuple[int, int, int], grid: _Bricks
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Return the nearest triangle of each sample plus 1, and its distance, as arrays of bricks."""
    cells = sorted_into_met_cells(mesh.corners, samples, boxes)
    nodes, about = cells.near_nodes()
    buffers = mesh.buffers
    more = {"MEMBERS": cells.members, "STARTS": cells.starts, "ABOUT": about.reshape(-1)}
    rows = np.arange(len(nodes), dtype=np.int32)
    squared, which = run(arithmetic.nearest_about, nodes[:, ::-1], rows, {**buffers, **more})
    nearest, values = grid.array(0, np.int32), grid.array(np.inf, np.float32)
    grid.scatter(nodes, (nearest, np.asarray(which)), (values, np.sqrt(squared)))
    _spread(nearest, values, buffers, grid)
    return nearest, values


def _spread(
    nearest: NDArray[np.int32],
    values: NDArray[np.float32],
    buffers: dict[str, NDArray[Any]],
    grid: _Bricks,
) -> None:
    """Fill in samples without a triangle, and improve all until no neighbor knows a nearer one.

    Args:
        nearest: The nearest triangle of each sample plus 1; changed in place.
        values: Its distance; changed in place.
        buffers: The corners of the triangles.
        grid: The bricks.
    """
    is_own: NDArray[np.bool_] = grid.array(False, bool)
    is_own[:-1][_OWN] = True
    grid.continue_(nearest, _bricks_of(nearest > 0))
    while True:  # outwards, a layer each time
        layer = widened(nearest > 0) & (nearest == 0) & is_own
        if not layer.any():
            break
        grid.continue_(nearest, _bricks_of(_compared(layer, nearest, values, buffers, grid)))
    asked: NDArray[np.bool_] = is_own
    while asked.any():
        changed = _compared(asked, nearest, values, buffers, grid)
        where = _bricks_of(changed)
        grid.continue_(nearest, where)
        grid.continue_(changed, where)
        asked = widened(changed)
        asked &= is_own


def _compared(
    is_asked: NDArray[np.bool_],
    nearest: NDArray[np.int32],
    values: NDArray[np.float32],
    buffers: dict[str, NDArray[Any]],
    grid: _Bricks,
) -> NDArray[np.bool_]:
    """Compare samples with their neighbors, and return which have a nearer triangle now.

    Args:
        is_asked: The samples.
        nearest: The nearest triangle of each sample plus 1; changed in place.
        values: Its distance; changed in place.
        buffers: The corners of the triangles.
        grid: The bricks.
    """
    asked = np.flatnonzero(is_asked)
    steps = np.array([_PADDED, _PADDED * _PADDED], np.int32)
    more = {**buffers, "NEAREST": nearest.reshape(-1), "NODE_STEPS": steps}
    found: list[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]] = []
    for start in range(0, len(asked), _ROWS):
        rows = asked[start : start + _ROWS]
        squared, which = run(
            arithmetic.nearest_of_neighbors, grid.nodes_at(rows), rows.astype(np.int32), more
        )
        away = np.sqrt(squared)
        better = away < values.reshape(-1)[rows]
        found.append((rows[better], away[better], np.asarray(which)[better]))
    # After all were compared, so that the same sample of two bricks has the same neighbors.
    is_better = np.zeros(nearest.size, bool)
    for rows, away, which in found:
        values.reshape(-1)[rows], nearest.reshape(-1)[rows] = away, which
        is_better[rows] = True
    return is_better.reshape(nearest.shape)


def _bricks_of(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which bricks have a sample in a mask."""
    return np.asarray(mask.any(axis=(1, 2, 3)))


def _inside(
    mesh: Joined,
    joints: EdgeTopology,
    nearest: NDArray[np.int32],
    values: NDArray[np.float32],
    grid: _Bricks,
    wide: tuple[NDArray[np.float32], str, bool],
) -> NDArray[np.bool_]:
    """Return which samples are inside, (n, 9, 9, 9).

    Those within one cell of the surface are asked. Corners of bricks are on the side of the coarse
    grid's; between other samples there is no surface.

    Args:
        mesh: The mesh.
        joints: How it is joined.
        nearest: The nearest triangle of each sample plus 1, with borders.
        values: Its distance, without borders.
        grid: The bricks.
        wide: The signed distances of corners of bricks, how their inside was found, and whether the
            mesh is inside out.
    """
    corners, method, turned = wide
    if method == UNSIGNED:
        return np.zeros(values.shape, bool)
    signs = np.zeros(values.shape, np.int8)
    for step in np.ndindex(2, 2, 2):
        z, y, x = (grid.places + step).T
        at = tuple(CELLS * s for s in step)
        signs[(slice(None), *at)] = np.where(corners[z, y, x] < 0.0, -1, 1)
    is_near = values <= 1.0 + ROUNDED
    brick, z, y, x = np.nonzero(is_near)
    nodes = grid.places[brick][:, ::-1] * CELLS + np.stack([x, y, z], axis=1)
    turn = -1 if turned else 1
    if method == WINDING or joints.mates is None:
        signs[is_near] = signs_by_winding(tree_buffers(mesh.corners), nodes, turn)
    else:
        which = nearest[:-1][_OWN][is_near]
        signs[is_near] = turn * signs_by_normals(mesh, joints.mates, nodes, which)
    return filled(signs) < 0
