"""Reads 3MF: the objects of its build, in the place of their item and components.

Input: bytes. Output: a mesh, in the unit that the file names.

Source: 3MF Core Specification 1.3; Production Extension 1.1.
"""

from __future__ import annotations

import io
import posixpath
import zipfile
import zlib
from dataclasses import dataclass, field
from typing import Any, Final
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.lang.units import UNITS
from distal.polygons.triangles import MOST_TRIANGLES, SourceTriangles, checked, colored

_CORE: Final = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
_PATH: Final = "{http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
_MATERIAL: Final = "{http://schemas.microsoft.com/3dmanufacturing/material/2015/02}"
_MODEL: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_LARGEST: Final = 2**30  # bytes of XML
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

    Colors are those of the triangles' corners, (m, 3, 3); None without them.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    components: list[tuple[tuple[str, str], NDArray[np.float64]]]
    colors: NDArray[np.float32] | None = None


@dataclass(slots=True)
class _Archive:
    """The models that were read, and the triangles that were placed so far.

    Attributes:
        archive: The file.
        with_colors: Whether colors are wanted.
        roots: The models by name.
        objects: Their objects by the name of the model and their own.
        points: The points of each placed object.
        triangles: Its triangles.
        colors: Their colors.
        corners: The number of all these points.
        count: The number of all these triangles.
        placed: The number of placed objects.
    """

    archive: zipfile.ZipFile
    with_colors: bool
    roots: dict[str, ElementTree.Element] = field(default_factory=dict)
    objects: dict[tuple[str, str], _Object] = field(default_factory=dict)
    points: list[NDArray[np.float64]] = field(default_factory=list)
    triangles: list[NDArray[np.int64]] = field(default_factory=list)
    colors: list[NDArray[np.float32] | None] = field(default_factory=list)
    corners: int = 0
    count: int = 0
    placed: int = 0


