"""Draw a ruler over the picture: a line, a mark at each end, a label.

Input: a ``ShownRuler``, the size of the window. Output: small pictures with their positions. The
line has a dark border and the label a dark plate, so that both are readable on any picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from distal.window.lettering import plain_font, width
from distal.window.panels import Panel
from distal.window.ruler_tool import ShownRuler

Point: TypeAlias = tuple[float, float]

_LINE: Final = (255, 214, 74)
_BORDER: Final = (14, 16, 22)
_PLATE: Final = (14, 16, 22, 232)
_TEXT: Final = (255, 255, 255, 255)
_DIM: Final = (200, 206, 216, 255)
# Sizes in units of the window.
_WIDTH: Final = 2.0
_BORDER_WIDTH: Final = 1.5
_MARK: Final = 6.0
_TEXT_SIZE: Final = 13.0
_LARGE: Final = 17.0
_PADDING: Final = 10.0
_APART: Final = 18.0
_MARGIN: Final = 6.0
_ROUND: Final = 6.0
# Side of the pictures that the line is cut into, in pixels.
_TILE: Final = 96


@dataclass(frozen=True, slots=True)
class _Ink:
    """What is drawn in pixels: segments, and marks with what they are on."""

    segments: tuple[tuple[Point, Point], ...]
    marks: tuple[tuple[Point, str], ...]
    ratio: float


def ruler_panels(ruler: ShownRuler, size: tuple[int, int], ratio: float) -> list[Panel]:
    """Return the panels of a ruler, the lowest first.

    Args:
        ruler: The ruler.
        size: The window's size in pixels.
        ratio: Pixels per unit of the window.
    """
    places = [None if p is None else (p[0] * size[0], p[1] * size[1]) for p in ruler.places]
    pairs = pairwise(places)
    cut = (_inside(a, b, size) for a, b in pairs if a is not None and b is not None)
    ends = [places[0], places[-1]][: len(ruler.kinds)]
    marks = tuple((p, k) for p, k in zip(ends, ruler.kinds, strict=True) if p is not None)
    ink = _Ink(tuple(c for c in cut if c is not None), marks, ratio)
    panels = list(_tiles(ink, size))
    if ruler.lines:
        panels.append(_label(ruler.lines, [p for p in places if p is not None], size, ratio))
    return panels


def _inside(a: Point, b: Point, size: tuple[int, int]) -> tuple[Point, Point] | None:
    """Return the part of a segment in the window and a margin; None if there is none.

    Source: You-Dong Liang, Brian Barsky, "A New Concept and Method for Line Clipping" (1984).
    """
    first, last = 0.0, 1.0
    for axis in (0, 1):
        way, low, high = b[axis] - a[axis], -_TILE - a[axis], size[axis] + _TILE - a[axis]
        if way == 0.0:
            if low > 0.0 or high < 0.0:
                return None
            continue
        near, far = sorted((low / way, high / way))
        first, last = max(first, near), min(last, far)
    if first > last:
        return None
    x, y = b[0] - a[0], b[1] - a[1]
    return (a[0] + first * x, a[1] + first * y), (a[0] + last * x, a[1] + last * y)


def _tiles(ink: _Ink, size: tuple[int, int]) -> Iterator[Panel]:
    """Yield the tiles of the window on which there is ink."""
    reach = (_MARK + _WIDTH + _BORDER_WIDTH) * ink.ratio + 2.0
    lines = [*ink.segments, *((p, p) for p, _ in ink.marks)]
    found: set[tuple[int, int]] = set()
    for a, b in lines:
        steps = int(np.ceil(np.hypot(b[0] - a[0], b[1] - a[1]) / (_TILE / 2))) + 1
        for share in np.linspace(0.0, 1.0, steps + 1):
            x, y = a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])
            near = [(x + i * reach, y + j * reach) for i in (-1, 0, 1) for j in (-1, 0, 1)]
            found.update((int(p // _TILE), int(q // _TILE)) for p, q in near)
    for column, row in sorted(found):
        left, top = column * _TILE, row * _TILE
        across, down = min(_TILE, size[0] - left), min(_TILE, size[1] - top)
        if left >= 0 and top >= 0 and across > 0 and down > 0:
            pixels = _drawn(ink, left, top, across, down)
            if pixels[..., 3].any():
                yield Panel(left, top, pixels)


def _drawn(ink: _Ink, left: int, top: int, across: int, down: int) -> NDArray[np.uint8]:
    """Return a tile: coverage by the distance from the middle of each stroke."""
    y, x = np.mgrid[top : top + down, left : left + across] + 0.5
    half, border = 0.5 * _WIDTH * ink.ratio, _BORDER_WIDTH * ink.ratio
    off = np.full(x.shape, np.inf)
    for a, b in ink.segments:
        off = np.minimum(off, _from_segment(x, y, a, b))
    for place, kind in ink.marks:
        ring, inside = _from_mark(x - place[0], y - place[1], kind, _MARK * ink.ratio)
        # The line ends at the mark, whose inside stays free: the place itself is seen.
        off = np.where(inside, ring, np.minimum(off, ring))
    core = np.clip(half - off + 0.5, 0.0, 1.0)
    alpha = np.clip(half + border - off + 0.5, 0.0, 1.0)
    color = np.stack([core * c + (1.0 - core) * b for c, b in zip(_LINE, _BORDER, strict=True)], -1)
    found = np.concatenate([color, 255.0 * alpha[..., None]], -1)
    made: NDArray[np.uint8] = np.rint(found).astype(np.uint8)
    return made


def _from_segment(
    x: NDArray[np.float64], y: NDArray[np.float64], a: Point, b: Point
) -> NDArray[np.float64]:
    way_x, way_y = b[0] - a[0], b[1] - a[1]
    squared = max(way_x * way_x + way_y * way_y, 1e-12)
    share = np.clip(((x - a[0]) * way_x + (y - a[1]) * way_y) / squared, 0.0, 1.0)
    return np.hypot(x - a[0] - share * way_x, y - a[1] - share * way_y)


def _from_mark(
    x: NDArray[np.float64], y: NDArray[np.float64], kind: str, radius: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the distance from a mark's outline, and what is inside of it.

    A circle on a surface, a square on an edge, a diamond on a corner.
    """
    if kind == "edge":
        out = np.maximum(abs(x), abs(y)) - 0.9 * radius
    elif kind == "corner":
        out = (abs(x) + abs(y)) / np.sqrt(2.0) - 0.9 * radius
    else:
        out = np.hypot(x, y) - radius
    return abs(out), out < 0.0


