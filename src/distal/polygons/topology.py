"""How the triangles of a mesh are joined: closed or open, its volume, normals of its features.

Input: points and triangles. Output: counts and arrays. Does not depend on grids.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.polygons.triangles import SourceTriangles, welded


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """A mesh whose equal points are one, without triangles that have a point twice.

    Attributes:
        points: (n, 3) float32.
        triangles: (m, 3) int64.
        corners: The first, second and third corner of each triangle, three times (m, 3) float32.
        left_out: The number of triangles with a point twice.
        rows: The numbers of the triangles in the mesh that they come from; None if all are there.
    """

    points: NDArray[np.float32]
    triangles: NDArray[np.int64]
    corners: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]
    left_out: int
    rows: NDArray[np.int64] | None = None

    @property
    def buffers(self) -> dict[str, NDArray[Any]]:
        """The corners, by the names of buffers in ``arithmetic``."""
        return dict(zip(("FIRST", "SECOND", "THIRD"), self.corners, strict=True))


@dataclass(frozen=True, slots=True, eq=False)
class EdgeTopology:
    """Whether a mesh is closed.

    Attributes:
        open_edges: Edges with one triangle.
        shared_edges: Edges of more than two triangles.
        turned_edges: Edges of two triangles, one of which is turned around.
        volume: The volume that the mesh encloses; negative if it is inside out.
        mates: For each edge of each triangle, (3 m,), the number of the same edge in the triangle
            on its other side; None if the mesh is not closed.
    """

    open_edges: int
    shared_edges: int
    turned_edges: int
    volume: float
    mates: NDArray[np.int64] | None

    @property
    def is_closed(self) -> bool:
        """Whether each edge has two triangles, which are turned alike."""
        return self.mates is not None


def joined(mesh: SourceTriangles, origin: NDArray[np.float64], spacing: float) -> Joined:
    """Return a mesh in units of a grid, with equal points joined.

    Args:
        mesh: The mesh.
        origin: The point that becomes 0.
        spacing: The length that becomes 1.
    """
    points, which = welded(((mesh.points - origin) / spacing).astype(np.float32))
    triangles = which[mesh.triangles]
    a, b, c = triangles.T
    proper = (a != b) & (b != c) & (c != a)
    rows = None
    if not proper.all():
        triangles, rows = triangles[proper], np.flatnonzero(proper)
    corners = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    return Joined(points, triangles, corners, len(proper) - len(triangles), rows)


def topology(mesh: Joined) -> EdgeTopology:
    """Return whether a mesh is closed."""
    starts = mesh.triangles.reshape(-1)
    ends = mesh.triangles[:, [1, 2, 0]].reshape(-1)
    keys = np.minimum(starts, ends) * len(mesh.points) + np.maximum(starts, ends)
    order = np.argsort(keys)
    keys = keys[order]
    is_forward = (starts < ends)[order]
    begins = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    counts = np.diff(np.append(begins, len(keys)))
    pairs = begins[counts == 2]
    turned = int((is_forward[pairs] == is_forward[pairs + 1]).sum())
    mates = None
    if len(pairs) == len(begins) and not turned:
        mates = np.empty(len(keys), np.int64)
        mates[order[0::2]], mates[order[1::2]] = order[1::2], order[0::2]
    a, b, c = (corner.astype(np.float64) for corner in mesh.corners)
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
    open_edges, shared = int((counts == 1).sum()), int((counts > 2).sum())
    return EdgeTopology(open_edges, shared, turned, volume, mates)


def feature_normals(
    mesh: Joined, mates: NDArray[np.int64], asked: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Return the angle-weighted normals of the features of some triangles, (7 n, 3).

    They are the face, three edges (from each corner to the next one) and three corners. Normals of
    edges and corners have any length.

    Args:
        mesh: A closed mesh.
        mates: The other half of each edge.
        asked: The numbers of the triangles.

    Source: Baerentzen and Aanaes, Signed Distance Computation Using the Angle Weighted
    Pseudonormal, 2005.
    """
    near = np.zeros(len(mesh.points), bool)
    near[mesh.triangles[asked].reshape(-1)] = True
    a, b, c = mesh.triangles.T
    about = np.flatnonzero(near[a] | near[b] | near[c])
    corners = np.stack([corner[about] for corner in mesh.corners], axis=1).astype(np.float64)
    along = _unit(corners[:, [1, 2, 0]] - corners)
    face = _unit(np.cross(along[:, 0], along[:, 1]))
    angles = np.arccos(np.clip(-(along * along[:, [2, 0, 1]]).sum(axis=2), -1.0, 1.0))
    faces = np.zeros((len(mesh.triangles), 3))
    faces[about] = face
    places = mesh.triangles[about].reshape(-1)
    at_points = np.stack(
        [
            np.bincount(places, (angles * face[:, axis, None]).reshape(-1), len(mesh.points))
            for axis in range(3)
        ],
        axis=1,
    )
    edges = asked[:, None] * 3 + np.arange(3)
    normals = np.empty((len(asked), 7, 3), np.float32)
    normals[:, 0] = faces[asked]
    normals[:, 1:4] = faces[asked][:, None] + faces[mates[edges] // 3]
    normals[:, 4:7] = at_points[mesh.triangles[asked]]
    return normals.reshape(-1, 3)


def _unit(vectors: NDArray[np.float64]) -> NDArray[Any]:
    lengths = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return vectors / np.where(lengths > 0.0, lengths, 1.0)
