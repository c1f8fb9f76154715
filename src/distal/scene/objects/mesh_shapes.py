"""Shapes from meshes: the author's file or arrays, as a node.

Input: a file or arrays, a spacing. Output: a node that every target compiles, and where it lies.
"""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import LoadError, Span
from distal.fields.guarantees import PRIMITIVES
from distal.fields.solids import volumes as _declares_the_field  # noqa: F401
from distal.lang.lazy_module import LazyModule
from distal.lang.parameter_values import as_float
from distal.lang.resources import Texture3D
from distal.lang.runtime_access import executor
from distal.scene.lowering.derived import DistanceOf
from distal.scene.objects.binding import bound
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.polygons import importing
    from distal.polygons.importing import Imported, ImportReport
else:
    importing = LazyModule("distal.polygons.importing")

_HINT: Final = 'Shape.from_mesh("part.stl"), or from_mesh(points, triangles) with two arrays'
_SIGNS: Final = ("auto", "normals", "winding", "unsigned")


class MeshVolume(Texture3D):
    """The distances to a mesh, with what is known of it."""

    def __init__(self, values: Any, report: ImportReport) -> None:
        super().__init__(values, wrap="clamp")
        self.report = report


def mesh_node(
    source: Any,
    triangles: Any,
    place: Span | None,
    *,
    spacing: Any,
    sign: Any,
    unit: Any,
    up: Any,
) -> tuple[Node, tuple[float, float, float]]:
    """Return the node of a mesh about its center, and the center; see ``Shape.from_mesh``.

    Args:
        source: The path of a file, or points.
        triangles: The triangles of points; None for a file.
        place: The author's line.
        spacing: The distance of two samples, or None.
        sign: How to find the inside.
        unit: The length of a scene unit, or None.
        up: The axis that points up in the mesh, or None.

    Raises:
        SceneValueError: The file cannot be read, or is no mesh with an inside.
        SceneTypeError: ``source`` is neither a path nor an array.
    """
    if sign not in _SIGNS:
        names = ", ".join(f"'{name}'" for name in _SIGNS)
        refuse(f"a sign is one of {names}, not {sign!r:.40}", "sign='auto'", place)
    if up not in (None, "y", "z"):
        refuse(f"up is 'y' or 'z', not {up!r:.40}", "up='z'", place)
    try:
        step = None if spacing is None else as_float("spacing", spacing)
    except (TypeError, ValueError) as error:
        refuse(str(error), "spacing=0.05", place)
    if step is not None and step <= 0.0:
        refuse(f"a spacing is above 0, not {step:g}", "leave it out for a 64th of the size", place)
    try:
        importing.checked_unit(unit)
        wanted = importing.ImportRequest(step, sign, unit, up)
        found = _imported(source, triangles, wanted, place)
    except LoadError as error:
        refuse(error.message, None, place)
    return _measured(found, place), found.center


def reports_of(node: Node) -> tuple[ImportReport, ...]:
    """Return what is known of the meshes in a tree, each once."""
    found: dict[int, ImportReport] = {}
    waiting = [node]
    while waiting:
        each = waiting.pop()
        for value in each.constants.values():
            if isinstance(value, MeshVolume):
                found.setdefault(id(value), value.report)
        waiting.extend(each.children)
    return tuple(found.values())


def _imported(source: Any, triangles: Any, wanted: Any, place: Span | None) -> Imported:
    if triangles is not None:
        return importing.imported_arrays(source, triangles, wanted)
    if not isinstance(source, str | PathLike):
        refuse_kind(f"a mesh is a file or two arrays, not {type(source).__name__}", _HINT, place)
    path = Path(source)
    if place is not None and not path.is_absolute():
        beside = Path(place.file).parent / path
        path = beside if beside.exists() else path
    return importing.imported_file(path, wanted)


def _measured(found: Imported, place: Span | None) -> Node:
    """Return the node, with a report of how far its surface is from the mesh."""
    node = _node(found, found.report, place)
    rows = found.places.shape[:2]
    values = executor().call(DistanceOf(node), (found.places.reshape(-1, 3),), {})
    report = importing.measured(found, values.reshape(rows))
    for message in importing.warnings_of(report):
        if place is None:
            warnings.warn(message, stacklevel=2)
        else:
            warnings.warn_explicit(message, UserWarning, place.file, place.line)
    return _node(found, report, place)


def _node(found: Imported, report: ImportReport, place: Span | None) -> Node:
    rule = PRIMITIVES["VolumeField"]
    volume = MeshVolume(found.values, report)
    numbers, constants = bound(rule, (volume, found.size), {}, place)
    return Node(rule, False, (), numbers, constants, place)
