"""A default scene for a single shape: a ground, a camera that sees the whole shape, studio lights.

Input: a shape. Output: a scene framed by the shape's box at one time, for one set of parameter
values.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from distal import Camera, DistantLight, GradientBackground, HemisphereLight, Plane
from distal.lang.chosen_values import checked_values
from distal.loading import copy_loaded_from
from distal.scene.objects.field import BaseShape
from distal.scene.objects.shape import Shape2D
from distal.scene.scene import Scene

# Length at which an infinite shape is cut, along each axis.
REACH: Final = 2.0
# Direction to the camera: slightly to the right and above, as in product photographs.
_FROM: Final = (0.5, 0.42, 1.0)
_VIEW_DEG: Final = 35.0
_MARGIN: Final = 1.06
# Thickness of the plate that shows a flat shape, as a fraction of its size.
_PLATE: Final = 0.08


def stage(shape: BaseShape, params: Mapping[str, Any] | None = None, time: float = 0.0) -> Scene:
    """Return the default scene of a shape.

    Args:
        shape: A solid; a flat one is shown as a plate.
        params: Values of parameters by name, for the framing.
        time: Time in seconds, for the framing.
    """
    given = shape
    if isinstance(shape, Shape2D):
        low, high = _finite(shape, params, time)
        shape = shape.extrude(_PLATE * math.dist(low, high)).named(shape.name)
    low, high = _finite(shape, params, time)
    middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
    radius = max(math.dist(low, high) / 2.0, 1e-3)
    away = _MARGIN * radius / math.sin(math.radians(_VIEW_DEG / 2.0)) / math.hypot(*_FROM)
    eye = tuple(m + away * d for m, d in zip(middle, _FROM, strict=True))
    shown: list[Any] = [shape]
    below = shape.bounds(params=params, time=time)[0][1]
    if math.isfinite(below):
        shown.append(Plane(y=below - 1e-3 * radius).paint((0.45, 0.46, 0.5)))
    scene = Scene(
        shown,
        lights=[
            DistantLight((0.5, 1.0, 0.6), 0.75, angle=0.12),
            DistantLight((-1.0, 0.5, 0.4), 0.15, color="#cfe0ff", angle=0.3),
            HemisphereLight(intensity=0.45),
        ],
        camera=Camera(position=eye, target=tuple(middle), fov_deg=_VIEW_DEG),
        background=GradientBackground((0.5, 0.52, 0.56), (0.78, 0.82, 0.88)),
        ambient_occlusion=0.3 * radius,
        near=1e-3 * radius,
        far=50.0 * radius,
        name=shape.name,
    )
    copy_loaded_from(given, scene)
    said = checked_values(given.parameters(), params)
    object.__setattr__(scene, "staged", (said, float(time)))  # recorded in its pictures
    return scene


def _finite(
    shape: BaseShape, params: Mapping[str, Any] | None, time: float
) -> tuple[list[float], list[float]]:
    """Return the shape's box, cut where it is infinite."""
    low, high = shape.bounds(params=params, time=time)
    pairs = [_cut(a, b) for a, b in zip(low, high, strict=True)]
    return [a for a, _ in pairs], [b for _, b in pairs]


def _cut(low: float, high: float) -> tuple[float, float]:
    if not math.isfinite(low) and not math.isfinite(high):
        return -REACH, REACH
    if not math.isfinite(low):
        return high - REACH, high
    return (low, high) if math.isfinite(high) else (low, low + REACH)
