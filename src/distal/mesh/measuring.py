"""Measures of a solid: volume, area, center of mass, inertia, box, walls, gaps and overhang.

Input: a shape and a density. Output: numbers with errors. They are integrals over the triangles of
two meshes (divergence theorem); the error of the finer mesh is taken from the difference.

Source: Brian Mirtich, "Fast and Accurate Computation of Polyhedral Mass Properties" (1996), for the
    integrals; here as sums over tetrahedra.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.brackets import Brackets, brackets_of
from distal.mesh.certain_boxes import MOST_BOXES, Effort
from distal.mesh.extract import Extent, Extracted, Nothing, extracted
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.meshing import MeshRequest, extent_of, found_mesh
from distal.mesh.overhangs import Overhang, overhang_of
from distal.mesh.requests import watch_of
from distal.mesh.solid import Floats
from distal.mesh.spacing import MOST_BRICKS
from distal.mesh.widths import Width, WidthSearch
from distal.scene.tree.errors import refuse, refuse_kind

if TYPE_CHECKING:
    from distal.scene.objects.meshable import Meshable

# At least so many cells along the largest side of the box.
_CELLS: Final = 128
OVERHANG_DEG: Final = 45.0
# The coarser mesh has cells this much longer.
_COARSER: Final = 1.6
_HOW: Final = "meshes with cells of {:.4g} and {:.4g}: the difference is the error"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A measured number or vector.

    Attributes:
        value: The value.
        error: How far it may be off, estimated; for vectors the largest component.
    """

    value: Any
    error: float

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        return {"value": self.value, "error": self.error}


@dataclass(frozen=True, slots=True)
class Measures:
    """Measures of a solid, in scene units.

    Attributes:
        volume: The volume.
        area: The area of the surface.
        mass: The volume times the density.
        center: The center of mass.
        inertia: The inertia tensor about the center of mass: three rows.
        low: The lowest corner of the box around the mesh.
        high: The highest corner.
        bounds: The conservative box, (low, high), as ``shape.bounds()``.
        wall: The thinnest wall, measured along normals inwards; None if nothing is met.
        gap: The narrowest gap, measured along normals outwards; None if there is none.
        overhang: The faces that hang over when the solid is built along y.
        brackets: Proved bounds; None if they were not asked for.
        density: The mass of a unit of volume.
        how: How the numbers and their errors were found.
    """

    volume: Quantity
    area: Quantity
    mass: Quantity
    center: Quantity
    inertia: Quantity
    low: Quantity
    high: Quantity
    bounds: tuple[tuple[float, ...], tuple[float, ...]]
    wall: Width | None
    gap: Width | None
    overhang: Overhang
    brackets: Brackets | None
    density: float
    how: str

    @property
    def feature(self) -> Width | None:
        """The smallest feature: the thinnest wall or the narrowest gap."""
        return min(
            (width for width in (self.wall, self.gap) if width is not None),
            key=lambda width: width.value,
            default=None,
        )

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        names = ("volume", "area", "mass", "center", "inertia", "low", "high")
        found = {name: getattr(self, name).as_json() for name in names}
        bounds = [list(corner) for corner in self.bounds]
        widths = {name: getattr(self, name) for name in ("wall", "gap", "feature")}
        return {
            **found,
            "bounds": bounds,
            **{name: width and width.as_json() for name, width in widths.items()},
            "overhang": self.overhang.as_json(),
            "proved": self.brackets and self.brackets.as_json(),
            "density": self.density,
            "how": self.how,
        }


@dataclass(frozen=True, slots=True)
class _Integrals:
    """Integrals over a mesh."""

    volume: float
    area: float
    center: Floats
    inertia: Floats
    low: Floats
    high: Floats


def measures_of(
    shape: Meshable,
    density: Any,
    request: MeshRequest,
    overhang_deg: Any = OVERHANG_DEG,
    effort: Effort | None = None,
) -> Measures:
    """Return the measures of a solid; see ``Shape.measure``.

    Args:
        shape: The solid.
        density: The mass of a unit of volume.
        request: The tolerance of the finer mesh.
        overhang_deg: The angle to the horizontal, in degrees, up to which faces need support.
        effort: How long to look for proved bounds; None for none.

    Raises:
        SceneValueError: The density is no number above 0, the angle is not one from 0 to 90, or the
            shape has no mesh.
    """
    node = shape.node
    valid = isinstance(density, int | float) and not isinstance(density, bool)
    if not valid or not 0.0 < density < math.inf:
        refuse(f"a density is a number above 0, not {density!r:.40}", "density=1.24e-3")
    if not is_angle(overhang_deg):
        words = f"an overhang is an angle from 0 to 90 degrees, not {overhang_deg!r:.40}"
        refuse(words, "overhang_deg=45")
    if node.flat:
        refuse_kind(f"'{node.name}' is flat, and has no volume", ".extrude(height)", node.place)
    found, wanted, kernels = found_mesh(node, request)
    extent = extent_of(node, request)
    found = _finer(kernels, extent, found, wanted.tolerance, request)
    rough = _rough(kernels, extent, found, wanted.tolerance, request)
    fine = _integrals(found, extent)
    coarse = _integrals(rough, extent)
    printed = _printed(kernels, extent, found, float(overhang_deg))
    measures = _measures(extent, found, rough, (fine, coarse), printed, float(density))
    if effort is None:
        return measures
    watch = watch_of(replace(request, progress=None))
    brackets = brackets_of(kernels, extent, watch, effort, float(density))
    return replace(measures, brackets=brackets)


