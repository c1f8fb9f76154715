"""A mesh of others as a grid of distances, and what was measured of it.

Input: a file or arrays, a spacing. Output: the grid with y up, and a report. Files that have not
changed are computed once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import Memory, bounded
from distal.lang.units import MILLIMETER, meters_of
from distal.polygons.bricks import CELLS, BrickSamples, from_grid
from distal.polygons.colors import ColorGrid, color_grid
from distal.polygons.distances import (
    UNSIGNED,
    WINDING,
    MeshOnGrid,
    box_and_spacing,
    described,
    distances,
    nodes_along,
)
from distal.polygons.reading import format_of, read_mesh
from distal.polygons.sparse import brick_distances
from distal.polygons.triangles import SourceTriangles, checked, colored

# The most triangles at which the surface is measured.
_MOST_MEASURED: Final = 50_000
# Above this number of samples only those near the surface are computed, if that is possible. At
# 128 along each side both ways take as long.
_MOST_WHOLE: Final = 2**21
# How far behind a triangle the inside is looked for, in spacings; at the last of them, a value
# above this says that the other side of a thin part has been passed.
_BEHIND: Final = (0.1, 0.25, 0.5, 1.0)
_PASSED: Final = 0.3
# The share of a mesh's area that may be lost without a warning.
_MOST_LOST: Final = 0.001


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """What an author asks for.

    Attributes:
        spacing: The distance of two samples in scene units; None for the default.
        sign: How to find the inside, one of ``distances.SIGNS``.
        unit: The length of one scene unit, a key of ``UNITS``; None keeps the numbers.
        up: "y" or "z"; None is the axis that is usual for the format, y for arrays.
        colors: Whether the colors of the mesh are wanted.
        max_memory: The most bytes that a file may become; None: by its size.
    """

    spacing: float | None
    sign: str
    unit: str | None
    up: str | None
    colors: bool = False
    max_memory: Memory | None = None


@dataclass(frozen=True, slots=True)
class ImportReport:
    """What is known of a shape from a mesh.

    Attributes:
        name: The file, or "arrays".
        triangles: The number of triangles.
        samples: The number of samples along x, y and z.
        spacing: Their distance, in scene units.
        closing: How the mesh is joined, in words.
        volume: The volume that its triangles enclose, in cubic scene units.
        sign: How the inside was found: "normals", "winding" or "unsigned".
        turned: Whether the mesh was inside out, and was turned around.
        largest: The largest distance of a measured place of the mesh from the surface that is left,
            as the field says it.
        mean: The mean of these distances.
        measured: The number of places: corners and middles of triangles.
        lost: The share of the triangles' area behind which there is no inside: that of parts
            thinner than the spacing.
        bricks: The number of bricks of 8 cells along each axis that are stored, because the surface
            is near; 0 if all samples are.
    """

    name: str
    triangles: int
    samples: tuple[int, int, int]
    spacing: float
    closing: str
    volume: float
    sign: str
    turned: bool
    largest: float = 0.0
    mean: float = 0.0
    measured: int = 0
    lost: float = 0.0
    bricks: int = 0

    def __str__(self) -> str:
        sizes = " x ".join(map(str, self.samples))
        near = f", stored in {self.bricks:,} bricks near the surface" if self.bricks else ""
        return (
            f"{self.name}: {self.triangles:,} triangles, {self.closing}; {sizes} samples, "
            f"{self.spacing:.4g} apart{near}; inside by {self.sign}; the surface is off by "
            f"{self.largest:.2g} at most, {self.mean:.2g} on average ({self.measured:,} places)"
            + (f"; {self.lost:.2%} of it is lost" if self.lost > 0.0 else "")
        )


@dataclass(frozen=True, slots=True, eq=False)
class Imported:
    """A mesh on a grid.

    Attributes:
        values: float32, (nodes along z, y, x), in scene units; or bricks of them.
        center: The middle of the grid.
        size: The size of the grid's cells together.
        places: Places at which the field is evaluated, from the center, (rows, n, 3): first
            corners of triangles, their middles, then what is behind these by ``_BEHIND``.
        areas: The areas of these triangles, (n,).
        report: What is known before that.
        colors: The colors, in scene units, if they are wanted.
    """

    values: NDArray[np.float32] | BrickSamples
    center: tuple[float, float, float]
    size: tuple[float, float, float]
    places: NDArray[np.float32]
    areas: NDArray[np.float64]
    report: ImportReport
    colors: ColorGrid | None = None


def imported_file(path: Path, wanted: ImportRequest) -> Imported:
    """Return the grid of a file.

    Raises:
        LoadError: The file cannot be read, or has no surface or no inside.
    """
    format_of(path)
    try:
        known = path.stat()
        version = known.st_mtime_ns, known.st_size
    except (OSError, ValueError):
        version = 0, 0  # reading it says why
    return _of_file(path, version, wanted)


@lru_cache(maxsize=4)
def _of_file(path: Path, version: tuple[int, int], wanted: ImportRequest) -> Imported:
    mesh = read_mesh(path, with_colors=wanted.colors, max_memory=wanted.max_memory)
    format = format_of(path)
    up = wanted.up or ("z" if format.z_up else "y")
    with bounded(format.name, path, version[1], max_memory=wanted.max_memory):
        return _imported(mesh, path.name, replace(wanted, up=up))


def imported_arrays(
    points: Any, triangles: Any, wanted: ImportRequest, colors: Any = None
) -> Imported:
    """Return the grid of arrays.

    Args:
        points: (n, 3).
        triangles: (m, 3).
        wanted: What is asked for.
        colors: Linear light of each point, (n, 3), or None.

    Raises:
        LoadError: The arrays are no mesh, or have no surface or no inside.
    """
    mesh = checked(points, triangles)
    if colors is not None:
        mesh = colored(mesh, colors, is_light=True)
    return _imported(mesh, "arrays", wanted)


def _imported(mesh: SourceTriangles, name: str, wanted: ImportRequest) -> Imported:
    if wanted.unit is not None:
        # A format without a unit is in millimeters, as programs for printers read it.
        meters = MILLIMETER if mesh.meters is None else mesh.meters
        mesh = replace(mesh, points=mesh.points * (meters / meters_of(wanted.unit, LoadError)))
    if wanted.up == "z":
        x, y, z = mesh.points.T
        mesh = replace(mesh, points=np.stack([x, z, -y], axis=1))
    if wanted.colors and mesh.colors is None:
        raise LoadError(f"'{name}' has no colors that are read: leave out colors=True")
    found, values, counts = _sampled(mesh, wanted)
    size = np.array(counts) * found.spacing
    center = found.low + 0.5 * (np.array(counts) - 1) * found.spacing
    report = ImportReport(
        name=name,
        triangles=len(mesh.triangles),
        samples=counts,
        spacing=found.spacing,
        closing=described(found.topology),
        volume=found.topology.volume,
        sign=found.sign,
        turned=found.turned,
        bricks=values.stored if isinstance(values, BrickSamples) else 0,
    )
    x, y, z = center.tolist()
    width, height, depth = size.tolist()
    places, areas = _places(mesh, found)
    local = (places - center).astype(np.float32)
    colors = color_grid(mesh, found.spacing) if wanted.colors else None
    size_ = (width, height, depth)
    return Imported(values, (x, y, z), size_, local, areas, report, colors)


def _sampled(
    mesh: SourceTriangles, wanted: ImportRequest
) -> tuple[MeshOnGrid, NDArray[np.float32] | BrickSamples, tuple[int, int, int]]:
    """Return what is known of a mesh, its distances, and the number of samples along x, y, z."""
    low, high, step = box_and_spacing(mesh, wanted.spacing)
    count = math.prod(nodes_along(high - low, step))
    if count > _MOST_WHOLE:
        sparse = brick_distances(mesh, step, wanted.sign)
        if sparse is not None:
            return sparse, sparse.bricks, sparse.bricks.samples
    found = distances(mesh, step, wanted.sign)
    z, y, x = found.values.shape
    # As in ``brick_distances``: a brick's width is more than what is interpolated is too large by.
    bricks = from_grid(found.values, (step, step, step), CELLS * step)
    return found, found.values if bricks is None else bricks, (x, y, z)


def _places(
    mesh: SourceTriangles, found: MeshOnGrid
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return ``Imported.places``, not from the center, and ``Imported.areas``."""
    step = -(-len(mesh.triangles) // _MOST_MEASURED)
    corners = mesh.points[mesh.triangles[::step]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    normals *= (found.spacing / np.where(areas > 0.0, areas, 1.0))[:, None]
    middles = corners.mean(axis=1)
    inward = normals if found.turned else -normals
    behind = [middles + part * inward for part in _BEHIND]
    return np.stack([corners[:, 0], middles, *behind]), areas


def measured(found: Imported, values: NDArray[Any]) -> ImportReport:
    """Return the report with what the field says at the places.

    Args:
        found: The mesh on its grid.
        values: The values of the field at ``found.places``, (rows, n).
    """
    rows = np.asarray(values, np.float64)
    away = np.abs(rows[:2])
    behind = rows[2:]
    is_lost = (behind.min(axis=0) > 0.0) & (behind[-1] > _PASSED * found.report.spacing)
    if found.report.sign == UNSIGNED:
        is_lost[:] = False
    total = float(found.areas.sum())
    return replace(
        found.report,
        largest=float(away.max()),
        mean=float(away.mean()),
        measured=away.size,
        lost=float(found.areas[is_lost].sum()) / total if total > 0.0 else 0.0,
    )


def warnings_of(report: ImportReport) -> list[str]:
    """Return what an author should know of a mesh: what is wrong, and how to fix it."""
    found = []
    if report.turned:
        found.append(
            f"'{report.name}' is inside out (its volume is {report.volume:.3g}): it was turned "
            "around; flip its normals in the file"
        )
    if report.sign == WINDING and report.closing != "the mesh is closed":
        found.append(
            f"'{report.name}': {report.closing}: holes are closed where the winding number is "
            "0.5; close them in the file, or give sign='unsigned' and .round(thickness) for a sheet"
        )
    if report.lost > _MOST_LOST:
        found.append(
            f"'{report.name}' has parts thinner than the samples are apart ({report.spacing:.3g}): "
            f"{report.lost:.1%} of its surface is lost; give spacing={report.spacing / 2:.3g}"
        )
    return found


def notice_of(report: ImportReport) -> str:
    """Return one line about what a mesh lost on its grid, and how to lose less."""
    lost = f"parts thinner than that are lost, {report.lost:.2g} of its area"
    return (
        f"'{report.name}' is sampled every {report.spacing:.4g}: its surface is off by up to "
        f"{report.largest:.2g}, {report.mean:.2g} on average, measured at {report.measured:,} "
        f"places; {lost if report.lost > 0.0 else 'no thin part is lost'}; "
        f"spacing={report.spacing / 2:.3g} is finer"
    )
