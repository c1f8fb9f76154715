"""Chooses the resolution at which a frame is finished in time.

Input: how long frames took. Output: the share of the window's width and height that the next one
has. Reads no clock.
"""

from __future__ import annotations

from typing import Final

# While something moves a frame should come within this; twenty in a second look fluid.
BUDGET_S: Final = 0.05
SHARES: Final = (1.0, 0.5, 0.25, 0.125)
# A sharper share must be finished well in time, or two would alternate.
_ROOM: Final = 0.75


class ResolutionChooser:
    """Learns how long a pixel takes, and chooses the share of the window's size."""

    def __init__(self) -> None:
        self._seconds_per_pixel: float | None = None
        self._share = SHARES[-1]

    def learn(self, seconds: float, pixels: float) -> None:
        """Record how long a frame, or a part of one, took."""
        if pixels < 1:
            return
        found = seconds / pixels
        known = self._seconds_per_pixel
        self._seconds_per_pixel = found if known is None else 0.5 * (found + known)

    def forget(self) -> None:
        """Start again for another scene or view."""
        self._seconds_per_pixel, self._share = None, SHARES[-1]

    def share(self, size: tuple[int, int], *, is_moving: bool) -> float:
        """The next frame's part of the window's size.

        A first frame is coarse: how long a sharp one takes is not known yet.
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
