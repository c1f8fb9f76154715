"""Reads OBJ: points and polygons; materials, curves and normals are left out.

Input: bytes. Output: a mesh.
"""

from __future__ import annotations

import numpy as np

from distal.diagnostics import LoadError
from distal.polygons.triangles import SourceTriangles, checked, fans


def read_obj(data: bytes) -> SourceTriangles:
    """Return the triangles of an OBJ file.

    Raises:
        LoadError: A line is invalid; the message has its number.
    """
    points: list[list[float]] = []
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
    return checked(np.array(points, np.float64).reshape(-1, 3), triangles)


def _index(number: int, count: int, line: int) -> int:
    index = number - 1 if number > 0 else count + number
    if number == 0 or index < 0 or index >= 2**31:
        raise LoadError(f"line {line}: there is no point {number:.0f}")
    return index
