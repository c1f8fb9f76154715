"""Encode pixels as PNG, and decode PNG.

Input: display-encoded float pixels, top row first, and texts for the metadata. Output: a PNG of 8
or 16 bits that is declared as sRGB. Does not depend on scenes.
"""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.levels import levels as fast_levels
from distal.foreign_files import need_pixels, opened, reading
from distal.images.metadata import PREFIX, ReadError
from distal.lang.lazy_module import LazyModule
from distal.lang.render_options import LARGEST_SIDE_PX

if TYPE_CHECKING:
    from PIL import Image as PillowImage
    from PIL import PngImagePlugin
else:
    # Slow to import, and only files need them.
    PillowImage, PngImagePlugin = LazyModule("PIL.Image"), LazyModule("PIL.PngImagePlugin")

BITS: Final = (8, 16)

# Perceptual, the rendering intent for pictures (PNG specification, 11.3.2.5).
_SRGB_INTENT = b"\x00"
# Measured on the raymarcher at 640x480, levels 1, 4, 6, 9: 6, 8, 12, 74 ms for 60, 47, 41, 37 kB.
_COMPRESSION = 4
_BAND = 32  # rows
_MANY = 65536  # values
_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {2: 3, 6: 4}  # by color type (PNG specification, 11.2.2)
_UP = 2  # the filter, as the byte before each row (PNG specification, 9.2)
_LARGEST_CHUNK = 2**31 - 1


def quantise(array: NDArray[np.float32], bits: int = 8) -> NDArray[Any]:
    """Round each value to the nearest of 256 or 65536 levels, as uint8 or uint16.

    NaN becomes 0, so that a broken pixel is always black (or transparent), independent of how the
    platform casts NaN; infinities and values outside 0 to 1 are clamped.
    """
    # For fewer values, loading the machine code takes longer than it saves.
    found = fast_levels(array, bits) if array.size >= _MANY else None
    return defined_levels(array, bits) if found is None else found


def defined_levels(array: NDArray[np.float32], bits: int) -> NDArray[Any]:
    """The definition of ``quantise`` in NumPy; used for few values or without compiled code."""
    levels = np.empty(array.shape, np.uint8 if bits == 8 else np.uint16)
    most = float(2**bits - 1)
    # In bands, because a whole picture in doubles would need several times its own memory.
    for top in range(0, len(array), _BAND):
        # Doubles represent value * most + 0.5 precisely enough that the floor is never the wrong
        # level.
        band = array[top : top + _BAND].astype(np.float64)
        np.nan_to_num(band, copy=False, nan=0.0, posinf=1.0, neginf=0.0)
        np.clip(band, 0.0, 1.0, out=band)
        levels[top : top + _BAND] = band * most + 0.5
    return levels


def encode(array: NDArray[np.float32], texts: Mapping[str, str], bits: int = 8) -> bytes:
    """Return a PNG of the pixels, with the texts in its metadata.

    An opaque picture is stored without alpha. Texts in Latin-1 become tEXt chunks, others iTXt
    chunks.

    Args:
        array: (height, width, 4), display values with straight alpha.
        texts: The metadata by key.
        bits: Bits of a channel, 8 or 16.
    """
    return encode_levels(quantise(array, bits), texts)


def encode_levels(levels: NDArray[Any], texts: Mapping[str, str]) -> bytes:
    """Return a PNG of levels, (height, width, 3 or 4), uint8 or uint16; see ``encode``."""
    pixels = np.ascontiguousarray(levels[..., :3] if _is_opaque(levels) else levels)
    information = PngImagePlugin.PngInfo()
    information.add(b"sRGB", _SRGB_INTENT)
    for key, text in texts.items():
        # add_text itself uses iTXt for text outside Latin-1.
        information.add_text(key, text)
    buffer = io.BytesIO()
    if pixels.dtype == np.uint16:
        _write_deep(buffer, pixels, information)
    else:
        PillowImage.fromarray(pixels).save(
            buffer, format="PNG", pnginfo=information, compress_level=_COMPRESSION
        )
    return buffer.getvalue()


def _is_opaque(levels: NDArray[Any]) -> bool:
    return bool((levels[..., 3:] == np.iinfo(levels.dtype).max).all())


