"""The outline of a flat shape: check what is asked, trace, report.

Input: a flat shape and a request. Output: an ``Outline``, or an error at the author's line that
says what to write instead. What the report holds is in ``docs/guide/printing.md``.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, NoReturn

from distal.lang.render_options import Cancel, Progress, checked_time
from distal.mesh.kernels import FieldKernels
from distal.mesh.leaf_check import refuse_missing
from distal.mesh.outlines.accuracy import area_and_length
from distal.mesh.outlines.all_leaves import traced_with_leaves
from distal.mesh.outlines.outline import Outline
from distal.mesh.outlines.tiles import FlatExtent, Floats, values_at
from distal.mesh.outlines.tracing import NoOutline, TooManyTiles, TracedOutline
from distal.mesh.problems import MeshProblem
from distal.mesh.requests import box_of, watch_of
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.objects.field import BaseShape

# Without a tolerance it is this share of the largest side of the box.
DEFAULT_TOLERANCE: Final = 2e-4
_FINEST_TOLERANCE: Final = 1e-7  # points are rounded to 4e-9 of the box
_SLOPE_ROUNDING: Final = 1.001
_STEEP: Final = 1e6  # a slope above it says nothing


@dataclass(frozen=True, slots=True)
class OutlineRequest:
    """What is asked of an outline.

    Attributes:
        tolerance: How far it may be from the edge, in scene units; None for 0.0002 of the largest
            side of the shape's box.
        params: Values of parameters by name.
        time: Seconds.
        progress: Called with the finished share, from 0 to 1.
        cancel: An event, or a function without arguments, that ends the work early.
    """

    tolerance: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    time: float = 0.0
    progress: Progress | None = None
    cancel: Cancel | None = None

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises:
            SceneValueError: The tolerance is not a positive number.
        """
        value = self.tolerance
        if value is not None:
            valid = isinstance(value, int | float) and not isinstance(value, bool)
            if not valid or not 0.0 < value < math.inf:
                refuse(f"tolerance is a length above 0, not {value!r:.40}", "tolerance=0.01")
        object.__setattr__(self, "time", checked_time(self.time))


def outline_of(shape: BaseShape, request: OutlineRequest) -> Outline:
    """Return the outline of a flat shape; see ``Shape2D.outline``.

    Args:
        shape: The shape.
        request: What is asked.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneValueError: The shape has no outline; the message names it and says what to change.
    """
    node = shape.node
    kernels = FieldKernels(node, request.params, request.time)
    found = outline_or_none(kernels, request)
    if isinstance(found, NoOutline):
        _refuse_nothing(node, found)
    if request.progress is not None:
        request.progress(1.0)
    return found


def outline_or_none(kernels: FieldKernels, request: OutlineRequest) -> Outline | NoOutline:
    """Return the outline of a flat shape, or why there is none.

    Args:
        kernels: The shape, with values of its parameters.
        request: What is asked; its parameters are those of ``kernels``.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneValueError: The shape has no outline; the message names it and says what to change.
    """
    node, begin = kernels.node, clock.process_time()
    extent = _extent_of(kernels)
    tolerance = request.tolerance or DEFAULT_TOLERANCE * extent.size
    if tolerance < _FINEST_TOLERANCE * extent.size:
        hint = f"tolerance={_FINEST_TOLERANCE * extent.size:.2g}"
        refuse(f"tolerance {tolerance:g} is too fine for the size of '{node.name}'", hint)
    try:
        found = traced_with_leaves(kernels, extent, tolerance, watch_of(request))
    except MeshProblem as problem:
        _refuse_problem(node, extent, problem)
    if isinstance(found, NoOutline):
        if not found.sampled:
            _refuse_false_slope(kernels, extent)
        return found
    if isinstance(found, TooManyTiles):
        refuse(
            f"an outline of '{node.name}' with the tolerance {tolerance:g} needs about "
            f"{float(f'{found.points:.1g}'):,.0f} points",
            f"tolerance={found.tolerance:.2g}",
            node.place,
        )
    outline, leaves = found.outline, found.leaves
    if leaves.missing:
        hint = "make it wider, or take the outline of a part: shape & Rectangle(…)"
        refuse_missing(leaves.missing, "outline", hint)
    area, length = area_and_length(outline.loops)
    report = _report(node, extent, outline, tolerance)
    report["leaves"] = leaves.report()
    report["warnings"] += leaves.warnings()
    report |= {"area": area, "length": length, "cpu_s": clock.process_time() - begin}
    return Outline(outline.loops, area, length, report, node.name)


