"""Mesh a shape: check what is asked, choose the spacing, report.

Input: a shape and a request. Output: a ``Mesh``, or an error at the author's line that says what to
write instead. What the report holds is in ``docs/guide/meshes.md``.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from distal.lang.render_options import Cancel, Progress, checked_time
from distal.mesh.borders import cut_at_borders
from distal.mesh.bricks import Slopes
from distal.mesh.checks import checked
from distal.mesh.coloring import Painted, painted
from distal.mesh.extract import Extent, Extracted, Nothing
from distal.mesh.fewer import with_fewer_triangles
from distal.mesh.files.parts import Finish, Finishes
from distal.mesh.integrals import size_and_volume
from distal.mesh.kernels import FieldKernels
from distal.mesh.leaf_check import LeafCheck, refuse_missing, with_all_leaves
from distal.mesh.mesh_report import record_leaves, report_of
from distal.mesh.palette import MOST as MOST_COLORS
from distal.mesh.problems import MeshProblem
from distal.mesh.refusals import refuse_endless, refuse_nothing, refuse_problem, refuse_too_fine
from distal.mesh.requests import box_of, watch_of
from distal.mesh.shells import shells_of
from distal.mesh.solid import Floats, Integers, Mesh
from distal.mesh.spacing import TooFine, Wanted, meshed
from distal.mesh.surface_box import with_size
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.objects.meshable import Meshable

# Without a tolerance it is this share of the largest side of the box.
DEFAULT_TOLERANCE: Final = 2e-3
_POSITIVE: Final = (
    ("tolerance", "a length", "0.01"),
    ("feature", "a length", "0.01"),
    ("angle", "an angle in radians", "0.1"),
)
STEEP: Final = 1e6  # a slope above it says nothing


@dataclass(frozen=True, slots=True)
class MeshRequest:
    """What is asked of a mesh.

    Attributes:
        tolerance: How far it may be from the surface, in scene units; None for 0.002 of the
            largest side of the shape's box.
        feature: The diameter of the smallest parts and gaps that must be found; None to leave that
            to the tolerance.
        params: Values of parameters by name.
        time: Seconds.
        progress: Called with the finished share, from 0 to 1.
        cancel: An event, or a function without arguments, that ends the work early.
        check: Whether open edges, pinched points and intersections are counted.
        colors: Whether the mesh has the colors of the shape's materials; a number for at most so
            many different ones.
        angle: How much the surface may turn within a triangle, in radians; None for any angle.
    """

    tolerance: float | None = None
    feature: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    time: float = 0.0
    progress: Progress | None = None
    cancel: Cancel | None = None
    check: bool = False
    colors: bool | int = True
    angle: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises:
            SceneValueError: One is not a positive number.
        """
        for name, what, example in _POSITIVE:
            value = getattr(self, name)
            if value is None:
                continue
            valid = isinstance(value, int | float) and not isinstance(value, bool)
            if not valid or not 0.0 < value < math.inf:
                refuse(f"{name} is {what} above 0, not {value!r:.40}", f"{name}={example}")
        wrong = not isinstance(self.colors, int) or not 0 <= self.colors <= MOST_COLORS
        if wrong:
            words = f"colors is True, False, or a number from 1 to {MOST_COLORS}"
            refuse(f"{words}, not {self.colors!r:.40}", "colors=4")
        object.__setattr__(self, "time", checked_time(self.time))


def mesh_of(shape: Meshable, request: MeshRequest) -> Mesh:
    """Return the mesh of a solid; see ``Shape.mesh``.

    Args:
        shape: The solid.
        request: What is asked.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneTypeError: The shape is flat.
        SceneValueError: The shape cannot be meshed; the message names it and says what to change.
    """
    node = shape.node
    if node.flat:
        refuse_kind(
            f"'{node.name}' is flat, and a mesh is of a solid", ".extrude(height)", node.place
        )
    return mesh_of_node(node, request)


