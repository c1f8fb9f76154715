"""Shapes from volumes of samples: the author's file or array, as a node.

Input: a file or an array, the distances of samples, a level. Output: a node that every target
compiles.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from distal.diagnostics import LoadError, Span
from distal.fields.guarantees import PRIMITIVES
from distal.fields.solids import bricks as _declares_bricks  # noqa: F401
from distal.fields.solids import volumes as _declares_the_field  # noqa: F401
from distal.lang.lazy_module import LazyModule
from distal.lang.notices import notice
from distal.lang.parameter_values import as_float
from distal.lang.resources import AXES, Buffer, Texture3D, checked_axes
from distal.lang.source import folder_of
from distal.scene.objects.binding import bound
from distal.scene.tree.errors import refuse, warn
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.polygons import bricks, volumes
    from distal.polygons.bricks import BrickSamples
else:
    bricks = LazyModule("distal.polygons.bricks")
    volumes = LazyModule("distal.polygons.volumes")


def volume_node(
    source: Any, place: Span | None, *, spacing: Any, axes: Any, level: Any, max_memory: Any = None
) -> tuple[Node, list[list[float]] | None]:
    """Return the node of a volume about the origin, and the matrix that places it, or None.

    See ``Shape.from_volume``.

    Args:
        source: The path of a file, or an array.
        place: The author's line.
        spacing: The distance of two samples, one number or three, or None.
        axes: The order of the axes of an array.
        level: The value at the surface, or None for distances.
        max_memory: The most bytes that a file may become, or None.

    Raises:
        SceneValueError: The file cannot be read, or is no volume with an inside.
    """
    try:
        checked_axes(axes)
    except ValueError as error:
        refuse(str(error), None, place)
    try:
        given = None if spacing is None else _three(spacing)
        at = None if level is None else as_float("level", level)
        if isinstance(source, str | PathLike):
            path = beside_author(source, place)
            found = volumes.read_volume(path, max_memory)
            is_ordered = path.suffix.lower() != ".npy"
        else:
            found = volumes.of_array(source)
            is_ordered = False
        if found.is_mask:
            at = _level_of_mask(at)
        step = given or found.spacing or (1.0, 1.0, 1.0)
        field = volumes.field_of(found.values, AXES if is_ordered else axes, step, at)
        x, y, z = (along / field.scale for along in step)
        parts = bricks.from_grid(field.values, (z, y, x))
    except LoadError as error:
        refuse(error.message, None, place)
    except (TypeError, ValueError) as error:
        refuse(str(error), "spacing=0.5, or spacing=(0.5, 0.5, 1.0) along x, y and z", place)
    if at is None and field.scale < 1.0:
        warn(
            f"neighboring samples differ by up to {1.0 / field.scale:.3g} times their distance, so "
            "they are no distances: they are divided by that; give spacing= if it is another one, "
            "or level= if they are no distances",
            place,
        )
    name = Path(source).name if isinstance(source, str | PathLike) else "array"
    notice(volumes.notice_of(name, field, step))
    if parts is not None:
        node = brick_node(Buffer(parts.numbers), parts, field.size, field.scale, place)
    else:
        volume = Texture3D(field.values, wrap="clamp")
        node = grid_node(volume, field.size, field.scale, place)
    return node, volumes.matrix_of(found, given)


def _level_of_mask(level: float | None) -> float:
    """Return the level of bools, whose surface is halfway between inside and outside.

    Raises:
        LoadError: The author gives one.
    """
    if level is not None:
        raise LoadError(
            "a mask of bools is inside where it is True and has no level: leave level= out, or "
            "write mask.astype(float)"
        )
    return 0.5


Size = tuple[float, float, float]


def grid_node(volume: Texture3D, size: Size, scale: float, place: Span | None) -> Node:
    """Return the node of a grid of samples.

    Args:
        volume: The samples.
        size: The size of their cells together.
        scale: By what they are multiplied.
        place: The author's line.
    """
    rule = PRIMITIVES["VolumeField"]
    numbers, constants = bound(rule, (volume, size, scale), {}, place)
    return Node(rule, False, (), numbers, constants, place)


def brick_node(
    values: Buffer, found: BrickSamples, size: Size, scale: float, place: Span | None
) -> Node:
    """Return the node of samples in bricks.

    Args:
        values: Their numbers.
        found: How they are arranged.
        size: The size of the cells of all samples together.
        scale: By what they are multiplied.
        place: The author's line.
    """
    rule = PRIMITIVES["BrickField"]
    given = (values, found.samples, size, found.reach, scale)
    numbers, constants = bound(rule, given, {}, place)
    return Node(rule, False, (), numbers, constants, place)


def _three(spacing: Any) -> tuple[float, float, float]:
    parts = list(spacing) if isinstance(spacing, Sequence) else [spacing] * 3
    if len(parts) != 3:
        raise ValueError(f"a spacing is one number or three, not {len(parts)}")
    x, y, z = (as_float("spacing", part) for part in parts)
    if min(x, y, z) <= 0.0:
        raise ValueError(f"a spacing is above 0, not {min(x, y, z):g}")
    return x, y, z


def beside_author(source: str | PathLike[str], place: Span | None) -> Path:
    """Return the path of a file, beside the author's file if it is there."""
    path = Path(source)
    if place is not None and not path.is_absolute():
        beside = Path(folder_of(place.file)) / path
        path = beside if beside.exists() else path
    return path
