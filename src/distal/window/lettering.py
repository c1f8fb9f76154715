"""Fonts for what is written over the picture.

Input: a size in pixels, texts. Output: fonts, and the widths of texts. The
machine's own DejaVu or its like where one is found, else the one that Pillow brings.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final, TypeAlias

from PIL import ImageFont

Font: TypeAlias = "ImageFont.FreeTypeFont | ImageFont.ImageFont"

_PLAIN: Final = ("DejaVuSans.ttf", "segoeui.ttf", "Helvetica.ttc", "Arial.ttf")
_FIXED: Final = ("DejaVuSansMono.ttf", "consola.ttf", "Menlo.ttc", "LiberationMono-Regular.ttf")


@lru_cache(maxsize=32)
def plain_font(size_px: int) -> Font:
    """For words."""
    return _first(_PLAIN, size_px)


@lru_cache(maxsize=32)
def fixed_font(size_px: int) -> Font:
    """For source code; where no font of one width is found, letters are in columns all the same."""
    return _first(_FIXED, size_px)


def _first(names: tuple[str, ...], size_px: int) -> Font:
    for name in names:
        try:
            return ImageFont.truetype(name, size_px)
        except OSError:  # not on this machine
            continue
    return ImageFont.load_default(size_px)


def width(font: Font, text: str) -> float:
    """How wide a text is, in pixels."""
    return float(font.getlength(text))


def shortened(font: Font, text: str, room: float) -> str:
    """The text, or as much of its beginning as there is room for."""
    if width(font, text) <= room:
        return text
    while text and width(font, text + "…") > room:
        text = text[:-1]
    return text + "…"


def shortened_inside(font: Font, text: str, room: float) -> str:
    """The text, or its beginning and its end: names of one family differ at their ends."""
    kept = len(text)
    made = text
    while kept > 2 and width(font, made) > room:
        kept -= 1
        made = f"{text[: kept - kept // 2]}…{text[len(text) - kept // 2 :]}"
    return made if width(font, made) <= room else shortened(font, text, room)
