"""The part of the plane, or of space, that a picture without a camera shows.

Input: a shape, and the author's box or None. Output: two corners.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from distal.fields.guarantees import Primitive
from distal.lang.render_options import RenderOptions
from distal.lang.source_places import author_place
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.scene.objects.field import BaseShape

_MARGIN: Final = 1.1  # around the box of a shape


def shown_box(shape: BaseShape, box: Any, options: RenderOptions, *, size: int) -> tuple[Any, Any]:
    """Return the corners (low, high): the given ones, or those of the shape's box with a margin.

    Args:
        shape: The shape.
        box: Corners, or None. A shape without a finite box is shown from -1 to 1.
        options: The time and the parameters, which may move the shape's box.
        size: The number of coordinates, 2 or 3.

    Raises:
        SceneValueError: The box is invalid.
    """
    unbounded = (-1.0,) * size, (1.0,) * size
    if box is None:
        if isinstance(shape.node.rule, Primitive) and shape.node.rule.bounds is None:
            return unbounded
        low, high = shape.bounds(params=options.params, time=options.time)
        is_finite = all(map(math.isfinite, (*low, *high)))
        if not is_finite or any(a > b for a, b in zip(low, high, strict=True)):
            return unbounded
        middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
        half = [_MARGIN * (b - a) / 2.0 for a, b in zip(low, high, strict=True)]
        return (
            tuple(m - h for m, h in zip(middle, half, strict=True)),
            tuple(m + h for m, h in zip(middle, half, strict=True)),
        )
    try:
        low, high = (tuple(float(number) for number in corner) for corner in box)
        valid = len(low) == len(high) == size and all(
            math.isfinite(b - a) and b > a for a, b in zip(low, high, strict=True)
        )
    except (TypeError, ValueError):
        valid = False
    if not valid:
        hint = f"box=({(-1,) * size}, {(1,) * size})"
        refuse(f"a box is two corners, (low, high), not {box!r:.60}", hint, author_place())
    return low, high