def read_three_mf(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of a 3MF file, with colors if they are wanted and there.

    Raises:
        LoadError: The file is no 3MF, or is damaged.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _read(_Archive(archive, with_colors))
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise LoadError(f"it is no whole zip archive, as 3MF is: {error}") from None


def _read(whole: _Archive) -> SourceTriangles:
    path = _start(whole)
    root = _root(whole, path)
    unit = root.get("unit", "millimeter")
    if unit not in _METERS:
        raise LoadError(f"it has the unknown unit '{unit:.20}'")
    build = root.find(f"{_CORE}build")
    for item in [] if build is None else build.findall(f"{_CORE}item"):
        key = (_beside(item.get(_PATH), path), item.get("objectid", ""))
        _place(whole, key, _matrix(item.get("transform")), 0)
    if not whole.triangles:
        raise LoadError("there is no triangle in its build")
    mesh = checked(np.concatenate(whole.points), np.concatenate(whole.triangles), _METERS[unit])
    if all(each is None for each in whole.colors):
        return mesh
    shades = [
        np.ones((len(triangles), 3, 3), np.float32) if each is None else each
        for each, triangles in zip(whole.colors, whole.triangles, strict=True)
    ]
    return colored(mesh, np.concatenate(shades), of="corners")


def _start(whole: _Archive) -> str:
    """Return the name of the model that the whole starts with."""
    names = whole.archive.namelist()
    if "_rels/.rels" in names:
        for relation in _parsed(whole, "_rels/.rels"):
            if relation.get("Type") == _MODEL:
                return relation.get("Target", "").lstrip("/")
    models = [name for name in names if name.lower().endswith(".model")]
    if not models:
        raise LoadError("it is a zip archive without a 3D model")
    return models[0]


def _root(whole: _Archive, path: str) -> ElementTree.Element:
    if path not in whole.roots:
        root = whole.roots[path] = _parsed(whole, path)
        palettes = _palettes(root) if whole.with_colors else {}
        for element in root.iterfind(f"{_CORE}resources/{_CORE}object"):
            whole.objects[path, element.get("id", "")] = _object(element, path, palettes)
    return whole.roots[path]


def _parsed(whole: _Archive, path: str) -> ElementTree.Element:
    try:
        entry = whole.archive.getinfo(path)
    except KeyError:
        raise LoadError(f"it lacks the part '{path:.60}'") from None
    if entry.file_size > _LARGEST:
        raise LoadError(f"its part '{path:.60}' is larger than {_LARGEST >> 20} MiB")
    text = whole.archive.read(entry)
    if b"<!DOCTYPE" in text[:4096] or b"<!ENTITY" in text:
        raise LoadError(f"its part '{path:.60}' declares a document type, which 3MF forbids")
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise LoadError(f"its part '{path:.60}' is no XML: {error}") from None


def _palettes(root: ElementTree.Element) -> dict[str, list[list[float]]]:
    """Return the colors of each group and list of materials, by its id, from 0 to 1."""
    found: dict[str, list[list[float]]] = {}
    kinds = (
        (f"{_MATERIAL}colorgroup", f"{_MATERIAL}color", "color"),
        (f"{_CORE}basematerials", f"{_CORE}base", "displaycolor"),
    )
    for group, entry, attribute in kinds:
        for each in root.iterfind(f"{_CORE}resources/{group}"):
            texts = [color.get(attribute, "") for color in each.iterfind(entry)]
            found[each.get("id", "")] = [_color(text) for text in texts]
    return found


def _color(text: str) -> list[float]:
    try:
        code = bytes.fromhex(text[1:7])
    except ValueError:
        code = b""
    if not text.startswith("#") or len(code) != 3:
        raise LoadError(f"the color '{text:.20}' is not as in #rrggbb")
    return [channel / 255.0 for channel in code]


def _colors(
    element: ElementTree.Element,
    mesh: ElementTree.Element,
    palettes: dict[str, list[list[float]]],
) -> NDArray[np.float32] | None:
    """Return the colors of the corners of an object's triangles; None if none has one."""
    group, index = element.get("pid", ""), element.get("pindex", "0")
    triangles = list(mesh.iterfind(f"{_CORE}triangles/{_CORE}triangle"))
    if group not in palettes and not any(each.get("pid") in palettes for each in triangles):
        return None
    rows: list[list[list[float]]] = []
    for each in triangles:
        own = each.get("pid")
        shades = palettes.get(group if own is None else own)
        first = each.get("p1", index if own is None else "0")
        numbers = (first, each.get("p2", first), each.get("p3", first))
        if shades is None:  # a picture or a mixture: white
            rows.append([[1.0, 1.0, 1.0]] * 3)
            continue
        if not all(n.isdecimal() and int(n) < len(shades) for n in numbers):
            raise LoadError(f"a triangle names the color {'/'.join(numbers):.30}, of {len(shades)}")
        rows.append([shades[int(n)] for n in numbers])
    return np.array(rows, np.float32).reshape(-1, 3, 3)


def _object(
    element: ElementTree.Element, path: str, palettes: dict[str, list[list[float]]]
) -> _Object:
    mesh = element.find(f"{_CORE}mesh")
    components = [
        (
            (_beside(each.get(_PATH), path), each.get("objectid", "")),
            _matrix(each.get("transform")),
        )
        for each in element.iterfind(f"{_CORE}components/{_CORE}component")
    ]
    if mesh is None or element.get("type", "model") not in ("model", "solidsupport"):
        return _Object(np.zeros((0, 3)), np.zeros((0, 3), np.int64), components)
    points = _rows(mesh, "vertices", "vertex", ("x", "y", "z"), float)
    triangles = _rows(mesh, "triangles", "triangle", ("v1", "v2", "v3"), int)
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(points):
        raise LoadError(f"a triangle of object {element.get('id')!r:.20} names a missing point")
    colors = _colors(element, mesh, palettes)
    return _Object(points.astype(np.float64), triangles.astype(np.int64), components, colors)


def _rows(
    mesh: ElementTree.Element, group: str, tag: str, names: tuple[str, ...], read: Any
) -> NDArray[Any]:
    found = mesh.iterfind(f"{_CORE}{group}/{_CORE}{tag}")
    try:
        rows = [[read(each.attrib[name]) for name in names] for each in found]
        return np.array(rows, np.float64 if read is float else np.int64).reshape(-1, 3)
    except (KeyError, ValueError, OverflowError):
        raise LoadError(f"a {tag} has no numbers {', '.join(names)}") from None


def _place(whole: _Archive, key: tuple[str, str], matrix: NDArray[np.float64], deep: int) -> None:
    """Add an object and its components, by a matrix (4, 3) for rows of coordinates."""
    _root(whole, key[0])
    found = whole.objects.get(key)
    if found is None:
        raise LoadError(f"its build names the object {key[1]!r:.20}, which is not there")
    whole.placed += 1
    whole.count += len(found.triangles)
    if deep > _DEEPEST or whole.placed > 100_000 or whole.count > MOST_TRIANGLES:
        raise LoadError("its objects contain each other too often")
    if len(found.triangles):
        _add(whole, found, matrix)
    for child, inner in found.components:
        _place(whole, child, _after(inner, matrix), deep + 1)


def _add(whole: _Archive, found: _Object, matrix: NDArray[np.float64]) -> None:
    start = whole.corners
    whole.corners += len(found.points)
    with np.errstate(all="ignore"):  # ``checked`` finds what is not finite
        whole.points.append(found.points @ matrix[:3] + matrix[3])
    mirrored = float(np.linalg.det(matrix[:3])) < 0.0
    whole.triangles.append(start + (found.triangles[:, ::-1] if mirrored else found.triangles))
    colors = found.colors
    whole.colors.append(colors[:, ::-1] if mirrored and colors is not None else colors)


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


def _beside(path: str | None, default: str) -> str:
    return default if path is None else posixpath.normpath(path).lstrip("/")
