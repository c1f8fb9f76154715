"""The count of rays that a picture lost.

Input: pixels of linear light whose alpha carries marks (``render.lost_rays``). Output: the same
pixels without marks, and the shares of pixels with each mark.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.render import lost_rays

# Why rays were lost, by mark.
REASONS: Final[Mapping[str, int]] = {
    "steps": lost_rays.STEPS,
    "far": lost_rays.FAR,
    "shadow steps": lost_rays.SHADOWS,
    "inside": lost_rays.INSIDE,
}
_COMBINATIONS: Final = 16


@dataclass(slots=True)
class LostRays:
    """The marks of the pixels that were rendered so far, in all passes.

    Attributes:
        pixels: Number of pixels.
        marks: Number of pixels with each combination of marks.
    """

    pixels: int = 0
    marks: NDArray[np.int64] = field(default_factory=lambda: np.zeros(_COMBINATIONS, np.int64))

    def remove_marks(self, pixels: NDArray[np.float32]) -> None:
        """Remove the marks from alpha, and count them.

        Args:
            pixels: Linear light, (height, width, 4); changed in place.
        """
        alpha = pixels[..., 3]
        low, mark = np.float32(-lost_rays.LOWEST), np.float32(lost_rays.MARK)
        # Few pixels have marks.
        where = np.nonzero(~((alpha >= low) & (alpha < mark + low)))
        lost = np.floor((np.nan_to_num(alpha[where]) - low) / mark)
        alpha[where] -= mark * lost
        counts = np.bincount(lost.astype(np.int64) & 15, minlength=_COMBINATIONS)
        counts[0] += alpha.size - lost.size
        self.marks += counts
        self.pixels += alpha.size

    @property
    def shares(self) -> dict[str, float]:
        """The share of pixels with a lost ray, by reason; those that occur."""
        kinds = np.arange(_COMBINATIONS)
        counts = {why: int(self.marks[kinds & bit > 0].sum()) for why, bit in REASONS.items()}
        return {why: count / max(self.pixels, 1) for why, count in counts.items() if count}
