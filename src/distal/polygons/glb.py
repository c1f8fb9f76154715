"""Reads GLB: the triangles of all nodes of glTF 2.0 in one file, in the place of their node.

Input: bytes. Output: a mesh in meters.

Source: glTF 2.0 Specification, Khronos.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import check_time
from distal.polygons.glb_numbers import (
    COMPRESSED,
    GlbFile,
    accessor,
    compressed,
    entry,
    has_extension,
    list_of,
    numbers_of,
    scaled,
)
from distal.polygons.glb_pose import joint_matrices, morphed, skinned
from distal.polygons.triangles import MeshSize, SourceTriangles, checked, colored

# What a number of a color is divided by.
_LEVELS: Final = {5121: 255.0, 5123: 65535.0, 5126: 1.0}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_INSTANCES: Final = "EXT_mesh_gpu_instancing"
# Extensions that a file may require: quantized numbers are read, others do not change triangles.
_READ: Final = re.compile(
    "KHR_mesh_quantization|KHR_xmp(_json_ld)?|KHR_animation_pointer|EXT_mesh_features"
    "|EXT_structural_metadata|(KHR|EXT)_lights_.*|(KHR|EXT|MSFT)_texture_.*"
    "|(KHR|EXT|ADOBE)_materials_.*"
)


@dataclass(frozen=True, slots=True, eq=False)
class _GlbPart:
    """A primitive that has triangles: its points, corners and colors, or None for no colors."""

    points: NDArray[np.float64]
    corners: NDArray[np.int64]
    colors: NDArray[np.float32] | None


@dataclass(frozen=True, slots=True, eq=False)
class _Placement:
    """A node with a mesh.

    Attributes:
        mesh: The number of the mesh.
        matrix: From the mesh to the scene; a skin's points are in the scene already.
        weights: Those of morph targets.
        skin: The number of its skin; None without.
    """

    mesh: int
    matrix: NDArray[np.float64]
    weights: tuple[float, ...]
    skin: int | None

    @property
    def pose(self) -> tuple[int, tuple[float, ...], int | None]:
        """What the points of the mesh depend on."""
        return self.mesh, self.weights, self.skin


class _Meshes:
    """The meshes of a file, each parsed once for each pose.

    Primitives may share what an accessor holds, and nodes may share meshes, so all are counted
    before they are copied.
    """

    def __init__(
        self, file: GlbFile, worlds: dict[int, NDArray[np.float64]], *, with_colors: bool
    ) -> None:
        self._file, self._worlds, self._with_colors = file, worlds, with_colors
        self._parts: dict[Any, list[_GlbPart]] = {}
        self._all = MeshSize()

    def parts(self, placed: _Placement) -> list[_GlbPart]:
        """Return the parts of a mesh that have triangles."""
        if placed.pose not in self._parts:
            item = entry(self._file.content, "meshes", placed.mesh)
            joints = None
            if placed.skin is not None:
                joints = joint_matrices(self._file, placed.skin, self._worlds)
            read = (self._part(each, placed, joints) for each in list_of(item, "primitives"))
            self._parts[placed.pose] = [part for part in read if part is not None]
        return self._parts[placed.pose]

    def size(self, placed: _Placement) -> MeshSize:
        """Return the size of a mesh."""
        size = MeshSize(parts=0)
        for part in self.parts(placed):
            size.add(MeshSize(len(part.points), len(part.corners)))
        return size

    def _part(
        self, primitive: Any, placed: _Placement, joints: NDArray[np.float64] | None
    ) -> _GlbPart | None:
        check_time()
        shape = _primitive(self._file, primitive, self._all)
        if shape is None or not len(shape[1]):
            return None
        points, corners = shape
        colors = _colors(self._file, primitive, len(points)) if self._with_colors else None
        with np.errstate(all="ignore"):  # ``checked`` finds what is not finite
            points = morphed(self._file, primitive, points, placed.weights)
            if joints is not None:
                points = skinned(self._file, primitive["attributes"], points, joints)
        # A skeleton that mirrors its mesh turns the triangles around, as a node does.
        if joints is not None and float(np.linalg.det(joints[0, :3, :3])) < 0.0:
            corners = corners[:, ::-1]
        return _GlbPart(points, corners, colors)


def read_glb(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of a GLB file, with colors if they are wanted and there.

    Raises:
        LoadError: The file is no GLB, is truncated, or is compressed.
    """
    file = _chunks(data)
    _check_version(file.content.get("asset"))
    for name in list_of(file.content, "extensionsRequired"):
        if name in COMPRESSED:
            raise compressed(name)
        if not isinstance(name, str) or not _READ.fullmatch(name):
            raise LoadError(
                f"it requires the extension {printable(name, 60)}, which is not read: "
                "save it without"
            )
    placed, worlds = _placed(file)
    meshes = _Meshes(file, worlds, with_colors=with_colors)
    total = MeshSize()
    for each in placed:
        total.add(meshes.size(each))
    first = meshes.size(placed[0]) if placed else total
    is_copied = len({each.pose for each in placed}) == 1 < len(placed)
    total.check(f"{len(placed):,} copies of {first.triangles:,} triangles" if is_copied else None)
    copies = [(part, each.matrix) for each in placed for part in meshes.parts(each)]
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


