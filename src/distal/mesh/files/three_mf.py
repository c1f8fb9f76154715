"""3MF: a zip archive with a model in XML; millimeters, z up, colors as slicers read them.

Input: parts. Output: bytes, the same each time. Colors are written twice, because no one way is
read by all slicers: as color groups of 3MF's material extension (Bambu Studio, Orca Slicer), and as
the attribute of PrusaSlicer that numbers the filament of each triangle.

Source: 3MF Core Specification 1.3; Materials and Properties Extension 1.2; the serialization of
painted triangles in PrusaSlicer's TriangleSelector.
"""

from __future__ import annotations

import base64
import zipfile
import zlib
from collections.abc import Sequence
from io import BytesIO
from typing import Any, BinaryIO, Final
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from distal.lang.srgb import hex_of
from distal.mesh.files.parts import FilePart, corner_codes

_CORE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_MATERIALS: Final = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
_PRUSA: Final = "http://schemas.slic3r.org/3mf/2017/06"
_MODEL: Final = "3D/3dmodel.model"
_TYPES: Final = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS: Final = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    f'<Relationship Target="/{_MODEL}" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)
_DATE: Final = (1980, 1, 1, 0, 0, 0)  # the first that zip can store: the bytes are always the same
# PrusaSlicer numbers the filaments of painted triangles 1 to 16.
MOST_FILAMENTS: Final = 16
# Sizes of the entries of a zip archive without names, and where check sums stand in them.
_LOCAL_BYTES: Final = 30
_CENTRAL_BYTES: Final = 46
_END_BYTES: Final = 22
_SUM_IN_LOCAL: Final = 14
_SUM_IN_CENTRAL: Final = 16
# Stands where a page inserts texts; no name contains it.
_SPLIT: Final = "\0"


def write_three_mf(file: BinaryIO, parts: Sequence[FilePart]) -> None:
    """Write the parts as objects of one build."""
    _write(file, _model(parts))


def frame_of(name: str) -> dict[str, Any]:
    """Return what is the same in every file of one part, for pages that write the rest.

    They are the archive before and after the model's bytes, in base64; where the model's check sum
    and its two sizes stand in both; the model before colors, attributes, points and triangles and
    after them; and PrusaSlicer's attributes by filament.

    Args:
        name: The name of the part.
    """
    file = BytesIO()
    _write(file, "")
    archive = file.getvalue()
    with zipfile.ZipFile(file) as read:
        begin = read.getinfo(_MODEL).header_offset
    at = begin + _LOCAL_BYTES + len(_MODEL)
    tail = archive[at + len(zlib.compress(b"", wbits=-zlib.MAX_WBITS)) :]
    parts = _text(["".join([_SPLIT, _opening(name, 2), _SPLIT, *_around(_SPLIT, _SPLIT)])], [2])
    return {
        "head": base64.b64encode(archive[:at]).decode("ascii"),
        "tail": base64.b64encode(tail).decode("ascii"),
        "local": begin + _SUM_IN_LOCAL,
        "central": len(tail) - _END_BYTES - _CENTRAL_BYTES - len(_MODEL) + _SUM_IN_CENTRAL,
        "model": parts.split(_SPLIT),
        "paints": [_painted(number + 1) for number in range(MOST_FILAMENTS)],
    }


def _write(file: BinaryIO, model: str) -> None:
    contents = {"[Content_Types].xml": _TYPES, "_rels/.rels": _RELATIONS, _MODEL: model}
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in contents.items():
            entry = zipfile.ZipInfo(name, _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 0
            archive.writestr(entry, text.encode())


def _model(parts: Sequence[FilePart]) -> str:
    codes = [corner_codes(part) for part in parts]
    filaments = _filaments(codes)
    resources, numbers = [], []
    for index, (part, colors) in enumerate(zip(parts, codes, strict=True)):
        group, number = 2 * index + 1, 2 * index + 2
        resources.append(_object(part, colors, group, number, filaments))
        numbers.append(number)
    return _text(resources, numbers)


def _text(resources: Sequence[str], objects: Sequence[int]) -> str:
    """Return the text of a model.

    Args:
        resources: The texts of its objects.
        objects: Their numbers.
    """
    items = [f'<item objectid="{number}"/>' for number in objects]
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}" xmlns:m="{_MATERIALS}"'
        f' xmlns:slic3rpe="{_PRUSA}">\n'
        '<metadata name="Application">distal</metadata>\n'
        '<metadata name="slic3rpe:Version3mf">1</metadata>\n'
        '<metadata name="slic3rpe:MmPaintingVersion">1</metadata>\n'
        f"<resources>\n{''.join(resources)}</resources>\n<build>{''.join(items)}</build>\n</model>\n"
    )


