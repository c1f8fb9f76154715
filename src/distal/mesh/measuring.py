"""Measures of a solid: volume, area, center of mass, inertia, box, walls, gaps and overhang.

Input: a shape and a density. Output: numbers with errors. They are integrals over meshes of ever
finer cells, whose differences give the errors (``rungs``); the volume and its error are held within
bounds that intervals prove (``brackets``).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.brackets import Brackets, brackets_of
from distal.mesh.certain_boxes import MOST_BOXES, Effort
from distal.mesh.extract import Extent, Extracted
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.meshing import MeshRequest, extent_of, found_mesh
from distal.mesh.overhangs import Overhang, overhang_of
from distal.mesh.problems import MeshProblem
from distal.mesh.refusals import above, refuse_nothing, refuse_problem, shown_place
from distal.mesh.requests import watch_of
from distal.mesh.rungs import Climbed, climbed, unconfirmed
from distal.mesh.spacing import BALL_CELLS
from distal.mesh.widths import Width, WidthSearch
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.objects.meshable import Meshable

OVERHANG_DEG: Final = 45.0
# How many boxes the proof of the volume looks at, if no proof is asked for.
_BOXES: Final = 10_000
# A box is computed in 32 bits: so much wider is one far from the origin.
_BOX_ROUNDING: Final = 2.0**-22
_HOW: Final = "meshes with cells down to {:.4g}: their differences are the errors"
_PROVED: Final = "; the volume is within the bounds that are proved"


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
        warnings: What is missing or not certain, with its place.
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
    warnings: tuple[str, ...] = ()

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
            "warnings": list(self.warnings),
        }


def measures_of(
    shape: Meshable,
    density: Any,
    request: MeshRequest,
    overhang_deg: Any = OVERHANG_DEG,
    effort: Effort | None = None,
    volume_tolerance: Any = None,
) -> Measures:
    """Return the measures of a solid; see ``Shape.measure``.

    Args:
        shape: The solid.
        density: The mass of a unit of volume.
        request: The tolerance of a mesh whose cells are reached at least.
        overhang_deg: The angle to the horizontal, in degrees, up to which faces need support.
        effort: How long to look for proved bounds; None if they are not asked for.
        volume_tolerance: How large the error of the volume may be, in scene units cubed.

    Raises:
        SceneValueError: A number is out of range, the shape has no mesh, or the tolerance of the
            volume is not reached.
    """
    node = shape.node
    for name, value, hint in (
        ("density", density, "1.24e-3"),
        ("volume_tolerance", 1.0 if volume_tolerance is None else volume_tolerance, "0.01"),
    ):
        valid = isinstance(value, int | float) and not isinstance(value, bool)
        if not valid or not 0.0 < value < math.inf:
            refuse(f"a {name} is a number above 0, not {value!r:.40}", f"{name}={hint}")
    if not is_angle(overhang_deg):
        words = f"an overhang is an angle from 0 to 90 degrees, not {overhang_deg!r:.40}"
        refuse(words, "overhang_deg=45")
    if node.flat:
        refuse_kind(f"'{node.name}' is flat, and has no volume", ".extrude(height)", node.place)
    extent = _widened(extent_of(node, request))
    step = None
    if request.tolerance is not None or request.feature is not None:
        step = found_mesh(node, replace(request, progress=None))[0].step
    kernels = FieldKernels(node, request.params, request.time)
    try:
        found = climbed(kernels, extent, watch_of(request), volume_tolerance, step)
    except MeshProblem as problem:
        refuse_problem(node, extent, problem)
    if found.finest is None:
        assert found.nothing is not None
        refuse_nothing(node, replace(found.nothing, lost=found.lost), request)
    watch = watch_of(replace(request, progress=None))
    brackets = brackets_of(kernels, extent, watch, effort or Effort(0.0, _BOXES), float(density))
    measures = _measures(kernels, extent, found, brackets, float(density), float(overhang_deg))
    if volume_tolerance is not None and measures.volume.error > volume_tolerance:
        error = measures.volume.error
        refuse(
            f"the volume of '{node.name}' is {measures.volume.value:.10g} with an error of "
            f"{error:.2g}, more than its tolerance, {volume_tolerance:g}: finer cells than "
            f"{found.finest.step:.2g} are too many",
            f"volume_tolerance={above(error):.2g}",
            node.place,
        )
    return replace(measures, brackets=None) if effort is None else measures


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


def _widened(extent: Extent) -> Extent:
    """Return a box that holds the shape where 32 bits round the corners of its box."""
    margin = _BOX_ROUNDING * np.maximum(np.abs(extent.low), np.abs(extent.high)).max()
    if margin < _BOX_ROUNDING * 64.0 * extent.size:
        return extent
    return replace(extent, low=extent.low - margin, high=extent.high + margin)


def _printed(
    kernels: FieldKernels, extent: Extent, finest: Extracted, overhang_deg: float
) -> tuple[Width | None, Width | None, Overhang]:
    """Return the thinnest wall, the narrowest gap, and what hangs over."""
    made = finest.made
    middles = rows_of(
        triangle_arithmetic.middle, *(made.points[made.triangles[:, i]] for i in range(3))
    )
    search = WidthSearch(kernels, extent.slopes.slope, extent.size)
    wall, gap = (search.smallest(middles, finest.step, side) for side in (-1, 1))
    bed = max(finest.accuracy.largest, 1e-6 * extent.size)
    return wall, gap, overhang_of(kernels, made.points, made.triangles, overhang_deg, bed)


def _within(value: float, error: float, brackets: Brackets) -> tuple[float, float, bool]:
    """Return a volume and an error that agree with what is proved, and whether they did before.

    Args:
        value: The volume that meshes give.
        error: Its error.
        brackets: What is proved of it.
    """
    if brackets.slope is not None:
        return value, error, True
    lower, upper = brackets.volume
    agrees = value + error >= lower and value - error <= upper
    inside = min(max(value, lower), upper)
    farthest = max(upper - inside, inside - lower)
    # A volume that is moved keeps what its error held.
    error = min(error + abs(inside - value), farthest) if agrees else farthest
    return inside, max(error, 1e-15 * abs(inside)), agrees


def _measures(
    kernels: FieldKernels,
    extent: Extent,
    found: Climbed,
    brackets: Brackets,
    density: float,
    overhang_deg: float,
) -> Measures:
    """Return the measures from meshes.

    Args:
        kernels: The shape.
        extent: The conservative box.
        found: What the meshes give.
        brackets: What is proved.
        density: The mass of a unit of volume.
        overhang_deg: The angle up to which faces need support.
    """
    finest, last = found.finest, found.last
    assert finest is not None and last is not None
    estimate = found.estimate or unconfirmed(last, extent)
    whole = estimate.integrals
    volume, error, agrees = _within(whole.volume, estimate.volume, brackets)
    if len(found.lost):
        # A mesh that misses parts says nothing of their volume: only the bounds do.
        lower, upper = brackets.volume
        error = max(error, upper - volume, volume - lower)
    points = finest.made.points
    low, high = points.min(axis=0), points.max(axis=0)
    distance = max(finest.accuracy.largest, finest.accuracy.from_surface)
    complete = agrees and found.estimate is not None
    if not complete:
        # Missing parts may be anywhere in the box.
        distance = float(max(distance, (low - extent.low).max(), (extent.high - high).max()))
        if not agrees:
            estimate = unconfirmed(whole, extent)
    wall, gap, overhang = _printed(kernels, extent, finest, overhang_deg)
    return Measures(
        volume=Quantity(volume, error),
        area=Quantity(estimate.area_value, estimate.area),
        mass=Quantity(volume * density, error * density),
        center=Quantity(whole.center.tolist(), estimate.center),
        inertia=Quantity((whole.inertia * density).tolist(), estimate.inertia * density),
        low=Quantity(low.tolist(), distance),
        high=Quantity(high.tolist(), distance),
        bounds=(tuple(extent.low.tolist()), tuple(extent.high.tolist())),
        wall=wall,
        gap=gap,
        overhang=overhang,
        brackets=brackets,
        density=density,
        how=_HOW.format(whole.step) + (_PROVED if brackets.slope is None else ""),
        warnings=tuple(_warnings(kernels.node, found, brackets, agrees=agrees)),
    )


def _warnings(node: Node, found: Climbed, brackets: Brackets, *, agrees: bool) -> Iterator[str]:
    """Yield what is missing or not certain."""
    finest = found.finest
    assert finest is not None
    thin = BALL_CELLS * finest.step
    if len(found.lost):
        yield (
            f"'{node.name}' is thinner than {thin:.3g} at {shown_place(found.lost[0])}: parts of "
            f"it are missing; give a smaller feature=, such as {thin / 4.0:.2g}"
        )
    elif not agrees:
        lower, upper = brackets.volume
        yield (
            f"the meshes miss parts of '{node.name}': its volume is proved to be {lower:.6g} to "
            f"{upper:.6g}; give a smaller feature=, such as {thin / 4.0:.2g}"
        )
    elif found.estimate is None:
        yield (
            f"fewer than three meshes show all parts of '{node.name}': errors are as large as the "
            f"values, or what is proved; give a smaller feature=, such as {thin / 4.0:.2g}"
        )