def mesh_of_node(node: Node, request: MeshRequest) -> Mesh:
    """Return the mesh of a tree.

    Args:
        node: A solid.
        request: What is asked.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneValueError: The shape cannot be meshed.
    """
    begin = clock.process_time()
    found, wanted, kernels = found_mesh(node, request)
    found, leaves = _with_all_leaves(node, kernels, found, wanted, request)
    report = report_of(node, found, wanted, request)
    record_leaves(report, leaves, wanted)
    watch = watch_of(replace(request, progress=None))
    made = MeshArrays(found.made.points, found.made.triangles, found.normals)
    paint = _paint(node, made, request)
    varies = paint is not None and paint.varies
    if paint is not None and varies:
        cut = cut_at_borders(*made, paint.appearance, found.step, watch)
        made = MeshArrays(cut.points, cut.triangles, cut.normals)
        report["points"], report["triangles"] = len(cut.points), len(cut.triangles)
        report["border_points"] = cut.added
    spared = with_fewer_triangles(
        kernels,
        made.points,
        made.triangles,
        paint.labels(made.points, made.triangles) if paint is not None and varies else None,
        tolerance=wanted.tolerance,
        angle=wanted.angle,
        step=found.step,
        watch=watch,
    )
    spared.record(report)
    made = made.with_points(spared.points, spared.triangles)
    colors = _appearance(paint, made, report)
    report |= asdict(shells_of(made.points, made.triangles))
    report["size"], report["volume"] = size_and_volume(made.points, made.triangles)
    if request.check:
        report["check"] = checked(made.points, made.triangles, watch_of(request))
    report["rows"] = kernels.rows
    report["cpu_s"] = clock.process_time() - begin
    if request.progress is not None:
        request.progress(1.0)
    at_points, of_triangles, finish = colors
    return Mesh(*made, at_points, of_triangles, report, node.name, finish)


class MeshArrays(NamedTuple):
    """Triangles and the normals at their points."""

    points: Floats
    triangles: Integers
    normals: Floats

    def with_points(self, points: Integers, triangles: Integers) -> MeshArrays:
        """Return other triangles between some of the points."""
        return MeshArrays(self.points[points], triangles, self.normals[points])


def _with_all_leaves(
    node: Node, kernels: FieldKernels, found: Extracted, wanted: Wanted, request: MeshRequest
) -> tuple[Extracted, LeafCheck]:
    """Return a mesh that shows all leaves of its tree, and what was compared.

    Args:
        node: The tree.
        kernels: Its kernels.
        found: The mesh.
        wanted: The tolerance.
        request: What was asked.

    Raises:
        SceneValueError: A leaf is missing, and cells cannot be small enough for it.
    """
    watch = watch_of(replace(request, progress=None))
    extent = extent_of(node, request)
    found, leaves = with_all_leaves(kernels, extent, found, wanted.tolerance, watch)
    if leaves.missing:
        refuse_missing(leaves.missing, "mesh", "feature={width}, or a smaller tolerance=")
    return found, leaves


def _paint(node: Node, made: MeshArrays, request: MeshRequest) -> Painted | None:
    """Return the appearance of a tree, with the colors that were asked for; None without any."""
    if request.colors is False:
        return None
    most = None if request.colors is True else request.colors
    given, time = request.params, request.time
    return painted(node, made.points, made.triangles, params=given, time=time, most=most)


def _appearance(
    paint: Painted | None, made: MeshArrays, report: Mapping[str, Any]
) -> tuple[Floats | None, Floats | None, Finish | Finishes | None]:
    """Return the colors of points and of triangles, and the finish."""
    if paint is None:
        return None, None, None
    points, triangles, _ = made
    sharp = paint.several or report.get("border_points", 0) > 0
    of_triangles = paint.of_triangles(points, triangles) if sharp else None
    return paint.colors(points), of_triangles, paint.finish(points, triangles)


def found_mesh(node: Node, request: MeshRequest) -> tuple[Extracted, Wanted, FieldKernels]:
    """Return the mesh of a tree, what was wanted, and the kernels that it was made with.

    Args:
        node: The tree.
        request: What is asked.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneValueError: The shape cannot be meshed; the message names it and says what to change.
    """
    kernels = FieldKernels(node, request.params, request.time)
    extent = with_size(kernels, extent_of(node, request))
    wanted = _wanted(extent, request)
    try:
        found = meshed(kernels, extent, wanted, watch_of(request))
    except MeshProblem as problem:
        refuse_problem(node, extent, problem)
    if isinstance(found, TooFine):
        refuse_too_fine(node, found, wanted)
    if isinstance(found, Nothing):
        refuse_nothing(node, found, request)
    return found, wanted, kernels


def _wanted(extent: Extent, request: MeshRequest) -> Wanted:
    """Return what is wanted of a mesh."""
    tolerance = request.tolerance or DEFAULT_TOLERANCE * extent.size
    return Wanted(tolerance, request.feature, request.angle or math.inf)


def extent_of(node: Node, request: MeshRequest) -> Extent:
    """Return where the shape is.

    Raises:
        SceneValueError: It has no end, or it is empty.
    """
    (slope, divisor), low, high = box_of(node, request.params, request.time)
    refuse_endless(node, low, high, request)
    positive = slope if 0.0 < slope < STEEP else STEEP
    return Extent(low, high, Slopes(positive, divisor if 0.0 < divisor < STEEP else positive))
