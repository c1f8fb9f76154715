"""The formats of meshes and outlines: one declaration each, and the functions that write a file.

Input: a path, meshes or polylines, a unit. Output: a file, replaced in one step. Commands, messages
and documentation read the declarations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from distal.file_writer import SaveError, check_destination, replacement
from distal.lang.units import MILLIMETER, meters_of
from distal.mesh.files.glb import write_glb
from distal.mesh.files.obj import write_obj
from distal.mesh.files.outlines import (
    FileLayer,
    Frame,
    write_dxf,
    write_dxf_layers,
    write_svg,
    write_svg_layers,
)
from distal.mesh.files.parts import FilePart, Finish, Finishes, Solid, part_of, placed
from distal.mesh.files.ply import write_ply
from distal.mesh.files.stl import write_stl
from distal.mesh.files.three_mf import write_three_mf


@dataclass(frozen=True, slots=True)
class MeshFormat:
    """A format of meshes.

    Attributes:
        name: Its name.
        keeps: What it keeps besides the triangles.
        meters: The length of its unit in meters.
        z_up: Whether z is up; else y is.
        write: Writes parts; None for OBJ, which may need a second file.
    """

    name: str
    keeps: str
    meters: float
    z_up: bool
    write: Callable[[BinaryIO, Sequence[FilePart]], None] | None


@dataclass(frozen=True, slots=True)
class OutlineFormat:
    """A format of outlines, in millimeters.

    Attributes:
        name: Its name.
        write: Writes closed polylines; in a frame, if one is given.
        write_layers: Writes the polylines of several heights.
    """

    name: str
    write: Callable[[BinaryIO, Sequence[NDArray[np.float64]], Frame | None], None]
    write_layers: Callable[[BinaryIO, Sequence[FileLayer]], None]


MESH_FORMATS: Final = {
    ".3mf": MeshFormat("3MF", "unit, colors, names", MILLIMETER, True, write_three_mf),
    ".stl": MeshFormat("STL", "nothing", MILLIMETER, True, write_stl),
    ".glb": MeshFormat("GLB", "unit, colors, normals, materials, names", 1.0, False, write_glb),
    ".ply": MeshFormat("PLY", "colors, normals", MILLIMETER, False, write_ply),
    ".obj": MeshFormat("OBJ", "colors, normals, names", MILLIMETER, False, None),
}
OUTLINE_FORMATS: Final = {
    ".svg": OutlineFormat("SVG", write_svg, write_svg_layers),
    ".dxf": OutlineFormat("DXF", write_dxf, write_dxf_layers),
}


def write(
    path: str | PathLike[str],
    solid: Solid | Sequence[Solid],
    *,
    unit: str = "mm",
    bed: bool = False,
    finishes: Sequence[Finish | Finishes | None] | None = None,
) -> None:
    """Save meshes in the format that the file's suffix names.

    3MF and STL have z up, so (x, y, z) is written as (x, -z, y); the others have y up. GLB is in
    meters, all others are in millimeters.

    Args:
        path: The file; its suffix is a key of ``MESH_FORMATS``.
        solid: A mesh, or several parts of one file.
        unit: The length of one scene unit, a key of ``UNITS``.
        bed: Move the parts so that they stand on 0 and are centered there.
        finishes: How each part, or each of its triangles, reflects light, or None; formats without
            materials ignore it.

    Raises:
        SaveError: The suffix or the unit is unknown, a mesh is invalid, or the file system reports
            an error.
    """
    target = Path(path)
    chosen = _chosen(target, MESH_FORMATS, "a mesh")
    scale = meters_of(unit, SaveError) / chosen.meters
    check_destination(target)
    solids = list(solid) if isinstance(solid, Sequence) else [solid]
    if not solids:
        raise SaveError(f"cannot write {target}: there is no part")
    finishes = [None] * len(solids) if finishes is None else finishes
    if len(finishes) != len(solids):
        raise SaveError(f"there are {len(finishes)} finishes for {len(solids)} parts")
    checked = [part_of(each, finish) for each, finish in zip(solids, finishes, strict=True)]
    parts = placed(checked, scale, z_up=chosen.z_up, bed=bed)
    if chosen.write is None:
        _write_obj(target, parts)
        return
    with replacement(target) as file:
        chosen.write(file, parts)


def size_in_file(path: str | PathLike[str], size: Sequence[float]) -> list[float]:
    """Return the lengths of a mesh along the axes of a file: 3MF and STL have z up.

    Args:
        path: The file; its suffix is a key of ``MESH_FORMATS``.
        size: The lengths along x, y and z, y up.
    """
    x, y, z = size
    return [x, z, y] if _chosen(Path(path), MESH_FORMATS, "a mesh").z_up else [x, y, z]


def check_output(path: str | PathLike[str], unit: str) -> None:
    """Check that a mesh can be saved, before time is spent on it.

    Args:
        path: The file.
        unit: The length of one scene unit.

    Raises:
        SaveError: The suffix or the unit is unknown, or the folder is not writable.
    """
    _chosen(Path(path), MESH_FORMATS, "a mesh")
    meters_of(unit, SaveError)
    check_destination(Path(path))


def write_outlines(
    path: str | PathLike[str],
    polylines: Sequence[Any],
    *,
    unit: str = "mm",
    frame: tuple[Any, Any] | None = None,
) -> None:
    """Save closed polylines in the format that the file's suffix names, in millimeters.

    Args:
        path: The file; its suffix is a key of ``OUTLINE_FORMATS``.
        polylines: Arrays (n, 2), y up, in scene units; the last point is joined to the first.
        unit: The length of one scene unit, a key of ``UNITS``.
        frame: The corners (low, high) of the drawing, so that several lie on each other; None for
            those of the polylines.

    Raises:
        SaveError: The suffix or the unit is unknown, a polyline is invalid, or the file system
            reports an error.
    """
    target = Path(path)
    chosen = _chosen(target, OUTLINE_FORMATS, "an outline")
    scale = meters_of(unit, SaveError) / MILLIMETER
    check_destination(target)
    if not len(polylines):
        raise SaveError("there is no outline to save: the shape has no edge here")
    lines = [_polyline(line, index) * scale for index, line in enumerate(polylines)]
    corners = None if frame is None else (np.array(frame[0]) * scale, np.array(frame[1]) * scale)
    with replacement(target) as file:
        chosen.write(file, lines, corners)


def write_layers(
    path: str | PathLike[str], layers: Sequence[tuple[float, Sequence[Any]]], *, unit: str = "mm"
) -> None:
    """Save the closed polylines of several heights in one file, in millimeters.

    Args:
        path: The file; its suffix is a key of ``OUTLINE_FORMATS``.
        layers: The height of each layer in scene units, and its polylines as for
            ``write_outlines``.
        unit: The length of one scene unit, a key of ``UNITS``.

    Raises:
        SaveError: The suffix or the unit is unknown, a polyline is invalid, or the file system
            reports an error.
    """
    target = Path(path)
    check_outline_file(target, unit)
    scale = meters_of(unit, SaveError) / MILLIMETER
    if not any(len(polylines) for _, polylines in layers):
        raise SaveError("there is no layer to save: the solid has no inside at their heights")
    scaled = [
        (height * scale, [_polyline(line, i) * scale for i, line in enumerate(polylines)])
        for height, polylines in layers
        if len(polylines)
    ]
    with replacement(target) as file:
        OUTLINE_FORMATS[target.suffix.lower()].write_layers(file, scaled)


def check_outline_file(path: str | PathLike[str], unit: str) -> None:
    """Check that an outline can be saved, before time is spent on it.

    Args:
        path: The file.
        unit: The length of one scene unit.

    Raises:
        SaveError: The suffix or the unit is unknown, or the folder is not writable.
    """
    _chosen(Path(path), OUTLINE_FORMATS, "an outline")
    meters_of(unit, SaveError)
    check_destination(Path(path))


def _write_obj(target: Path, parts: Sequence[FilePart]) -> None:
    """Write an OBJ file and, before it is in place, the MTL file that it names."""
    library = target.with_suffix(".mtl")
    with replacement(target) as file:
        materials = write_obj(file, parts, library.name)
        if materials is not None:
            with replacement(library) as beside:
                beside.write(materials.encode())


def _chosen(path: Path, formats: dict[str, Any], what: str) -> Any:
    chosen = formats.get(path.suffix.lower())
    if chosen is None:
        known = ", ".join(formats)
        named = f"'{path.suffix}'" if path.suffix else f"the name '{path.name}' without a suffix"
        raise SaveError(f"{what} is not saved as {named}: use one of {known}")
    return chosen


def _polyline(line: Any, index: int) -> NDArray[np.float64]:
    points = np.asarray(line)
    if points.ndim != 2 or points.shape[1:] != (2,) or points.dtype.kind not in "fiu":
        raise SaveError(f"outline {index} is an array (n, 2), not {points.dtype} {points.shape}")
    if len(points) < 3:
        raise SaveError(f"outline {index} has {len(points)} points, but needs 3")
    if not np.isfinite(points).all():
        raise SaveError(f"outline {index} has a point without a finite place")
    return points.astype(np.float64)
