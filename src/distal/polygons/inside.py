"""Which nodes of a grid are inside a mesh: by normals if it is closed, else by winding numbers.

Input: the nearest triangle and the distance of each node, in units of the grid. Output: which nodes
are inside. Does not compute distances to triangles.
"""

from __future__ import annotations

import itertools
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.polygons import arithmetic
from distal.polygons.kernels import run
from distal.polygons.topology import Joined, feature_normals

# Two neighbors on different sides of the surface have distances whose sum is at most 1.
ROUNDED: Final = 1e-3
_NEIGHBORS: Final = [
    step for step in itertools.product((-1, 0, 1), repeat=3) if step > (0, 0, 0)
]  # the other 13 are opposite


def inside_by_normals(
    mesh: Joined, mates: NDArray[np.int64], nearest: NDArray[np.int32], values: NDArray[np.float32]
) -> NDArray[np.bool_]:
    """Return which nodes are behind the surface of a closed mesh.

    A node within one cell of the surface is on the side of its nearest triangle. Between any other
    node and its six neighbors there is no surface: they are on the same side.

    Args:
        mesh: The mesh.
        mates: The other half of each of its edges.
        nearest: The nearest triangle of each node plus 1.
        values: Its distance.
    """
    near = values <= 1.0 + ROUNDED
    z, y, x = np.nonzero(near)
    signs = np.zeros(values.shape, np.int8)
    places = np.stack([x, y, z], axis=1)
    signs[near] = signs_by_normals(mesh, mates, places, nearest[near])
    return filled(signs) < 0


def signs_by_normals(
    mesh: Joined,
    mates: NDArray[np.int64],
    places: NDArray[np.int64],
    nearest: NDArray[np.int32],
) -> NDArray[np.int8]:
    """Return -1 for places behind their nearest triangle, else 1.

    Args:
        mesh: A closed mesh.
        mates: The other half of each of its edges.
        places: (n, 3).
        nearest: The nearest triangle of each place plus 1.
    """
    asked, which = np.unique(nearest - 1, return_inverse=True)
    buffers = {name: corners[asked] for name, corners in mesh.buffers.items()}
    buffers["NORMALS"] = feature_normals(mesh, mates, asked.astype(np.int64))
    rows = which.reshape(-1).astype(np.int32)
    side = run(arithmetic.side_of_triangle, places, rows, buffers, double=True)
    return np.where(side < 0.0, np.int8(-1), np.int8(1))


def filled(signs: NDArray[np.int8]) -> NDArray[np.int8]:
    """Give nodes of sign 0 that of a neighbor along one of the last three axes, in place."""
    known = -1
    while known != (known := int(np.count_nonzero(signs))):
        for axis in range(-3, 0):
            along = np.moveaxis(signs, axis, 0)
            for each in (along, along[::-1]):
                for before, here in itertools.pairwise(each):
                    np.copyto(here, before, where=here == 0)
    return signs


def is_contradictory(inside: NDArray[np.bool_], values: NDArray[np.float32]) -> bool:
    """Return whether two neighbors are on different sides without a surface between them.

    Where bodies overlap or lie in each other, normals say that a place is outside of the one and
    inside of the other.
    """
    for axis in range(-3, 0):
        sides, near = np.moveaxis(inside, axis, 0), np.moveaxis(values, axis, 0)
        if ((sides[1:] != sides[:-1]) & (near[1:] + near[:-1] > 1.0 + ROUNDED)).any():
            return True
    return False


def closed_by_winding(
    tree: dict[str, NDArray[Any]], values: NDArray[np.float32], *, inverted: bool
) -> NDArray[np.float32]:
    """Return signed distances to a mesh with holes.

    They are closed where the winding number is 0.5.

    Args:
        tree: The buffers of the tree.
        values: The distance of each node to the triangles.
        inverted: Whether the mesh is inside out.
    """
    turn = -1.0 if inverted else 1.0
    is_near = values <= 1.0 + ROUNDED
    signs = np.zeros(values.shape, np.int8)
    z, y, x = np.nonzero(is_near)
    signs[is_near] = signs_by_winding(tree, np.stack([x, y, z], axis=1), turn)
    inside = filled(signs) < 0
    if not is_contradictory(inside, values):  # bodies that overlap; holes smaller than a cell
        return np.where(inside, -values, values)
    z, y, x = np.indices(values.shape).reshape(3, -1)
    winding = turn * winding_numbers(tree, np.stack([x, y, z], axis=1)).reshape(values.shape)
    near = values.copy()
    closed_between(near, winding)
    if (near < values).any():
        shorten(near)
    return np.where(winding > 0.5, -near, near)


def signs_by_winding(
    tree: dict[str, NDArray[Any]], places: NDArray[np.int64], turn: float
) -> NDArray[np.int8]:
    """Return -1 for places where the winding number, times ``turn``, is more than 0.5, else 1."""
    return np.where(turn * winding_numbers(tree, places) > 0.5, np.int8(-1), np.int8(1))


def winding_numbers(
    tree: dict[str, NDArray[Any]], places: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Return the winding numbers of places, (n, 3)."""
    return np.asarray(run(arithmetic.winding_number, places, None, tree), np.float32)


def closed_between(near: NDArray[np.float32], winding: NDArray[np.float32]) -> None:
    """Bound distances by those to the surface that closes holes, along all axes, in place."""
    for axis in range(3):
        _close(np.moveaxis(near, axis, 0), np.moveaxis(winding, axis, 0))


def _close(near: NDArray[np.float32], winding: NDArray[np.float32]) -> None:
    """Bound distances by those to the surface that closes a hole, along the first axis.

    Where two neighbors are on different sides and the mesh is far from both, that surface passes
    between them.
    """
    here, there = winding[:-1], winding[1:]
    crossed = (here > 0.5) != (there > 0.5)
    crossed &= near[:-1] + near[1:] > 1.0 + ROUNDED
    rise = np.where(crossed, there - here, 1.0)
    share = np.clip((0.5 - here) / rise, 0.0, 1.0)
    np.copyto(near[:-1], np.minimum(near[:-1], share), where=crossed)
    np.copyto(near[1:], np.minimum(near[1:], 1.0 - share), where=crossed)


def shorten(near: NDArray[np.float32]) -> None:
    """Lower distances until neighbors differ by at most how far they are apart."""
    total = np.inf
    while total > (total := float(near.sum(dtype=np.float64))):
        for step in _NEIGHBORS:
            far = np.float32(np.sqrt(sum(s * s for s in step)))
            here = near[tuple(slice(max(s, 0), min(s, 0) or None) for s in step)]
            there = near[tuple(slice(max(-s, 0), min(-s, 0) or None) for s in step)]
            np.minimum(here, there + far, out=here)
            np.minimum(there, here + far, out=there)
