"""The one way from a picture to its pixels; textures, patterns, environments and heights use it.

Input: a file, a picture of Pillow, an array or nested lists. Output: ``Pixels``. The format of a
file is found by its first bytes, not by its name.
"""

from __future__ import annotations

import io
import struct
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import Memory, need_pixels, opened
from distal.pixels import openexr, radiance
from distal.pixels.arrays import is_encoded, numbers_of, with_channels
from distal.pixels.modes import pixels_of, rule_of

# Bytes that a pixel costs while its file is read: four floats, the decoder's pixel, and what
# progressive JPEG keeps.
_PIXEL_BYTES: Final = 24
# Formats of pictures that Pillow decodes itself: its others start programs, or read more files.
PICTURE_FORMATS: Final = (
    "PNG",
    "JPEG",
    "WEBP",
    "GIF",
    "BMP",
    "TIFF",
    "TGA",
    "PPM",
    "AVIF",
    "JPEG2000",
    "DDS",
    "PCX",
    "PSD",
    "QOI",
    "SGI",
)


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """The pixels of a picture.

    Attributes:
        values: (height, width, 4), top row first, straight alpha; float32, or float64 if 32 bits
            do not hold what an array has. 1 is white, but for linear pictures, which may be
            brighter.
        encoded: Whether the colors are encoded for display (sRGB); else they are linear.
    """

    values: NDArray[Any]
    encoded: bool


def read_pixels(data: Any, max_memory: Memory | None = None) -> Pixels:
    """Return the pixels of a picture.

    Args:
        data: The path of a file, a picture of Pillow, an array or nested lists.
        max_memory: The most bytes that a file may become; None: by its size.

    Raises:
        LoadError: A file cannot be read or is too large, or the data is no picture.
        PackageError: The file needs a package that is missing.
    """
    if isinstance(data, str | Path):
        with opened("texture", data, max_memory=max_memory, option=True) as content:
            return _of_file(content, str(data))
    if is_pillow(data):
        return Pixels(pixels_of(data), rule_of(data).encoded)
    array = numbers_of(data)
    return Pixels(with_channels(array, 2), is_encoded(array))


def is_pillow(data: Any) -> bool:
    """Return whether data is a picture of Pillow, which is not imported for that."""
    pillow = sys.modules.get("PIL.Image")
    return pillow is not None and isinstance(data, pillow.Image)


def _of_file(content: bytes, name: str) -> Pixels:
    if content.startswith(radiance.SIGNATURE):
        return Pixels(radiance.read_radiance(content), encoded=False)
    if content.startswith(openexr.SIGNATURE):
        return Pixels(openexr.read_light(content), encoded=False)
    with _decoder(content, name) as picture:
        rule_of(picture)
        width, height = picture.size
        need_pixels(width, height, _PIXEL_BYTES)
        picture.load()
        return Pixels(pixels_of(picture), rule_of(picture).encoded)


def _decoder(content: bytes, name: str) -> Any:
    """Return the picture of a file, of which only the header is read.

    ``Image.open`` refuses large pictures, whoever asked for them; the budget does that here.
    """
    from PIL import Image  # noqa: PLC0415 (only a file's data needs it)

    Image.init()
    reason = "it is no picture of a format that is read"
    for format in PICTURE_FORMATS:
        make, accept = Image.OPEN.get(format, (None, None))
        is_likely = accept is None or accept(content[:16])
        if make is None or isinstance(is_likely, str) or not is_likely:
            continue
        try:
            picture = make(io.BytesIO(content), name)
        except (SyntaxError, IndexError, TypeError, KeyError, EOFError, struct.error) as error:
            if accept is not None and isinstance(error, SyntaxError):
                reason = f"it is a {format} that is not read: {printable(error.msg, 80)}"
            continue  # as ``Image.open``: it may be another format's
        if picture is not None:
            return picture
    raise LoadError(reason)
