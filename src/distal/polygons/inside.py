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
_ROUNDED: Final = 1e-3
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
    near = values <= 1.0 + _ROUNDED
    z, y, x = np.nonzero(near)
    asked, which = np.unique(nearest[near] - 1, return_inverse=True)
    buffers = {name: corners[asked] for name, corners in mesh.buffers.items()}
    buffers["NORMALS"] = feature_normals(mesh, mates, asked.astype(np.int64))
    places, rows = np.stack([x, y, z], axis=1), which.reshape(-1).astype(np.int32)
    side = run(arithmetic.side_of_triangle, places, rows, buffers, double=True)
    signs = np.zeros(values.shape, np.int8)
    signs[near] = np.where(side < 0.0, -1, 1)
    return _filled(signs)


def _filled(signs: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Return which nodes are inside, where those of sign 0 are on the side of a neighbor."""
    known = -1
    while known != (known := int(np.count_nonzero(signs))):
        for axis in range(3):
            along = np.moveaxis(signs, axis, 0)
            for each in (along, along[::-1]):
                for before, here in itertools.pairwise(each):
                    np.copyto(here, before, where=here == 0)
    return signs < 0


def is_contradictory(inside: NDArray[np.bool_], values: NDArray[np.float32]) -> bool:
    """Return whether two neighbors are on different sides without a surface between them.

    Where bodies overlap or lie in each other, normals say that a place is outside of the one and
    inside of the other.
    """
    for axis in range(3):
        sides, near = np.moveaxis(inside, axis, 0), np.moveaxis(values, axis, 0)
        if ((sides[1:] != sides[:-1]) & (near[1:] + near[:-1] > 1.0 + _ROUNDED)).any():
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
    is_near = values <= 1.0 + _ROUNDED
    signs = np.zeros(values.shape, np.int8)
    signs[is_near] = np.where(turn * _winding(tree, is_near) > 0.5, -1, 1)
    inside = _filled(signs)
    if not is_contradictory(inside, values):  # bodies that overlap; holes smaller than a cell
        return np.where(inside, -values, values)
    winding = turn * _winding(tree, np.ones(values.shape, bool)).reshape(values.shape)
    near = values.copy()
    for axis in range(3):
        _close(np.moveaxis(near, axis, 0), np.moveaxis(winding, axis, 0))
    if (near < values).any():
        _shorten(near)
    return np.where(winding > 0.5, -near, near)


def _winding(tree: dict[str, NDArray[Any]], asked: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return the winding numbers of the nodes that are asked for, in their order."""
    z, y, x = np.nonzero(asked)
    found = run(arithmetic.winding_number, np.stack([x, y, z], axis=1), None, tree)
    return np.asarray(found, np.float32)


def _close(near: NDArray[np.float32], winding: NDArray[np.float32]) -> None:
    """Bound distances by those to the surface that closes a hole, along the first axis.

    Where two neighbors are on different sides and the mesh is far from both, that surface passes
    between them.
    """
    here, there = winding[:-1], winding[1:]
    crossed = (here > 0.5) != (there > 0.5)
    crossed &= near[:-1] + near[1:] > 1.0 + _ROUNDED
    rise = np.where(crossed, there - here, 1.0)
    share = np.clip((0.5 - here) / rise, 0.0, 1.0)
    np.copyto(near[:-1], np.minimum(near[:-1], share), where=crossed)
    np.copyto(near[1:], np.minimum(near[1:], 1.0 - share), where=crossed)


def _shorten(near: NDArray[np.float32]) -> None:
    """Lower distances until neighbors differ by at most how far they are apart."""
    total = np.inf
    while total > (total := float(near.sum(dtype=np.float64))):
        for step in _NEIGHBORS:
            far = np.float32(np.sqrt(sum(s * s for s in step)))
            here = near[tuple(slice(max(s, 0), min(s, 0) or None) for s in step)]
            there = near[tuple(slice(max(-s, 0), min(-s, 0) or None) for s in step)]
            np.minimum(here, there + far, out=here)
            np.minimum(there, here + far, out=there)