def _label(
    lines: Sequence[str], places: Sequence[Point], size: tuple[int, int], ratio: float
) -> Panel:
    """Return the label, beside the middle of the line and inside of the window."""
    fonts = [plain_font(max(round(s * ratio), 6)) for s in (_LARGE, *[_TEXT_SIZE] * len(lines[1:]))]
    heights = [1.45 * s * ratio for s in (_LARGE, *[_TEXT_SIZE] * len(lines[1:]))]
    padding = _PADDING * ratio
    across = max(width(f, t) for f, t in zip(fonts, lines, strict=True)) + 2 * padding
    down = sum(heights) + 1.4 * padding
    image = Image.new("RGBA", (max(round(across), 1), max(round(down), 1)))
    draw = ImageDraw.Draw(image)
    box = (0, 0, image.width - 1, image.height - 1)
    draw.rounded_rectangle(box, round(_ROUND * ratio), _PLATE)
    y = 0.7 * padding
    for number, (font, text, high) in enumerate(zip(fonts, lines, heights, strict=True)):
        color = (*_LINE, 255) if number == 0 else _TEXT if number == 1 else _DIM
        draw.text((padding, y + high / 2), text, color, font, "lm")
        y += high
    left, top = _free_place(places, image.size, size, ratio)
    return Panel(left, top, np.asarray(image))


def _free_place(
    places: Sequence[Point], plate: tuple[int, int], size: tuple[int, int], ratio: float
) -> tuple[int, int]:
    """Return where a plate covers as little of the line as possible: on one of its four sides."""
    middle = places[len(places) // 2] if places else (size[0] / 2, size[1] / 2)
    apart, margin = _APART * ratio, _MARGIN * ratio
    lefts = (middle[0] + apart, middle[0] - apart - plate[0])
    tops = (middle[1] + apart, middle[1] - apart - plate[1])
    best, least = (0, 0), float("inf")
    for x in lefts:
        for y in tops:
            left = min(max(x, margin), max(size[0] - plate[0] - margin, 0.0))
            top = min(max(y, margin), max(size[1] - plate[1] - margin, 0.0))
            covered = sum(
                -apart / 2 < p[0] - left < plate[0] + apart / 2
                and -apart / 2 < p[1] - top < plate[1] + apart / 2
                for p in places
            )
            cost = covered + (abs(left - x) + abs(top - y)) / max(size)
            if cost < least:
                best, least = (round(left), round(top)), cost
    return best
