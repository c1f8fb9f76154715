"""Choose a resolution at which frames are finished in time.

Input: rendering times of frames. Output: the fraction of the window's width and height for the next
frame. Does not read a clock.
"""

from __future__ import annotations

from typing import Final

# The longest time for a frame while something moves; twenty frames per second look smooth.
BUDGET_S: Final = 0.05
SHARES: Final = (1.0, 0.5, 0.25, 0.125)
# A higher resolution must be finished well in time; otherwise two resolutions would alternate.
_ROOM: Final = 0.75


class ResolutionChooser:
    """Measures the rendering time per pixel and chooses the fraction of the window's size."""

    def __init__(self) -> None:
        self._seconds_per_pixel: float | None = None
        self._share = SHARES[-1]

    def learn(self, seconds: float, pixels: float) -> None:
        """Record the rendering time of a frame, or of a part of one."""
        if pixels < 1:
            return
        found = seconds / pixels
        known = self._seconds_per_pixel
        self._seconds_per_pixel = found if known is None else 0.5 * (found + known)

    def forget(self) -> None:
        """Reset the measurement, for another scene or view."""
        self._seconds_per_pixel, self._share = None, SHARES[-1]

    def share(self, size: tuple[int, int], *, is_moving: bool) -> float:
        """Return the fraction of the window's width and height for the next frame.

        The first frame has the lowest resolution, because the time per pixel is not known yet.
        """
        if self._seconds_per_pixel is None:
            return SHARES[-1]
        if not is_moving:
            return SHARES[0]
        whole = self._seconds_per_pixel * size[0] * size[1]
        for share in SHARES:
            room = BUDGET_S if share <= self._share else BUDGET_S * _ROOM
            if whole * share * share <= room:
                self._share = share
                break
        else:
            self._share = SHARES[-1]
        return self._share
