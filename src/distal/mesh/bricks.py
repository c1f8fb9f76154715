"""Find the bricks that the surface passes through, and what happens in them.

Input: a shape's kernels and a lattice. Output: for each brick the masks of its cells, and the edges
whose ends differ, with the values at the ends. Samples are kept for a few hundred bricks at a time.

Blocks are dropped where the shape's slope says that there is no surface. A slope that is wrong can
lose a separate part, but leaves no hole: where the sign changes on a brick's face, the brick on the
other side is sampled too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
import numpy.typing as npt

from distal.ir.types import FLOAT, VEC3
from distal.mesh.arithmetic import distance_value, samples_along_x
from distal.mesh.joining import Blocks, corner_masks, separate_blocks
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import BRICK, Lattice, cells_of_keys, keys_of, position
from distal.mesh.parallel import parallel_map, slices_of
from distal.mesh.problems import MeshProblem
from distal.mesh.solid import Floats, Integers
from distal.mesh.tables import CORNERS

BRICKS_AT_ONCE: Final = 128
# Lattice points whose values say that the surface is closer than this, in cells, must be near a
# cell with a change of sign.
SUSPICIOUS: Final = 0.9
# Half of a cube's diagonal, for each unit of its side.
HALF_DIAGONAL: Final = 0.5 * float(np.sqrt(3.0))
_NO_BLOCKS: Final[Blocks] = (np.empty(0, np.int64),) * 3
Watch = Callable[[float], None]


@dataclass(frozen=True, slots=True)
class Edges:
    """Edges along one axis whose ends differ.

    Attributes:
        brick: The brick of each edge: its row in the bricks of the surface.
        start: The lattice point at the lower end, of shape (n, 3), within the brick.
        first: The value at the lower end.
        second: The value at the upper end.
    """

    brick: Integers
    start: Integers
    first: Floats
    second: Floats


@dataclass(frozen=True, slots=True)
class SurfaceBricks:
    """The bricks with a change of sign, in the order of their keys.

    Attributes:
        bricks: Their places, of shape (n, 3), in bricks.
        masks: The masks of their cells, of shape (n, 8, 8, 8).
        edges: The edges with a change of sign along each axis.
        sampled: How many bricks were sampled.
        lost: Lattice points next to a surface that changes no sign near them, of shape (n, 3).
        separate: The keys of blocks of 8, 4 and 2 cells a side that are more than one cell, if
            cells are joined.
        near: The places of all bricks that were sampled.
    """

    bricks: Integers
    masks: npt.NDArray[np.uint8]
    edges: tuple[Edges, Edges, Edges]
    sampled: int
    lost: Floats
    separate: Blocks
    near: Integers


@dataclass(frozen=True, slots=True)
class Slopes:
    """What is known about how fast values change.

    Attributes:
        slope: Lipschitz bound (slope): a bound on |gradient| everywhere.
        divisor: A positive value divided by it is at most the distance to the surface.
    """

    slope: float
    divisor: float


def descend(
    kernels: FieldKernels, lattice: Lattice, slopes: Slopes, most: int, watch: Watch
) -> Integers:
    """Return the bricks that the surface can pass through, of shape (n, 3).

    Args:
        kernels: The shape.
        lattice: The lattice.
        slopes: How fast values change.
        most: The most bricks.
        watch: Called now and then.

    Raises:
        MeshProblem: There are more.
    """
    levels = int(np.ceil(np.log2(max(int(lattice.extent.max()), 1))))
    blocks = np.zeros((1, 3), np.int64)
    halves = np.array(CORNERS, np.int64)
    for level in range(levels, -1, -1):
        if level < levels:
            blocks = (blocks[:, None] * 2 + halves[None]).reshape(-1, 3)
        blocks = blocks[lattice.contains(blocks << level)]
        if len(blocks) > 8 * most:
            raise MeshProblem("too many")
        near = partial(_near_blocks, kernels, lattice, slopes, level)
        some = [blocks[rows] for rows in slices_of(len(blocks))]
        blocks = np.concatenate(
            [blocks[:0], *parallel_map(near, some, watch=lambda share: watch(0.0))]
        )
    if len(blocks) > most:
        raise MeshProblem("too many")
    return blocks


def _near_blocks(
    kernels: FieldKernels, lattice: Lattice, slopes: Slopes, level: int, blocks: Integers
) -> Integers:
    """Return the blocks, of ``BRICK << level`` cells a side, that the surface can pass through."""
    side = (BRICK << level) * lattice.step
    centers = lattice.places((blocks + 0.5) * (BRICK << level))
    values = kernels.call(distance_value, centers, types=[("p", VEC3)])
    check_numbers(values, centers)
    reach = np.where(values > 0.0, min(slopes.divisor, slopes.slope), slopes.slope)
    near: Integers = blocks[np.abs(values) <= reach * (side * HALF_DIAGONAL * 1.000001)]
    return near


def check_numbers(values: Floats, places: Floats) -> None:
    """Check that all values are finite.

    Raises:
        MeshProblem: One is not.
    """
    if not np.isfinite(values).all():
        raise MeshProblem("no number", tuple(places[int(np.argmin(np.isfinite(values)))]))


def surface_bricks(
    kernels: FieldKernels,
    lattice: Lattice,
    slopes: Slopes,
    most: int,
    watch: Watch,
    joined: float | None = None,
) -> SurfaceBricks:
    """Return the bricks that the surface passes through.

    Args:
        kernels: The shape.
        lattice: The lattice.
        slopes: How fast values change.
        most: The most bricks.
        watch: Called with the share of the bricks that are sampled.
        joined: The tolerance within which cells are joined; None for equal cells.

    Raises:
        MeshProblem: There are more; a value is not a number; or the surface leaves the lattice.
    """
    waiting = descend(kernels, lattice, slopes, most, watch)
    known = np.sort(keys_of(waiting))
    parts: list[_SampledBricks] = []
    while len(waiting):
        some = [waiting[rows] for rows in slices_of(len(waiting), BRICKS_AT_ONCE)]
        sampled = partial(_sampled, kernels, lattice, slopes, joined=joined)
        found = parallel_map(sampled, some, watch)
        parts += found
        neighbors = np.concatenate([part.neighbors for part in found])
        keys, first = np.unique(keys_of(neighbors), return_index=True)
        waiting = neighbors[first[position(keys, known) < 0]]
        if not lattice.contains(waiting).all():
            outside = waiting[~lattice.contains(waiting)][0]
            raise MeshProblem("leaves its box", tuple(lattice.places((outside + 0.5) * BRICK)))
        known = np.sort(np.concatenate([known, keys_of(waiting)]))
        if len(known) > most:
            raise MeshProblem("too many")
    return _joined(parts, cells_of_keys(known))


@dataclass(frozen=True, slots=True)
class _SampledBricks:
    """What was found in some bricks; ``Edges.brick`` counts within this part."""

    bricks: Integers
    masks: npt.NDArray[np.uint8]
    edges: tuple[Edges, Edges, Edges]
    neighbors: Integers
    lost: Floats
    separate: Blocks


def _sampled(
    kernels: FieldKernels,
    lattice: Lattice,
    slopes: Slopes,
    bricks: Integers,
    joined: float | None,
) -> _SampledBricks:
    values = _values(kernels, lattice, bricks)
    inside = values < 0.0
    neighbors = _neighbors(bricks, inside)
    masks = corner_masks(inside)
    lost = _suspicious(lattice, slopes, bricks, values, masks)
    some = ((masks != 0) & (masks != 255)).any(axis=(1, 2, 3))
    values, inside, bricks, masks = values[some], inside[some], bricks[some], masks[some]
    edges = (_edges(values, inside, 0), _edges(values, inside, 1), _edges(values, inside, 2))
    separate = _NO_BLOCKS
    if joined is not None:
        separate = separate_blocks(bricks, values, masks, lattice.step, joined)
    return _SampledBricks(bricks, masks, edges, neighbors, lost, separate)


def _values(kernels: FieldKernels, lattice: Lattice, bricks: Integers) -> Floats:
    """Return the samples of bricks, of shape (n, 9, 9, 9)."""
    across = np.arange(BRICK + 1)
    rows = np.zeros((len(bricks), BRICK + 1, BRICK + 1, 3), np.int64)
    rows[..., 1] = across[None, :, None]
    rows[..., 2] = across[None, None, :]
    rows += (bricks * BRICK)[:, None, None, :]
    corners = lattice.places(rows.reshape(-1, 3))
    found = kernels.call(
        samples_along_x,
        corners,
        rows[..., 0].reshape(-1),
        np.full(len(corners), lattice.origin[0]),
        np.full(len(corners), lattice.step),
        types=[("corner", VEC3), ("first", FLOAT), ("origin", FLOAT), ("step", FLOAT)],
    )
    if not np.isfinite(found).all():
        row, i = (int(n) for n in np.argwhere(~np.isfinite(found))[0])
        raise MeshProblem("no number", tuple(corners[row] + (i * lattice.step, 0.0, 0.0)))
    sides = (len(bricks), BRICK + 1, BRICK + 1, BRICK + 1)
    return np.ascontiguousarray(found.reshape(sides).transpose(0, 3, 1, 2))


def _neighbors(bricks: Integers, inside: npt.NDArray[np.bool_]) -> Integers:
    """Return the bricks beside faces on which the sign changes."""
    found = []
    for axis in range(3):
        for at, step in ((0, -1), (BRICK, 1)):
            face = inside.take(at, axis=1 + axis).reshape(len(bricks), -1)
            beside = bricks[face.any(axis=1) & ~face.all(axis=1)]
            beside[:, axis] += step
            found.append(beside)
    return np.concatenate(found)


def _edges(values: Floats, inside: npt.NDArray[np.bool_], axis: int) -> Edges:
    """Return the edges along an axis; those on upper faces belong to the next brick."""
    lower: list[slice] = [slice(None), *[slice(0, BRICK)] * 3]
    upper = list(lower)
    upper[1 + axis] = slice(1, BRICK + 1)
    brick, x, y, z = np.nonzero(inside[tuple(lower)] != inside[tuple(upper)])
    first = values[tuple(lower)][brick, x, y, z]
    second = values[tuple(upper)][brick, x, y, z]
    return Edges(brick, np.stack([x, y, z], axis=1), first, second)


def _suspicious(
    lattice: Lattice,
    slopes: Slopes,
    bricks: Integers,
    values: Floats,
    masks: npt.NDArray[np.uint8],
) -> Floats:
    """Return lattice points close to the surface by their value, without a change of sign nearby.

    Only points within a brick are looked at: cells around the others are in several bricks.
    """
    inner = slice(1, BRICK)
    near = np.abs(values[:, inner, inner, inner]) < SUSPICIOUS * lattice.step * slopes.slope
    if not near.any():
        return np.empty((0, 3))
    crossed = (masks != 0) & (masks != 255)
    crossed = crossed[:, :-1] | crossed[:, 1:]
    crossed = crossed[:, :, :-1] | crossed[:, :, 1:]
    near &= ~(crossed[..., :-1] | crossed[..., 1:])
    brick, *local = np.nonzero(near)
    return lattice.places(bricks[brick] * BRICK + np.stack(local, axis=1) + 1)


def _joined(parts: list[_SampledBricks], near: Integers) -> SurfaceBricks:
    """Return all parts as one, with the bricks in the order of their keys."""
    if not parts:
        parts = [_empty()]
    bricks = np.concatenate([part.bricks for part in parts])
    order = np.argsort(keys_of(bricks), kind="stable")
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    starts = np.cumsum([0, *(len(part.bricks) for part in parts)])
    edges = []
    for axis in range(3):
        rows = [part.edges[axis] for part in parts]
        brick = np.concatenate([e.brick + s for e, s in zip(rows, starts, strict=False)])
        # Within a brick the order is that of the samples; a stable sort keeps it.
        brick = place[brick] if len(brick) else brick
        sort = np.argsort(brick, kind="stable")
        edges.append(
            Edges(
                brick[sort],
                np.concatenate([e.start for e in rows])[sort],
                np.concatenate([e.first for e in rows])[sort],
                np.concatenate([e.second for e in rows])[sort],
            )
        )
    masks = np.concatenate([part.masks for part in parts])[order]
    lost = np.concatenate([part.lost for part in parts])
    x, y, z = edges
    large, middle, small = (
        np.concatenate(keys) for keys in zip(*(part.separate for part in parts), strict=True)
    )
    separate = (large, middle, small)
    return SurfaceBricks(bricks[order], masks, (x, y, z), len(near), lost, separate, near)


def _empty() -> _SampledBricks:
    none = Edges(np.empty(0, np.int64), np.empty((0, 3), np.int64), np.empty(0), np.empty(0))
    places = np.empty((0, 3), np.int64)
    masks = np.empty((0, BRICK, BRICK, BRICK), np.uint8)
    return _SampledBricks(places, masks, (none, none, none), places, np.empty((0, 3)), _NO_BLOCKS)
