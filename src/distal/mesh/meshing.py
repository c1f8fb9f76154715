"""Mesh a shape: check what is asked, choose the spacing, report.

Input: a shape and a request. Output: a ``Mesh``, or an error at the author's line that says what to
write instead. What the report holds is in ``docs/guide/meshes.md``.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, NoReturn

import numpy as np

from distal.lang.render_options import Cancel, Progress, checked_time
from distal.mesh import simplify
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
from distal.mesh.palette import MOST as MOST_COLORS
from distal.mesh.parts import PlacedPart, named, part_at, parts_at
from distal.mesh.problems import MeshProblem
from distal.mesh.requests import box_of, watch_of
from distal.mesh.shells import shells_of
from distal.mesh.simplify import Simplified
from distal.mesh.solid import Floats, Integers, Mesh
from distal.mesh.spacing import BALL_CELLS, TooFine, Wanted, meshed
from distal.mesh.surface_box import with_size
from distal.packages import imported
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.objects.meshable import Meshable

# Without a tolerance it is this share of the largest side of the box.
DEFAULT_TOLERANCE: Final = 2e-3
# Without an angle and without a tolerance it is this one, or a larger one where it would need more
# triangles than these.
DEFAULT_ANGLE: Final = math.radians(5.0)
_MOST_BY_ANGLE: Final = 150_000
# A mesh that is simplified first takes this share of the tolerance, and leaves the rest.
FIRST_SHARE: Final = 0.5
_MOST_NAMED: Final = 8  # lost parts that are named
_MOST_ASKED: Final = 100  # members of a union that are asked for their ends
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
        simplify: Whether points that the tolerance can spare are removed.
        angle: How much the surface may turn within a triangle, in radians; None for 5 degrees
            without a tolerance, and for any angle with one or with ``simplify``, which keeps none.
    """

    tolerance: float | None = None
    feature: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    time: float = 0.0
    progress: Progress | None = None
    cancel: Cancel | None = None
    check: bool = False
    colors: bool | int = True
    simplify: bool = False
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
    report = _report(node, found, wanted, request)
    _record_leaves(report, leaves, wanted)
    points, triangles, normals = found.made.points, found.made.triangles, found.normals
    paint = _paint(node, points, triangles, request)
    if paint is not None and paint.varies:
        watch = watch_of(replace(request, progress=None))
        cut = cut_at_borders(points, triangles, normals, paint.appearance, found.step, watch)
        points, triangles, normals = cut.points, cut.triangles, cut.normals
        report["points"], report["triangles"] = len(points), len(triangles)
        report["border_points"] = cut.added
    spared = with_fewer_triangles(
        kernels,
        points,
        triangles,
        paint.labels(points, triangles) if paint is not None and paint.varies else None,
        tolerance=None if request.simplify else wanted.tolerance,
        step=found.step,
        watch=watch_of(replace(request, progress=None)),
    )
    spared.record(report)
    points, normals, triangles = points[spared.points], normals[spared.points], spared.triangles
    at_points, of_triangles, finish = _appearance(paint, points, triangles, report)
    if request.simplify:
        imported(simplify.PACKAGE)
        less = simplify.simplified(
            kernels,
            points,
            triangles,
            of_triangles,
            error=report["error"]["largest"],
            tolerance=wanted.tolerance,
            step=found.step,
            watch=watch_of(replace(request, progress=None)),
        )
        _record_simplified(report, less)
        if less is not None:
            triangles = less.triangles
            points, normals = points[less.points], normals[less.points]
            at_points, of_triangles, finish = _appearance(paint, points, triangles, report)
    report |= asdict(shells_of(points, triangles))
    report["size"], report["volume"] = size_and_volume(points, triangles)
    if request.check:
        report["check"] = checked(points, triangles, watch_of(request))
    report["rows"] = kernels.rows
    report["cpu_s"] = clock.process_time() - begin
    if request.progress is not None:
        request.progress(1.0)
    made = (points, triangles, normals)
    return Mesh(*made, at_points, of_triangles, report, node.name, finish)


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
    share = FIRST_SHARE if request.simplify else 1.0
    watch = watch_of(replace(request, progress=None))
    extent = extent_of(node, request)
    found, leaves = with_all_leaves(kernels, extent, found, share * wanted.tolerance, watch)
    if leaves.missing:
        refuse_missing(leaves.missing, "mesh", "feature={width}, or a smaller tolerance=")
    return found, leaves


