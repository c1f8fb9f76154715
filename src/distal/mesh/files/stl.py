"""Binary STL: triangles without colors, names or a unit; programs read it as millimeters, z up.

Input: parts. Output: bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO, Final

import numpy as np

from distal.file_writer import SaveError
from distal.mesh.files.parts import FilePart

# The text must not begin with "solid", by which readers recognize the other kind of STL.
HEADER: Final = b"binary STL, millimeters, z up".ljust(80)
_RECORD: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
_MOST: Final = 2**32 - 1


def write_stl(file: BinaryIO, parts: Sequence[FilePart]) -> None:
    """Write the triangles of all parts.

    Raises:
        SaveError: There are more triangles than the format can count.
    """
    count = sum(len(part.triangles) for part in parts)
    if count > _MOST:
        raise SaveError(f"{count} triangles are more than STL can count")
    file.write(HEADER + count.to_bytes(4, "little"))
    for part in parts:
        corners = part.points.astype(np.float32)[part.triangles]
        edges = corners[:, 1:].astype(np.float64) - corners[:, :1]
        normals = np.cross(edges[:, 0], edges[:, 1])
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        records = np.zeros(len(corners), _RECORD)
        records["normal"] = normals / np.where(lengths > 0.0, lengths, 1.0)
        records["corners"] = corners
        file.write(records.tobytes())
