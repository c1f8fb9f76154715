"""The triangles of a mesh as a notebook shows them: few, rounded, packed.

Input: a mesh. Output: plain values for JSON, with the corners of triangles as bytes. Corners have
normals of their own where triangles meet at an edge. Does not depend on how they are drawn; the
other side of the format is ``web/src/mesh/unpacking.ts``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.deflating import deflated_text
from distal.mesh import preview_arithmetic
from distal.mesh.files.parts import FilePart, corner_codes, display_codes, part_of
from distal.mesh.files.shading import corner_normals

if TYPE_CHECKING:
    from distal.mesh.solid import Floats, Integers, Mesh

# About a megabyte in a notebook; larger meshes are shown with fewer triangles.
MOST_TRIANGLES: Final = 100_000
_PLACES: Final = 2**16 - 1
_NORMALS: Final = 2**7 - 1


@dataclass(frozen=True, slots=True)
class Preview:
    """What is shown of a mesh.

    Attributes:
        size: The size of its box, in scene units.
        triangles: How many triangles it has.
        shown: How many of them are shown.
        content: Plain values for the viewer.
    """

    size: tuple[float, float, float]
    triangles: int
    shown: int
    content: dict[str, Any]


def preview_of(mesh: Mesh, most: int = MOST_TRIANGLES) -> Preview | None:
    """Return what is shown of a mesh; None if it has no extent.

    Args:
        mesh: The mesh.
        most: How many triangles are shown at most.

    Raises:
        SaveError: It has no triangle, or a number that is not finite.
    """
    part = part_of(mesh)
    low, high = part.points.min(axis=0), part.points.max(axis=0)
    size = high - low
    side = float(size.max())
    if not side > 0.0:
        return None
    points = (part.points - low) / side
    triangles, of = fewer(points, part.triangles, most)
    if not len(triangles):
        return None
    normals = corner_normals(points, triangles, part.normals)
    rows, corners = _vertices(points[triangles], normals, _codes(part, triangles, of))
    content = {
        "size": (size / side).tolist(),
        "elevation": preview_arithmetic.ELEVATION,
        "points": len(rows),
        "triangles": len(corners),
        "data": _packed(rows, corners),
    }
    x, y, z = (float(length) for length in size)
    return Preview((x, y, z), len(part.triangles), len(triangles), content)


def fewer(points: Floats, triangles: Integers, most: int) -> tuple[Integers, Integers]:
    """Return at most so many triangles, and the numbers of those that they were.

    Points in one cell of a lattice become the first of them, and triangles without area are left
    out. The lattice is the finest one, of those tried, that leaves few enough.

    Args:
        points: Of shape (n, 3), from 0 to 1.
        triangles: Of shape (m, 3).
        most: How many may be left.
    """
    kept, of = triangles, np.arange(len(triangles))
    cells = 1024.0
    while len(kept) > most and cells >= 1.0:
        places = np.floor(points * cells).astype(np.int64)
        keys = (places[:, 0] * 2048 + places[:, 1]) * 2048 + places[:, 2]
        _, first, which = np.unique(keys, return_index=True, return_inverse=True)
        joined = first[which.reshape(-1)][triangles]
        a, b, c = joined.T
        of = np.flatnonzero((a != b) & (b != c) & (c != a))
        kept = joined[of]
        # Triangles of a surface are as many as the square of the cells along a side.
        cells *= min(0.9, 0.97 * (most / max(len(kept), 1)) ** 0.5)
    return kept, of


def _codes(part: FilePart, triangles: Integers, of: Integers) -> NDArray[np.uint8]:
    """Return the sRGB codes of each corner of the triangles that are shown."""
    shades = None if part.triangle_colors is None else part.triangle_colors[of]
    shown = FilePart(part.name, part.points, triangles, None, part.colors, shades)
    codes = corner_codes(shown)
    if codes is None:
        material = display_codes(np.array([preview_arithmetic.MATERIAL], np.float64))
        codes = np.broadcast_to(material, (len(triangles), 3, 3))
    return codes


def _vertices(
    places: Floats, normals: Floats, codes: NDArray[np.uint8]
) -> tuple[NDArray[np.void], Integers]:
    """Return each corner that differs once, in the order of use, and the corners of triangles."""
    kind = np.dtype([("place", "<u2", 3), ("normal", "i1", 3), ("code", "u1", 3)])
    rows = np.zeros(3 * len(places), kind)
    rows["place"] = np.rint(places.reshape(-1, 3) * _PLACES)
    rows["normal"] = np.rint(normals.reshape(-1, 3) * _NORMALS)
    rows["code"] = codes.reshape(-1, 3)
    keys = rows.view(f"V{kind.itemsize}")
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return rows[first[order]], rank[which.reshape(-1)].reshape(-1, 3)


def _packed(rows: NDArray[np.void], corners: Integers) -> str:
    """Return corners and triangles as differences, byte by byte, compressed, in base64."""
    columns = [rows[name][:, axis] for name in ("place", "normal", "code") for axis in range(3)]
    planes = b"".join(_planes(column) for column in columns)
    planes += _planes(corners.reshape(-1).astype("<u4"))
    return deflated_text(planes)


def _planes(column: NDArray[Any]) -> bytes:
    """Return the differences of whole numbers, modulo their range: all low bytes first."""
    width = column.dtype.itemsize
    plain = np.ascontiguousarray(column).view(f"<u{width}")
    changes = np.diff(plain, prepend=plain.dtype.type(0))
    return np.ascontiguousarray(changes.view(np.uint8).reshape(-1, width).T).tobytes()
