"""Fewer triangles: flat faces as flat faces, and points that the tolerance can spare.

Input: a closed mesh and its shape. Output: triangles between some of its points, checked: where
triangles would intersect, in 64 or in 32 bits, or miss the surface, a face keeps its triangles, and
points stay. The same points are spared every time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from distal.mesh import collapse_arithmetic, triangle_arithmetic
from distal.mesh.checks import meeting_triangles
from distal.mesh.collapses import Collapsing, collapsed, pieces_of
from distal.mesh.face_groups import face_groups
from distal.mesh.flat_faces import without_spare_points
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.moves import take_back
from distal.mesh.parallel import by_one_thread
from distal.mesh.pieces import PieceDistances, distances
from distal.mesh.solid import Bools, Floats, Integers

# Corners of a flat face are this close to its plane, as a share of the mesh's size: sixteen
# roundings of 32 bits.
_FLAT: Final = 1e-6
_MOST_REPEATS: Final = 16
# In the end triangles are measured in up to so many pieces along each side.
_MOST_PIECES: Final = 16
# The least share of the normals around a corner in each direction; that of a cube has a third.
_CORNER: Final = 0.1
# So many triangles are handled in one thread: each round would start others for few rows.
_FEW: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class Spared:
    """A mesh with fewer triangles.

    Attributes:
        points: Which points of the mesh are left, in order.
        triangles: Of shape (n, 3): indices of these points.
        largest: The largest distance to the surface of triangles that moved; 0 without any.
        mean: The mean of their distances.
        place: Where the largest one is.
        moved: How many triangles moved.
        away: The largest distance of a point that was spared on a curved face to the mesh.
    """

    points: Integers
    triangles: Integers
    largest: float = 0.0
    mean: float = 0.0
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    moved: int = 0
    away: float = 0.0

    def record(self, report: dict[str, Any]) -> None:
        """Change the report of a mesh to what it says about this one.

        Distances are the largest ones, before and now: what did not move was not measured again.

        Args:
            report: The report of ``Shape.mesh``.
        """
        error, before = report["error"], report["triangles"]
        report["triangles_before"] = before
        report["points"], report["triangles"] = len(self.points), len(self.triangles)
        if self.moved:
            count = before + self.moved
            error["mean"] = (before * error["mean"] + self.moved * self.mean) / count
        if self.largest > error["mesh_to_surface"]:
            error["mesh_to_surface"], error["place"] = self.largest, list(self.place)
        error["surface_to_mesh"] = max(error["surface_to_mesh"], self.away)
        error["largest"] = max(error["mesh_to_surface"], error["surface_to_mesh"])


def with_fewer_triangles(
    kernels: FieldKernels,
    points: Floats,
    triangles: Integers,
    labels: Integers | None,
    *,
    tolerance: float,
    angle: float,
    step: float,
    watch: Callable[[float], None],
) -> Spared:
    """Return a mesh with fewer triangles and, but for the tolerance, the same surface.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        labels: Triangles with different numbers keep the border between them; those below 0 keep
            their points. None for all the same.
        tolerance: How far mesh and surface may be apart where faces are curved.
        angle: How much the surface may turn within a triangle, in radians; infinite for any angle.
        step: The length of a cell.
        watch: Called now and then.
    """

    def spared() -> Spared:
        rows = _with_flat_faces(points, triangles, labels, watch)
        fixed = _at_borders(triangles, labels, len(points)) | _at_corners(points, rows)
        mesh = Collapsing.of(kernels, points, rows, ~fixed, tolerance, angle, step)
        return _numbered(_without_points(mesh, watch))

    return by_one_thread(spared) if len(triangles) <= _FEW else spared()


def _without_points(mesh: Collapsing, watch: Callable[[float], None]) -> Spared:
    """Return triangles without the points of curved faces that the tolerance can spare.

    Where triangles are too far away, or intersect, the last moves around them are taken back.

    Args:
        mesh: The mesh; changed in place.
        watch: Called now and then.
    """
    first = mesh.triangles.copy()
    collapsed(mesh, watch)
    looked_at = np.ones(len(first), np.bool_)
    for number in range(_MOST_REPEATS):
        bad = _bad(mesh, first, looked_at, watch)
        if not len(bad):
            return _measured(mesh, first)
        looked_at = take_back(mesh, bad, number + 1)
    return Spared(np.empty(0, np.int64), first)


def _bad(
    mesh: Collapsing, first: Integers, looked_at: Bools, watch: Callable[[float], None]
) -> Integers:
    """Return the triangles that are too far from the surface, or intersect others.

    Args:
        mesh: The mesh.
        first: The triangles of the first mesh: these are close enough.
        looked_at: The triangles that are looked at.
        watch: Called now and then.
    """
    left = np.flatnonzero(mesh.is_left)
    meeting = meeting_triangles(mesh.points, mesh.triangles[left], looked_at[left], watch)
    moved = left[looked_at[left] & (mesh.triangles[left] != first[left]).any(axis=1)]
    far = moved[_distances(mesh, moved).largest > mesh.tolerance] if len(moved) else moved
    return np.union1d(left[meeting], far)


def _distances(mesh: Collapsing, rows: Integers) -> PieceDistances:
    """Return how far some triangles are from the surface, more exactly than while points move."""
    triangles = mesh.triangles[rows]
    counts = pieces_of(mesh.points, triangles, 0.5 * mesh.step, _MOST_PIECES)
    return distances(mesh.kernels, mesh.points, triangles, counts)


def _with_flat_faces(
    points: Floats, triangles: Integers, labels: Integers | None, watch: Callable[[float], None]
) -> Integers:
    """Return triangles without spare points in flat faces."""
    close = _FLAT * float(np.ptp(points, axis=0).max())
    groups = face_groups(points, triangles, labels, close)
    for _ in range(_MOST_REPEATS):
        rows, of = without_spare_points(points, triangles, groups, close)
        bad = meeting_triangles(points, rows, of >= 0, watch, of)
        faces = np.unique(of[bad])
        if not len(faces):
            return rows
        kept = np.where(np.isin(groups.of, faces), -1, groups.of)
        groups = replace(groups, of=kept)
    return triangles


def _at_borders(triangles: Integers, labels: Integers | None, count: int) -> Bools:
    """Return which points have triangles with different labels, or with one below 0."""
    fixed = np.zeros(count, np.bool_)
    if labels is None:
        return fixed
    corners, of = triangles.reshape(-1), np.repeat(labels, 3)
    lowest = np.full(count, int(labels.max(initial=0)))
    highest = np.full(count, -1)
    np.minimum.at(lowest, corners, of)
    np.maximum.at(highest, corners, of)
    fixed[corners] = (lowest[corners] < highest[corners]) | (lowest[corners] < 0)
    return fixed


def _at_corners(points: Floats, triangles: Integers) -> Bools:
    """Return which points are corners: the normals around them go in three directions.

    They are the sizes of a part: the tolerance must not cut them.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
    """
    corners = points[triangles]
    _, normals = rows_of(triangle_arithmetic.face, *(corners[:, i] for i in range(3)))
    squares = normals[:, :, None] * normals[:, None, :]
    sums = np.zeros((len(points), 3, 3))
    for i in range(3):
        ways = np.roll(corners, -i, axis=1)
        angle = rows_of(collapse_arithmetic.angle, *(ways[:, k] for k in range(3)))
        for row, column in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            part = np.bincount(triangles[:, i], angle * squares[:, row, column], len(points))
            sums[:, row, column] += part
            if row != column:
                sums[:, column, row] += part
    shares = np.linalg.eigvalsh(sums)
    found: Bools = shares[:, 0] > _CORNER * shares.sum(axis=1)
    return found


def _measured(mesh: Collapsing, first: Integers) -> Spared:
    """Return the triangles that are left, and the distances of those that moved."""
    left = mesh.triangles[mesh.is_left]
    found = Spared(np.empty(0, np.int64), left, away=float(mesh.away.max(initial=0.0)))
    moved = np.flatnonzero(mesh.is_left & (mesh.triangles != first).any(axis=1))
    if not len(moved):
        return found
    given = _distances(mesh, moved)
    largest = float(given.largest.max())
    return replace(found, largest=largest, mean=given.mean, place=given.place, moved=len(moved))


def _numbered(found: Spared) -> Spared:
    """Return the mesh with the points that its triangles need."""
    points, corners = np.unique(found.triangles, return_inverse=True)
    return replace(found, points=points, triangles=corners.reshape(-1, 3))
