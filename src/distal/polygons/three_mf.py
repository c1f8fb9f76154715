"""Reads 3MF: the objects of its build, in the place of their item and components.

Input: bytes. Output: a mesh, in the unit that the file names.

Source: 3MF Core Specification 1.3; Production Extension 1.1.
"""

from __future__ import annotations

import io
import posixpath
import zipfile
from dataclasses import dataclass, field
from typing import Final
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import TooLargeError, check_time
from distal.lang.units import UNITS
from distal.polygons.model_xml import Model, ModelObject, path_of, read_model
from distal.polygons.triangles import MeshSize, SourceTriangles, checked, colored

_MODEL: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
# Objects of these types are solids; those of the last two are no part of what is made.
_SOLID: Final = ("model", "solidsupport")
_BESIDE: Final = ("support", "other")
_METHODS: Final = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # Open Packaging Conventions
_CHUNK: Final = 2**16  # bytes of XML
_DEEPEST: Final = 32  # components within components
_METERS: Final = {
    "micron": UNITS["um"],
    "millimeter": UNITS["mm"],
    "centimeter": UNITS["cm"],
    "meter": UNITS["m"],
    "inch": UNITS["inch"],
    "foot": UNITS["ft"],
}


@dataclass(slots=True)
class _Object:
    """An object: a mesh, or other objects with the matrices that place them.

    Colors are those of the triangles' corners, (m, 3, 3); None without them. ``left_out`` says why
    an object has no triangles.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    components: list[tuple[tuple[str, str], NDArray[np.float64]]]
    colors: NDArray[np.float32] | None = None
    left_out: str = ""
    is_beside: bool = False


@dataclass(slots=True)
class _Archive:
    """The models that were read, and the objects that are placed so far.

    Attributes:
        archive: The file.
        with_colors: Whether colors are wanted.
        models: The models by name.
        size: What is in all of them.
        objects: Their objects by the name of the model and their own.
        names: Their names in the archive, by what names them: without regard to capitals.
        placed: Each placed object, and its matrix.
        left_out: Why placed objects have no triangles.
        total: Points and triangles of all these.
    """

    archive: zipfile.ZipFile
    with_colors: bool
    models: dict[str, Model] = field(default_factory=dict)
    size: MeshSize = field(default_factory=MeshSize)
    objects: dict[tuple[str, str], _Object] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    placed: list[tuple[_Object, NDArray[np.float64]]] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    total: MeshSize = field(default_factory=MeshSize)


def read_three_mf(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of a 3MF file, with colors if they are wanted and there.

    Raises:
        LoadError: The file is no 3MF, or is damaged.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _read(_Archive(archive, with_colors))
    except zipfile.BadZipFile as error:
        raise LoadError(f"it is no whole zip archive, as 3MF is: {error}") from None
    except (ValueError, NotImplementedError) as error:  # places or ways that do not exist
        if isinstance(error, LoadError | UnicodeError):
            raise
        raise LoadError(f"it is no whole zip archive, as 3MF is: {error}") from None


def _read(whole: _Archive) -> SourceTriangles:
    whole.names = {_key(name): name for name in reversed(whole.archive.namelist())}
    path = _start(whole)
    root = _model(whole, path)
    unit = root.attributes.get("unit", "millimeter")
    if unit not in _METERS:
        raise LoadError(f"it has the unknown unit '{unit:.20}'")
    for item in root.items:
        key = (_beside(path_of(item), path), item.get("objectid", ""))
        _place(whole, key, _matrix(item.get("transform")), 0)
    whole.total.check()
    if not any(len(each.triangles) for each, _ in whole.placed):
        if not root.items:
            raise LoadError("its build is empty: add its objects to the plate and save it again")
        reasons = "; ".join(dict.fromkeys(whole.left_out))
        raise LoadError(f"there is no triangle in its build{reasons and ': ' + reasons:.400}")
    return _joined(whole.placed, _METERS[unit])


def _joined(placed: list[tuple[_Object, NDArray[np.float64]]], meters: float) -> SourceTriangles:
    """Return the mesh of all placed objects."""
    points: list[NDArray[np.float64]] = []
    triangles: list[NDArray[np.int64]] = []
    colors: list[NDArray[np.float32] | None] = []
    start = 0
    for each, matrix in placed:
        with np.errstate(all="ignore"):  # ``checked`` finds what is not finite
            points.append(each.points @ matrix[:3] + matrix[3])
        mirrored = float(np.linalg.det(matrix[:3])) < 0.0
        triangles.append(start + (each.triangles[:, ::-1] if mirrored else each.triangles))
        start += len(each.points)
        own = each.colors
        colors.append(own[:, ::-1] if mirrored and own is not None else own)
    mesh = checked(np.concatenate(points), np.concatenate(triangles), meters)
    if all(each is None for each in colors):
        return mesh
    shades = [
        np.ones((len(corners), 3, 3), np.float32) if each is None else each
        for each, corners in zip(colors, triangles, strict=True)
    ]
    return colored(mesh, np.concatenate(shades), of="corners")


def _start(whole: _Archive) -> str:
    """Return the name of the model that the whole starts with."""
    names = whole.archive.namelist()
    if "_rels/.rels" in whole.names:
        for relation in _parsed(whole, "_rels/.rels").relations:
            if relation.get("Type") == _MODEL:
                return relation.get("Target", "").lstrip("/")
    models = [name for name in names if name.lower().endswith(".model")]
    if not models:
        raise LoadError("it is a zip archive without a 3D model")
    return models[0]


def _model(whole: _Archive, path: str) -> Model:
    if path not in whole.models:
        model = whole.models[path] = _parsed(whole, path)
        palettes = {
            group: [_color(text) for text in texts] for group, texts in model.palettes.items()
        }
        for each in model.objects:
            whole.objects[path, each.attributes.get("id", "")] = _object(each, path, palettes)
        model.objects.clear()  # their numbers are arrays now
    return whole.models[path]


def _parsed(whole: _Archive, path: str) -> Model:
    try:
        entry = whole.archive.getinfo(whole.names[_key(path)])
    except KeyError:
        raise LoadError(f"it lacks the part '{path:.60}'") from None
    if entry.compress_type not in _METHODS:
        raise LoadError(f"its part '{path:.60}' is packed in a way that 3MF does not have")
    with whole.archive.open(entry) as file:
        try:
            chunks = iter(lambda: file.read(_CHUNK), b"")
            return read_model(chunks, whole.size, with_colors=whole.with_colors)
        except TooLargeError:
            raise
        except LoadError as error:
            if not error.message.startswith("it "):
                raise
            raise LoadError(f"its part '{path:.60}' {error.message[3:]}") from None


def _color(text: str) -> list[float]:
    try:
        code = bytes.fromhex(text[1:7])
    except ValueError:
        code = b""
    if not text.startswith("#") or len(code) != 3:
        raise LoadError(f"the color '{text:.20}' is not as in #rrggbb")
    return [channel / 255.0 for channel in code]


def _colors(
    source: ModelObject, palettes: dict[str, list[list[float]]]
) -> NDArray[np.float32] | None:
    """Return the colors of the corners of an object's triangles; None if none has one."""
    group = source.attributes.get("pid", "")
    index = source.attributes.get("pindex", "0")
    if group not in palettes and not any(row[0] in palettes for row in source.colors):
        return None
    rows = np.ones((len(source.colors), 3, 3), np.float32)
    for row, (own, *places) in zip(rows, source.colors, strict=True):
        shades = palettes.get(group if own is None else own)
        if shades is None:  # a picture or a mixture: white
            continue
        first = places[0] or (index if own is None else "0")
        numbers = [first, *(each or first for each in places[1:])]
        if not all(n.isdecimal() and int(n) < len(shades) for n in numbers):
            raise LoadError(f"a triangle names the color {'/'.join(numbers):.30}, of {len(shades)}")
        row[...] = [shades[int(n)] for n in numbers]
    return rows


