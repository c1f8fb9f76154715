"""Reads STL: binary and text.

Input: bytes. Output: a mesh whose equal corners are joined.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.polygons.triangles import SourceTriangles, checked, welded

_HEADER: Final = 84
_RECORD: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
# Blanks, but not the end of a line: many empty lines would each be tried with all that follow.
_VERTEX: Final = re.compile(
    rb"^[^\S\n]*vertex[^\S\n]+(\S+)[^\S\n]+(\S+)[^\S\n]+(\S+)[^\S\n]*$", re.MULTILINE | re.I
)


def read_stl(data: bytes) -> SourceTriangles:
    """Return the triangles of an STL file.

    Raises:
        LoadError: The file is no STL, or is truncated.
    """
    count = int.from_bytes(data[80:84], "little") if len(data) >= _HEADER else 0
    size = _HEADER + count * _RECORD.itemsize
    # Some programs begin binary files with "solid" too, so the size decides first.
    is_text = data[:5].lower() == b"solid" and len(data) != size
    if is_text and b"facet" in data[:1024].lower():
        return _text(data)
    if len(data) < _HEADER:
        raise LoadError("it is neither binary STL, which has 84 bytes or more, nor text")
    if len(data) < size:
        there = (len(data) - _HEADER) // _RECORD.itemsize
        raise LoadError(f"it announces {count} triangles and contains {there}: it is truncated")
    if count == 0:
        raise LoadError("there is no triangle")
    return _mesh(np.frombuffer(data, _RECORD, count, _HEADER)["corners"])


def _text(data: bytes) -> SourceTriangles:
    numbers = _VERTEX.findall(data)
    if len(numbers) % 3 or b"endsolid" not in data[-1024:].lower():
        raise LoadError(f"it ends after {len(numbers)} corners: it is truncated")
    if not numbers:
        raise LoadError("there is no triangle")
    try:
        values = [float(word) for row in numbers for word in row]
    except ValueError:
        raise LoadError("a corner is not three numbers") from None
    with np.errstate(over="ignore"):  # ``checked`` finds what is not finite
        corners = np.array(values).astype(np.float32)
    return _mesh(corners)


def _mesh(corners: NDArray[np.float32]) -> SourceTriangles:
    points, which = welded(corners.reshape(-1, 3))
    return checked(points, which.reshape(-1, 3))
