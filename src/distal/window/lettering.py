"""Fonts for the text over the picture.

Input: a size in pixels, texts. Output: fonts, and the widths of texts. Uses a system font such as
DejaVu if one is found, else the font of Pillow.
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
    """Return a proportional font."""
    return _first(_PLAIN, size_px)


@lru_cache(maxsize=32)
def fixed_font(size_px: int) -> Font:
    """Return a monospaced font; if there is none, the caller places letters in columns."""
    return _first(_FIXED, size_px)


def _first(names: tuple[str, ...], size_px: int) -> Font:
    for name in names:
        try:
            return ImageFont.truetype(name, size_px)
        except OSError:  # the font is not installed
            continue
    return ImageFont.load_default(size_px)


def width(font: Font, text: str) -> float:
    """Return the width of a text in pixels."""
    return float(font.getlength(text))


def shortened(font: Font, text: str, room: float) -> str:
    """Return a text, cut at its end to fit.

    Args:
        font: The font.
        text: The text.
        room: The available width in pixels.
    """
    if width(font, text) <= room:
        return text
    while text and width(font, text + "…") > room:
        text = text[:-1]
    return text + "…"


def shortened_inside(font: Font, text: str, room: float) -> str:
    """Return a text, cut in its middle to fit, because similar names often differ at the end.

    Args:
        font: The font.
        text: The text.
        room: The available width in pixels.
    """
    kept = len(text)
    made = text
    while kept > 2 and width(font, made) > room:
        kept -= 1
        made = f"{text[: kept - kept // 2]}…{text[len(text) - kept // 2 :]}"
    return made if width(font, made) <= room else shortened(font, text, room)
