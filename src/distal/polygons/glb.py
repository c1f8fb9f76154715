"""Reads GLB: the triangles of all nodes of glTF 2.0 in one file, in the place of their node.

Input: bytes. Output: a mesh in meters.

Source: glTF 2.0 Specification, Khronos.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import check_time
from distal.polygons.triangles import MeshSize, SourceTriangles, checked, colored

_COMPONENTS: Final = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS: Final = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
# What a number of a color is divided by.
_LEVELS: Final = {5121: 255.0, 5123: 65535.0, 5126: 1.0}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSED: Final = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")


@dataclass(frozen=True, slots=True)
class _File:
    """The two chunks of a file."""

    content: dict[str, Any]
    data: bytes


@dataclass(frozen=True, slots=True, eq=False)
class _GlbPart:
    """A primitive that has triangles: its points, corners and colors, or None for no colors."""

    points: NDArray[np.float64]
    corners: NDArray[np.int64]
    colors: NDArray[np.float32] | None


class _Meshes:
    """The meshes of a file, each parsed once.

    Primitives may share what an accessor holds, and nodes may share meshes, so all are counted
    before they are copied.
    """

    def __init__(self, file: _File, *, with_colors: bool) -> None:
        self._file, self._with_colors = file, with_colors
        self._parts: dict[int, list[_GlbPart]] = {}
        self._sizes: dict[int, MeshSize] = {}
        self._all = MeshSize()

    def parts(self, number: Any) -> list[_GlbPart]:
        """Return the parts of a mesh that have triangles."""
        entry = _entry(self._file.content, "meshes", number)
        if number not in self._parts:
            read = (self._part(each) for each in _list(entry, "primitives"))
            parts = self._parts[number] = [part for part in read if part is not None]
            size = self._sizes[number] = MeshSize(parts=0)
            for part in parts:
                size.add(MeshSize(len(part.points), len(part.corners)))
        return self._parts[number]

    def size(self, number: Any) -> MeshSize:
        """Return the size of a mesh."""
        self.parts(number)
        return self._sizes[number]

    def _part(self, primitive: Any) -> _GlbPart | None:
        check_time()
        shape = _primitive(self._file, primitive, self._all)
        if shape is None or not len(shape[1]):
            return None
        points, corners = shape
        count = len(points)
        colors = _colors(self._file, primitive, count) if self._with_colors else None
        return _GlbPart(points, corners, colors)


def read_glb(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of a GLB file, with colors if they are wanted and there.

    Raises:
        LoadError: The file is no GLB, is truncated, or is compressed.
    """
    file = _chunks(data)
    for name in _list(file.content, "extensionsRequired"):
        if name in _COMPRESSED:
            raise LoadError(f"it is compressed by {name}: save it without compression")
    meshes = _Meshes(file, with_colors=with_colors)
    placed = list(_placed(file))
    total = MeshSize()
    for number, _ in placed:
        total.add(meshes.size(number))
    numbers = {number for number, _ in placed}
    first = meshes.size(placed[0][0]) if placed else total
    is_copied = len(numbers) == 1 < len(placed)
    total.check(f"{len(placed):,} copies of {first.triangles:,} triangles" if is_copied else None)
    copies = [(part, matrix) for number, matrix in placed for part in meshes.parts(number)]
    if not copies:
        raise LoadError("there is no triangle")
    return _copied(copies)


def _copied(copies: list[tuple[_GlbPart, NDArray[np.float64]]]) -> SourceTriangles:
    """Return the mesh of all copies, each placed by its matrix."""
    points: list[NDArray[np.float64]] = []
    triangles: list[NDArray[np.int64]] = []
    start = 0
    for part, matrix in copies:
        with np.errstate(all="ignore"):  # ``checked`` finds what is not finite
            points.append(part.points @ matrix[:3, :3].T + matrix[:3, 3])
        # A node that mirrors its mesh turns the triangles around.
        mirrored = float(np.linalg.det(matrix[:3, :3])) < 0.0
        triangles.append(start + (part.corners[:, ::-1] if mirrored else part.corners))
        start += len(part.points)
    mesh = checked(np.concatenate(points), np.concatenate(triangles), 1.0)
    if all(part.colors is None for part, _ in copies):
        return mesh
    # A part without a color is white, as glTF has it.
    shades = [
        np.ones((len(part.points), 3), np.float32) if part.colors is None else part.colors
        for part, _ in copies
    ]
    return colored(mesh, np.concatenate(shades), is_light=True)


