"""Reads OBJ: points, their colors, and polygons; materials and curves are left out.

Input: bytes. Output: a mesh.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.polygons.triangles import SourceTriangles, checked, colored, fans


def read_obj(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of an OBJ file, with colors of points if they are wanted and there.

    Raises:
        LoadError: A line is invalid; the message has its number.
    """
    points: list[list[float]] = []
    colors: list[list[float]] = []
    counts: list[int] = []
    indices: list[int] = []
    number = 0
    try:
        for number, line in enumerate(data.replace(b"\\\n", b" ").splitlines(), 1):
            if line.startswith((b"v ", b"v\t")):
                words = line.split()
                if len(words) < 4:
                    raise LoadError(f"line {number}: a point needs three numbers")
                points.append([float(word) for word in words[1:4]])
                if with_colors and len(words) == 7:  # with x, y, z: red, green, blue
                    colors.append([float(word) for word in words[4:7]])
            elif line.startswith((b"f ", b"f\t")):
                corners = [int(word.partition(b"/")[0]) for word in line.split()[1:]]
                if len(corners) < 3:
                    raise LoadError(f"line {number}: a polygon needs three points")
                counts.append(len(corners))
                # Positive ones count from 1; negative ones count back from the last point.
                indices += [_index(c, len(points), number) for c in corners]
    except (ValueError, OverflowError):
        raise LoadError(f"line {number} is not as in OBJ: {line[:40]!r}") from None
    if not counts:
        raise LoadError("there is no polygon")
    triangles = fans(np.array(counts, np.int64), np.array(indices, np.int64))
    mesh = checked(np.array(points, np.float64).reshape(-1, 3), triangles)
    if not colors or len(colors) != len(points):
        return mesh
    shown = np.array(colors, np.float32)
    return colored(mesh, np.clip(np.where(np.isfinite(shown), shown, 0.0), 0.0, 1.0))


def read_obj_points(data: bytes) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the points of an OBJ file and their normals: a vn for each v, in the same order.

    Raises:
        LoadError: A line is invalid; the message has its number.
    """
    found: dict[bytes, list[list[float]]] = {b"v": [], b"vn": []}
    for number, line in enumerate(data.splitlines(), 1):
        words = line.split()
        if not words or words[0] not in found:
            continue
        try:
            row = [float(word) for word in words[1:4]]
        except ValueError:
            raise LoadError(f"line {number} is not as in OBJ: {line[:40]!r}") from None
        if len(row) < 3:
            raise LoadError(f"line {number}: {words[0].decode()} needs three numbers")
        found[words[0]].append(row)
    points, normals = (np.array(found[name], np.float64).reshape(-1, 3) for name in (b"v", b"vn"))
    return points, normals


def _index(number: int, count: int, line: int) -> int:
    index = number - 1 if number > 0 else count + number
    if number == 0 or index < 0 or index >= 2**31:
        raise LoadError(f"line {line}: there is no point {number:.0f}")
    return index
