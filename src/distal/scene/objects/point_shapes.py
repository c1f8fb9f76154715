"""Shapes from points with normals: the author's file or arrays, as a node.

Input: a file or arrays, a spacing. Output: a node that every target compiles, and where it lies.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import LoadError, Span
from distal.lang.lazy_module import LazyModule
from distal.lang.parameter_values import as_float
from distal.lang.units import meters_of
from distal.scene.objects.mesh_shapes import sampled_node, tell, values_at
from distal.scene.objects.volume_shapes import beside_author
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.polygons import importing, importing_points
else:
    importing = LazyModule("distal.polygons.importing")
    importing_points = LazyModule("distal.polygons.importing_points")

_HINT: Final = 'Shape.from_points("scan.ply"), or from_points(points, normals) with two arrays'


def points_node(
    source: Any,
    normals: Any,
    place: Span | None,
    *,
    spacing: Any,
    radius: Any,
    unit: Any,
    up: Any,
    max_memory: Any = None,
) -> tuple[Node, tuple[float, float, float]]:
    """Return the node of points about their center, and the center; see ``Shape.from_points``.

    Args:
        source: The path of a file, or points.
        normals: The normals of points; None for a file.
        place: The author's line.
        spacing: The distance of two samples, or None.
        radius: Within which points count, or None.
        unit: The length of a scene unit, or None.
        up: The axis that points up, or None.
        max_memory: The most bytes that a file may become, or None.

    Raises:
        SceneValueError: The file cannot be read, or its points have no inside.
        SceneTypeError: ``source`` is neither a path nor an array.
    """
    if up not in (None, "y", "z"):
        refuse(f"up is 'y' or 'z', not {up!r:.40}", "up='z'", place)
    lengths = [_length(n, value, place) for n, value in (("spacing", spacing), ("radius", radius))]
    try:
        if unit is not None:
            meters_of(unit, LoadError)
        wanted = importing_points.PointsRequest(lengths[0], lengths[1], unit, up, max_memory)
        if normals is not None:
            found = importing_points.imported_points_arrays(source, normals, wanted)
        elif isinstance(source, str | PathLike):
            found = importing_points.imported_points_file(beside_author(source, place), wanted)
        else:
            message = f"points are a file or two arrays, not {type(source).__name__}"
            refuse_kind(f"{message} without normals", _HINT, place)
    except LoadError as error:
        refuse(error.message, None, place)
    report = importing_points.measured_points(found, values_at(found, found.places, place))
    tell(
        importing_points.warnings_of_points(report),
        importing_points.notice_of_points(report),
        place,
    )
    return sampled_node(found, report, place), found.center


def _length(name: str, value: Any, place: Span | None) -> float | None:
    if value is None:
        return None
    try:
        found = as_float(name, value)
    except (TypeError, ValueError) as error:
        refuse(str(error), f"{name}=0.05", place)
    if found <= 0.0:
        refuse(f"a {name} is above 0, not {found:g}", "leave it out for the usual one", place)
    return found
