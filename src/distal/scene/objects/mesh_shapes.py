"""Shapes from meshes: the author's file or arrays, as a node.

Input: a file or arrays, a spacing. Output: a node that every target compiles, and where it lies.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import LoadError, Span
from distal.lang.lazy_module import LazyModule
from distal.lang.notices import notice
from distal.lang.parameter_values import as_float
from distal.lang.resources import Buffer, Texture3D
from distal.lang.runtime_access import executor
from distal.lang.units import meters_of
from distal.scene.lowering.derived import DistanceOf
from distal.scene.objects.materials import as_material
from distal.scene.objects.patterns import volume_colors
from distal.scene.objects.volume_shapes import beside_author, brick_node, grid_node
from distal.scene.tree.calls import Pattern
from distal.scene.tree.errors import refuse, refuse_kind, warn
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.polygons import bricks, importing
    from distal.polygons.colors import ColorGrid
    from distal.polygons.importing import Imported, ImportReport, ImportRequest
    from distal.polygons.importing_points import ImportedPoints, PointsReport

    Report = ImportReport | PointsReport
else:
    bricks = LazyModule("distal.polygons.bricks")
    importing = LazyModule("distal.polygons.importing")

_HINT: Final = 'Shape.from_mesh("part.stl"), or from_mesh(points, triangles) with two arrays'
_SIGNS: Final = ("auto", "normals", "winding", "unsigned")


class MeshVolume(Texture3D):
    """The distances to a mesh or to points, with what is known of them."""

    def __init__(self, values: Any, report: Report) -> None:
        super().__init__(values, wrap="clamp")
        self.report = report


class MeshBricks(Buffer):
    """The distances to a mesh or to points in bricks, with what is known of them."""

    def __init__(self, numbers: Any, report: Report) -> None:
        super().__init__(numbers)
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
    colors: Any = False,
    max_memory: Any = None,
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
        colors: Whether to use the colors of a file, or the colors of points.
        max_memory: The most bytes that a file may become, or None.

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
        if unit is not None:
            meters_of(unit, LoadError)
        shades = None if isinstance(colors, bool) or colors is None else colors
        is_colored = colors is True or shades is not None
        wanted = importing.ImportRequest(step, sign, unit, up, is_colored, max_memory)
        found = _imported(source, triangles, wanted, shades, place)
    except LoadError as error:
        refuse(error.message, None, place)
    node = _measured(found, place)
    if found.colors is not None:
        node = node.with_material(as_material(_colors(found, found.colors, place)))
    return node, found.center


def _colors(found: Imported, colors: ColorGrid, place: Span | None) -> Pattern:
    texture = Texture3D(colors.values, wrap="clamp")
    x, y, z = (a - b for a, b in zip(colors.middle, found.center, strict=True))
    return volume_colors(texture, (x, y, z), colors.size, place)


def reports_of(node: Node) -> tuple[Report, ...]:
    """Return what is known of the meshes and points in a tree, each once."""
    found: dict[int, Report] = {}
    waiting = [node]
    while waiting:
        each = waiting.pop()
        for value in each.constants.values():
            if isinstance(value, MeshVolume | MeshBricks):
                found.setdefault(id(value), value.report)
        waiting.extend(each.children)
    return tuple(found.values())


def _imported(
    source: Any, triangles: Any, wanted: ImportRequest, colors: Any, place: Span | None
) -> Imported:
    if triangles is not None:
        return importing.imported_arrays(source, triangles, wanted, colors)
    if colors is not None:
        message = "a file has its own colors: colors=True shows them"
        refuse_kind(f"{message}; an array of colors goes with arrays", _HINT, place)
    if not isinstance(source, str | PathLike):
        refuse_kind(f"a mesh is a file or two arrays, not {type(source).__name__}", _HINT, place)
    return importing.imported_file(beside_author(source, place), wanted)


def _measured(found: Imported, place: Span | None) -> Node:
    """Return the node, with a report of how far its surface is from the mesh."""
    rows = found.places.shape[:2]
    values = values_at(found, found.places.reshape(-1, 3), place)
    report = importing.measured(found, values.reshape(rows))
    tell(importing.warnings_of(report), importing.notice_of(report), place)
    return sampled_node(found, report, place)


def values_at(found: Imported | ImportedPoints, places: Any, place: Span | None) -> Any:
    """Return the values of the field of a grid at places, (n, 3), from its center."""
    node = sampled_node(found, found.report, place)
    return executor().call(DistanceOf(node), (places,), {})


def tell(messages: Sequence[str], line: str, place: Span | None) -> None:
    """Warn of what is wrong at the author's line, and give a host the line about an import.

    Args:
        messages: The warnings.
        line: What was done.
        place: The author's line.
    """
    for message in messages:
        warn(message, place)
    notice(line)


def sampled_node(found: Imported | ImportedPoints, report: Report, place: Span | None) -> Node:
    """Return the node of a grid or of bricks about the center.

    Args:
        found: The samples.
        report: What is known of them.
        place: The author's line.
    """
    values = found.values
    if isinstance(values, bricks.BrickSamples):
        numbers = MeshBricks(values.numbers, report)
        return brick_node(numbers, values, found.size, 1.0, place)
    return grid_node(MeshVolume(values, report), found.size, 1.0, place)
