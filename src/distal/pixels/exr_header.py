"""Read the header of an OpenEXR file without the library; another program may have written it.

Input: a file. Output: its size, the bits of its channels, its texts; or a ``ValueError`` that
explains the fault. OpenEXR's C++ ends the process on some broken files, so no file is passed to it
unless its header passes the checks here: one part of scan lines, and every row in the file.

Source: "OpenEXR File Layout" of the format's documentation.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import BinaryIO, Final

from distal.lang.render_options import LARGEST_SIDE_PX

_MAGIC: Final = b"\x76\x2f\x31\x01"
_VERSION: Final = 2
_LONG_NAMES: Final = 0x400  # the only flag allowed for a single part of scan lines
_LONGEST_NAME: Final = 255
_LONGEST_VALUE: Final = 2**22  # bytes
_MOST_ATTRIBUTES: Final = 1000
_BITS: Final = {0: 32, 1: 16, 2: 32}  # of unsigned integers, half floats, floats
# Rows in a chunk, by the code of the compression.
_ROWS: Final = {0: 1, 1: 1, 2: 1, 3: 16, 4: 32, 5: 16, 6: 32, 7: 32, 8: 32, 9: 256}


@dataclass(slots=True)
class ExrHeader:
    """The relevant content of a header.

    Attributes:
        size: Width and height of its data in pixels.
        corner: Where the upper left pixel of its data is: column and row.
        display: What a picture shows: the first column and row, and the last.
        bits: Bits of each channel by name.
        texts: The text attributes.
    """

    size: tuple[int, int] = (0, 0)
    corner: tuple[int, int] = (0, 0)
    display: tuple[int, int, int, int] = (0, 0, 0, 0)
    bits: dict[str, int] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)


def read_header(file: BinaryIO) -> ExrHeader:
    """Read the header, and check that every row is in the file.

    Raises:
        OSError: The file cannot be read.
        ValueError: Its header is not one that distal writes, or the file is incomplete.
    """
    magic, version = struct.unpack("<4sI", _exactly(file, 8))
    if magic != _MAGIC or version & 0xFF != _VERSION:
        raise ValueError("it is of another version")
    if version & ~0xFF & ~_LONG_NAMES:
        raise ValueError(
            "it has tiles, depths or several parts: save it as one picture of scan lines"
        )
    values = _attributes(file)
    corner, size = _window(values, "dataWindow")
    left, top = _window(values, "displayWindow")[0]
    across, down = _window(values, "displayWindow")[1]
    header = ExrHeader(size, corner, (left, top, left + across - 1, top + down - 1))
    header.bits = _channels(values)
    header.texts = {
        name: data.decode("utf-8", "replace")
        for name, (kind, data) in values.items()
        if kind == "string"
    }
    _check_rows(file, header.size[1], _rows_in_chunk(values))
    return header


def _exactly(file: BinaryIO, count: int) -> bytes:
    data = file.read(count)
    if len(data) != count:
        raise ValueError("it is cut short")
    return data


def _name(file: BinaryIO) -> str:
    name = bytearray()
    while (byte := _exactly(file, 1)) != b"\0":
        name += byte
        if len(name) > _LONGEST_NAME:
            raise ValueError("a name is too long")
    return name.decode("utf-8", "replace")


def _attributes(file: BinaryIO) -> dict[str, tuple[str, bytes]]:
    """Return type and value of each attribute by name."""
    found: dict[str, tuple[str, bytes]] = {}
    while name := _name(file):
        kind = _name(file)
        (length,) = struct.unpack("<i", _exactly(file, 4))
        if not 0 <= length <= _LONGEST_VALUE or len(found) == _MOST_ATTRIBUTES or name in found:
            raise ValueError("its attributes are garbled")
        found[name] = kind, _exactly(file, length)
    return found


def _value(
    values: dict[str, tuple[str, bytes]], name: str, kind: str, form: str
) -> tuple[int, ...]:
    found, data = values.get(name, ("", b""))
    if found != kind or len(data) != struct.calcsize(form):
        raise ValueError(f"its {name} is missing or garbled")
    return struct.unpack(form, data)


def _window(
    values: dict[str, tuple[str, bytes]], name: str
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the upper left corner of a window, and its size."""
    left, top, right, bottom = _value(values, name, "box2i", "<4i")
    width, height = right - left + 1, bottom - top + 1
    if not (0 < width <= LARGEST_SIDE_PX and 0 < height <= LARGEST_SIDE_PX):
        raise ValueError(f"it claims {width}x{height} pixels")
    return (left, top), (width, height)


def _rows_in_chunk(values: dict[str, tuple[str, bytes]]) -> int:
    (number,) = _value(values, "compression", "compression", "<B")
    if number not in _ROWS:
        raise ValueError("its compression is unknown")
    return _ROWS[number]


def _channels(values: dict[str, tuple[str, bytes]]) -> dict[str, int]:
    kind, data = values.get("channels", ("", b""))
    found: dict[str, int] = {}
    place = 0
    while kind == "chlist" and data[place : place + 1] not in (b"\0", b""):
        end = data.find(b"\0", place)
        if not 0 <= end < len(data) - 16:
            raise ValueError("its channels are garbled")
        name = data[place:end]
        number, _, across, down = struct.unpack_from("<iIii", data, end + 1)
        if number not in _BITS or across < 1 or down < 1:
            raise ValueError("its channels are garbled")
        if (across, down) != (1, 1):
            raise ValueError("not every pixel has all channels: save it as R, G and B")
        found[name.decode("utf-8", "replace")] = _BITS[number]
        place += len(name) + 17
    if not found:
        raise ValueError("it has no channels")
    return found


def _check_rows(file: BinaryIO, height: int, rows: int) -> None:
    """Check that each chunk is in the file: its offset, its length, and as many bytes."""
    count = -(-height // rows)
    places = struct.unpack(f"<{count}Q", _exactly(file, 8 * count))
    begin = file.tell()
    end = file.seek(0, 2)
    for place in places:
        if not begin <= place <= end - 8:
            raise ValueError("it is cut short")
        file.seek(place)
        _, length = struct.unpack("<ii", _exactly(file, 8))
        if not 0 <= length <= end - place - 8:
            raise ValueError("it is cut short")
