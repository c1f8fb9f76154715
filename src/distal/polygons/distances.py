"""Signed distances to a mesh at the nodes of a grid.

Input: a mesh, the spacing of the nodes, how to find its inside. Output: distances, and what is
known of the mesh. Near the surface a distance is exact; farther away it is that to the nearest of
the triangles that are nearest to the neighboring nodes, so that neighbors differ by at most their
distance.
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
from distal.polygons.bricks import MOST_DENSE
from distal.polygons.cells import sorted_into_cells
from distal.polygons.inside import closed_by_winding, inside_by_normals, is_contradictory
from distal.polygons.kernels import run
from distal.polygons.topology import EdgeTopology, Joined, joined, topology
from distal.polygons.tree import tree_buffers
from distal.polygons.triangles import SourceTriangles

# Ways to find the inside of a mesh.
AUTO: Final = "auto"
NORMALS: Final = "normals"
WINDING: Final = "winding"
UNSIGNED: Final = "unsigned"
SIGNS: Final = (AUTO, NORMALS, WINDING, UNSIGNED)
# Empty cells around the mesh: the surface never touches the border of the grid.
MARGIN: Final = 2
CELLS_ALONG: Final = 64
# Bytes that a node costs at the peak.
NODE_BYTES: Final = 100
_ROWS: Final = 2**18  # nodes that are compared at once


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MeshOnGrid:
    """What is known of a mesh on a grid.

    Attributes:
        low: The first node.
        spacing: The distance of two nodes along an axis.
        topology: Whether the mesh is closed, and its volume.
        sign: How the inside was found, one of ``SIGNS`` but not "auto".
        turned: Whether the mesh was inside out.
        left_out: Triangles that have a corner twice.
    """

    low: NDArray[np.float64]
    spacing: float
    topology: EdgeTopology
    sign: str
    turned: bool
    left_out: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Distances(MeshOnGrid):
    """Signed distances at the nodes of a grid.

    Attributes:
        values: float32, (nodes along z, y, x), in the unit of the mesh.
    """

    values: NDArray[np.float32]


def distances(mesh: SourceTriangles, spacing: float | None = None, sign: str = AUTO) -> Distances:
    """Return the signed distances to a mesh.

    Args:
        mesh: The mesh.
        spacing: The distance of two nodes; None divides the longest side of the mesh's box by 64.
        sign: How to find the inside: "normals" needs a closed mesh; "winding" closes holes;
            "unsigned" has no inside; "auto" takes the first one that is possible.

    Raises:
        LoadError: The mesh has no size or no inside, or the grid is too large.
    """
    low, high, step = box_and_spacing(mesh, spacing)
    x, y, z = nodes_along(high - low, step)
    if x * y * z > MOST_DENSE:
        enough = step * (x * y * z / MOST_DENSE) ** (1.0 / 3.0)
        message = f"a spacing of {step:g} needs {x * y * z:,} samples, more than "
        raise LoadError(f"{message}{MOST_DENSE:,}: a spacing of {enough * 1.05:.3g} is enough")
    need(x * y * z * NODE_BYTES, f"a spacing of {step:g} needs {x * y * z:,} samples")
    origin = first_node(low, high, step)
    found = joined_on_grid(mesh, origin, step)
    joints = topology(found)
    values, method, turned = signed(found, joints, (x, y, z), sign)
    joints = replace(joints, volume=joints.volume * step**3)
    return Distances(
        low=origin,
        spacing=step,
        topology=joints,
        sign=method,
        turned=turned,
        left_out=found.left_out,
        values=values * np.float32(step),
    )


def box_and_spacing(
    mesh: SourceTriangles, spacing: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return the corners of a mesh's box, and the spacing.

    Raises:
        LoadError: The mesh has no size, or the spacing does not suit it.
    """
    is_used = np.zeros(len(mesh.points), bool)
    is_used[mesh.triangles.reshape(-1)] = True
    used = mesh.points[is_used]
    low, high = used.min(axis=0), used.max(axis=0)
    return low, high, _checked_spacing(high - low, spacing)


def nodes_along(size: NDArray[np.float64], step: float) -> tuple[int, int, int]:
    """Return how many nodes a grid has along x, y and z for a mesh of a size."""
    x, y, z = (math.ceil(side / step - 1e-9) + 1 + 2 * MARGIN for side in size.tolist())
    return x, y, z


def first_node(
    low: NDArray[np.float64], high: NDArray[np.float64], step: float
) -> NDArray[np.float64]:
    """Return the first node of a grid about the middle of a mesh's box."""
    count = np.array(nodes_along(high - low, step))
    found: NDArray[np.float64] = 0.5 * (low + high) - 0.5 * step * (count - 1)
    return found


def joined_on_grid(mesh: SourceTriangles, origin: NDArray[np.float64], step: float) -> Joined:
    """Return a mesh in units of a grid.

    Raises:
        LoadError: It has no triangle.
    """
    found = joined(mesh, origin, step)
    if not len(found.triangles):
        raise LoadError("all triangles have a corner twice: there is no surface")
    return found


def _checked_spacing(size: NDArray[np.float64], spacing: float | None) -> float:
    longest = float(size.max())
    if not longest > 0.0:
        raise LoadError("all points are in one place: the mesh has no size")
    if spacing is None:
        return longest / CELLS_ALONG
    if spacing >= longest:
        message = f"the spacing {spacing:g} is not smaller than the mesh, {longest:g}"
        raise LoadError(f"{message}: leave it out, or give {longest / CELLS_ALONG:.3g}")
    if longest / spacing > 2**20:
        raise LoadError(f"a spacing of {spacing:g} is too small for a mesh of size {longest:g}")
    return spacing