def _record_leaves(report: dict[str, Any], leaves: LeafCheck, wanted: Wanted) -> None:
    """Add to the report what the comparison of leaves with the mesh found."""
    report["leaves"] = leaves.report()
    error = report["error"]
    known = max(wanted.tolerance, error["largest"], error["cut_corner"])
    if leaves.error_at is not None and leaves.error > known:
        error["surface_to_mesh"] = error["largest"] = leaves.error
        error["place"] = list(leaves.error_at)
        report["warnings"].append(
            f"the tolerance {wanted.tolerance:g} is exceeded: {leaves.error:.3g} at "
            f"{shown_place(leaves.error_at)}"
        )
    report["warnings"] += leaves.warnings()


def _paint(node: Node, points: Floats, triangles: Integers, request: MeshRequest) -> Painted | None:
    """Return the appearance of a tree, with the colors that were asked for; None without any."""
    if request.colors is False:
        return None
    most = None if request.colors is True else request.colors
    given, time = request.params, request.time
    return painted(node, points, triangles, params=given, time=time, most=most)


def _appearance(
    paint: Painted | None, points: Floats, triangles: Integers, report: Mapping[str, Any]
) -> tuple[Floats | None, Floats | None, Finish | Finishes | None]:
    """Return the colors of points and of triangles, and the finish."""
    if paint is None:
        return None, None, None
    sharp = paint.several or report.get("border_points", 0) > 0
    of_triangles = paint.of_triangles(points, triangles) if sharp else None
    return paint.colors(points), of_triangles, paint.finish(points, triangles)


def _record_simplified(report: dict[str, Any], less: Simplified | None) -> None:
    """Change the report to what it says about the mesh with fewer triangles."""
    if less is None:
        report["warnings"].append(
            "the mesh was not simplified: no mesh with fewer triangles is within the tolerance"
        )
        return
    error = report["error"]
    report["points"], report["triangles"] = len(less.points), len(less.triangles)
    # What manifold3d removes moves the surface by less than it is allowed to.
    error["surface_to_mesh"] += less.moved
    error["mesh_to_surface"], error["mean"] = less.largest, less.mean
    error["place"] = list(less.place)
    error["largest"] = max(less.largest, error["surface_to_mesh"])


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
    share = FIRST_SHARE if request.simplify else 1.0
    first = replace(wanted, tolerance=share * wanted.tolerance)
    try:
        found = meshed(kernels, extent, first, watch_of(request))
    except MeshProblem as problem:
        refuse_problem(node, extent, problem)
    if isinstance(found, TooFine):
        if found.tolerance is not None:
            found = replace(found, tolerance=found.tolerance / share)
        _refuse_too_fine(node, found, wanted)
    if isinstance(found, Nothing):
        refuse_nothing(node, found, request)
    return found, wanted, kernels


def _wanted(extent: Extent, request: MeshRequest) -> Wanted:
    """Return what is wanted of a mesh."""
    tolerance = request.tolerance or DEFAULT_TOLERANCE * extent.size
    if request.angle is not None:
        return Wanted(tolerance, request.feature, request.angle)
    if request.tolerance is not None or request.simplify:
        return Wanted(tolerance, request.feature)
    return Wanted(tolerance, request.feature, DEFAULT_ANGLE, _MOST_BY_ANGLE)


