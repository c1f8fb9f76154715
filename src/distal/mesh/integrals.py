"""Integrals over a solid from one mesh: volume, area, center of mass, inertia.

Input: a mesh and the shape's kernels. Output: numbers. They are sums over the tetrahedra of an
origin and the triangles, and over the columns between the triangles and the surface
(``column_arithmetic``): with these, the error of a smooth solid falls as the fourth power of the
length of a cell. The area is that of the triangles.

Source: Brian Mirtich, "Fast and Accurate Computation of Polyhedral Mass Properties" (1996), for the
    integrals; here as sums over tetrahedra.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from distal.ir.types import VEC3
from distal.mesh import column_arithmetic, triangle_arithmetic
from distal.mesh.extract import Extent, Extracted
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.parallel import parallel_map, slices_of
from distal.mesh.solid import Floats, Integers


@dataclass(frozen=True, slots=True)
class Integrals:
    """Integrals over a solid.

    Attributes:
        step: The length of a cell.
        volume: The volume.
        area: The area of the surface.
        center: The center of mass.
        inertia: The inertia tensor about the center of mass, for density 1.
        columns: The volume between mesh and surface, without signs.
        rough: How far the columns may be off, since the surface bends sharply in some.
        triangles: How many triangles the mesh has.
    """

    step: float
    volume: float
    area: float
    center: Floats
    inertia: Floats
    columns: float
    rough: float
    triangles: int


def size_and_volume(points: Floats, triangles: Integers) -> tuple[list[float], float]:
    """Return the lengths of a mesh along x, y and z, and the volume within its triangles.

    Args:
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
    """
    low, high = points.min(axis=0), points.max(axis=0)
    corners = [points[triangles[:, i]] - low for i in range(3)]
    volumes = rows_of(triangle_arithmetic.moments, *corners)[0]
    return (high - low).tolist(), float(volumes.sum())


def integrals_of(kernels: FieldKernels, found: Extracted, extent: Extent) -> Integrals:
    """Return the integrals over the solid of a mesh.

    Args:
        kernels: The shape.
        found: Its mesh.
        extent: Its box.
    """
    points, triangles = found.made.points, found.made.triangles
    # Sums far from the origin would cancel.
    origin = (extent.low + extent.high) / 2.0
    near = points - origin
    corners = [near[triangles[:, i]] for i in range(3)]
    volumes, areas, first, squares, products = rows_of(triangle_arithmetic.moments, *corners)

    def on(rows: slice) -> tuple[Floats, Floats, Floats, Floats]:
        sides = (points[triangles[rows, i]] for i in range(3))
        at: tuple[Floats, Floats, Floats, Floats] = kernels.call(
            column_arithmetic.columns,
            *sides,
            np.broadcast_to(origin, (len(triangles[rows]), 3)),
            types=[(name, VEC3) for name in ("a", "b", "c", "origin")],
        )
        return at

    columns = parallel_map(on, slices_of(len(triangles)))
    added, more, more_squares, more_products = (
        np.concatenate([part[i] for part in columns]) for i in range(4)
    )
    volume = float(volumes.sum() + added[:, 0].sum())
    moment = first.sum(axis=0) + more.sum(axis=0)
    square = squares.sum(axis=0) + more_squares.sum(axis=0)
    product = products.sum(axis=0) + more_products.sum(axis=0)
    center = moment / volume if volume else moment
    second = np.diag(square)
    second[[0, 1, 2], [1, 2, 0]] = second[[1, 2, 0], [0, 1, 2]] = product
    about = second - volume * np.outer(center, center)
    inertia = np.trace(about) * np.eye(3) - about
    return Integrals(
        step=found.step,
        volume=volume,
        area=float(areas.sum()),
        center=center + origin,
        inertia=inertia,
        columns=float(added[:, 2].sum()),
        rough=float(np.sqrt((added[:, 1] ** 2).sum())),
        triangles=len(triangles),
    )
