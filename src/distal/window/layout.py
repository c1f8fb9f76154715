"""The layout of the window, in its own units (not pixels), y down.

Input: the size of the window. Output: rectangles, for drawing and for finding what is under the
pointer. Draws nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

MARGIN: Final = 10.0
STATUS_HEIGHT: Final = 28.0
ROW: Final = 22.0
TABLE_WIDTH: Final = 380.0
TABLE_TOP: Final = MARGIN + STATUS_HEIGHT + 8.0
TABLE_PADDING: Final = 8.0
LABEL_SHARE: Final = 0.4
VALUE_SHARE: Final = 0.2
BAR_HEIGHT: Final = 30.0
_BAR_TIME_WIDTH: Final = 76.0


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle on the window."""

    x: float
    y: float
    width: float
    height: float

    def holds(self, x: float, y: float) -> bool:
        """Return whether a point is in it."""
        return 0 <= x - self.x < self.width and 0 <= y - self.y < self.height

    def share(self, x: float) -> float:
        """Return the position of ``x`` between the left (0) and right (1) side, clamped."""
        return min(max((x - self.x) / max(self.width, 1.0), 0.0), 1.0)


def time_bar(width: float, height: float) -> Rectangle:
    """Return the time bar along the bottom of a window."""
    return Rectangle(0.0, height - BAR_HEIGHT, width, BAR_HEIGHT)


def time_track(width: float, height: float) -> Rectangle:
    """Return the part of the time bar along which the time moves."""
    strip = time_bar(width, height)
    left = MARGIN + _BAR_TIME_WIDTH
    return Rectangle(left, strip.y, max(width - left - MARGIN, 1.0), strip.height)


@dataclass(frozen=True, slots=True)
class Table:
    """The table of parameters: as many rows as fit in the window, around the chosen one.

    Attributes:
        frame: The rectangle of the table.
        first: The index of the first visible row.
        count: The number of visible rows.
    """

    frame: Rectangle
    first: int
    count: int

    @staticmethod
    def of(width: float, height: float, rows: int, chosen: int) -> Table:
        """Return the table for a number of rows in a window.

        Args:
            width: Width of the window.
            height: Height of the window.
            rows: Number of all rows.
            chosen: The index of the chosen row.
        """
        room = height - TABLE_TOP - BAR_HEIGHT - MARGIN - 2 * TABLE_PADDING
        count = max(min(rows, int(room // ROW)), min(rows, 1))
        first = min(max(chosen - count // 2, 0), rows - count)
        frame = Rectangle(
            MARGIN,
            TABLE_TOP,
            max(min(TABLE_WIDTH, width - 2 * MARGIN), 1.0),
            max(count, 1) * ROW + 2 * TABLE_PADDING,
        )
        return Table(frame, first, count)

    def row(self, number: int) -> Rectangle:
        """Return the rectangle of a row, by its index among all rows."""
        inside = self.frame.width - 2 * TABLE_PADDING
        top = self.frame.y + TABLE_PADDING + (number - self.first) * ROW
        return Rectangle(self.frame.x + TABLE_PADDING, top, inside, ROW)

    def track(self, number: int) -> Rectangle:
        """Return the rectangle of a row's bar."""
        row = self.row(number)
        left = row.x + row.width * LABEL_SHARE
        return Rectangle(left, row.y, row.width * (1 - LABEL_SHARE - VALUE_SHARE), row.height)

    def handle(self, rows: int) -> Rectangle:
        """Return the scroll mark at the right edge, which shows the visible part of all rows."""
        whole = self.frame.height - 2 * TABLE_PADDING
        top = self.frame.y + TABLE_PADDING + whole * self.first / rows
        right = self.frame.x + self.frame.width
        return Rectangle(right - 3.0, top, 2.0, whole * self.count / rows)

    def row_at(self, x: float, y: float) -> int | None:
        """Return the index of the row at a point; None if there is none."""
        if not self.frame.holds(x, y):
            return None
        number = self.first + int((y - self.frame.y - TABLE_PADDING) // ROW)
        return number if self.first <= number < self.first + self.count else None
