"""Draw the overlay over the picture: status, parameters, help, errors, the time bar.

Input: the content as plain values, and the window's size and pixel ratio. Output: small pictures
with their positions in pixels; an unchanged part is the same object as before. Does not depend on
windows or GPUs.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from distal.scene.viewing.key_bindings import HELP
from distal.window import layout
from distal.window.lettering import fixed_font, plain_font, shortened, shortened_inside, width
from distal.window.overlay_content import OverlayContent, ParameterRow
from distal.window.panels import Panel, clipped
from distal.window.ruler_panels import ruler_panels
from distal.window.ruler_tool import ShownRuler

_TEXT_SIZE: Final = 13
_BACK: Final = (16, 18, 24, 196)
_BACK_OF_HELP: Final = (16, 18, 24, 238)
_BACK_OF_MISTAKE: Final = (48, 10, 14, 232)
_TEXT: Final = (240, 242, 246, 255)
_DIM: Final = (168, 176, 190, 255)
_ACCENT: Final = (96, 165, 250, 255)
_CHOSEN: Final = (255, 255, 255, 36)
_TRACK: Final = (255, 255, 255, 48)
_ROUND: Final = 6
_SWATCH: Final = 14


class Overlay:
    """Draws the overlay's content; keeps the panel of a part while its content is the same."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[Hashable, Panel]] = {}
        self._ruler: tuple[Hashable, list[Panel]] = (None, [])

    def panels(self, read: OverlayContent, size: tuple[int, int], ratio: float) -> list[Panel]:
        """Return the panels, the lowest first.

        Args:
            read: The content.
            size: The window's size in pixels.
            ratio: Pixels per unit of the layout.
        """
        if min(size) < 8:
            return []
        place = _Place(size[0] / ratio, size[1] / ratio, ratio)
        parts: list[tuple[str, Hashable, Callable[[], Panel]]] = []
        if read.status:
            parts.append(("status", read.status, lambda: _status(read.status, place)))
        if read.time is not None:
            time = (read.time, read.is_paused)
            parts.append(("time", time, lambda: _time(*time, place)))
        if read.rows is not None:
            rows, chosen = read.rows, read.chosen
            parts.append(("rows", (rows, chosen), lambda: _rows(rows, chosen, place)))
        if read.trouble:
            parts.append(("trouble", read.trouble, lambda: _trouble(read.trouble, place)))
        if read.help:
            parts.append(("help", None, lambda: _help(place)))
        if read.note:
            parts.append(("note", read.note, lambda: _note(read.note, place)))
        drawn = [self._part(name, (place, key), draw, size) for name, key, draw in parts]
        ruler = self._ruler_panels(read.ruler, size, ratio)
        return [panel for panel in (*ruler, *drawn) if panel.pixels.size]

    def _ruler_panels(
        self, ruler: ShownRuler | None, size: tuple[int, int], ratio: float
    ) -> list[Panel]:
        if ruler is None:
            return []
        if self._ruler[0] != (ruler, size, ratio):
            made = [clipped(panel, size) for panel in ruler_panels(ruler, size, ratio)]
            self._ruler = ((ruler, size, ratio), made)
        return self._ruler[1]

    def _part(
        self, name: str, key: Hashable, draw: Callable[[], Panel], size: tuple[int, int]
    ) -> Panel:
        known = self._kept.get(name)
        if known is None or known[0] != key:
            known = self._kept[name] = (key, clipped(draw(), size))
        return known[1]


@dataclass(frozen=True, slots=True)
class _Place:
    """The size of the window in units of the layout, and the pixels per unit."""

    width: float
    height: float
    ratio: float

    def px(self, units: float) -> int:
        return round(units * self.ratio)

    @property
    def text_px(self) -> int:
        return max(self.px(_TEXT_SIZE), 6)


class _Canvas:
    """A panel that is being drawn; coordinates are those of the layout."""

    def __init__(
        self,
        frame: layout.Rectangle,
        place: _Place,
        back: tuple[int, int, int, int] = _BACK,
        *,
        rounded: bool = True,
    ) -> None:
        self.frame, self.place = frame, place
        self.image = Image.new(
            "RGBA", (max(place.px(frame.width), 1), max(place.px(frame.height), 1))
        )
        self.draw = ImageDraw.Draw(self.image)
        across, down = self.image.width - 1, self.image.height - 1
        radius = place.px(_ROUND) if rounded else 0
        self.draw.rounded_rectangle((0, 0, across, down), radius, back)

    def text(
        self,
        x: float,
        middle: float,
        text: str,
        color: tuple[int, ...] = _TEXT,
        *,
        room: float | None = None,
        anchor: str = "lm",
    ) -> None:
        """Draw a text at ``x``, vertically centered on ``middle``."""
        font = plain_font(self.place.text_px)
        if room is not None:
            text = shortened(font, text, self.place.px(room))
        self.draw.text(self._local(x, middle), text, color, font, anchor)

    def box(
        self, x: float, y: float, width: float, height: float, color: tuple[int, ...], radius: float
    ) -> None:
        """Draw a filled box, blended by its alpha."""
        left, top = self._local(x, y)
        right, bottom = left + self.place.px(width) - 1, top + self.place.px(height) - 1
        if right < left or bottom < top:
            return
        layer = Image.new("RGBA", self.image.size)
        shape = (left, top, right, bottom)
        ImageDraw.Draw(layer).rounded_rectangle(shape, self.place.px(radius), color)
        self.image.alpha_composite(layer)

    def dot(self, x: float, y: float, radius: float, color: tuple[int, ...]) -> None:
        left, top = self._local(x, y)
        r = self.place.px(radius)
        self.draw.ellipse((left - r, top - r, left + r, top + r), color)

    def panel(self) -> Panel:
        pixels: NDArray[Any] = np.asarray(self.image)
        return Panel(self.place.px(self.frame.x), self.place.px(self.frame.y), pixels)

    def _local(self, x: float, y: float) -> tuple[int, int]:
        return self.place.px(x - self.frame.x), self.place.px(y - self.frame.y)