def signed(
    mesh: Joined, joints: EdgeTopology, nodes: tuple[int, int, int], sign: str
) -> tuple[NDArray[np.float32], str, bool]:
    """Return distances in units of the grid, how the inside was found, and whether it was turned.

    Args:
        mesh: The mesh, with the first node at 0.
        joints: How it is joined.
        nodes: The number of nodes along x, y and z.
        sign: One of ``SIGNS``.
    """
    nearest, values = nearest_triangles(mesh, nodes)
    if sign == UNSIGNED:
        return values, UNSIGNED, False
    turned = joints.volume < 0.0
    if sign == NORMALS and joints.mates is None:
        raise LoadError(
            f"{described(joints)}: sign='normals' needs a closed one; close it, or give "
            "sign='winding'"
        )
    if sign != WINDING and joints.mates is not None:
        inside = inside_by_normals(mesh, joints.mates, nearest, values) ^ turned
        if sign == NORMALS or not is_contradictory(inside, values):
            return np.where(inside, -values, values), NORMALS, turned
    signed = closed_by_winding(tree_buffers(mesh.corners), values, inverted=turned)
    if not (signed < 0.0).any():
        raise LoadError(
            f"{described(joints)}, and encloses nothing: close it, or give sign='unsigned' and "
            "make a sheet of it with .round(thickness)"
        )
    return signed, WINDING, turned


def described(joints: EdgeTopology) -> str:
    """Return in words how a mesh is joined."""
    if joints.open_edges:
        return f"the mesh is open, with {joints.open_edges} open edges"
    if joints.turned_edges:
        return f"the mesh has {joints.turned_edges} edges whose triangles are turned differently"
    if joints.shared_edges:
        return f"the mesh has {joints.shared_edges} edges of more than two triangles"
    return "the mesh is closed"


def nearest_triangles(
    mesh: Joined, nodes: tuple[int, int, int]
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Return the nearest triangle of each node plus 1, and its distance, both (z, y, x)."""
    shape = (nodes[2], nodes[1], nodes[0])
    cells, buffers = sorted_into_cells(mesh.corners, nodes), mesh.buffers
    is_near = _about(cells.is_met)
    z, y, x = np.nonzero(is_near)
    _, height, width = cells.shape
    first = ((z * height + y) * width + x).astype(np.int32)
    more = {
        "MEMBERS": cells.members,
        "STARTS": cells.starts,
        "CELL_STEPS": np.array([width, height * width], np.int32),
    }
    squared, which = run(
        arithmetic.nearest_in_cells, np.stack([x, y, z], axis=1), first, {**buffers, **more}
    )
    # A border of unknown nodes: each node then has 26 neighbors.
    nearest = np.zeros(tuple(n + 2 for n in shape), np.int32)
    values = np.full(nearest.shape, np.inf, np.float32)
    inner = (slice(1, -1),) * 3
    nearest[inner][is_near] = which
    values[inner][is_near] = np.sqrt(squared)
    _spread(nearest, values, buffers)
    return nearest[inner], values[inner]


def _spread(
    nearest: NDArray[np.int32], values: NDArray[np.float32], buffers: dict[str, NDArray[Any]]
) -> None:
    """Fill in the nodes without a triangle, and improve all until no neighbor knows a nearer one.

    Args:
        nearest: The nearest triangle of each node plus 1, with a border; changed in place.
        values: Its distance; changed in place.
        buffers: The corners of the triangles.
    """
    steps = np.array([nearest.shape[2], nearest.shape[1] * nearest.shape[2]], np.int32)
    is_node = np.pad(np.ones(tuple(n - 2 for n in nearest.shape), bool), 1)

    def compared(is_asked: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Compare nodes with their neighbors, and return which have a nearer triangle now."""
        asked = np.flatnonzero(is_asked)
        parts: list[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]] = []
        for start in range(0, len(asked), _ROWS):
            rows = asked[start : start + _ROWS]
            z, y, x = np.unravel_index(rows, nearest.shape)
            squared, which = run(
                arithmetic.nearest_of_neighbors,
                np.stack([x, y, z], axis=1) - 1,
                rows.astype(np.int32),
                {**buffers, "NEAREST": nearest.reshape(-1), "NODE_STEPS": steps},
            )
            distance = np.sqrt(squared)
            better = distance < values.reshape(-1)[rows]
            parts.append((rows[better], distance[better], np.asarray(which)[better]))
        changed = np.zeros(nearest.shape, bool)
        for rows, distance, which in parts:  # after all were compared, as if at once
            changed.reshape(-1)[rows] = True
            values.reshape(-1)[rows], nearest.reshape(-1)[rows] = distance, which
        return changed

    while True:  # outwards, a layer each time
        layer = widened(nearest > 0) & (nearest == 0) & is_node
        if not layer.any():
            break
        compared(layer)
    asked = is_node
    while asked.any():
        asked = widened(compared(asked)) & is_node


def widened(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a mask with the 26 neighbors of each of its nodes, along the last three axes."""
    for axis in range(-3, 0):
        along = np.moveaxis(mask, axis, 0)
        wide = along.copy()
        wide[1:] |= along[:-1]
        wide[:-1] |= along[1:]
        mask = np.moveaxis(wide, 0, axis)
    return mask


def _about(is_met: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which nodes have a triangle in the eight cells about them."""
    for axis in range(3):
        along = np.moveaxis(is_met, axis, 0)
        is_met = np.moveaxis(along[1:] | along[:-1], 0, axis)
    return is_met
