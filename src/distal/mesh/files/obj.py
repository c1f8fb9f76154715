"""OBJ: text; colors of points beside them, colors of triangles and finishes in an MTL file.

Input: parts. Output: text, and the text of the MTL file if there are materials.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from distal.file_writer import SaveError
from distal.mesh.files.parts import FilePart, display_codes
from distal.mesh.files.shading import normals_with_edges

_MOST_MATERIALS: Final = 1024


def write_obj(file: BinaryIO, parts: Sequence[FilePart], library: str) -> str | None:
    """Write the parts as groups; numbers of colors are display values from 0 to 1.

    Args:
        file: The file.
        parts: The parts.
        library: The name of the MTL file, beside this one.

    Returns:
        The text of the MTL file; None if no part needs one.

    Raises:
        SaveError: The triangles have too many colors for an MTL file.
    """
    materials: dict[tuple[int, ...], str] = {}
    texts: list[str] = []
    start = first_normal = 1
    for index, part in enumerate(parts):
        texts.append(f"o {part_name(part, index)}\n")
        texts.append(_points(part))
        order, groups = _groups(part, materials)
        corners = part.triangles[order] + start
        of_normals = None
        if part.normals is not None:
            normals, which = normals_with_edges(part.points, part.triangles, part.normals)
            texts.append(_lines("vn %.6g %.6g %.6g\n", normals))
            of_normals = which[order] + first_normal
            first_normal += len(normals)
        for name, first, last in groups:
            texts.append("" if name is None else f"usemtl {name}\n")
            turned = None if of_normals is None else of_normals[first:last]
            texts.append(_faces(corners[first:last], turned))
        start += len(part.points)
    head = "# millimeters, y up\n" + (f"mtllib {library}\n" if materials else "")
    file.write((head + "".join(texts)).encode())
    return _library(materials) if materials else None


def part_name(part: FilePart, index: int) -> str:
    """Return the name of a part as one word of printable ASCII, for formats that need that."""
    kept = "".join(c if c.isascii() and c.isalnum() else "_" for c in part.name)
    return kept if kept.strip("_") else f"part_{index + 1}"


def _points(part: FilePart) -> str:
    if part.triangle_colors is None and part.colors is not None:
        shown = display_codes(part.colors) / 255.0
        rows = np.concatenate([part.points, shown], axis=1)
        return _lines("v %.9g %.9g %.9g %.4g %.4g %.4g\n", rows)
    return _lines("v %.9g %.9g %.9g\n", part.points)


def _groups(
    part: FilePart, materials: dict[tuple[int, ...], str]
) -> tuple[NDArray[np.int64], list[tuple[str | None, int, int]]]:
    """Return an order of the triangles, and (material, first, last) for each run of a material."""
    count = len(part.triangles)
    if part.triangle_colors is None:
        name = None
        if part.whole_finish is not None:
            codes = display_codes(np.array([part.whole_finish.color]))
            name = _material(materials, tuple(codes[0].tolist()))
        return np.arange(count), [(name, 0, count)]
    found, which = np.unique(display_codes(part.triangle_colors), axis=0, return_inverse=True)
    which = which.reshape(-1)
    if len(found) + len(materials) > _MOST_MATERIALS:
        raise SaveError(
            f"the triangles have {len(found)} colors, and OBJ takes {_MOST_MATERIALS} materials: "
            "save fewer colors, or as .ply or .glb"
        )
    order = np.argsort(which, kind="stable")
    ends = np.cumsum(np.bincount(which, minlength=len(found))).tolist()
    names = [_material(materials, tuple(row)) for row in found.tolist()]
    return order, list(zip(names, [0, *ends], ends, strict=False))


def _material(materials: dict[tuple[int, ...], str], codes: tuple[int, ...]) -> str:
    return materials.setdefault(codes, "color_" + bytes(codes).hex())


def _library(materials: dict[tuple[int, ...], str]) -> str:
    lines = []
    for codes, name in materials.items():
        shown = " ".join(f"{code / 255.0:.4g}" for code in codes)
        lines.append(f"newmtl {name}\nKd {shown}\nillum 1\n")
    return "\n".join(lines)


def _faces(corners: NDArray[np.int64], normals: NDArray[np.int64] | None) -> str:
    if normals is None:
        return _lines("f %d %d %d\n", corners)
    return _lines("f %d//%d %d//%d %d//%d\n", np.stack([corners, normals], axis=2))


def _lines(pattern: str, rows: NDArray[Any]) -> str:
    """Return one line of text for each row."""
    return (pattern * len(rows)) % tuple(rows.reshape(-1).tolist())
