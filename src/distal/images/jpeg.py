"""Encode pixels as JPEG, and read the metadata of such a file.

Input: display-encoded float pixels, top row first, and texts. Output: a JPEG of 8 bits with full
resolution of color, whose comment holds the texts as JSON. Does not depend on scenes.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.file_writer import SaveError
from distal.foreign_files import need_pixels, opened, reading
from distal.images.metadata import ReadError
from distal.images.png import quantise
from distal.lang.lazy_module import LazyModule

if TYPE_CHECKING:
    from PIL import Image as PillowImage
    from PIL import JpegImagePlugin
else:
    # Slow to import, and only files need them.
    PillowImage, JpegImagePlugin = LazyModule("PIL.Image"), LazyModule("PIL.JpegImagePlugin")

SIGNATURE: Final = b"\xff\xd8\xff"
BITS: Final = (8,)
LARGEST_SIDE: Final = 65535  # pixels (ITU-T T.81, B.2.2)
_QUALITY: Final = 95
_LONGEST_COMMENT: Final = 65533  # bytes (ITU-T T.81, B.2.4.5)


def encode(array: NDArray[np.float32], texts: Mapping[str, str]) -> bytes:
    """Return a JPEG of the pixels. Metadata that is too long for a comment is left out.

    Args:
        array: (height, width, 4), display values; opaque.
        texts: The metadata by key.

    Raises:
        SaveError: A pixel is transparent, or a side is too long.
    """
    levels = quantise(array)
    if not (levels[..., 3] == 255).all():
        raise SaveError("a JPEG has no transparency: save a .png")
    if max(levels.shape[:2]) > LARGEST_SIDE:
        raise SaveError(f"a side of a JPEG has at most {LARGEST_SIDE} pixels: save a .png")
    comment = json.dumps(dict(texts)).encode("ascii")
    options: dict[str, Any] = {"comment": comment} if len(comment) <= _LONGEST_COMMENT else {}
    buffer = io.BytesIO()
    pixels = PillowImage.fromarray(np.ascontiguousarray(levels[..., :3]))
    pixels.save(buffer, format="JPEG", quality=_QUALITY, subsampling="4:4:4", **options)
    return buffer.getvalue()


def head_of(path: Path) -> tuple[tuple[int, int], int, dict[str, str]]:
    """Return the size, the bits of a channel and the texts of a file.

    Raises:
        ReadError: It cannot be read.
    """
    with (
        opened("JPEG", path, error=ReadError) as data,
        JpegImagePlugin.JpegImageFile(io.BytesIO(data)) as picture,
    ):
        size, comment = picture.size, picture.info.get("comment", b"")
        found = json.loads(comment or b"{}")
    texts = found.items() if isinstance(found, dict) else ()
    return size, 8, {key: text for key, text in texts if isinstance(text, str)}


def decode(data: bytes) -> NDArray[np.uint8]:
    """Return the pixels of a file: (height, width, 3).

    Raises:
        ReadError: It cannot be read.
    """
    with (
        reading("JPEG", "the picture", len(data), error=ReadError),
        JpegImagePlugin.JpegImageFile(io.BytesIO(data)) as picture,
    ):
        need_pixels(*picture.size, 16)
        return np.asarray(picture.convert("RGB"))
