"""Encode linear light and layers as an OpenEXR file, and decode such a file.

Input: linear light with straight alpha, layers by name, texts. Output: a file with one part of scan
lines. Does not depend on scenes. Channels have the names that compositors recognize:
``R G B A``, ``Z`` (the format's standard name for depth), ``N.X N.Y N.Z``, ``albedo.R`` …,
``material.id``, ``height``, ``samples``, ``variance``.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.foreign_files import reading
from distal.images.metadata import PREFIX, ReadError
from distal.packages import imported
from distal.pixels.exr_header import read_header
from distal.pixels.openexr import read_channels

BITS: Final = (16, 32)

# For each layer its channels, and whether half floats are precise enough. Depth is geometry: a
# half's 11 bits would quantize it visibly. An id is a whole number.
CHANNELS: Final[dict[str, tuple[tuple[str, ...], bool]]] = {
    "depth": (("Z",), False),
    "normal": (("N.X", "N.Y", "N.Z"), True),
    "albedo": (("albedo.R", "albedo.G", "albedo.B"), True),
    "material": (("material.id",), False),
    "height": (("height",), False),
    "samples": (("samples",), False),
    "variance": (("variance",), False),
}
_COLOR: Final = ("R", "G", "B", "A")
# Red, green, blue, white of ITU-R BT.709, whose primaries are also those of sRGB.
_REC709: Final = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
_LARGEST_HALF: Final = 65504.0


def encode(
    light: NDArray[np.float32],
    layers: Mapping[str, NDArray[Any]],
    texts: Mapping[str, str],
    bits: int = 16,
) -> bytes:
    """Return an EXR file of the light, with the layers, and the texts as attributes.

    Args:
        light: (height, width, 4), straight alpha; stored premultiplied, as the format requires.
        layers: Arrays by the names of ``CHANNELS``: (height, width) or (height, width, 3).
        texts: The metadata of the file.
        bits: Bits of a channel: 16 for half floats, or 32.

    Raises:
        PackageError: OpenEXR is missing or broken.
    """
    openexr = imported("OpenEXR")
    associated = light.copy()
    # The color of an uncovered pixel is stored as 0, even if it is infinite.
    np.multiply(light[..., :3], light[..., 3:], out=associated[..., :3], where=light[..., 3:] != 0)
    associated[light[..., 3] == 0, :3] = 0.0
    channels = {n: _stored(associated[..., i], bits) for i, n in enumerate(_COLOR)}
    for name, values in layers.items():
        names, halved = CHANNELS[name]
        parts = values.reshape(*values.shape[:2], -1)
        for i, channel in enumerate(names):
            channels[channel] = _stored(parts[..., i], bits if halved else 32)
    header: dict[str, Any] = {
        "compression": openexr.ZIP_COMPRESSION,
        "type": openexr.scanlineimage,
        "chromaticities": _REC709,
        "pixelAspectRatio": 1.0,
        **texts,
    }
    buffer = io.BytesIO()
    with openexr.File(header, channels) as file:
        file.write(buffer)
    return buffer.getvalue()


def _stored(values: NDArray[Any], bits: int) -> NDArray[Any]:
    """Convert values to a channel: half floats, floats, or whole numbers unchanged.

    Values too large for a half become the largest half, because infinity would spread in every
    filter. Infinities and NaN of the scene are kept.
    """
    if bits == 32 or values.dtype == np.uint32:
        return np.ascontiguousarray(values)
    clamped = np.clip(values, -_LARGEST_HALF, _LARGEST_HALF)
    return np.where(np.isinf(values), values, clamped).astype(np.float16)


def head_of(path: Path) -> tuple[tuple[int, int], int, dict[str, str]]:
    """Return the size, the bits of a color channel and distal's texts of an EXR file.

    Raises:
        ReadError: The file is broken or incomplete.
    """
    with reading("EXR", str(path), 0, error=ReadError), path.open("rb") as file:
        header = read_header(file)
    texts = {key: text for key, text in header.texts.items() if key.startswith(PREFIX)}
    if "R" not in header.bits:
        raise ReadError("it has no channel R")
    return header.size, header.bits["R"], texts


def decode(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the channels of an EXR file by name, each (height, width).

    Raises:
        ReadError: The file is broken.
        PackageError: OpenEXR is missing or broken.
    """
    with reading("EXR", "the picture", len(data), error=ReadError):
        return read_channels(data)[1]