def _colors(file: _File, primitive: Any, count: int) -> NDArray[np.float32] | None:
    """Return the linear colors of a primitive's points; None without them.

    They are those of its points times that of its material; pictures are left out.
    """
    number = primitive["attributes"].get("COLOR_0")
    known = "material" in primitive
    material = _entry(file.content, "materials", primitive["material"]) if known else {}
    surface = material.get("pbrMetallicRoughness", {})
    is_colored = isinstance(surface, dict) and "baseColorFactor" in surface
    if number is None and not is_colored:
        return None
    shown = np.ones((count, 3), np.float32)
    if is_colored:
        shown *= _numbers(surface, "baseColorFactor", 4, ())[:3].astype(np.float32)
    if number is not None:
        entry = _entry(file.content, "accessors", number)
        kind = "VEC3" if entry.get("type") == "VEC3" else "VEC4"
        rows = _accessor(file, number, kind)
        if entry["componentType"] not in _LEVELS or len(rows) != count:
            raise LoadError(f"accessor {number} has no color for each point")
        with np.errstate(all="ignore"):
            shown *= rows[:, :3].astype(np.float32) / np.float32(_LEVELS[entry["componentType"]])
    return np.clip(np.nan_to_num(shown, nan=0.0), 0.0, 1.0)


def _chunks(data: bytes) -> _File:
    if data[:4] != b"glTF" or len(data) < 20:
        raise LoadError("it does not begin with the header of GLB")
    if int.from_bytes(data[4:8], "little") != 2:
        raise LoadError("it is not version 2 of GLB")
    at = 12
    chunks: list[tuple[bytes, bytes]] = []
    while at + 8 <= len(data) and len(chunks) < 2:
        size = int.from_bytes(data[at : at + 4], "little")
        if at + 8 + size > len(data):
            raise LoadError("it is truncated")
        chunks.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + size]))
        at += 8 + size
    if not chunks or chunks[0][0] != b"JSON":
        raise LoadError("its first part is no JSON")
    try:
        content = json.loads(chunks[0][1])
    except (ValueError, RecursionError):
        raise LoadError("its JSON is damaged") from None
    if not isinstance(content, dict):
        raise LoadError("its JSON is no object")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else b""
    return _File(content, binary)


