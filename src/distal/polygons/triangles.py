"""``SourceTriangles``: the points and triangles that a file contains, or an author gives.

Input: arrays. Output: checked arrays; equal points joined. Does not depend on files.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import need

# The most triangles of a mesh: 240 MB of indices, and minutes of work.
MOST_TRIANGLES: Final = 10_000_000
# Bytes that each costs at the peak of an import: its arrays while it is read, joined, and looked up
# in a grid; and what a part costs beside them.
POINT_BYTES: Final = 160
TRIANGLE_BYTES: Final = 440
PART_BYTES: Final = 4096
_LARGEST: Final = 1e15  # the squares of lengths stay far from the largest single float
_HASH: Final = np.array((0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9), np.uint64)


@dataclass(frozen=True, slots=True, eq=False)
class SourceTriangles:
    """A mesh of triangles.

    Attributes:
        points: (n, 3) float64.
        triangles: (m, 3) int64, indices of points.
        meters: The length of the unit of the points in meters; None if nothing says it.
        colors: A color for each point, (n, 3) float32, or None. Points of triangles whose colors
            differ are not shared.
        is_light: Whether colors are linear light; else they are display values, from 0 to 1.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    meters: float | None = None
    colors: NDArray[np.float32] | None = None
    is_light: bool = False


@dataclass(slots=True)
class MeshSize:
    """Counts of a mesh that is put together of parts, checked before the parts are copied."""

    points: int = 0
    triangles: int = 0
    parts: int = 1

    def add(self, other: MeshSize) -> None:
        """Add the counts of a part."""
        self.points += other.points
        self.triangles += other.triangles
        self.parts += other.parts

    def check(self, what: str | None = None) -> None:
        """Check the counts.

        Args:
            what: What they are of, in words.

        Raises:
            LoadError: They are more than the file may become, or than a mesh has.
        """
        counts = f"{self.triangles:,} triangles and {self.points:,} points"
        if self.parts > 1:
            counts = f"{counts} in {self.parts:,} parts"
        if self.triangles > MOST_TRIANGLES:
            raise LoadError(
                f"it has {what or counts}, and a mesh has at most {MOST_TRIANGLES:,} triangles: "
                "leave some out"
            )
        size = self.points * POINT_BYTES + self.triangles * TRIANGLE_BYTES
        need(size + self.parts * PART_BYTES, what or counts)


def checked(points: Any, triangles: Any, meters: float | None = None) -> SourceTriangles:
    """Return a mesh from arrays.

    Args:
        points: (n, 3) numbers.
        triangles: (m, 3) indices of points.
        meters: The length of the unit of the points in meters; None if nothing says it.

    Raises:
        LoadError: An array has another shape, there is no triangle, or a number is invalid.
    """
    places = checked_places(points, "points")
    corners = _array(triangles, "triangles", "iu")
    if not len(corners):
        raise LoadError("there is no triangle")
    MeshSize(len(places), len(corners)).check()
    low, high = int(corners.min()), int(corners.max())
    if low < 0 or high >= len(places):
        wrong = low if low < 0 else high
        raise LoadError(f"a triangle names point {wrong}, and there are {len(places)} points")
    return SourceTriangles(places, corners.astype(np.int64), meters)


def checked_places(values: Any, name: str) -> NDArray[np.float64]:
    """Return an array (n, 3) of finite numbers.

    Args:
        values: The numbers.
        name: What they are: "points", "normals".

    Raises:
        LoadError: They have another shape, or one of them is invalid.
    """
    places = _array(values, name, "fiu").astype(np.float64)
    wrong_rows = np.flatnonzero(~(np.abs(places) <= _LARGEST).all(axis=1))
    if len(wrong_rows):
        row = ", ".join(f"{value:g}" for value in places[wrong_rows[0]])
        what = "place" if name == "points" else "direction"
        raise LoadError(f"{name[:-1]} {wrong_rows[0]} is ({row}), which is no {what}")
    return places


def colored(
    mesh: SourceTriangles, colors: Any, *, of: str = "points", is_light: bool = False
) -> SourceTriangles:
    """Return a mesh with colors.

    Args:
        mesh: The mesh.
        colors: (n, 3) for points, (m, 3) for triangles, (m, 3, 3) for their corners.
        of: What has colors: "points", "triangles" or "corners".
        is_light: Whether they are linear light.

    Raises:
        LoadError: There are not as many, or one is no color.
    """
    count = len(mesh.points) if of == "points" else len(mesh.triangles)
    if of != "points":
        MeshSize(3 * count, count).check()
    try:
        found = np.asarray(colors, np.float32)
    except (TypeError, ValueError):
        raise LoadError("colors are numbers (n, 3), one color for each point") from None
    if found.shape != ((count, 3, 3) if of == "corners" else (count, 3)):
        raise LoadError(f"there are {count} {of}, and colors are {found.shape}")
    wrong = np.flatnonzero(~((found >= 0.0) & (found <= 1.0)).reshape(count, -1).all(axis=1))
    if len(wrong):
        raise LoadError(f"color {wrong[0]} is no color: its numbers are from 0 to 1")
    if of == "points":
        return replace(mesh, colors=found, is_light=is_light)
    if of == "triangles":
        found = np.repeat(found[:, None], 3, axis=1)
    return replace(
        mesh,
        points=mesh.points[mesh.triangles.reshape(-1)],
        triangles=np.arange(3 * count).reshape(-1, 3),
        colors=found.reshape(-1, 3),
        is_light=is_light,
    )


def welded(places: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Return points of which no two are equal, and the number of the point at each place.

    Args:
        places: (n, 3).
    """
    with np.errstate(invalid="ignore"):  # ``checked`` finds what is no number
        rows = np.ascontiguousarray(places) + np.float32(0.0)  # -0 becomes 0
    bits = rows.view(np.uint32).astype(np.uint64)
    keys = bits[:, 0] * _HASH[0] ^ bits[:, 1] * _HASH[1] ^ bits[:, 2] * _HASH[2]
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    points = rows[first]
    if not np.array_equal(points[which], rows, equal_nan=True):  # two points had one key
        points, which = np.unique(rows, axis=0, return_inverse=True)
    return points, which.reshape(-1).astype(np.int64)


def _array(values: Any, name: str, kinds: str) -> NDArray[Any]:
    try:
        array = np.asarray(values)
    except ValueError:
        raise LoadError(f"{name} are an array (n, 3), not rows of different lengths") from None
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in kinds:
        what = "numbers" if "f" in kinds else "integers"
        raise LoadError(f"{name} are {what} (n, 3), not {array.dtype} {array.shape}")
    return array
