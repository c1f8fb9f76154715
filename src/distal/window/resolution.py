"""Choose a resolution at which frames are finished in time.

Input: rendering times of frames. Output: the fraction of the window's width and height for the next
frame. Does not read a clock.
"""

from __future__ import annotations

import math
from typing import Final

# Fractions of width and height, and the longest time for a moving frame at each: a picture too
# coarse to recognise is worse than a slow one. Below a quarter only if that took a quarter second.
STAIRS: Final = (
    (1.0, 0.04),
    (0.71, 0.045),
    (0.5, 0.06),
    (0.35, 0.08),
    (0.25, 0.25),
    (0.18, 0.4),
    (0.125, math.inf),
)
COARSEST: Final = STAIRS[-1][0]
# A higher resolution must be finished well in time; otherwise two resolutions would alternate.
_ROOM: Final = 0.75
# A still that takes longer is preceded by one of half its width.
_LONG_S: Final = 0.5
_PREVIEW: Final = 0.5


class ResolutionChooser:
    """Measures the rendering time per pixel and chooses the fraction of the window's size."""

    def __init__(self) -> None:
        self._seconds_per_pixel: float | None = None
        self._share = COARSEST

    def learn(self, seconds: float, pixels: float) -> None:
        """Record the rendering time of a frame, or of a part of one."""
        if pixels < 1:
            return
        found = seconds / pixels
        known = self._seconds_per_pixel
        self._seconds_per_pixel = found if known is None else 0.5 * (found + known)

    def forget(self) -> None:
        """Reset the measurement, for another scene or view."""
        self._seconds_per_pixel, self._share = None, COARSEST

    def share(self, size: tuple[int, int], *, is_moving: bool, is_first: bool = False) -> float:
        """Return the fraction of the window's width and height for the next frame.

        The first frame has the lowest resolution, because the time per pixel is not known yet.

        Args:
            size: Width and height of the window's picture in pixels.
            is_moving: Whether a fast frame is preferred to a sharp one.
            is_first: Whether no frame of this still was shown at more than a preview's resolution.
        """
        if self._seconds_per_pixel is None:
            return COARSEST
        whole = self._seconds_per_pixel * size[0] * size[1]
        if not is_moving:
            return _PREVIEW if is_first and whole > _LONG_S else 1.0
        for share, budget in STAIRS:
            if whole * share * share <= (budget if share <= self._share else budget * _ROOM):
                self._share = share
                break
        return self._share