def extent_of(node: Node, request: MeshRequest) -> Extent:
    """Return where the shape is.

    Raises:
        SceneValueError: It has no end, or it is empty.
    """
    (slope, divisor), low, high = box_of(node, request.params, request.time)
    endless = _axes_without_end(low, high)
    if endless:
        refuse(
            f"'{node.name}' has no end along {' and '.join(endless)}, and a mesh is of a part of "
            "space with an end",
            _endless_hint(node, request),
            node.place,
        )
    if (low >= high).any():
        refuse(f"'{node.name}' is empty: its box has no volume", None, node.place)
    positive = slope if 0.0 < slope < STEEP else STEEP
    return Extent(low, high, Slopes(positive, divisor if 0.0 < divisor < STEEP else positive))


def _axes_without_end(low: Floats, high: Floats) -> list[str]:
    return [axis for axis, a, b in zip("xyz", low, high, strict=True) if not math.isfinite(b - a)]


def _endless_hint(node: Node, request: MeshRequest) -> str:
    """Return what to write: a union without its infinite members, or a box."""
    members = node.children if node.rule.name == "union" else ()
    endless = []
    for member in members[:_MOST_ASKED]:
        _, low, high = box_of(member, request.params, request.time)
        if _axes_without_end(low, high):
            endless.append(f"'{member.name}'")
    if 0 < len(endless) < len(members):
        names = ", ".join(dict.fromkeys(endless))
        return f"leave out {names}; distal mesh FILE:NAME meshes one shape of a file"
    return "intersect it with a box: shape & Box(…); an own function takes bounds=(low, high)"


def refuse_problem(node: Node, extent: Extent, problem: MeshProblem) -> NoReturn:
    """Refuse a shape that cannot be meshed, with what to write instead.

    Args:
        node: The shape.
        extent: Its box.
        problem: What prevents a mesh.

    Raises:
        SceneValueError: Always.
    """
    where = "" if problem.place is None else f" at {shown_place(problem.place)}"
    match problem.kind:
        case "no number":
            refuse(
                f"the value of '{node.name}'{where} is no finite number",
                "avoid divisions by 0, and roots and logarithms of negative numbers",
                node.place,
            )
        case "leaves its box":
            refuse(
                f"the surface of '{node.name}' leaves its box: it goes on{where}",
                f"give larger bounds than {shown_place(extent.low)} to {shown_place(extent.high)}",
                node.place,
            )
        case "too far":
            x, y, z = (-float(number) for number in (extent.low + extent.high) / 2.0)
            refuse(
                f"'{node.name}' is too far from the origin for so fine a mesh: files hold 7 digits",
                f"mesh it at the origin: .translate({x:.4g}, {y:.4g}, {z:.4g})",
                node.place,
            )
        case "too many":
            hint = "give a smaller slope=, smaller bounds=, or a larger feature= and tolerance="
            refuse(
                f"the surface of '{node.name}' is in too many places to look at", hint, node.place
            )


def _refuse_too_fine(node: Node, found: TooFine, wanted: Wanted) -> NoReturn:
    many = f"a mesh of '{node.name}' with this"
    about = f"needs about {rounded(found.triangles):,.0f} triangles"
    if found.by_feature:
        feature = found.step * BALL_CELLS
        refuse(f"{many} feature {about}", f"feature={above(feature):.2g}", node.place)
    assert found.tolerance is not None
    hint = f"tolerance={above(found.tolerance):.2g}"
    refuse(f"{many} tolerance, {wanted.tolerance:g}, {about}", hint, node.place)


def refuse_nothing(node: Node, found: Nothing, request: MeshRequest) -> NoReturn:
    """Refuse a shape without a mesh, with what to write instead.

    Args:
        node: The shape.
        found: What was looked at.
        request: What was asked.

    Raises:
        SceneValueError: Always.
    """
    if not len(found.lost):
        refuse(f"'{node.name}' has no inside: its values are positive everywhere", None, node.place)
    part = part_at(node, found.lost[0], request.params, request.time)
    thin = found.step * BALL_CELLS
    refuse(
        f"nothing of '{node.name}' is as thick as {thin:.2g}: {part.text} is thinner at "
        f"{shown_place(found.lost[0])}",
        f"a smaller feature=, such as {thin / 4.0:.2g}",
        node.place,
    )


