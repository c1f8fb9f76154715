"""Heights of a solid seen along an axis: which part of space, and from which side.

Input: a solid, a box and an axis. Output: what the executor evaluates. Does not depend on how.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor, ray_views
from distal.lang.source_places import author_place
from distal.scene.lowering.derived import GradientOf
from distal.scene.objects.shown_box import shown_box
from distal.scene.objects.vm_shapes import program_of_node
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.images.height_map import HeightMap
    from distal.runtime.heights import RayView
    from distal.scene.objects.field import BaseShape

_MOST_LAYERS: Final = 4096
# For each side that a solid is seen from: the directions to the right, up, and toward the viewer.
_SIDES: Final[Mapping[str, tuple[tuple[int, int, int], ...]]] = {
    "+x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "+y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "+z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-z": ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
}


def seen_heights(shape: BaseShape, options: RenderOptions, side: Any, box: Any) -> HeightMap:
    """Return the heights of a solid; see ``Shape.heights``.

    Args:
        shape: The shape.
        options: Size, time, parameters, threads, progress and cancel.
        side: A key of the table of sides.
        box: Corners (low, high) of the part of space that is shown, or None.
    """
    if side not in _SIDES:
        names = ", ".join(f'"{name}"' for name in _SIDES)
        refuse(f"a side is one of {names}, not {side!r:.40}", 'side="+y"', author_place())
    low, high = shown_box(shape, box, options, size=3)
    program = program_of_node(shape.node)
    ready = None if program is None else program.tape
    view = _view(_SIDES[side], low, high, options.size)
    return executor().heights(shape, GradientOf(shape.node), view, options, ready)


def _view(
    side: Sequence[Sequence[int]],
    low: Sequence[float],
    high: Sequence[float],
    size: tuple[int, int],
) -> RayView:
    """Return rays through a box, whose samples are as far apart along a ray as the rays.

    Args:
        side: The directions to the right, up, and toward the viewer.
        low: The lower corner of the box.
        high: Its upper corner.
        size: The picture's width and height in pixels.
    """
    right, up, toward = side
    middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
    across, upward, deep = (
        sum(abs(part) * (b - a) for part, a, b in zip(direction, low, high, strict=True))
        for direction in side
    )
    width, height = size
    pixel = max(across / width, upward / height)
    layers = min(max(math.ceil(deep / pixel - 1e-6), 1), _MOST_LAYERS)
    step = deep / layers
    corner = [
        m - r * 0.5 * width * pixel + u * 0.5 * height * pixel + t * 0.5 * deep
        for m, r, u, t in zip(middle, right, up, toward, strict=True)
    ]
    front = sum(t * m for t, m in zip(toward, middle, strict=True)) + 0.5 * deep
    return ray_views.RayView(
        corner=corner,
        column=[pixel * r for r in right],
        row=[-pixel * u for u in up],
        layer=[-step * t for t in toward],
        layers=layers,
        front=front,
        step=-step,
    )
