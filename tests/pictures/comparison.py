"""How two pictures are held against each other: SEEDS' measure, on 8-bit values.

In: float pictures or 8-bit arrays, (height, width, 3 or 4), top row first. Out: a Difference.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

MOST_MEAN: Final = 1.0
MOST_FAR_OFF: Final = 0.002
# The map of this fractal multiplies rounding errors by 8 in each round: the normal in a pixel
# is that of the device. The mean is held as for others. In .3 % of the pixels of this sea, as it
# warns, rays use up their steps: they end where rounding leads them.
MOST_FAR_OFF_OF: Final = {"mandelbulb": 0.06, "sea_sphere_tracing": 0.005}


@dataclass(frozen=True, slots=True)
class Difference:
    """Mean absolute difference in steps of 1/255, and the share of pixels off by more than 2."""

    mean: float
    far_off: float

    @property
    def is_agreement(self) -> bool:
        """Mean at most 1/255, at most 0.2 % of the pixels off by more than 2/255."""
        return self.is_agreement_of("")

    def is_agreement_of(self, example: str) -> bool:
        """``is_agreement``, with the share of pixels that an example of the gallery may have."""
        most = MOST_FAR_OFF_OF.get(example, MOST_FAR_OFF)
        return self.mean <= MOST_MEAN and self.far_off <= most


def difference(a: NDArray[Any], b: NDArray[Any]) -> Difference:
    """Compare the colors of two pictures of one size."""
    first, second = as_bytes(a).astype(int), as_bytes(b).astype(int)
    assert first.shape == second.shape, (first.shape, second.shape)
    off = np.abs(first - second)
    return Difference(float(off.mean()), float((off.max(axis=2) > 2).mean()))


def as_bytes(pixels: NDArray[Any]) -> NDArray[np.uint8]:
    """Colors as 8-bit values, the way a picture is written to a file."""
    if pixels.dtype == np.uint8:
        return pixels[..., :3]
    clean = np.nan_to_num(pixels[..., :3], nan=0.0, posinf=1.0, neginf=0.0)
    return np.floor(np.clip(clean, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
