"""Faces that hang over: what a printer that builds upwards cannot lay on anything.

Input: a mesh, the direction in which it is built, an angle. Output: an area, its share of the
surface, and the worst place with the shape there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.parts import part_at
from distal.mesh.solid import Floats, Integers

UP: Final = 1  # the axis y; files that are z up are turned
_ROUNDING: Final = 1e-6  # of a cosine: a face at the angle itself does not hang over


@dataclass(frozen=True, slots=True)
class Overhang:
    """The faces that look down more steeply than an angle allows.

    Attributes:
        angle_deg: The angle between a face and the horizontal, in degrees, up to which a face that
            looks down needs support.
        area: The area of these faces, in scene units squared, without those that stand on the bed.
        share: Its share of the whole surface.
        place: The middle of the flattest of these faces; None if there is none.
        name: The shape there: the author's name, its kind and the line; "" if there is none.
        line: The author's line; None if it is not known.
    """

    angle_deg: float
    area: float
    share: float
    place: tuple[float, ...] | None
    name: str
    line: int | None

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        place = None if self.place is None else list(self.place)
        return {
            "angle_deg": self.angle_deg,
            "area": self.area,
            "share": self.share,
            "place": place,
            "name": self.name,
            "line": self.line,
        }


def overhang_of(
    kernels: FieldKernels, points: Floats, triangles: Integers, angle_deg: float, bed: float
) -> Overhang:
    """Return what hangs over in a mesh that is built along y.

    Args:
        kernels: The shape.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        angle_deg: The angle to the horizontal, in degrees.
        bed: Faces this close to the lowest point, in scene units, stand on the bed.
    """
    corners = [points[triangles[:, i]] for i in range(3)]
    areas, normals = rows_of(triangle_arithmetic.face, *corners)
    down = -normals[:, UP]
    height = np.max([corner[:, UP] for corner in corners], axis=0)
    free = height > float(points[:, UP].min()) + bed
    hangs = (down > math.cos(math.radians(angle_deg)) + _ROUNDING) & free
    area, whole = float(areas[hangs].sum()), float(areas.sum())
    if not hangs.any():
        return Overhang(angle_deg, 0.0, 0.0, None, "", None)
    # Of equally flat faces the largest, so that noise at tiny ones does not decide.
    flat = np.where(hangs, np.round(down, 3), -1.0)
    worst = int(np.lexsort((areas, flat))[-1])
    place = points[triangles[worst]].mean(axis=0)
    part = part_at(kernels.node, place, kernels.params, kernels.time)
    return Overhang(angle_deg, area, area / whole, tuple(place.tolist()), part.text, part.line)