def _placed(file: _File) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Yield the mesh and the matrix of each node of the scene that has a mesh."""
    nodes = _list(file.content, "nodes")
    scenes = _list(file.content, "scenes")
    if scenes:
        roots = _list(_entry(file.content, "scenes", file.content.get("scene", 0)), "nodes")
    else:
        roots = list(range(len(nodes)))
    waiting = [(root, np.eye(4)) for root in reversed(roots)]
    seen: set[int] = set()
    while waiting:
        number, above = waiting.pop()
        node = _entry(file.content, "nodes", number)
        if number in seen:
            raise LoadError(f"node {number} is in the scene twice")
        seen.add(number)
        with np.errstate(all="ignore"):
            matrix = above @ _matrix(node)
        if "mesh" in node:
            yield node["mesh"], matrix
        waiting += [(child, matrix) for child in reversed(_list(node, "children"))]


def _matrix(node: dict[str, Any]) -> NDArray[np.float64]:
    if "matrix" in node:
        return _numbers(node, "matrix", 16, ()).reshape(4, 4).T
    x, y, z, w = _numbers(node, "rotation", 4, (0.0, 0.0, 0.0, 1.0)).tolist()
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * _numbers(node, "scale", 3, (1.0, 1.0, 1.0))
    matrix[:3, 3] = _numbers(node, "translation", 3, (0.0, 0.0, 0.0))
    return matrix


def _primitive(
    file: _File, primitive: Any, size: MeshSize
) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Return the points and triangles of a primitive; None for lines and points.

    Args:
        file: The file.
        primitive: Its entry.
        size: That of all primitives; this one is added to it.
    """
    if not isinstance(primitive, dict) or not isinstance(primitive.get("attributes"), dict):
        raise LoadError("a primitive has no attributes")
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        return None
    rows = _accessor(file, primitive["attributes"].get("POSITION"), "VEC3")
    numbers = _accessor(file, primitive["indices"], "SCALAR") if "indices" in primitive else None
    count = len(rows if numbers is None else numbers)
    size.add(MeshSize(len(rows), count // 3 if mode == _TRIANGLES else max(count - 2, 0)))
    size.check()
    points = rows.astype(np.float64)
    order = np.arange(count) if numbers is None else numbers.reshape(-1).astype(np.int64)
    if len(order) and order.max() >= len(points):
        raise LoadError(f"a triangle names point {order.max()} of {len(points)}")
    if mode == _TRIANGLES:
        return points, order[: len(order) // 3 * 3].reshape(-1, 3)
    if len(order) < 3:
        return points, np.zeros((0, 3), np.int64)
    if mode == _FAN:
        first = np.full(len(order) - 2, order[0])
        return points, np.stack([first, order[1:-1], order[2:]], axis=1)
    strip = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
    strip[1::2] = strip[1::2, [1, 0, 2]]
    return points, strip


def _accessor(file: _File, number: Any, kind: str) -> NDArray[Any]:
    """Return the rows of an accessor, (count, width)."""
    entry = _entry(file.content, "accessors", number)
    component = entry.get("componentType")
    if entry.get("type") != kind or component not in _COMPONENTS:
        raise LoadError(f"accessor {number} is no {kind} of numbers")
    if "sparse" in entry or "bufferView" not in entry:
        raise LoadError(f"accessor {number} is sparse, which is not read: save it again without")
    view = _entry(file.content, "bufferViews", entry["bufferView"])
    buffer = _entry(file.content, "buffers", view.get("buffer"))
    if "uri" in buffer:
        raise LoadError("its numbers are in another file: save it as one file")
    dtype, width = np.dtype(_COMPONENTS[component]), _WIDTHS[kind]
    size = dtype.itemsize * width
    count, stride = _whole(entry, "count", None), _whole(view, "byteStride", size)
    begin = _whole(view, "byteOffset", 0) + _whole(entry, "byteOffset", 0)
    if stride < size or (count and begin + (count - 1) * stride + size > len(file.data)):
        raise LoadError(f"it is truncated: accessor {number} goes beyond the numbers")
    if count == 0:
        return np.zeros((0, width), dtype)
    return np.ndarray((count, width), dtype, file.data, begin, (stride, dtype.itemsize))


# Checked entries of the JSON


def _list(mapping: dict[str, Any], key: str) -> list[Any]:
    found = mapping.get(key, [])
    if not isinstance(found, list):
        raise LoadError(f"'{key}' in its JSON is no list")
    return found


def _entry(content: dict[str, Any], key: str, number: Any) -> dict[str, Any]:
    entries = _list(content, key)
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(entries):
        raise LoadError(f"'{key}' in its JSON has no entry {number!r:.20}")
    entry = entries[number]
    if not isinstance(entry, dict):
        raise LoadError(f"entry {number} of '{key}' in its JSON is no object")
    return entry


def _whole(mapping: dict[str, Any], key: str, default: int | None) -> int:
    value = mapping.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**40:
        raise LoadError(f"'{key}' in its JSON is no count")
    return value


def _numbers(
    mapping: dict[str, Any], key: str, count: int, default: tuple[float, ...]
) -> NDArray[np.float64]:
    values = mapping.get(key, default)
    known = isinstance(values, list | tuple) and len(values) == count
    if not known or not all(type(v) in (int, float) and abs(v) < 1e30 for v in values):
        raise LoadError(f"'{key}' in its JSON is not {count} numbers")
    return np.array(values, np.float64)
