"""Reads OpenEXR pictures: their channels, and their light as a picture shows it.

Input: the bytes of a file. Output: channels by name, or float32 (height, width, 4), top row first,
with straight alpha. OpenEXR's C++ is given a file only when its header was checked.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import need
from distal.packages import imported
from distal.pixels.exr_header import ExrHeader, read_header

SIGNATURE: Final = b"\x76\x2f\x31\x01"
_LIGHT_BYTES: Final = 24
_COLORS: Final = ("R", "G", "B")


def read_channels(data: bytes) -> tuple[ExrHeader, dict[str, NDArray[Any]]]:
    """Return the header and the channels of a file by name, each (height, width) of its data.

    Raises:
        ValueError: The file is damaged.
        TooLargeError: It takes more memory than it may.
        PackageError: OpenEXR is missing or broken.
    """
    openexr = imported("OpenEXR")
    header = read_header(io.BytesIO(data))
    width, height = header.size
    pixel = sum(header.bits.values()) // 8
    need(2 * width * height * pixel, f"{width:,} x {height:,} pixels of {pixel} bytes")
    with _quiet(), openexr.File(io.BytesIO(data), separate_channels=True) as file:
        return header, {name: channel.pixels for name, channel in file.channels().items()}


def read_light(data: bytes) -> NDArray[np.float32]:
    """Return the light of a picture: what of its data is in its display window, 0 elsewhere.

    Raises:
        ValueError: The file is damaged, or has no colors.
        TooLargeError: It takes more memory than it may.
        PackageError: OpenEXR is missing or broken.
    """
    header = read_header(io.BytesIO(data))
    names = colors_of(header.bits)
    left, top, right, bottom = header.display
    width, height = right - left + 1, bottom - top + 1
    pixel = sum(header.bits.values()) // 8
    data_bytes = 2 * header.size[0] * header.size[1] * pixel
    need(data_bytes + width * height * _LIGHT_BYTES, f"{width:,} x {height:,} pixels")
    _, channels = read_channels(data)
    pixels = np.zeros((height, width, 4), np.float32)
    x, y = header.corner[0] - left, header.corner[1] - top
    columns = slice(max(x, 0), min(x + header.size[0], width))
    rows = slice(max(y, 0), min(y + header.size[1], height))
    if rows.start >= rows.stop or columns.start >= columns.stop:
        raise LoadError("its pixels are outside of its display window")
    seen = (
        slice(rows.start - y, rows.stop - y),
        slice(columns.start - x, columns.stop - x),
    )
    for i, name in enumerate(names):
        pixels[rows, columns, i] = 1.0 if name is None else channels[name][seen]
    if names[3] is not None:
        for row in pixels:  # the format's colors are multiplied by their alpha
            alpha = row[:, 3:]
            np.divide(row[:, :3], alpha, out=row[:, :3], where=alpha > 0.0)
    return pixels


def colors_of(channels: Mapping[str, Any]) -> tuple[str, str, str, str | None]:
    """Return the names of the channels that are red, green, blue and alpha.

    Those without a layer's name, or else those of the only layer that has colors; ``Y`` is grey.

    Raises:
        LoadError: There are none, or several layers.
    """
    if {"RY", "BY"} & set(channels):
        raise LoadError("its colors are stored as luminance and chroma: save it as R, G and B")
    layers = {name.rpartition(".")[0] for name in channels}
    colored = [layer for layer in sorted(layers) if _of_layer(layer, channels) is not None]
    if not colored:
        raise LoadError(f"it has no colors, but {printable(', '.join(sorted(channels)), 80)}")
    if "" not in colored and len(colored) > 1:
        named = printable(", ".join(colored), 80)
        raise LoadError(f"it has the layers {named}, and none without a name: save one of them")
    found = _of_layer(colored[0], channels)
    assert found is not None
    return found


def _of_layer(layer: str, channels: Mapping[str, Any]) -> tuple[str, str, str, str | None] | None:
    prefix = f"{layer}." if layer else ""
    alpha = f"{prefix}A" if f"{prefix}A" in channels else None
    if all(f"{prefix}{color}" in channels for color in _COLORS):
        return f"{prefix}R", f"{prefix}G", f"{prefix}B", alpha
    # The grey of a layer would be a direction in "N.X N.Y N.Z".
    return ("Y", "Y", "Y", alpha) if not layer and "Y" in channels else None


@contextmanager
def _quiet() -> Iterator[None]:
    """Suppress what the C++ library prints about a broken file; it also raises an exception."""
    kept = [os.dup(number) for number in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in (1, 2):
            os.dup2(nowhere, number)
        yield
    finally:
        for number, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)
