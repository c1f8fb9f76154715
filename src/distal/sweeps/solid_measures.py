"""What is measured of the solid of each picture of a sweep: volume, area, box, walls.

Input: a shape, values of its parameters. Output: plain numbers by column. Does not depend on
pictures.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from distal.devices.base import Cancel
from distal.scene.objects.field import BaseShape
from distal.scene.objects.meshable import Meshable
from distal.scene.tree.errors import SceneValueError

COLUMNS: Final = (
    *("volume", "volume_error", "area", "area_error"),
    *("width", "height", "depth", "wall", "remark"),
)


def checked_solid(shape: BaseShape | None) -> Meshable:
    """Return the shape of a scene, if it can be measured.

    Raises:
        ValueError: It cannot.
    """
    if not isinstance(shape, Meshable):
        raise ValueError("measures are of solids: an @image and flat shapes have none")
    return shape


def measured(
    shape: Meshable, params: Mapping[str, Any], time: float, cancel: Cancel | None
) -> dict[str, Any]:
    """Return the measures of a solid, in scene units, by column.

    One that has no mesh with these values, for example because nothing is left of it, has a remark.

    Args:
        shape: The solid.
        params: Values of parameters by name; those of camera, light and paint are left out.
        time: Time in seconds.
        cancel: Ends the work early.
    """
    row: dict[str, Any] = dict.fromkeys(COLUMNS, "")
    own = {parameter.name for parameter in shape.parameters()}
    values = {name: value for name, value in params.items() if name in own}
    try:
        found = shape.measure(params=values, time=time, cancel=cancel)
    except SceneValueError as error:
        return row | {"remark": str(error).splitlines()[0]}
    sides = [high - low for low, high in zip(found.low.value, found.high.value, strict=True)]
    wall = "" if found.wall is None else _rounded(found.wall.value)
    return row | {
        "volume": _rounded(found.volume.value),
        "volume_error": _rounded(found.volume.error),
        "area": _rounded(found.area.value),
        "area_error": _rounded(found.area.error),
        **dict(zip(("width", "height", "depth"), map(_rounded, sides), strict=True)),
        "wall": wall,
    }


def _rounded(value: float) -> float:
    """Return a number with the digits that the errors of measures leave."""
    return float(f"{value:.7g}")
