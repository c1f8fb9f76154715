"""A scene of a single shape, for all that shows pictures.

Input: a shape. Output: the scene that shows it in a look. ``Scene(shape)`` is the same, but takes
solids only, and frames them by the defaults of their parameters.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from distal.lang.chosen_values import checked_values
from distal.loading import copy_loaded_from
from distal.scene.objects.field import BaseShape
from distal.scene.objects.shape import Shape, Shape2D
from distal.scene.scene import Scene

# Thickness of the plate that shows a flat shape, as a fraction of its size, and the size of one
# that is infinite.
_PLATE: Final = 0.08
_INFINITE: Final = 2.0


def stage(
    shape: BaseShape,
    params: Mapping[str, Any] | None = None,
    time: float = 0.0,
    look: str | None = None,
) -> Scene:
    """Return the default scene of a shape.

    Args:
        shape: A solid; a flat one is shown as a standing plate.
        params: Values of parameters by name, for the framing.
        time: Time in seconds, for the framing.
        look: The name of a look; None for the default.
    """
    given = shape
    said = checked_values(given.parameters(), params)
    if isinstance(shape, Shape2D):
        low, high = shape.bounds(params=params, time=time)
        size = math.dist(low, high)
        thickness = _PLATE * (size if math.isfinite(size) else _INFINITE)
        shape = shape.extrude(thickness).named(shape.name)
        copy_loaded_from(given, shape)
    assert isinstance(shape, Shape)
    return Scene.of_shape(shape, said, float(time), look)
