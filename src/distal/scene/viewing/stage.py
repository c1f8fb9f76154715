"""A scene around a lone shape: a ground, a camera that sees all of it, the light of a studio.

Input: a shape. Output: a scene framed by the shape's box, as it is at one time and
for one set of parameters.
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

# How far a shape without end is shown along an axis.
REACH: Final = 2.0
# From where: a little to the right and from above, as products are photographed.
_FROM: Final = (0.5, 0.42, 1.0)
_VIEW_DEG: Final = 35.0
_MARGIN: Final = 1.06
# A flat shape becomes a plate this thick, of its size.
_PLATE: Final = 0.08


def stage(shape: BaseShape, params: Mapping[str, Any] | None = None, time: float = 0.0) -> Scene:
    """The scene of a shape.

    Args:
        shape: A solid; a flat one is shown as a plate.
        params: Values of parameters by name, for the frame.
        time: Seconds.
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
    """The shape's box, cut where it has no end."""
    low, high = shape.bounds(params=params, time=time)
    pairs = [_cut(a, b) for a, b in zip(low, high, strict=True)]
    return [a for a, _ in pairs], [b for _, b in pairs]


def _cut(low: float, high: float) -> tuple[float, float]:
    if not math.isfinite(low) and not math.isfinite(high):
        return -REACH, REACH
    if not math.isfinite(low):
        return high - REACH, high
    return (low, high) if math.isfinite(high) else (low, low + REACH)