def _text_width(text: str, place: _Place) -> float:
    return width(plain_font(place.text_px), text) / place.ratio


def _status(text: str, place: _Place) -> Panel:
    room = place.width - 2 * layout.MARGIN
    across = min(_text_width(text, place) + 22, max(room, 1))
    frame = layout.Rectangle(layout.MARGIN, layout.MARGIN, across, layout.STATUS_HEIGHT)
    canvas = _Canvas(frame, place)
    canvas.text(frame.x + 10, frame.y + frame.height / 2, text, room=frame.width - 20)
    return canvas.panel()


def _time(time: tuple[float, float, float], is_paused: bool, place: _Place) -> Panel:
    seconds, low, high = time
    strip = layout.time_bar(place.width, place.height)
    track = layout.time_track(place.width, place.height)
    canvas = _Canvas(strip, place, rounded=False)
    middle = strip.y + strip.height / 2
    canvas.text(layout.MARGIN + 16, middle, f"{seconds:.2f} s", _DIM if is_paused else _TEXT)
    _sign(canvas, layout.MARGIN + 2, middle, is_paused)
    share = min(max((seconds - low) / (high - low), 0.0), 1.0)
    canvas.box(track.x, middle - 2, track.width, 4, _TRACK, 2)
    canvas.box(track.x, middle - 2, track.width * share, 4, _ACCENT, 2)
    canvas.dot(track.x + track.width * share, middle, 5, _TEXT)
    return canvas.panel()


def _sign(canvas: _Canvas, x: float, middle: float, is_paused: bool) -> None:
    """Draw two bars while the time is paused, a triangle while it runs."""
    if is_paused:
        canvas.box(x, middle - 5, 3, 10, _DIM, 0)
        canvas.box(x + 5, middle - 5, 3, 10, _DIM, 0)
        return
    corners = [(x, middle - 5), (x, middle + 5), (x + 9, middle)]
    canvas.draw.polygon([canvas._local(*corner) for corner in corners], _TEXT)


def _rows(rows: tuple[ParameterRow, ...], chosen: int, place: _Place) -> Panel:
    table = layout.Table.of(place.width, place.height, len(rows), chosen)
    canvas = _Canvas(table.frame, place)
    if not rows:
        frame = table.frame
        middle = frame.y + frame.height / 2
        canvas.text(frame.x + layout.TABLE_PADDING, middle, "no parameters", _DIM)
    for number in range(table.first, table.first + table.count):
        row, place_of = rows[number], table.row(number)
        middle = place_of.y + place_of.height / 2
        if row.is_heading:
            canvas.text(place_of.x, middle + 2, row.label, _ACCENT, room=place_of.width)
            continue
        if number == chosen:
            canvas.box(
                place_of.x - 4, place_of.y + 1, place_of.width + 8, place_of.height - 2, _CHOSEN, 4
            )
        color = _TEXT if row.is_moved or number == chosen else _DIM
        width_px = place.px(
            place_of.width * layout.LABEL_SHARE - (8 if row.swatch is None else _SWATCH + 14)
        )
        label = shortened_inside(plain_font(place.text_px), row.label, width_px)
        canvas.text(place_of.x, middle, label, color)
        track = table.track(number)
        if row.swatch is not None:  # the rows of one color make one swatch
            _swatch(canvas, rows, number, table)
        if row.share is not None:
            canvas.box(track.x, middle - 2, track.width, 4, _TRACK, 2)
            canvas.box(track.x, middle - 2, track.width * row.share, 4, _ACCENT, 2)
            canvas.dot(track.x + track.width * row.share, middle, 4, _TEXT)
        room = place_of.width * layout.VALUE_SHARE - 10
        right = place_of.x + place_of.width
        canvas.text(right, middle, row.words, color, room=room, anchor="rm")
    if table.count < len(rows):
        # The scroll mark.
        part = table.handle(len(rows))
        canvas.box(part.x, part.y, part.width, part.height, _DIM, part.width / 2)
    return canvas.panel()


