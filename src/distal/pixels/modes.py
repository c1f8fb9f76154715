"""Pictures of Pillow: one rule for each of its modes, and the orientation of photos.

Input: a picture, opened or in memory. Output: float32 (height, width, 4), turned upright by its
orientation. ``MODE_RULES`` says what the levels of a file mean; the reference page prints them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.pixels.arrays import BAND

_ORIENTATION: Final = 0x0112
_LARGEST_LEVEL: Final = 65535
# The stored picture as a view of the one that is shown, by the EXIF orientation.
_STORED: Final[dict[int, Callable[[NDArray[Any]], NDArray[Any]]]] = {
    2: lambda shown: shown[:, ::-1],
    3: lambda shown: shown[::-1, ::-1],
    4: lambda shown: shown[::-1],
    5: lambda shown: shown.swapaxes(0, 1),
    6: lambda shown: shown[:, ::-1].swapaxes(0, 1),
    7: lambda shown: shown[::-1, ::-1].swapaxes(0, 1),
    8: lambda shown: shown[::-1].swapaxes(0, 1),
}


def _colors(picture: Any) -> NDArray[Any]:
    return np.asarray(picture.convert("RGBA"))


def _by_red_green_blue(picture: Any) -> NDArray[Any]:
    return _colors(picture.convert("RGB"))


def _premultiplied_grey(picture: Any) -> NDArray[Any]:
    return _colors(picture.convert("LA"))


def _lab(picture: Any) -> NDArray[Any]:
    from PIL import ImageCms  # noqa: PLC0415 (only this mode needs it)

    lab, srgb = ImageCms.createProfile("LAB"), ImageCms.createProfile("sRGB")
    change = ImageCms.buildTransform(lab, srgb, "LAB", "RGB")
    return _colors(ImageCms.applyTransform(picture, change))


def _deep(picture: Any) -> NDArray[Any]:
    levels = np.asarray(picture)
    low, high = int(levels.min()), int(levels.max())
    if low < 0 or high > _LARGEST_LEVEL:
        raise LoadError(
            f"its grey levels are {low} to {high}, and nothing says which is white: save it with "
            "16 bits (0 to 65535) or as floats"
        )
    return levels[..., None]


def _floats(picture: Any) -> NDArray[Any]:
    return np.asarray(picture)[..., None]


@dataclass(frozen=True, slots=True)
class ModeRule:
    """What a mode of Pillow means.

    Attributes:
        meaning: The rule in words.
        read: Returns the levels of a part of a picture: (rows, columns, 1 or 4).
        white: The level that is 1.
        encoded: Whether it is encoded for display.
    """

    meaning: str
    read: Callable[[Any], NDArray[Any]]
    white: float = 255.0
    encoded: bool = True


_EIGHT: Final = ModeRule("8 bits a channel, divided by 255", _colors)
_SIXTEEN: Final = ModeRule("grey of 16 bits, divided by 65535", _deep, 65535.0)
_CONVERTED: Final = ModeRule("converted to RGB by Pillow", _by_red_green_blue)
MODE_RULES: Final = {
    "1": ModeRule("black is 0, white is 1", _colors),
    **dict.fromkeys(("L", "LA", "RGB", "RGBA"), _EIGHT),
    "La": ModeRule("8 bits, with the alpha divided out", _premultiplied_grey),
    "RGBa": ModeRule("8 bits, with the alpha divided out", _colors),
    **dict.fromkeys(
        ("P", "PA"), ModeRule("the colors of its palette, transparent ones too", _colors)
    ),
    "RGBX": ModeRule("8 bits a channel; the fourth is ignored", _by_red_green_blue),
    **dict.fromkeys(("CMYK", "YCbCr", "HSV"), _CONVERTED),
    "LAB": ModeRule("CIE L*a*b* to sRGB by LittleCMS", _lab),
    **dict.fromkeys(("I;16", "I;16B", "I;16L", "I;16N"), _SIXTEEN),
    "I": ModeRule(
        "grey of 16 bits, divided by 65535; refused if a level is larger", _deep, 65535.0
    ),
    "F": ModeRule("floats, unchanged; linear", _floats, 1.0, encoded=False),
}


def rule_of(picture: Any) -> ModeRule:
    """Return the rule of a picture's mode.

    Raises:
        LoadError: It has none.
    """
    rule = MODE_RULES.get(picture.mode)
    if rule is None:
        raise LoadError(f"pixels of Pillow's mode {printable(picture.mode, 20)} are not read")
    return rule


def pixels_of(picture: Any) -> NDArray[np.float32]:
    """Return the pixels of a picture: float32 (height, width, 4), top row first.

    Args:
        picture: A picture of Pillow.

    Raises:
        LoadError: Its mode or its levels have no rule.
    """
    # Pillow turns a TIFF while it loads it, and forgets its orientation then.
    picture.load()
    rule = rule_of(picture)
    width, height = picture.size
    orientation = _orientation(picture)
    pixels = np.ones((width, height, 4) if orientation > 4 else (height, width, 4), np.float32)
    stored = _STORED[orientation](pixels) if orientation in _STORED else pixels
    for top in range(0, height, BAND):
        band = rule.read(picture.crop((0, top, width, min(top + BAND, height))))
        used = 4 if band.shape[-1] == 4 else 3
        stored[top : top + BAND, :, :used] = band
    used = 4 if rule.read in (_deep, _floats) else 0
    pixels[..., : 3 if used else 4] /= np.float32(rule.white)
    return pixels


def _orientation(picture: Any) -> int:
    """Return the EXIF orientation, 1 to 8; damaged tags are ignored, as viewers do."""
    try:
        found = picture.getexif().get(_ORIENTATION, 1)
    except Exception:  # Pillow's parser raises many kinds
        return 1
    return found if isinstance(found, int) and 1 <= found <= 8 else 1