def _object(source: ModelObject, path: str, palettes: dict[str, list[list[float]]]) -> _Object:
    components = [
        ((_beside(path_of(each), path), each.get("objectid", "")), _matrix(each.get("transform")))
        for each in source.components
    ]
    name = printable(source.attributes.get("id", ""), 20)
    kind = source.attributes.get("type", "model")
    if not source.is_mesh or kind not in _SOLID:
        reason = f"its object '{name}' has the type '{printable(kind, 20)}', which is no solid"
        if kind == "surface":
            reason += ": save it as 'model'"
        reason = "" if kind in _SOLID else reason
        return _Object(
            np.zeros((0, 3)), np.zeros((0, 3), np.int64), components, None, reason, kind in _BESIDE
        )
    points = np.frombuffer(source.points, np.float64).reshape(-1, 3)
    triangles = np.frombuffer(source.corners, np.int64).reshape(-1, 3)
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(points):
        raise LoadError(f"a triangle of object '{name}' names a missing point")
    reason = f"its object '{name}' has beams, which are not read" if source.has_beams else ""
    return _Object(points, triangles, components, _colors(source, palettes), reason)


def _place(whole: _Archive, key: tuple[str, str], matrix: NDArray[np.float64], deep: int) -> None:
    """Place an object and its components, by a matrix (4, 3) for rows of coordinates."""
    _model(whole, key[0])
    found = whole.objects.get(key)
    if found is None:
        raise LoadError(f"its build names the object {key[1]!r:.20}, which is not there")
    if deep > _DEEPEST:
        raise LoadError("its objects contain each other too often")
    check_time()
    # Those without triangles cost as much time as others.
    whole.total.add(MeshSize(len(found.points), len(found.triangles)))
    whole.total.check()
    if found.left_out and not found.is_beside:
        raise LoadError(found.left_out)
    if len(found.triangles):
        whole.placed.append((found, matrix))
    elif found.left_out:
        whole.left_out.append(found.left_out)
    for child, inner in found.components:
        _place(whole, child, _after(inner, matrix), deep + 1)


def _after(inner: NDArray[np.float64], outer: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix that applies ``inner``, then ``outer``."""
    with np.errstate(all="ignore"):
        linear = inner[:3] @ outer[:3]
        return np.concatenate([linear, inner[3:] @ outer[:3] + outer[3:]])


def _matrix(text: str | None) -> NDArray[np.float64]:
    """Return the matrix (4, 3) of a transform: a row of coordinates times the first three rows."""
    if text is None:
        return np.eye(4, 3)
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.zeros(0)
    if numbers.shape != (12,) or not (np.abs(numbers) < 1e30).all():
        raise LoadError(f"the transform '{text:.40}' is not 12 numbers")
    return numbers.reshape(4, 3)


def _key(path: str) -> str:
    """Return a name of a part as those that are equal by the conventions have it."""
    return unquote(path).replace("\\", "/").lstrip("/").lower()


def _beside(path: str | None, default: str) -> str:
    return default if path is None else posixpath.normpath(path).lstrip("/")
