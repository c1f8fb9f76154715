"""Binary PLY: points and triangles, with colors of points or of triangles.

Input: parts. Output: bytes, little endian.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from distal.mesh.files.parts import Part, display_codes

_TYPES: Final = {"<f4": "float", "u1": "uchar"}
_COLORS: Final = ("red", "green", "blue")


def write_ply(file: BinaryIO, parts: Sequence[Part]) -> None:
    """Write all parts as one mesh; colors are sRGB codes.

    The triangles have colors if each part has colors of triangles; else the points, if each part
    has those; else nothing has colors. Normals are written if each part has them.
    """
    starts = np.cumsum([0, *(len(part.points) for part in parts)])
    columns = [("<f4", name) for name in "xyz"]
    values: list[NDArray[Any]] = [_joined([part.points for part in parts])]
    normals = _all_of([part.normals for part in parts])
    if normals is not None:
        columns += [("<f4", name) for name in ("nx", "ny", "nz")]
        values.append(normals)
    of_triangles = _all_of([part.triangle_colors for part in parts])
    of_points = None if of_triangles is not None else _all_of([part.colors for part in parts])
    if of_points is not None:
        columns += [("u1", name) for name in _COLORS]
        values.append(display_codes(of_points))
    points = _rows(columns, np.concatenate(values, axis=1))
    triangles = _joined(
        [part.triangles + start for part, start in zip(parts, starts, strict=False)]
    )
    fields: list[Any] = [("count", "u1"), ("corners", "<i4", 3)]
    if of_triangles is not None:
        fields += [(name, "u1") for name in _COLORS]
    faces = np.zeros(len(triangles), np.dtype(fields))
    faces["count"], faces["corners"] = 3, triangles
    if of_triangles is not None:
        for name, channel in zip(_COLORS, display_codes(of_triangles).T, strict=True):
            faces[name] = channel
    header = ["ply", "format binary_little_endian 1.0", "comment millimeters, y up"]
    header += [f"element vertex {len(points)}"]
    header += [f"property {_TYPES[type]} {name}" for type, name in columns]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
    header += [f"property uchar {name}" for name in _COLORS if of_triangles is not None]
    file.write("\n".join([*header, "end_header\n"]).encode())
    file.write(points.tobytes() + faces.tobytes())


def _rows(columns: Sequence[tuple[str, str]], values: NDArray[Any]) -> NDArray[Any]:
    rows = np.zeros(len(values), np.dtype([(name, type) for type, name in columns]))
    for (_, name), column in zip(columns, values.T, strict=True):
        rows[name] = column
    return rows


def _joined(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    return np.concatenate(arrays)


def _all_of(arrays: Sequence[NDArray[Any] | None]) -> NDArray[Any] | None:
    """Return the rows of all arrays; None if one is missing."""
    known = [array for array in arrays if array is not None]
    return _joined(known) if len(known) == len(arrays) else None