def effort_of(width: Any, work: Any, *, proved: bool) -> Effort | None:
    """Return how long to look for proved bounds; None for none.

    Args:
        width: The distance between the bounds of the volume, as a share; None for any.
        work: How many boxes are looked at, at most; None for the default.
        proved: Whether there are proved bounds.

    Raises:
        SceneValueError: A number is out of range, or it is given without ``proved``.
    """
    if not proved:
        if width is not None or work is not None:
            name = "work" if width is None else "width"
            refuse(f"'{name}' is for proved bounds", "proved=True")
        return None
    return Effort(0.0 if width is None else width, MOST_BOXES if work is None else work)


def is_angle(value: Any) -> bool:
    """Return whether a value is an angle from 0 to 90 degrees."""
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value <= 90


def _printed(
    kernels: FieldKernels, extent: Extent, found: Extracted, overhang_deg: float
) -> tuple[Width | None, Width | None, Overhang]:
    """Return the thinnest wall, the narrowest gap, and what hangs over."""
    made = found.made
    middles = rows_of(
        triangle_arithmetic.middle, *(made.points[made.triangles[:, i]] for i in range(3))
    )
    search = WidthSearch(kernels, extent.slopes.slope, extent.size)
    wall, gap = (search.smallest(middles, found.step, side) for side in (-1, 1))
    bed = max(found.accuracy.largest, 1e-6 * extent.size)
    return wall, gap, overhang_of(kernels, made.points, made.triangles, overhang_deg, bed)


def _finer(
    kernels: FieldKernels,
    extent: Extent,
    found: Extracted,
    tolerance: float,
    request: MeshRequest,
) -> Extracted:
    """Return a mesh of equal cells if it is finer: integrals need more than a tolerance does.

    Args:
        kernels: The shape.
        extent: Its box.
        found: The mesh.
        tolerance: How far lines may be from the surface.
        request: What was asked.
    """
    step = extent.size / _CELLS
    if found.step <= step:
        return found
    watch = watch_of(replace(request, progress=None))
    made = extracted(kernels, extent, step, tolerance, MOST_BRICKS, watch)
    return found if isinstance(made, Nothing) else made


def _rough(
    kernels: FieldKernels,
    extent: Extent,
    found: Extracted,
    tolerance: float,
    request: MeshRequest,
) -> Extracted:
    """Return a coarser mesh of the same shape; a finer one if the coarser one has nothing.

    Args:
        kernels: The shape.
        extent: Its box.
        found: The mesh.
        tolerance: How far lines may be from the surface.
        request: What was asked.
    """
    watch = watch_of(replace(request, progress=None))
    for factor in (_COARSER, 1.0 / _COARSER):
        # Errors are quadratic in the spacing: with the same share of fans, they can be compared.
        allowed = tolerance * factor**2
        made = extracted(kernels, extent, found.step * factor, allowed, MOST_BRICKS, watch)
        if not isinstance(made, Nothing):
            return made
    return found


def _integrals(found: Extracted, extent: Extent) -> _Integrals:
    """Return the integrals over a mesh."""
    origin = (extent.low + extent.high) / 2.0
    points = found.made.points - origin
    corners = [points[found.made.triangles[:, i]] for i in range(3)]
    volumes, areas, first, squares, products = rows_of(triangle_arithmetic.moments, *corners)
    volume = float(volumes.sum())
    moment, square, product = first.sum(axis=0), squares.sum(axis=0), products.sum(axis=0)
    center = moment / volume
    second = np.diag(square)
    second[[0, 1, 2], [1, 2, 0]] = second[[1, 2, 0], [0, 1, 2]] = product
    about = second - volume * np.outer(center, center)
    inertia = np.trace(about) * np.eye(3) - about
    low, high = points.min(axis=0) + origin, points.max(axis=0) + origin
    return _Integrals(volume, float(areas.sum()), center + origin, inertia, low, high)


def _measures(
    extent: Extent,
    found: Extracted,
    rough: Extracted,
    integrals: tuple[_Integrals, _Integrals],
    printed: tuple[Width | None, Width | None, Overhang],
    density: float,
) -> Measures:
    """Return the measures from two meshes.

    Args:
        extent: The conservative box.
        found: The finer mesh.
        rough: The coarser one.
        integrals: Those over the finer and the coarser mesh.
        printed: The thinnest wall, the narrowest gap, and what hangs over.
        density: The mass of a unit of volume.
    """
    fine, coarse = integrals
    wall, gap, overhang = printed
    # To first order, the volume between mesh and surface is at most this.
    between = found.accuracy.mean * fine.area
    distance = max(found.accuracy.largest, found.accuracy.from_surface)

    def number(name: str, factor: float = 1.0, least: float = 0.0) -> Quantity:
        value, other = np.asarray(getattr(fine, name)), np.asarray(getattr(coarse, name))
        # Two meshes may agree by chance; sums of 64 bits are no better than this.
        least = max(least, 1e-12 * float(np.abs(value).max()))
        error = max(float(np.abs(value - other).max()), least)
        return Quantity((value * factor).tolist(), error * factor)

    return Measures(
        volume=number("volume", least=between),
        area=number("area"),
        mass=number("volume", density, between),
        center=number("center"),
        inertia=number("inertia", density),
        low=Quantity(fine.low.tolist(), distance),
        high=Quantity(fine.high.tolist(), distance),
        bounds=(tuple(extent.low.tolist()), tuple(extent.high.tolist())),
        wall=wall,
        gap=gap,
        overhang=overhang,
        brackets=None,
        density=density,
        how=_HOW.format(found.step, rough.step),
    )