def shown_place(place: Sequence[float] | Floats) -> str:
    """Return a place for messages."""
    return f"({', '.join(f'{number:.4g}' for number in place)})"


def rounded(number: float) -> float:
    """Return a number rounded to one digit."""
    return float(f"{number:.1g}")


def above(number: float) -> float:
    """Return a number rounded up to two digits."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 1)
    return math.ceil(number / unit) * unit


def _report(node: Node, found: Extracted, wanted: Wanted, request: MeshRequest) -> dict[str, Any]:
    """Return the report of a mesh.

    Args:
        node: The shape.
        found: The mesh.
        wanted: The tolerance and the feature size.
        request: What was asked.
    """
    accuracy = found.accuracy
    error = max(accuracy.largest, accuracy.from_surface)
    lost = _lost_parts(node, found, request)
    warnings = [
        f"{part['name']} is thinner than {found.step * BALL_CELLS:.3g} at "
        f"{shown_place(part['place'])}: parts of it are missing"
        for part in lost
    ]
    if error > wanted.tolerance:
        warnings.append(
            f"the tolerance {wanted.tolerance:g} is exceeded: {error:.3g} at "
            f"{shown_place(accuracy.place)}"
        )
    needed = found.looked_at.needed
    assert needed is not None
    if needed.narrower and not lost:
        near = ", ".join(sorted({named(leaf) for leaf in needed.narrower})[:_MOST_NAMED])
        warnings.append(
            f"parts, walls or gaps of {near} are thinner than the smallest possible cells, "
            f"{needed.sure_to:.2g}: some may be missing"
        )
    corner = found.corner
    if corner.distance > wanted.tolerance and not lost:
        part = part_at(node, np.array(corner.place), request.params, request.time)
        warnings.append(
            f"a corner of {part.text} is cut by up to {corner.distance:.3g} at "
            f"{shown_place(corner.place)}: it ends between samples"
        )
    if found.exceeds_slope:
        part = part_at(node, found.steepest_at, request.params, request.time)
        warnings.append(
            f"{part.text} changes {found.steepest:.3g} times as fast as its slope says, at "
            f"{shown_place(found.steepest_at)}: separate parts may be missing"
        )
    return {
        "tolerance": wanted.tolerance,
        "angle": wanted.angle if math.isfinite(wanted.angle) else None,
        "feature": found.step * BALL_CELLS,
        "sure_to": needed.sure_to * BALL_CELLS,
        "unknown_widths": sorted({named(leaf) for leaf in needed.unknown})[:_MOST_NAMED],
        "spacing": found.step,
        "levels": found.levels,
        "joined": found.joined,
        "cells": found.cells,
        "bricks": found.sampled,
        "points": len(found.made.points),
        "triangles": len(found.made.triangles),
        "error": {
            "largest": error,
            "mean": accuracy.mean,
            "place": list(accuracy.place),
            "mesh_to_surface": accuracy.largest,
            "surface_to_mesh": accuracy.from_surface,
            "at_points": accuracy.at_points,
            "cut_corner": corner.distance,
        },
        "crease_points": found.creases,
        "cut_points": accuracy.cut,
        "fans": found.made.fans,
        "lost": lost,
        "warnings": warnings,
    }


def _lost_parts(node: Node, found: Extracted, request: MeshRequest) -> list[dict[str, Any]]:
    """Return the shapes that are too thin in places: name, line, one place and how many."""
    places = found.lost
    parts: dict[PlacedPart, dict[str, Any]] = {}
    for part, place in zip(
        parts_at(node, places, request.params, request.time), places, strict=True
    ):
        first = {"name": part.text, "line": part.line, "place": place.tolist(), "count": 0}
        parts.setdefault(part, first)["count"] += 1
    return list(parts.values())[:_MOST_NAMED]
