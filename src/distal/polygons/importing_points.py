"""Points with normals as a grid of distances, and what was measured of it.

Input: a file or arrays, a spacing. Output: the grid with y up, and a report. Files that have not
changed are computed once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import Memory, bounded
from distal.lang.units import MILLIMETER, meters_of
from distal.polygons.bricks import BrickSamples, from_grid
from distal.polygons.clouds import cloud_distances
from distal.polygons.points import SourcePoints, checked_points, read_points

# The most points at which the surface is measured.
_MOST_MEASURED: Final = 100_000


@dataclass(frozen=True, slots=True)
class PointsRequest:
    """What an author asks for.

    Attributes:
        spacing: The distance of two samples in scene units; None for the default.
        radius: Within which points count, in scene units; None for the default.
        unit: The length of one scene unit, a key of ``UNITS``; None keeps the numbers.
        up: "y" or "z"; None is y.
        max_memory: The most bytes that a file may become; None: by its size.
    """

    spacing: float | None
    radius: float | None
    unit: str | None
    up: str | None
    max_memory: Memory | None = None


@dataclass(frozen=True, slots=True)
class PointsReport:
    """What is known of a shape from points.

    Attributes:
        name: The file, or "arrays".
        points: The number of points.
        apart: Their distance, about, in scene units.
        radius: Within which points count.
        samples: The number of samples along x, y and z.
        spacing: Their distance.
        turned: Whether the normals pointed inwards, and were turned.
        wrong: The number of points that were left out, because their normals disagree with those
            about them.
        is_closed: Whether the points surround the inside; else holes were closed where the winding
            number is 0.5.
        bricks: As in ``ImportReport``.
        largest: The largest distance of a measured point from the surface, as the field says it.
        mean: The mean of these distances: noise, and what the radius smooths.
        measured: The number of these points.
    """

    name: str
    points: int
    apart: float
    radius: float
    samples: tuple[int, int, int]
    spacing: float
    turned: bool
    wrong: int
    is_closed: bool
    bricks: int
    largest: float = 0.0
    mean: float = 0.0
    measured: int = 0

    def __str__(self) -> str:
        sizes = " x ".join(map(str, self.samples))
        near = f", stored in {self.bricks:,} bricks near the surface" if self.bricks else ""
        holes = "on all sides" if self.is_closed else "with holes, which are closed"
        return (
            f"{self.name}: {self.points:,} points about {self.apart:.4g} apart, {holes}; {sizes} "
            f"samples, {self.spacing:.4g} apart{near}; points are off the surface by "
            f"{self.largest:.2g} at most, {self.mean:.2g} on average ({self.measured:,} points)"
        )


@dataclass(frozen=True, slots=True, eq=False)
class ImportedPoints:
    """Points on a grid.

    Attributes:
        values: float32, (nodes along z, y, x), in scene units; or bricks of them.
        center: The middle of the grid.
        size: The size of the grid's cells together.
        places: Points at which the field is evaluated, from the center, (n, 3).
        report: What is known before that.
    """

    values: NDArray[np.float32] | BrickSamples
    center: tuple[float, float, float]
    size: tuple[float, float, float]
    places: NDArray[np.float32]
    report: PointsReport


def imported_points_file(path: Path, wanted: PointsRequest) -> ImportedPoints:
    """Return the grid of a file.

    Raises:
        LoadError: The file cannot be read, or its points have no inside.
    """
    try:
        known = path.stat()
        version = known.st_mtime_ns, known.st_size
    except (OSError, ValueError):
        version = 0, 0  # reading it says why
    return _of_file(path, version, wanted)


@lru_cache(maxsize=4)
def _of_file(path: Path, version: tuple[int, int], wanted: PointsRequest) -> ImportedPoints:
    points = read_points(path, wanted.max_memory)
    with bounded("points", path, version[1], max_memory=wanted.max_memory):
        return _imported(points, path.name, wanted)


def imported_points_arrays(points: Any, normals: Any, wanted: PointsRequest) -> ImportedPoints:
    """Return the grid of arrays.

    Raises:
        LoadError: The arrays are no points with normals, or have no inside.
    """
    return _imported(checked_points(points, normals), "arrays", wanted)


def _imported(cloud: SourcePoints, name: str, wanted: PointsRequest) -> ImportedPoints:
    points, normals = cloud.points, cloud.normals
    if wanted.unit is not None:
        # As meshes of formats without a unit.
        points = points * (MILLIMETER / meters_of(wanted.unit, LoadError))
    if wanted.up == "z":
        points, normals = points[:, [0, 2, 1]], normals[:, [0, 2, 1]]
        points, normals = points * (1.0, 1.0, -1.0), normals * (1.0, 1.0, -1.0)
    found = cloud_distances(SourcePoints(points, normals), wanted.spacing, wanted.radius)
    bricks = from_grid(found.values, (found.spacing,) * 3)
    z, y, x = found.values.shape
    counts = np.array((x, y, z))
    center = found.low + 0.5 * (counts - 1) * found.spacing
    report = PointsReport(
        name=name,
        points=len(points),
        apart=found.apart,
        radius=found.radius,
        samples=(x, y, z),
        spacing=found.spacing,
        turned=found.turned,
        wrong=found.wrong,
        is_closed=found.is_closed,
        bricks=0 if bricks is None else bricks.stored,
    )
    step = -(-len(points) // _MOST_MEASURED)
    places = (points[::step] - center).astype(np.float32)
    values = found.values if bricks is None else bricks
    width, height, depth = (counts * found.spacing).tolist()
    a, b, c = center.tolist()
    return ImportedPoints(values, (a, b, c), (width, height, depth), places, report)


def measured_points(found: ImportedPoints, values: NDArray[Any]) -> PointsReport:
    """Return the report with what the field says at the points."""
    away = np.abs(np.asarray(values, np.float64))
    return replace(
        found.report, largest=float(away.max()), mean=float(away.mean()), measured=len(away)
    )


def warnings_of_points(report: PointsReport) -> list[str]:
    """Return what an author should know of points: what is wrong, and how to fix it."""
    found = []
    if report.turned:
        found.append(
            f"the normals of '{report.name}' point inwards: they were turned around; flip them in "
            "the file"
        )
    if report.wrong:
        found.append(
            f"{report.wrong:,} of the {report.points:,} normals of '{report.name}' point away from "
            "those about them: these points are left out; orient them alike"
        )
    return found


def notice_of_points(report: PointsReport) -> str:
    """Return one line about what points lost on their grid, and how to lose less."""
    finer = 0.5 * report.spacing
    hint = f"spacing={finer:.3g} is finer"
    if finer < 0.5 * report.apart:
        hint = "the points are too far apart for a finer spacing"
    return (
        f"'{report.name}' is sampled every {report.spacing:.4g}: its points are off the surface by "
        f"up to {report.largest:.2g}, {report.mean:.2g} on average, measured at "
        f"{report.measured:,} points; parts thinner than {report.radius:.4g} may be missing; {hint}"
    )