def _swatch(
    canvas: _Canvas, rows: tuple[ParameterRow, ...], number: int, table: layout.Table
) -> None:
    """Draw the part of a color's swatch that belongs to one of its rows."""
    color = rows[number].swatch
    assert color is not None
    place, left = table.row(number), table.track(number).x - _SWATCH - 6
    begins = number == table.first or rows[number - 1].swatch != color
    ends = number + 1 == len(rows) or rows[number + 1].swatch != color
    top, bottom = (4.0 if begins else 0.0), (4.0 if ends else 0.0)
    canvas.box(left, place.y + top, _SWATCH, place.height - top - bottom, (*color, 255), 0)


def _help(place: _Place) -> Panel:
    left = max(_text_width(line.keys, place) for line in HELP)
    across = left + max(_text_width(line.meaning, place) for line in HELP) + 52
    # In a small window only the first lines are shown; overlapping lines would not be readable.
    line = min(21.0, max((place.height - 24) / len(HELP), _TEXT_SIZE + 2.0))
    shown = HELP[: max(int((place.height - 20) // line), 1)]
    down = line * len(shown) + 20
    x, y = max((place.width - across) / 2, 0.0), max((place.height - down) / 2, 0.0)
    frame = layout.Rectangle(x, y, min(across, place.width), down)
    canvas = _Canvas(frame, place, _BACK_OF_HELP)
    for number, help_line in enumerate(shown):
        middle = y + 10 + line * (number + 0.5)
        canvas.text(x + 16, middle, help_line.keys, _ACCENT)
        canvas.text(x + 32 + left, middle, help_line.meaning)
    return canvas.panel()


def _note(text: str, place: _Place) -> Panel:
    across = min(_text_width(text, place) + 26, place.width)
    x = (place.width - across) / 2
    y = max(place.height - layout.BAR_HEIGHT - 44, 0.0)
    frame = layout.Rectangle(x, y, across, 30)
    canvas = _Canvas(frame, place)
    canvas.text(x + 12, y + 15, text, room=across - 24)
    return canvas.panel()


def _trouble(text: str, place: _Place) -> Panel:
    """Draw an error in columns, so that carets are at the right place; long lines are wrapped."""
    font = fixed_font(place.text_px)
    cell = width(font, "M")
    line_px = round(place.text_px * 1.45)
    padding = place.px(12)
    margin = place.px(layout.MARGIN)
    top = place.px(layout.TABLE_TOP)
    across = place.px(place.width) - 2 * margin
    columns = max(int((across - 2 * padding) // cell), 8)
    room = place.px(place.height - layout.BAR_HEIGHT) - top - margin
    count = max((room - 2 * padding) // line_px, 1)
    lines = _fitted([line.expandtabs(4) for line in text.splitlines()], columns)
    if len(lines) > count:
        lines = [*lines[: count - 1], "…"]
    longest = max(map(len, lines), default=1)
    wide = max(round(longest * cell) + 2 * padding, 1)
    size = (min(wide, max(across, 1)), max(len(lines) * line_px + 2 * padding, 1))
    image = Image.new("RGBA", size)
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle((0, 0, size[0] - 1, size[1] - 1), place.px(_ROUND), _BACK_OF_MISTAKE)
    fixed = width(font, "i") == cell
    for number, line in enumerate(lines):
        y = padding + number * line_px + line_px // 2
        if fixed:
            draw.text((padding, y), line, _TEXT, font, "lm")
            continue
        for column, letter in enumerate(line):
            draw.text((padding + (column + 0.5) * cell, y), letter, _TEXT, font, "mm")
    return Panel(margin, top, np.asarray(image))


_GUTTER: Final = re.compile(r" *\d* \| ?")
_CARETS: Final = re.compile(r" *\| *(\^+)")


def _fitted(lines: list[str], columns: int) -> list[str]:
    """Fit lines to a width: prose is wrapped; a source line is cut so that its caret is visible."""
    fitted: list[str] = []
    shift = 0
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        carets = _CARETS.fullmatch(below)
        is_source = _GUTTER.match(line) is not None
        if carets is not None:
            # Scroll the source line until the marked place is visible.
            shift = max(min(carets.end(1), carets.start(1) + columns // 2) - columns + 2, 0)
        if is_source and (carets is not None or _CARETS.fullmatch(line)):
            fitted.append(_windowed(line, shift, columns))
        else:
            fitted += textwrap.wrap(
                line, columns, replace_whitespace=False, break_on_hyphens=False
            ) or [""]
    return fitted


def _windowed(line: str, shift: int, columns: int) -> str:
    """Return a line with its gutter, scrolled by ``shift`` columns and cut to ``columns``."""
    found = _GUTTER.match(line)
    gutter = found.group() if found is not None else ""
    rest = line[len(gutter) :]
    if shift:
        rest = (" " if rest[:shift].isspace() else "…") + rest[shift + 1 :]
    room = columns - len(gutter)
    return gutter + (rest if len(rest) <= room else rest[: room - 1] + "…")