def _extent_of(kernels: FieldKernels) -> FlatExtent:
    """Return where the shape is.

    Raises:
        SceneValueError: It has no end, or it is empty.
    """
    node = kernels.node
    (slope, divisor), low, high = box_of(node, kernels.params, kernels.time)
    endless = [a for a, b, c in zip("xy", low, high, strict=False) if not math.isfinite(c - b)]
    if endless:
        refuse(
            f"'{node.name}' has no end along {' and '.join(endless)}, and an outline is closed",
            "intersect it with a rectangle: shape & Rectangle(…); an own function takes "
            "bounds=(low, high)",
            node.place,
        )
    if (low >= high).any():
        refuse(f"'{node.name}' is empty: its box has no area", None, node.place)
    positive = slope if 0.0 < slope < _STEEP else _STEEP
    return FlatExtent(low, high, positive, divisor if 0.0 < divisor < _STEEP else positive)


def _refuse_problem(node: Node, extent: FlatExtent, problem: MeshProblem) -> NoReturn:
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
                f"the edge of '{node.name}' leaves its box: it goes on{where}",
                f"give larger bounds than {shown_place(extent.low)} to {shown_place(extent.high)}",
                node.place,
            )
        case "too many" | "too far":
            refuse(
                f"the edge of '{node.name}' is in too many places to look at",
                "give a smaller slope=, smaller bounds=, or a larger tolerance=",
                node.place,
            )


def _refuse_false_slope(kernels: FieldKernels, extent: FlatExtent) -> None:
    """Refuse a shape without an edge whose box has a middle inside: its slope cannot be true."""
    node, middle = kernels.node, (extent.low + extent.high) * 0.5
    if values_at(kernels, middle[None])[0] < 0.0:
        refuse(
            f"'{node.name}' is inside at {shown_place(middle)}, and its slope, {extent.slope:g}, "
            "says that it has no edge in its box",
            "a larger slope=",
            node.place,
        )


def _refuse_nothing(node: Node, found: NoOutline) -> NoReturn:
    if not len(found.thin):
        refuse(f"'{node.name}' has no inside: its values are positive everywhere", None, node.place)
    refuse(
        f"nothing of '{node.name}' is as thick as {found.step:.2g}: it is thinner at "
        f"{shown_place(found.thin[0])}",
        "make it thicker, or scale it alone",
        node.place,
    )


def shown_place(place: Sequence[float] | Floats) -> str:
    """Return a place for messages."""
    return f"({', '.join(f'{number:.4g}' for number in place)})"


def _report(
    node: Node, extent: FlatExtent, found: TracedOutline, tolerance: float
) -> dict[str, Any]:
    """Return the report of an outline.

    Args:
        node: The shape.
        extent: Its box and slope.
        found: The outline.
        tolerance: The tolerance.
    """
    error, warnings = found.error, []
    if len(found.thin):
        warnings.append(
            f"'{node.name}' is thinner than {found.step:.3g} at {shown_place(found.thin[0])}: "
            "parts or gaps of it are missing"
        )
    if error.largest > tolerance:
        warnings.append(
            f"the tolerance {tolerance:g} is exceeded: {error.largest:.3g} at "
            f"{shown_place(error.place)}"
        )
    if found.steepest > extent.slope * _SLOPE_ROUNDING:
        warnings.append(
            f"'{node.name}' changes {found.steepest / extent.slope:.3g} times as fast as its slope "
            f"says, at {shown_place(found.steepest_at)}: separate parts may be missing"
        )
    if found.crossings:
        warnings.append(f"{found.crossings} pairs of lines of '{node.name}' cross")
    return {
        "tolerance": tolerance,
        "spacing": found.step,
        "cells": found.cells,
        "tiles": found.sampled,
        "loops": len(found.loops),
        "points": sum(len(loop) for loop in found.loops),
        "corners": sum(int(corner.sum()) for corner in found.corners),
        "error": error.largest,
        "error_at": list(error.place),
        "cut_corner": found.cut,
        "crossings": found.crossings,
        "warnings": warnings,
    }
