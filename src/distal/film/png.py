"""Pixels to PNG bytes.

What flows in: display-encoded float pixels, top row first, and texts to keep beside them. What
flows out: an 8-bit PNG that says it is sRGB. Knows nothing of scenes or files.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage
from PIL.PngImagePlugin import PngInfo

# Perceptual, the rendering intent for pictures (PNG specification, 11.3.2.5).
_SRGB_INTENT = b"\x00"
# Measured on the raymarcher at 640x480, levels 1, 4, 6, 9: 6, 8, 12, 74 ms for 60, 47, 41, 37 kB.
_COMPRESSION = 4
_BAND = 32  # rows


def quantise(array: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Each value as the nearest of 256 levels.

    NaN, of which no display has a notion, becomes 0, so that a broken pixel is black (or
    transparent) and never the luck of a cast; infinities and values outside 0 to 1 are clamped.
    """
    levels = np.empty(array.shape, np.uint8)
    # In bands, since a picture in doubles would need several times its own memory.
    for top in range(0, len(array), _BAND):
        # Doubles hold value * 255 + 0.5 exactly enough that the floor is never the wrong neighbour.
        band = array[top : top + _BAND].astype(np.float64)
        np.nan_to_num(band, copy=False, nan=0.0, posinf=1.0, neginf=0.0)
        np.clip(band, 0.0, 1.0, out=band)
        levels[top : top + _BAND] = band * 255.0 + 0.5
    return levels


def encode(array: NDArray[np.float32], texts: Mapping[str, str]) -> bytes:
    """A PNG of the pixels, with the texts in its metadata.

    An opaque picture is stored without alpha. Texts of Latin-1 go into tEXt chunks, others into
    iTXt.
    """
    levels = quantise(array)
    pixels: NDArray[Any] = levels[..., :3] if (levels[..., 3] == 255).all() else levels
    information = PngInfo()
    information.add(b"sRGB", _SRGB_INTENT)
    for key, text in texts.items():
        # add_text itself turns to iTXt where Latin-1 does not reach.
        information.add_text(key, text)
    buffer = io.BytesIO()
    PillowImage.fromarray(np.ascontiguousarray(pixels)).save(
        buffer, format="PNG", pnginfo=information, compress_level=_COMPRESSION
    )
    return buffer.getvalue()
