"""Numbers that follow from a shape's data: how much neighboring texels differ.

Input: a texture. Output: plain numbers. Only nested lists of numbers are measured without NumPy.
Does not depend on what the numbers are used for.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from distal.diagnostics import Span
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Texture2D
from distal.packages import imported
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.scene.objects import images as image_files
else:
    image_files = LazyModule("distal.scene.objects.images")  # needs NumPy

# Texels of a picture's file are between 0 and 1, so neighbors differ by at most this.
OF_ANY_PICTURE = (1.0, 1.0)


def largest_rise(texture: Texture2D, what: str, place: Span | None) -> tuple[float, float]:
    """Return the largest differences of neighboring texels' first channels, along each axis.

    Without NumPy or Pillow, files are not read, and the result is the largest possible one.

    Args:
        texture: The texture.
        what: The name in messages of the shape that uses it.
        place: The author's line.

    Raises:
        SceneValueError: The file cannot be read, or a number is not finite.
    """
    try:
        np = imported("numpy")
        rows = image_files.texture_light(texture, what, place)[..., 0].astype(np.float64)
    except ImportError:
        return _rise_of_lists(texture.data)
    if not np.isfinite(rows).all():
        row, column = (int(i) for i in np.argwhere(~np.isfinite(rows))[0])
        refuse(
            f"{what}: the height in row {row}, column {column} is {rows[row, column]}",
            "every height must be a finite number",
            place,
        )
    along_x, along_z = (abs(np.diff(rows, axis=axis)) for axis in (1, 0))
    return float(along_x.max(initial=0.0)), float(along_z.max(initial=0.0))


def _rise_of_lists(data: Any) -> tuple[float, float]:
    if not isinstance(data, list | tuple):
        return OF_ANY_PICTURE
    rows = [[_first(texel) for texel in row] for row in data]
    along_x = (abs(b - a) for row in rows for a, b in itertools.pairwise(row))
    beside = itertools.pairwise(rows)
    along_z = (abs(b - a) for one, other in beside for a, b in zip(one, other, strict=True))
    found = max(along_x, default=0.0), max(along_z, default=0.0)
    return found if all(map(math.isfinite, found)) else OF_ANY_PICTURE


def _first(texel: Any) -> float:
    return float(texel[0] if isinstance(texel, Sequence) else texel)