def _object(
    part: FilePart,
    colors: NDArray[np.uint8] | None,
    group: int,
    number: int,
    filaments: dict[int, int],
) -> str:
    """Return the colors and the mesh of a part.

    Args:
        part: The part.
        colors: The codes of the corners of its triangles, or None.
        group: The number of its colors.
        number: The number of its object.
        filaments: PrusaSlicer's filament of each color; empty if there are too many colors.
    """
    attributes, palette = "", ""
    faces = _triangles(part.triangles)
    if colors is None and part.whole_finish is not None:
        palette = f'<basematerials id="{group}"><base name="1" displaycolor="'
        palette += f'{hex_of(part.whole_finish.color).upper()}"/></basematerials>\n'
        attributes = f' pid="{group}" pindex="0"'
    elif colors is not None:
        found, which = np.unique(_packed(colors), return_inverse=True)
        which = which.reshape(-1, 3)
        shades = "".join(f'<m:color color="#{code:06X}FF"/>' for code in found.tolist())
        palette = f'<m:colorgroup id="{group}">{shades}</m:colorgroup>\n'
        # The whole part's color, for slicers that know no other: that of most triangles.
        common = int(np.bincount(which[:, 0]).argmax())
        attributes = f' pid="{group}" pindex="{common}"'
        if len(found) > 1:
            faces = _colored(part.triangles, which, group, found, filaments)
    points = "".join(_rows('<vertex x="%.9g" y="%.9g" z="%.9g"/>\n', part.points))
    return "".join([palette, _opening(part.name, number), attributes, *_around(points, faces)])


def _opening(name: str, number: int) -> str:
    """Return the beginning of an object."""
    quoted = quoteattr(_printable(name) or f"part {number // 2}")
    return f'<object id="{number}" name={quoted} type="model"'


def _around(points: str, faces: str) -> tuple[str, ...]:
    """Return the points and the triangles of an object, and what stands around them."""
    return (
        ">\n<mesh>\n<vertices>\n",
        points,
        "</vertices>\n<triangles>\n",
        faces,
        "</triangles>\n</mesh>\n</object>\n",
    )


def _triangles(triangles: NDArray[np.int64]) -> str:
    return _rows('<triangle v1="%d" v2="%d" v3="%d"/>\n', triangles)


def _colored(
    triangles: NDArray[np.int64],
    which: NDArray[np.intp],
    group: int,
    found: NDArray[np.int64],
    filaments: dict[int, int],
) -> str:
    """Return triangles with a color for each corner, or one for all three."""
    one = (which == which[:, :1]).all(axis=1)
    paints = [""] * len(found)
    if filaments:
        paints = [_painted(filaments[code]) for code in found.tolist()]
    lines = []
    for corners, shades, same in zip(triangles.tolist(), which.tolist(), one.tolist(), strict=True):
        first, second, third = corners
        a, b, c = shades
        several = "" if same else f' p2="{b}" p3="{c}"'
        paint = paints[a] if same else ""
        lines.append(
            f'<triangle v1="{first}" v2="{second}" v3="{third}" pid="{group}" p1="{a}"'
            f"{several}{paint}/>\n"
        )
    return "".join(lines)


def _filaments(codes: Sequence[NDArray[np.uint8] | None]) -> dict[int, int]:
    """Return the number of a filament for each color, the most frequent first.

    Empty if there are more colors than filaments.
    """
    known = [_packed(colors).reshape(-1) for colors in codes if colors is not None]
    if not known:
        return {}
    found, counts = np.unique(np.concatenate(known), return_counts=True)
    if not 1 < len(found) <= MOST_FILAMENTS:
        return {}
    order = np.argsort(-counts, kind="stable")
    return {int(found[at]): place + 1 for place, at in enumerate(order)}


def _painted(filament: int) -> str:
    """Return PrusaSlicer's attribute of a triangle that is not divided.

    The last digit has the state in its upper two bits and the number of divisions, 0, in the lower
    ones. States from 3 on are 3 there, and the rest is in a digit before it.
    """
    text = f"{filament << 2:X}" if filament < 3 else f"{filament - 3:X}C"
    return f' slic3rpe:mmu_segmentation="{text}"'


def _packed(codes: NDArray[np.uint8]) -> NDArray[np.int64]:
    wide = codes.astype(np.int64)
    return wide[..., 0] << 16 | wide[..., 1] << 8 | wide[..., 2]


def _printable(text: str) -> str:
    """Return a text without characters that XML cannot contain."""
    return "".join(c for c in text if c.isprintable() and not "\ud800" <= c <= "\udfff")


def _rows(pattern: str, rows: NDArray[Any]) -> str:
    return (pattern * len(rows)) % tuple(rows.reshape(-1).tolist())
