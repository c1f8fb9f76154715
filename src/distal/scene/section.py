"""A section: the plane that cuts a scene open for a person who inspects it.

Input: the plane, and the distance of the lines that mark cut faces. Output: the values of the
uniforms that a sectioned scene reads; ``scene/lowering/section.py`` cuts the scene by them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.ir.types import FLOAT, VEC3
from distal.lang.parameter_values import LARGEST_FLOAT
from distal.scene.tree.conversion import HostNumber

NORMAL: Final = HostNumber("Section_normal", VEC3, (0.0, 1.0, 0.0))
OFFSET: Final = HostNumber("Section_offset", FLOAT, 0.0)
HATCH: Final = HostNumber("Section_hatch", FLOAT, 0.0)
# A direction written with six digits is accepted as having length 1.
_UNIT_TOLERANCE: Final = 1e-5


@dataclass(frozen=True, slots=True)
class CutPlane:
    """A plane; what is in front of it is not shown.

    Attributes:
        normal: The direction that is cut away, of length 1.
        offset: Distance of the plane from the origin along the normal, in scene units.
        hatch: Distance of the lines on cut faces, in scene units. 0: cut faces look like the
            material, without lines.

    Raises:
        ValueError: A number is not finite, the normal has another length, or hatch is below 0.
    """

    normal: tuple[float, float, float]
    offset: float
    hatch: float = 0.0

    def __post_init__(self) -> None:
        if not all(abs(n) <= LARGEST_FLOAT for n in (*self.normal, self.offset, self.hatch)):
            raise ValueError(f"a section has finite numbers, not {self!r}")
        if abs(math.hypot(*self.normal) - 1.0) > _UNIT_TOLERANCE:
            raise ValueError(f"the normal of a section has length 1, not {self.normal}")
        if self.hatch < 0.0:
            raise ValueError(f"hatch is 0 or a distance, not {self.hatch:g}")

    @classmethod
    def of(cls, numbers: Sequence[float]) -> CutPlane:
        """Return the section of the numbers of ``numbers``."""
        x, y, z, offset, hatch = numbers
        return cls((x, y, z), offset, hatch)

    @property
    def numbers(self) -> tuple[float, ...]:
        """The five numbers: the normal's, offset, hatch."""
        return (*self.normal, self.offset, self.hatch)

    @property
    def settings(self) -> dict[str, Any]:
        """The values of the uniforms, by name."""
        return {NORMAL.name: self.normal, OFFSET.name: self.offset, HATCH.name: self.hatch}
