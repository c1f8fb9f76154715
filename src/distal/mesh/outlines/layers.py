"""Layers of a solid: its outlines at heights along an axis.

Input: a solid and a layer height. Output: layers, one after another. The height is a parameter of
one slice, so all layers use the same compiled code.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from distal.lang.parameters import slider
from distal.lang.render_options import Progress
from distal.mesh.accuracy import NARROWEST
from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines.outline import Outline
from distal.mesh.outlines.outlining import (
    OutlineRequest,
    outline_or_none,
    shown_place,
)
from distal.mesh.outlines.tiles import Floats
from distal.mesh.outlines.tracing import NoOutline
from distal.mesh.requests import box_of
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.scene.objects.shape import Shape

AXES: Final = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
MOST_LAYERS: Final = 100_000
# The parameter that moves the slice; an author's parameter of this name would be a coincidence.
_PLACE: Final = "place_of_the_layer"


@dataclass(frozen=True, slots=True)
class SolidLayer:
    """One layer.

    Attributes:
        place: Where its plane is along the axis.
        outline: Its outline; None if the solid is not there.
        frame: The corners of the box of all layers, in the plane.
        warning: Why there is none although the solid may be there, or None.
    """

    place: float
    outline: Outline | None
    frame: tuple[Floats, Floats] | None = None
    warning: str | None = None


def layer_places(shape: Shape, height: float, axis: str, request: OutlineRequest) -> list[float]:
    """Return where the layers of a solid are: in the middle of each, from its box's low end.

    Args:
        shape: The solid.
        height: The height of a layer, in scene units.
        axis: The axis along which the solid is cut, a key of ``AXES``.
        request: The values of parameters.

    Raises:
        SceneValueError: The solid has no end along the axis, is empty, or has too many layers.
    """
    node, along = shape.node, list(AXES).index(axis)
    _, low, high = box_of(node, request.params, request.time)
    begin, end = float(low[along]), float(high[along])
    if not math.isfinite(end - begin):
        hint = "intersect it with a box: shape & Box(…)"
        refuse(f"'{node.name}' has no end along {axis}, and layers end", hint, node.place)
    if begin >= end:
        refuse(f"'{node.name}' is empty: its box has no volume", None, node.place)
    if (end - begin) / height > MOST_LAYERS:
        refuse(
            f"'{node.name}' has about {(end - begin) / height:,.0f} layers of {height:g}, and "
            f"{MOST_LAYERS:,} are the most",
            f"height={(end - begin) / MOST_LAYERS:.2g}",
            node.place,
        )
    # A last layer whose middle is above the top has nothing in it.
    count = max(math.ceil((end - begin) / height - 0.5), 1)
    return [begin + (index + 0.5) * height for index in range(count)]


def layers_at(
    shape: Shape, places: list[float], axis: str, request: OutlineRequest
) -> Iterator[SolidLayer]:
    """Yield the layers of a solid at places along an axis.

    On a layer across y, x is that of space and y is -z, as files with z up have it.

    Args:
        shape: The solid.
        places: Where the layers are.
        axis: The axis along which the solid is cut, a key of ``AXES``.
        request: What is asked of each outline; its progress counts all layers.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneValueError: A layer has no outline; the message names it and says what to change.
    """
    width = 1.0 + max(abs(place) for place in places)
    moved = slider(_PLACE, 0.0, low=-width, high=width)
    origin = tuple(moved * part if part else 0.0 for part in AXES[axis])
    node = shape.slice(origin, AXES[axis]).node
    _, low, high = box_of(node, {**request.params, _PLACE: 0.0}, request.time)
    # In the plane of faces that touch, the value is 0 inside of the solid: just above, it is not.
    size = float((high - low).max())
    above = 0.25 * NARROWEST * size if math.isfinite(size) else 0.0
    for index, place in enumerate(places):
        params = {**request.params, _PLACE: place + above}
        kernels = FieldKernels(node, params, request.time)
        one = replace(request, params=params, progress=_part_of(request, index, len(places)))
        found = outline_or_none(kernels, one)
        if isinstance(found, Outline):
            yield SolidLayer(place, found, (low, high))
        else:
            yield SolidLayer(place, None, None, _thin(place, found))
    if request.progress is not None:
        request.progress(1.0)


def _part_of(request: OutlineRequest, index: int, count: int) -> Progress | None:
    """Return the progress of one layer of several.

    Args:
        request: What is asked.
        index: The number of the layer, from 0.
        count: How many layers there are.
    """
    progress = request.progress
    return None if progress is None else lambda share: progress((index + share) / count)


def _thin(place: float, found: NoOutline) -> str | None:
    """Return that a layer is left out although the solid is there, or None."""
    if not len(found.thin):
        return None
    at = shown_place(found.thin[0])
    return f"the layer at {place:g} is left out: it is thinner than {found.step:.2g} at {at}"
