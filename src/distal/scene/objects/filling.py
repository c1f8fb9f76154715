"""Filled pictures of flat shapes: which part of the plane, and which colors.

Input: a flat shape, a box and colors. Output: what the executor fills. Does not depend on how.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from distal.lang.parameter_values import as_color
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.lang.source_places import author_place
from distal.lang.srgb import encode_srgb
from distal.scene.objects.shown_box import shown_box
from distal.scene.objects.vm_shapes import program_of_node
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.scene.objects.field import BaseShape

_MOST_ACROSS: Final = 16


def filled(
    shape: BaseShape, options: RenderOptions, box: Any, inside: Any, outside: Any, samples: Any
) -> Picture:
    """Return the filled picture of a flat shape; see ``Shape2D.fill``.

    Args:
        shape: The shape.
        options: Size, time, parameters, threads, progress and cancel.
        box: Corners (low, high) of the part of the plane that is shown, or None.
        inside: The color inside.
        outside: The color outside.
        samples: Samples in each pixel, a square number.
    """
    across = math.isqrt(samples) if isinstance(samples, int) and samples > 0 else 0
    if across**2 != samples or not 1 <= across <= _MOST_ACROSS:
        message = f"samples are a square number from 1 to {_MOST_ACROSS**2}, not {samples!r}"
        refuse(message, "1, 4, 9, 16 …", author_place())
    low, high = shown_box(shape, box, options, size=2)
    width, height = options.size
    step = max((high[0] - low[0]) / width, (high[1] - low[1]) / height)
    middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
    view = middle[0] - 0.5 * width * step, step, middle[1] + 0.5 * height * step, -step
    colors = _colors(as_color("outside", outside), as_color("inside", inside), samples)
    program = program_of_node(shape.node)
    return executor().fill(shape, view, colors, options, None if program is None else program.tape)


def _colors(
    outside: tuple[float, ...], inside: tuple[float, ...], samples: int
) -> list[tuple[float, ...]]:
    """Return display values for each number of samples inside; light is mixed, not codes."""
    encode = encode_srgb.python_function
    rows = []
    for count in range(samples + 1):
        share = count / samples
        light = (a * (1.0 - share) + b * share for a, b in zip(outside, inside, strict=True))
        rows.append((*(float(encode(part)) for part in light), 1.0))
    return rows
