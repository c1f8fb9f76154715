"""Linear light and layers to an OpenEXR file, and back.

What flows in: linear light with straight alpha, layers by name, texts. What flows out: one part of
scan lines. Knows nothing of scenes. Channels are called as compositors find them by themselves:
``R G B A``, ``Z`` (the format's own name for depth), ``N.X N.Y N.Z``, ``albedo.R`` …,
``material.id``.
"""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.film.metadata import PREFIX, ReadError

BITS: Final = (16, 32)

# Layer -> its channels, and whether half floats are enough for it. Depth is geometry: 11 bits would
# make steps of it. An id is a whole number.
CHANNELS: Final[dict[str, tuple[tuple[str, ...], bool]]] = {
    "depth": (("Z",), False),
    "normal": (("N.X", "N.Y", "N.Z"), True),
    "albedo": (("albedo.R", "albedo.G", "albedo.B"), True),
    "material": (("material.id",), False),
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
    """An EXR of the light, with the layers beside it and the texts as attributes.

    Args:
        light: (height, width, 4), straight alpha; stored premultiplied, as the format has it.
        layers: Arrays by the names of ``CHANNELS``: (height, width) or (height, width, 3).
        texts: What the file says about itself.
        bits: Of a channel: 16, half floats, or 32.

    Raises:
        ModuleNotFoundError: OpenEXR is missing.
    """
    openexr = importlib.import_module("OpenEXR")
    associated = light.copy()
    # Where nothing covers a pixel its color is nothing too, even if it is infinite.
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
    """Values as a channel: half floats, floats, or whole numbers as they are.

    What is too large for a half becomes its largest: infinity would spread in every filter.
    Infinities and NaN that the scene made stay.
    """
    if bits == 32 or values.dtype == np.uint32:
        return np.ascontiguousarray(values)
    clamped = np.clip(values, -_LARGEST_HALF, _LARGEST_HALF)
    return np.where(np.isinf(values), values, clamped).astype(np.float16)


def head_of(path: Path) -> tuple[tuple[int, int], int, dict[str, str]]:
    """The size, the bits of a color's channel and our texts of an EXR.

    Raises:
        ReadError: The file is broken.
        ModuleNotFoundError: OpenEXR is missing.
    """
    channels, header = _read(path)
    color = channels.get("R")
    if color is None:
        raise ReadError(f"{path} has no channel R")
    found = {k: v for k, v in header.items() if k.startswith(PREFIX) and isinstance(v, str)}
    height, width = color.shape
    return (width, height), color.dtype.itemsize * 8, found


def decode(path: Path) -> dict[str, NDArray[Any]]:
    """The channels of an EXR by name, each (height, width).

    Raises:
        ReadError: The file is broken.
        ModuleNotFoundError: OpenEXR is missing.
    """
    return _read(path)[0]


def _read(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    openexr = importlib.import_module("OpenEXR")
    try:
        # All of it: a file cut short has a whole header.
        with openexr.File(str(path), separate_channels=True) as file:
            channels = {name: channel.pixels for name, channel in file.channels().items()}
            return channels, dict(file.header())
    except Exception as error:  # its C++ raises what it likes on broken files
        raise ReadError(f"{path} is no whole EXR: {str(error).splitlines()[0]}") from None
