"""Split a large picture into parts that are short enough for the GPU's driver.

Input: a picture's size, and the time that each part took. Output: the next part. Drivers reset a
GPU that works on one submission for more than about two seconds (Windows) or five to ten (Linux),
and a window on the same GPU does not react during this time. So parts are sized by measured time.
Does not depend on GPUs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

TARGET_S: Final = (
    0.05  # time of a part: ``cancel`` is checked 20 times per second, with little overhead
)
WHOLE_S: Final = 0.1  # a picture whose expected time is at most this is one part
FIRST_PIXELS: Final = 64 * 64  # 0.2 s at 50 µs a pixel: a slow scene in software
_GROWTH: Final = 8  # largest growth from one part to the next: the first pixels may be the fastest
_ROW: Final = 8  # sides of workgroups


@dataclass(frozen=True, slots=True)
class Tile:
    """A part of a picture, in pixels; x and y are its corner, from the top left."""

    x: int
    y: int
    width: int
    height: int

    @property
    def pixels(self) -> int:
        """The number of pixels."""
        return self.width * self.height


class TileSizer:
    """Measures the speed of one kernel, and determines the size of its next part.

    Speed is counted in samples, so that a picture with several samples in each pixel has smaller
    parts from its first one on.

    Attributes:
        most: The maximum pixels of a part, limited by the size of a binding; 8 or more.
        first: The pixels of the first part.
    """

    def __init__(self, most: int, first: int = FIRST_PIXELS) -> None:
        self.most = most
        self.first = first
        self._picture_rate = 0.0  # samples per second of the last picture
        self._part_rate = 0.0  # of the last part
        self._samples, self._seconds = 0, 0.0  # of this picture up to now
        self._budget = 1
        self._samples_of_pixel = 1
        self._is_warm = False  # the driver has compiled the program

    def start(self, pixels: int, samples: int = 1) -> int:
        """Begin a picture, and return the size limit of its first part, in pixels.

        Args:
            pixels: The number of pixels.
            samples: The number of samples in each pixel.
        """
        self._samples, self._seconds, self._samples_of_pixel = 0, 0.0, samples
        rate = self._part_rate = self._picture_rate
        if rate <= 0.0:
            budget = self.first // samples
        elif pixels * samples <= rate * WHOLE_S:
            budget = pixels
        else:
            budget = int(rate * TARGET_S / samples)
        self._budget = max(1, min(budget, self.most))
        return self._budget

    def measured(self, tile: Tile, seconds: float) -> None:
        """Record how long a part took."""
        if not self._is_warm:  # drivers compile at the first use, so its time is not measured
            self._is_warm = True
            return
        samples = tile.pixels * self._samples_of_pixel
        self._samples += samples
        self._seconds += max(seconds, 1e-6)
        self._picture_rate = self._samples / self._seconds
        # The slower of the last two parts predicts the next part.
        rate = samples / max(seconds, 1e-6)
        slower = min(rate, self._part_rate or rate)
        self._part_rate = rate
        grown = min(int(slower * TARGET_S / self._samples_of_pixel), tile.pixels * _GROWTH)
        self._budget = max(1, min(grown, self.most))

    def next(self) -> int:
        """Return the size limit of the next part, in pixels."""
        return self._budget


def tiles(width: int, height: int, tile_sizer: TileSizer, samples: int = 1) -> Iterator[Tile]:
    """Yield the parts of a picture, top row first; each is sized when it is requested.

    The caller reports each part's time to ``tile_sizer`` before it requests the next part.

    Args:
        width: Pixels across.
        height: Pixels down.
        tile_sizer: Determines the size of the parts.
        samples: The number of samples in each pixel.
    """
    y, budget = 0, tile_sizer.start(width * height, samples)
    while y < height:
        rows = min(budget // width, height - y)
        if rows == height - y or rows >= _ROW:
            rows -= rows % _ROW if rows < height - y else 0
            yield Tile(0, y, width, rows)
            budget = tile_sizer.next()
        else:  # one row of workgroups is too large: split it
            rows, x = min(_ROW, height - y), 0
            while x < width:
                across = max(1, budget // rows)
                across = across if across < _ROW else across - across % _ROW
                across = min(across, width - x)
                yield Tile(x, y, across, rows)
                budget = tile_sizer.next()
                x += across
        y += rows
