"""Points with normals: their files and arrays.

Input: a PLY, OBJ or XYZ file, or two arrays. Output: points and unit normals.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import Memory, opened
from distal.polygons.obj import read_obj_points
from distal.polygons.ply import read_ply_points
from distal.polygons.triangles import checked_places

MOST_POINTS: Final = 10_000_000
FEWEST_POINTS: Final = 10


@dataclass(frozen=True, slots=True, eq=False)
class SourcePoints:
    """Points on a surface.

    Attributes:
        points: (n, 3) float64.
        normals: (n, 3) float64, of length 1, outward.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]


def read_points(path: Path, max_memory: Memory | None = None) -> SourcePoints:
    """Return the points of a file, in its own unit and axes.

    Args:
        path: The file.
        max_memory: The most bytes that it may become; None: by its size.

    Raises:
        LoadError: The file cannot be read, is not what its suffix says, or has no normals.
    """
    read = POINT_FORMATS.get(path.suffix.lower())
    if read is None:
        known = ", ".join(POINT_FORMATS)
        message = f"cannot read '{printable(path)}': points with normals are in one of {known}"
        raise LoadError(message)
    with opened("points", path, max_memory=max_memory, option=True) as data:
        return checked_points(*read(data))


def checked_points(points: Any, normals: Any) -> SourcePoints:
    """Return points from arrays.

    Raises:
        LoadError: An array has another shape, there are too few points, or a number is invalid.
    """
    places, given = checked_places(points, "points"), checked_places(normals, "normals")
    if len(places) != len(given):
        raise LoadError(f"there are {len(places)} points and {len(given)} normals")
    if len(places) < FEWEST_POINTS:
        raise LoadError(f"{len(places)} points are too few: give {FEWEST_POINTS} or more")
    if len(places) > MOST_POINTS:
        raise LoadError(f"{len(places)} points are more than {MOST_POINTS}")
    lengths = np.linalg.norm(given, axis=1)
    wrong = np.flatnonzero(~(lengths > 0.0))
    if len(wrong):
        raise LoadError(f"normal {wrong[0]} is zero: leave the point out, or give it a direction")
    return SourcePoints(places, given / lengths[:, None])


def read_xyz(data: bytes) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the points and normals of a text: x, y, z and the normal in each line.

    Raises:
        LoadError: A line is invalid; the message has its number.
    """
    rows: list[list[float]] = []
    for number, line in enumerate(data.splitlines(), 1):
        words = line.replace(b",", b" ").split()
        if not words or words[0].startswith((b"#", b"//")):
            continue
        try:
            row = [float(word) for word in words[:6]]
        except ValueError:
            raise LoadError(f"line {number} has no numbers: {line[:40]!r}") from None
        if len(row) < 6:
            raise LoadError(f"line {number} has {len(row)} numbers: x, y, z and a normal are 6")
        rows.append(row)
    found = np.array(rows, np.float64).reshape(-1, 6)
    return found[:, :3], found[:, 3:]


POINT_FORMATS: Final[dict[str, Callable[[bytes], tuple[NDArray[Any], NDArray[Any]]]]] = {
    ".ply": read_ply_points,
    ".obj": read_obj_points,
    ".xyz": read_xyz,
}
