"""``HeightMap``: the heights and normals of a solid that is seen along an axis.

Input: two arrays, and how they were computed. Output: the arrays, and a ``Picture`` of the normals.
Does not depend on how they were computed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.images.picture import Picture, Provenance
from distal.lang.runtime_access import executor
from distal.render.between_samples import normal_pixel


@dataclass(frozen=True, slots=True, eq=False)
class HeightMap:
    """The first surface of a solid along parallel rays.

    Attributes:
        heights: float32, (height, width), top row first: the coordinate of the surface along the
            axis, in scene units, larger toward the viewer; NaN where there is no surface.
        normals: float32, (height, width, 3), in scene coordinates; 0 where there is no surface.
        provenance: How they were computed.
        stats: Statistics: times in seconds, the number of operations of the tape, or why the shape
            has none ("no_tape").
    """

    heights: NDArray[np.float32] = field(repr=False)
    normals: NDArray[np.float32] = field(repr=False)
    provenance: Provenance = field(default_factory=Provenance)
    stats: Mapping[str, Any] = field(default_factory=dict)

    def __eq__(self, other: object) -> bool:
        """Return whether heights and normals are the same to the bit; how they came does not count.

        NaN is equal to itself.
        """
        if not isinstance(other, HeightMap):
            return NotImplemented
        return self is other or self._contents() == other._contents()

    def __hash__(self) -> int:
        return hash(self._contents())

    def _contents(self) -> tuple[Any, ...]:
        return self.heights.shape, self.heights.tobytes(), self.normals.tobytes()

    def picture(self) -> Picture:
        """Return a picture of the normals, as ``view="normal"`` shows them.

        It is transparent where there is no surface. Its layers are "height" and "normal".
        """
        is_surface = np.isfinite(self.heights).astype(np.float32).reshape(-1)
        pixels = executor().call(normal_pixel, (self.normals.reshape(-1, 3), is_surface), {})
        array = np.asarray(pixels, np.float32).reshape(*self.heights.shape, 4)
        layers = {"height": self.heights, "normal": self.normals}
        return Picture(array, self.provenance, self.stats, layers=layers)