def _write_deep(
    buffer: io.BytesIO, pixels: NDArray[np.uint16], information: PngImagePlugin.PngInfo
) -> None:
    """Write a PNG of 16 bits, which Pillow cannot write; only its function for chunks is used.

    Each row is stored as the difference from the one above (the filter Up): of the five filters it
    is the only one that NumPy can apply to whole rows in both directions.
    """
    height, width, channels = pixels.shape
    kind = 2 if channels == 3 else 6
    buffer.write(_SIGNATURE)
    PngImagePlugin.putchunk(
        buffer, b"IHDR", struct.pack(">IIBBBBB", width, height, 16, kind, 0, 0, 0)
    )
    for name, data, *_ in information.chunks:
        PngImagePlugin.putchunk(buffer, name, data)
    rows = pixels.astype(">u2").view(np.uint8).reshape(height, -1)
    filtered = np.empty((height, rows.shape[1] + 1), np.uint8)
    filtered[:, 0] = _UP
    filtered[0, 1:] = rows[0]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])  # modulo 256, as the filter requires
    packed = zlib.compress(filtered.data, _COMPRESSION)
    for start in range(0, len(packed), _LARGEST_CHUNK):
        PngImagePlugin.putchunk(buffer, b"IDAT", packed[start : start + _LARGEST_CHUNK])
    PngImagePlugin.putchunk(buffer, b"IEND", b"")


def head_of(path: Path) -> tuple[tuple[int, int], int, dict[str, str]]:
    """Return the size, the bits of a channel and distal's texts of a PNG.

    Raises:
        ReadError: The file is broken.
    """
    with opened("PNG", path, error=ReadError) as data:
        # Not Image.open, which refuses large pictures as a possible attack.
        with PngImagePlugin.PngImageFile(io.BytesIO(data)) as image:
            if max(image.size) > LARGEST_SIDE_PX:
                raise ValueError(f"it claims {image.width}x{image.height} pixels")
            need_pixels(*image.size, 4)
            image.load()  # detects missing data, and reads texts after the pixels
            texts = {str(key): str(value) for key, value in image.info.items()}
            size = image.size
        _check_end(io.BytesIO(data))
    return size, data[24], {key: text for key, text in texts.items() if key.startswith(PREFIX)}


def _check_end(file: BinaryIO) -> None:
    """Check that a PNG has all of its chunks; Pillow accepts one that ends after the pixels.

    Raises:
        ValueError: The file ends before its last chunk, IEND, does.
    """
    end = file.seek(0, io.SEEK_END)
    place, name = len(_SIGNATURE), b""
    while name != b"IEND":
        file.seek(place)
        head = file.read(8)
        if len(head) == 8:
            length, name = struct.unpack(">I4s", head)
            place += length + 12
        if len(head) < 8 or place > end:
            raise ValueError("its end is missing")


def decode(data: bytes) -> NDArray[Any]:
    """Return the levels of a PNG, (height, width, 4): uint8, or uint16 if ``encode`` wrote 16 bits.

    Raises:
        ReadError: The file is broken, or has 16 bits and was written by another program.
    """
    with reading("PNG", "the picture", len(data), error=ReadError):
        if data[24] == 16:
            return _read_deep(data)
        with PngImagePlugin.PngImageFile(io.BytesIO(data)) as image:
            need_pixels(*image.size, 12)
            return np.asarray(image.convert("RGBA"))


def _read_deep(data: bytes) -> NDArray[np.uint16]:
    chunks = list(_chunks(data))
    width, height, _, kind, *_, interlaced = struct.unpack(">IIBBBBB", chunks[0][1])
    if kind not in _CHANNELS or interlaced:
        raise ReadError("it was written by another program, and cannot be compared")
    channels = _CHANNELS[kind]
    need_pixels(width, height, channels * 12)
    packed = b"".join(content for name, content in chunks if name == b"IDAT")
    length = height * (1 + 2 * channels * width)  # a limit, however much the file would unpack to
    unpacked = zlib.decompressobj().decompress(packed, length)
    filtered = np.frombuffer(unpacked, np.uint8).reshape(height, -1)
    if (filtered[:, 0] != _UP).any():
        raise ReadError("it was written by another program, and cannot be compared")
    rows = np.cumsum(filtered[:, 1:], axis=0, dtype=np.uint8)
    levels = rows.view(">u2").astype(np.uint16).reshape(height, width, channels)
    if channels == 4:
        return levels
    return np.dstack((levels, np.full((height, width), 65535, np.uint16)))


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield the chunks of a PNG: name and content."""
    place = len(_SIGNATURE)
    while place < len(data):
        length, name = struct.unpack_from(">I4s", data, place)
        yield name, data[place + 8 : place + 8 + length]
        place += length + 12
