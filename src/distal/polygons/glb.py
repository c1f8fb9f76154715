"""Reads GLB: the triangles of all nodes of glTF 2.0 in one file, in the place of their node.

Input: bytes. Output: a mesh in meters.

Source: glTF 2.0 Specification, Khronos.
"""

from __future__ import annotations

import base64
import binascii
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import check_time, need
from distal.polygons.triangles import MeshSize, SourceTriangles, checked, colored

_COMPONENTS: Final = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS: Final = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
# What a number of a color is divided by.
_LEVELS: Final = {5121: 255.0, 5123: 65535.0, 5126: 1.0}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSED: Final = (
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
)
_INSTANCES: Final = "EXT_mesh_gpu_instancing"
# Extensions that a file may require: quantized numbers are read, others do not change triangles.
_READ: Final = re.compile(
    "KHR_mesh_quantization|KHR_lights_punctual|KHR_xmp(_json_ld)?|(KHR|EXT|MSFT)_texture_.*"
    "|KHR_materials_.*"
)
# What a whole number that is normalized is divided by.
_NORMAL: Final = {5120: 127.0, 5121: 255.0, 5122: 32767.0, 5123: 65535.0}
_DATA: Final = re.compile(r"data:[^,]{0,200};base64,")


@dataclass(slots=True)
class _File:
    """The two chunks of a file, and its other buffers by number."""

    content: dict[str, Any]
    data: bytes
    buffers: dict[int, bytes] = field(default_factory=dict)


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
            raise _compressed(name)
        if not isinstance(name, str) or not _READ.fullmatch(name):
            raise LoadError(
                f"it requires the extension {printable(name, 60)}, which is not read: "
                "save it without"
            )
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


def _compressed(name: str) -> LoadError:
    return LoadError(f"it is compressed by {name}: save it without compression")


def _extension(entry: dict[str, Any], name: str) -> bool:
    """Whether an entry of the JSON uses an extension."""
    extensions = entry.get("extensions", {})
    return isinstance(extensions, dict) and name in extensions


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
        inner = {str(c) for n in nodes if isinstance(n, dict) for c in _list(n, "children")}
        roots = [number for number in range(len(nodes)) if str(number) not in inner]
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
            _check_unmoved(file, number, node)
            yield node["mesh"], matrix
        waiting += [(child, matrix) for child in reversed(_list(node, "children"))]


def _check_unmoved(file: _File, number: int, node: dict[str, Any]) -> None:
    """Check that a node's mesh is where its matrix says.

    Raises:
        LoadError: It is copied, bent or moved in a way that is not read.
    """
    mesh = _entry(file.content, "meshes", node["mesh"])
    if _extension(node, _INSTANCES):
        message = f"is copied by {_INSTANCES}, which is not read: save each copy as a node"
    elif "skin" in node:
        message = "is bent by a skin, which is not read: apply its pose and save it without"
    elif any(_list(node if "weights" in node else mesh, "weights")):
        message = "is moved by morph targets, which are not read: apply them and save it without"
    else:
        return
    raise LoadError(f"node {number} {message}")


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
    if _extension(primitive, _COMPRESSED[0]):
        raise _compressed(_COMPRESSED[0])
    number = primitive["attributes"].get("POSITION")
    rows = _accessor(file, number, "VEC3")
    numbers = _accessor(file, primitive["indices"], "SCALAR") if "indices" in primitive else None
    count = len(rows if numbers is None else numbers)
    size.add(MeshSize(len(rows), count // 3 if mode == _TRIANGLES else max(count - 2, 0)))
    size.check()
    points = rows.astype(np.float64)
    entry = _entry(file.content, "accessors", number)
    if entry.get("normalized") is True and entry["componentType"] in _NORMAL:
        points = np.maximum(points / _NORMAL[entry["componentType"]], -1.0)
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
    if kind == "SCALAR" and np.dtype(_COMPONENTS[component]).kind != "u":
        raise LoadError(f"accessor {number} has indices that are no whole numbers from 0")
    dtype, width = np.dtype(_COMPONENTS[component]), _WIDTHS[kind]
    count = _whole(entry, "count", None)
    where = f"accessor {number}"
    if "bufferView" in entry:
        rows = _rows(file, entry, dtype, width, count, where)
    else:
        need(count * width * dtype.itemsize, f"{count:,} zeros of {where}")
        rows = np.zeros((count, width), dtype)
    if "sparse" not in entry:
        return rows
    sparse = entry["sparse"]
    parts = [sparse.get(key) if isinstance(sparse, dict) else None for key in ("indices", "values")]
    indices, values = parts
    if not isinstance(indices, dict) or not isinstance(values, dict):
        raise LoadError(f"{where} is sparse without indices or values")
    if indices.get("componentType") not in (5121, 5123, 5125):
        raise LoadError(f"{where} is sparse, and its indices are no whole numbers")
    changed = _whole(sparse, "count", None)
    places = np.dtype(_COMPONENTS[indices["componentType"]])
    at = _rows(file, indices, places, 1, changed, where).reshape(-1)
    if len(at) and int(at.max()) >= count:
        raise LoadError(f"{where} changes its row {at.max()} of {count}")
    need(2 * rows.size * dtype.itemsize, f"{count:,} rows of {where}")
    rows = rows.copy()
    rows[at] = _rows(file, values, dtype, width, changed, where)
    return rows


def _rows(
    file: _File, entry: dict[str, Any], dtype: np.dtype[Any], width: int, count: int, where: str
) -> NDArray[Any]:
    """Return rows of numbers of a view, (count, width).

    Args:
        file: The file.
        entry: What names the view, and where its rows begin in it.
        dtype: The type of its numbers.
        width: How many a row has.
        count: The number of rows.
        where: What they are, for messages.
    """
    view = _entry(file.content, "bufferViews", entry.get("bufferView"))
    for name in _COMPRESSED:
        if _extension(view, name):
            raise _compressed(name)
    data = _buffer(file, view.get("buffer"))
    size = dtype.itemsize * width
    stride = _whole(view, "byteStride", size)
    begin = _whole(view, "byteOffset", 0) + _whole(entry, "byteOffset", 0)
    if stride < size or (count and begin + (count - 1) * stride + size > len(data)):
        raise LoadError(f"it is truncated: {where} goes beyond the numbers")
    if count == 0:
        return np.zeros((0, width), dtype)
    return np.ndarray((count, width), dtype, data, begin, (stride, dtype.itemsize))


def _buffer(file: _File, number: Any) -> bytes:
    """Return the bytes of a buffer: the second chunk, or what is in the JSON."""
    entry = _entry(file.content, "buffers", number)
    uri = entry.get("uri")
    if uri is None:
        if number != 0:
            raise LoadError(f"its buffer {number} has no numbers")
        return file.data
    if number not in file.buffers:
        head = _DATA.match(uri) if isinstance(uri, str) else None
        if head is None:
            raise LoadError("its numbers are in another file: save it as one file")
        try:
            file.buffers[number] = base64.b64decode(uri[head.end() :], validate=True)
        except (binascii.Error, ValueError):
            raise LoadError(f"the text of its buffer {number} is damaged") from None
    return file.buffers[number]


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
