"""A contact sheet: pictures in rows and columns, with the values that they belong to.

Input: the levels of pictures one by one, axes. Output: a picture of 8 bits. The values of the last
axis are above the columns, those of the others left of the rows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.lazy_module import LazyModule
from distal.lang.render_options import LARGEST_SIDE_PX
from distal.sweeps.inputs import Inputs

if TYPE_CHECKING:
    from PIL import Image, ImageDraw, ImageFont
else:
    Image, ImageDraw, ImageFont = map(LazyModule, ("PIL.Image", "PIL.ImageDraw", "PIL.ImageFont"))

_GAP: Final = 6
_MARGIN: Final = 16
_INK: Final = (32, 34, 38)
_SOFT: Final = (110, 114, 122)
_PAPER: Final = (250, 250, 248)
_MOST_PX: Final = 2**28


class Sheet:
    """A sheet that pictures are put on.

    Args:
        inputs: The inputs of the sweep: all combinations have a row or a column for each value, of
            a list the rows have its numbers.
        size: Width and height of each picture in pixels.
        title: A line above all.

    Raises:
        ValueError: The sheet would be too large.
    """

    def __init__(self, inputs: Inputs, size: tuple[int, int], title: str) -> None:
        labels, columns = _labels(inputs)
        self._columns, self._rows = len(columns), max(1, len(labels))
        self._size = size
        points = max(11, min(20, size[1] // 9))
        self._font: Any = ImageFont.load_default(points)
        self._line = round(points * 1.5)
        widest = max((self._width(line) for label in labels for line in label), default=0)
        self._left = _MARGIN + (widest + 2 * _GAP if labels else 0)
        self._top = _MARGIN + 2 * self._line + _GAP
        width = self._left + self._columns * (size[0] + _GAP) - _GAP + _MARGIN
        width = max(width, 2 * _MARGIN + self._width(title))
        height = self._top + self._rows * (size[1] + _GAP) - _GAP + _MARGIN
        if max(width, height) > LARGEST_SIDE_PX or width * height > _MOST_PX:
            raise ValueError(
                f"a sheet of {self._columns}x{self._rows} pictures would have {width}x{height} "
                "pixels: take a smaller --size, or a folder for -o"
            )
        self._picture = Image.new("RGB", (width, height), _PAPER)
        self._draw = ImageDraw.Draw(self._picture)
        self._write(title, labels, columns)

    def _width(self, text: str) -> int:
        return int(self._font.getlength(text)) + 1

    def _write(
        self, title: str, labels: Sequence[Sequence[str]], columns: Sequence[tuple[str, str]]
    ) -> None:
        draw, (width, height) = self._draw, self._size
        draw.text((_MARGIN, _MARGIN), title, _SOFT, self._font)
        for column, (label, text) in enumerate(columns):
            if self._width(label) > width:
                label = text
            at = self._left + column * (width + _GAP) + width // 2
            middle = _MARGIN + self._line + self._line // 2
            draw.text((at, middle), label, _INK, self._font, anchor="mm")
        for row, lines in enumerate(labels):
            middle = self._top + row * (height + _GAP) + height // 2
            top = middle - (len(lines) - 1) * self._line / 2
            for number, line in enumerate(lines):
                end = (self._left - 2 * _GAP, top + number * self._line)
                draw.text(end, line, _INK, self._font, anchor="rm")

    def put(self, index: int, levels: NDArray[np.uint8]) -> None:
        """Put a picture on the sheet.

        Args:
            index: Its number, the values of the last axis fastest.
            levels: (height, width, 4).
        """
        row, column = divmod(index, self._columns)
        width, height = self._size
        at = (self._left + column * (width + _GAP), self._top + row * (height + _GAP))
        self._picture.paste(Image.fromarray(levels[..., :3]), at)

    def pixels(self) -> NDArray[np.uint8]:
        """Return the sheet, (height, width, 3)."""
        return np.asarray(self._picture)


def _labels(inputs: Inputs) -> tuple[list[list[str]], list[tuple[str, str]]]:
    """Return the lines of text at each row, and a long and a short text for each column."""
    if inputs.axes is None:
        count = len(inputs.sets)
        across = math.isqrt(count - 1) + 1
        ends = [
            (first, min(first + across, count + 1) - 1) for first in range(1, count + 1, across)
        ]
        return [[str(a) if a == b else f"{a} to {b}"] for a, b in ends], [("", "")] * across
    *outer, last = inputs.axes
    labels: list[list[str]] = [[]] if outer else []
    for axis in outer:
        labels = [[*label, f"{axis.label} {text}"] for label in labels for text in axis.texts]
    return labels, [(f"{last.label} {text}", text) for text in last.texts]