def _colors(file: GlbFile, primitive: Any, count: int) -> NDArray[np.float32] | None:
    """Return the linear colors of a primitive's points; None without them.

    They are those of its points times that of its material; pictures are left out.
    """
    number = primitive["attributes"].get("COLOR_0")
    known = "material" in primitive
    material = entry(file.content, "materials", primitive["material"]) if known else {}
    surface = material.get("pbrMetallicRoughness", {})
    is_colored = isinstance(surface, dict) and "baseColorFactor" in surface
    if number is None and not is_colored:
        return None
    shown = np.ones((count, 3), np.float32)
    if is_colored:
        shown *= numbers_of(surface, "baseColorFactor", 4, ())[:3].astype(np.float32)
    if number is not None:
        item = entry(file.content, "accessors", number)
        kind = "VEC3" if item.get("type") == "VEC3" else "VEC4"
        rows = accessor(file, number, kind)
        if item["componentType"] not in _LEVELS or len(rows) != count:
            raise LoadError(f"accessor {number} has no color for each point")
        with np.errstate(all="ignore"):
            shown *= rows[:, :3].astype(np.float32) / np.float32(_LEVELS[item["componentType"]])
    return np.clip(np.nan_to_num(shown, nan=0.0), 0.0, 1.0)


def _chunks(data: bytes) -> GlbFile:
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
    return GlbFile(content, binary)


def _check_version(asset: Any) -> None:
    """Refuse what needs a later version than 2.0; what is only written by one is compatible."""
    least = asset.get("minVersion", "2.0") if isinstance(asset, dict) else "2.0"
    if least != "2.0":
        raise LoadError(f"it requires version {printable(least, 20)} of glTF, and 2.0 is read")


def _placed(file: GlbFile) -> tuple[list[_Placement], dict[int, NDArray[np.float64]]]:
    """Return the nodes of the scene that have a mesh, and the matrices of all its nodes."""
    nodes = list_of(file.content, "nodes")
    scenes = list_of(file.content, "scenes")
    if scenes:
        roots = list_of(entry(file.content, "scenes", file.content.get("scene", 0)), "nodes")
    else:
        inner = {str(c) for n in nodes if isinstance(n, dict) for c in list_of(n, "children")}
        roots = [number for number in range(len(nodes)) if str(number) not in inner]
    waiting = [(root, np.eye(4)) for root in reversed(roots)]
    placed: list[_Placement] = []
    worlds: dict[int, NDArray[np.float64]] = {}
    while waiting:
        number, above = waiting.pop()
        node = entry(file.content, "nodes", number)
        if number in worlds:
            raise LoadError(f"node {number} is in the scene twice")
        with np.errstate(all="ignore"):
            matrix = worlds[number] = above @ _matrix(node)
        if "mesh" in node:
            placed.append(_placement(file, number, node, matrix))
        waiting += [(child, matrix) for child in reversed(list_of(node, "children"))]
    return placed, worlds


def _placement(
    file: GlbFile, number: int, node: dict[str, Any], matrix: NDArray[np.float64]
) -> _Placement:
    """Return how a node places its mesh.

    Raises:
        LoadError: It is copied, or its weights are no numbers.
    """
    if has_extension(node, _INSTANCES):
        raise LoadError(
            f"node {number} is copied by {_INSTANCES}, which is not read: save each copy as a node"
        )
    mesh = entry(file.content, "meshes", node["mesh"])
    source = node if "weights" in node else mesh
    weights = numbers_of(source, "weights", len(list_of(source, "weights")), ())
    skin = node.get("skin")
    if skin is not None:
        entry(file.content, "skins", skin)
        matrix = np.eye(4)
    return _Placement(node["mesh"], matrix, tuple(weights.tolist()), skin)


def _matrix(node: dict[str, Any]) -> NDArray[np.float64]:
    if "matrix" in node:
        return numbers_of(node, "matrix", 16, ()).reshape(4, 4).T
    quaternion = numbers_of(node, "rotation", 4, (0.0, 0.0, 0.0, 1.0))
    length = float(np.linalg.norm(quaternion))
    if length == 0.0:
        raise LoadError("the rotation of a node is four zeros")
    # Programs round it: without this, a node would be scaled, too.
    x, y, z, w = (quaternion / length).tolist()
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * numbers_of(node, "scale", 3, (1.0, 1.0, 1.0))
    matrix[:3, 3] = numbers_of(node, "translation", 3, (0.0, 0.0, 0.0))
    return matrix


def _primitive(
    file: GlbFile, primitive: Any, size: MeshSize
) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Return the points and triangles of a primitive; None for lines and points.

    Args:
        file: The file.
        primitive: Its item.
        size: That of all primitives; this one is added to it.
    """
    if not isinstance(primitive, dict) or not isinstance(primitive.get("attributes"), dict):
        raise LoadError("a primitive has no attributes")
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        return None
    if has_extension(primitive, COMPRESSED[0]):
        raise compressed(COMPRESSED[0])
    points = scaled(file, primitive["attributes"].get("POSITION"), "VEC3")
    numbers = accessor(file, primitive["indices"], "SCALAR") if "indices" in primitive else None
    count = len(points if numbers is None else numbers)
    size.add(MeshSize(len(points), count // 3 if mode == _TRIANGLES else max(count - 2, 0)))
    size.check()
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
