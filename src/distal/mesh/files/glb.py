"""GLB: glTF 2.0 in one file; meters, y up, linear colors, materials, several parts.

Input: parts. Output: bytes.

Source: glTF 2.0 Specification, Khronos.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from distal.file_writer import SaveError
from distal.mesh.files.parts import FilePart, Finish
from distal.mesh.files.shading import normals_with_edges

_FLOAT, _UINT, _USHORT = 5126, 5125, 5123
_VERTICES, _INDICES = 34962, 34963
_MOST_BYTES: Final = 2**32 - 1
_MOST_LEVELS: Final = 65535.0


@dataclass(slots=True)
class _Document:
    """The binary chunk, and the entries of the JSON that name its parts."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, rows: NDArray[Any], component: int, target: int, **more: Any) -> int:
        """Append an array and return the number of its accessor.

        Args:
            rows: The array; the rows of one of vertices are multiples of four bytes.
            component: The type of its numbers.
            target: What it is used for.
            more: Further entries of the accessor.
        """
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": rows.nbytes}
        if rows.ndim == 2 and rows.strides[0] != rows.shape[1] * rows.itemsize:
            raise AssertionError("rows are contiguous")
        self.views.append({**view, "target": target})
        self.data += rows.tobytes()
        self.data += bytes(-len(self.data) % 4)
        kind = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[1 if rows.ndim == 1 else rows.shape[1]]
        entry = {"bufferView": len(self.views) - 1, "componentType": component}
        self.accessors.append({**entry, "count": len(rows), "type": kind, **more})
        return len(self.accessors) - 1


def write_glb(file: BinaryIO, parts: Sequence[FilePart]) -> None:
    """Write each part as a node with a mesh and a material.

    Raises:
        SaveError: The file would be larger than the format allows.
    """
    document = _Document()
    meshes, nodes = [], []
    materials: list[dict[str, Any]] = []
    for index, part in enumerate(parts):
        name = part.name or f"part {index + 1}"
        primitives = []
        for piece in part.pieces():
            primitives.append({**_primitive(document, piece), "material": len(materials)})
            materials.append({"name": name, **_material(piece.whole_finish or Finish())})
        meshes.append({"name": name, "primitives": primitives})
        nodes.append({"name": name, "mesh": index})
    content: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "distal"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": document.accessors,
        "bufferViews": document.views,
        "buffers": [{"byteLength": len(document.data)}],
    }
    used = sorted({name for each in materials for name in each.get("extensions", ())})
    if used:
        content["extensionsUsed"] = used
    text = json.dumps(content, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(document.data)
    if total > _MOST_BYTES:
        raise SaveError("the mesh is larger than 4 GiB, which GLB cannot hold: save it as .ply")
    file.write(b"glTF" + _words(2, total) + _words(len(text)) + b"JSON" + text)
    file.write(_words(len(document.data)) + b"BIN\0")
    file.write(document.data)


def _primitive(document: _Document, part: FilePart) -> dict[str, Any]:
    points, normals, colors, triangles = _vertices(part)
    places = points.astype("<f4")
    low, high = places.min(axis=0).tolist(), places.max(axis=0).tolist()
    attributes = {"POSITION": document.add(places, _FLOAT, _VERTICES, min=low, max=high)}
    if normals is not None:
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        unit = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), (0, 1, 0))
        attributes["NORMAL"] = document.add(unit.astype("<f4"), _FLOAT, _VERTICES)
    if colors is not None:
        levels = np.rint(np.clip(colors, 0.0, 1.0) * _MOST_LEVELS).astype("<u2")
        opaque = np.full((len(levels), 1), 65535, "<u2")
        rows = np.ascontiguousarray(np.concatenate([levels, opaque], axis=1))
        attributes["COLOR_0"] = document.add(rows, _USHORT, _VERTICES, normalized=True)
    corners = np.ascontiguousarray(triangles.reshape(-1), "<u4")
    return {"attributes": attributes, "indices": document.add(corners, _UINT, _INDICES)}


def _vertices(
    part: FilePart,
) -> tuple[
    NDArray[np.float64],
    NDArray[np.float64] | None,
    NDArray[np.float64] | None,
    NDArray[np.int64],
]:
    """Return points, normals, linear colors and triangles.

    A point where two colors of triangles meet is written once for each color, and a point at an
    edge once for each side of it.
    """
    points, colors, triangles = np.arange(len(part.points)), part.colors, part.triangles
    if part.triangle_colors is not None:
        shades, which = np.unique(part.triangle_colors, axis=0, return_inverse=True)
        pairs = part.triangles * len(shades) + which.reshape(-1, 1)
        found, corners = np.unique(pairs, return_inverse=True)
        triangles = corners.reshape(-1, 3)
        points, of_colors = np.divmod(found, len(shades))
        colors = shades[of_colors]
    if part.normals is None:
        return part.points[points], None, colors, triangles
    normals, of = normals_with_edges(part.points, part.triangles, part.normals)
    if of is part.triangles:
        return part.points[points], normals[points], colors, triangles
    found, corners = np.unique(triangles * len(normals) + of, return_inverse=True)
    rows, of_normals = np.divmod(found, len(normals))
    colors = None if colors is None else colors[rows]
    return part.points[points[rows]], normals[of_normals], colors, corners.reshape(-1, 3)


def _material(finish: Finish) -> dict[str, Any]:
    """Return how a part reflects light; values are clamped to the ranges of glTF."""
    color = [min(max(float(c), 0.0), 1.0) for c in (*finish.color, finish.opacity)]
    surface = {
        "baseColorFactor": color,
        "metallicFactor": min(max(float(finish.metallic), 0.0), 1.0),
        "roughnessFactor": min(max(float(finish.roughness), 0.0), 1.0),
    }
    material: dict[str, Any] = {"pbrMetallicRoughness": surface}
    if finish.opacity < 1.0:
        material["alphaMode"] = "BLEND"
    if finish.transmission > 0.0:
        material["extensions"] = {
            "KHR_materials_ior": {"ior": max(float(finish.ior), 1.0)},
            "KHR_materials_transmission": {"transmissionFactor": min(finish.transmission, 1.0)},
        }
    if max(finish.emission) > 0.0:
        material["emissiveFactor"] = [min(max(float(c), 0.0), 1.0) for c in finish.emission]
    return material


def _words(*numbers: int) -> bytes:
    return b"".join(number.to_bytes(4, "little") for number in numbers)
