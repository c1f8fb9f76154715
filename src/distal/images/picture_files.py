"""Reads what a picture file says of itself, whatever its format.

Input: the path of a PNG, a JPEG or an EXR. Output: a ``Record``: how the picture was rendered, and
how the file stores it. Recognizes formats by their first bytes only. Does not read pixels.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from distal.images import exr, jpeg, png
from distal.images.metadata import Provenance, ReadError, provenance

_HEAD_PNG: Final = b"\x89PNG\r\n\x1a\n"
_HEAD_EXR: Final = b"\x76\x2f\x31\x01"


@dataclass(frozen=True, slots=True)
class Record:
    """The metadata of a picture file.

    Attributes:
        provenance: How the picture was rendered.
        size: Width and height in pixels when it was rendered.
        stored_size: Width and height of the file; different if a program scaled or cropped it.
        version: The version of distal that rendered it.
        format: "png", "jpg" or "exr".
        bits: Bits of each channel: 8 or 16 in a PNG; 8 in a JPEG; 16 or 32 in an EXR.
    """

    provenance: Provenance
    size: tuple[int, int]
    stored_size: tuple[int, int]
    version: str
    format: str
    bits: int


def read(path: Path) -> Record:
    """Read the metadata of a picture file.

    Raises:
        ReadError: The file is missing, broken, not a picture, or has no metadata.
    """
    try:
        with path.open("rb") as file:
            head = file.read(8)
    except OSError as error:
        raise ReadError(f"cannot read {path}: {error.strerror or error}") from None
    if head == _HEAD_PNG:
        kind, (size, bits, found) = "png", png.head_of(path)
    elif head[:4] == _HEAD_EXR:
        kind, (size, bits, found) = "exr", exr.head_of(path)
    elif head[:3] == jpeg.SIGNATURE:
        kind, (size, bits, found) = "jpg", jpeg.head_of(path)
    else:
        raise ReadError(f"{path} is no PNG, JPEG or EXR")
    if not found.get("distal:source-hash"):
        raise ReadError(
            f"{path} does not say how it was made: not a picture of distal's, or its metadata "
            "was stripped"
        )
    try:
        origin = provenance(found)
        rendered = _size(found.get("distal:size"), size)
    except ReadError as error:
        raise ReadError(f"cannot rebuild {path}: {error}") from None
    return Record(origin, rendered, size, found.get("distal:version", ""), kind, bits)


def _size(text: str | None, otherwise: tuple[int, int]) -> tuple[int, int]:
    if text is None:
        return otherwise
    found = re.fullmatch(r"([0-9]{1,6})x([0-9]{1,6})", text)
    if found is None:
        raise ReadError("what it says about itself is garbled")
    return int(found[1]), int(found[2])
