"""Reads Radiance pictures (.hdr): four bytes a pixel, three mantissas with one exponent.

Input: the bytes of a file. Output: linear light, float32 (height, width, 4), top row first.
Reads scan lines in the three ways of the format: flat, with repeated pixels, and with each byte
packed by itself.

Source: Greg Ward, "Real Pixels", Graphics Gems II (1991), and the format's page at
radsite.lbl.gov/radiance/refer/filefmts.pdf. The value of a mantissa m is m / 256, as most programs
that read the format have it.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import check_time, need_pixels

SIGNATURE: Final = b"#?"
_PIXEL_BYTES: Final = 28
_LONGEST_HEAD: Final = 65536
_SIZE: Final = re.compile(rb"([-+])([XY]) +([0-9]{1,8}) +([-+])([XY]) +([0-9]{1,8}) *")
# Widths that the later way of packing is used for.
_NARROWEST, _WIDEST = 8, 32767
# CIE XYZ to the primaries of ITU-R BT.709, with equal-energy white as the format defines it.
_FROM_XYZ: Final = np.array(
    [[2.565, -1.167, -0.398], [-1.022, 1.978, 0.044], [0.075, -0.252, 1.177]], np.float32
)
_RGB, _XYZ = "32-bit_rle_rgbe", "32-bit_rle_xyze"


def read_radiance(data: bytes) -> NDArray[np.float32]:
    """Return the light of a Radiance picture.

    Raises:
        LoadError: It is damaged.
    """
    fields, exposure, begin = _head(data)
    line = data[begin : data.find(b"\n", begin, begin + 200)]
    size = _SIZE.fullmatch(line.rstrip(b"\r"))
    if size is None or size[2] == size[5]:
        raise LoadError(f"its size is '{printable(line.decode('latin-1'), 40)}', not '-Y 8 +X 16'")
    lines, columns = int(size[3]), int(size[6])
    if lines == 0 or columns == 0:
        raise LoadError("it has no pixels")
    need_pixels(columns, lines, _PIXEL_BYTES)
    levels = _levels(memoryview(data)[begin + len(line) + 1 :], lines, columns)
    # Mantissa times 2^(exponent - 128 - 8); an exponent of 0 is black.
    scale = np.ldexp(np.float32(1.0), levels[..., 3].astype(np.int32) - 136)
    scale[levels[..., 3] == 0] = 0.0
    pixels = np.ones((lines, columns, 4), np.float32)
    np.multiply(levels[..., :3], scale[..., None], out=pixels[..., :3])
    if fields == _XYZ:
        pixels[..., :3] = np.maximum(pixels[..., :3] @ _FROM_XYZ.T, 0.0)
    pixels[..., :3] /= exposure
    return np.ascontiguousarray(_top_left(pixels, size))


def _top_left(pixels: NDArray[np.float32], size: re.Match[bytes]) -> NDArray[np.float32]:
    """Return a picture whose lines are rows from the top, and whose columns go to the right."""
    lines_along, columns_along = size[1] + size[2], size[4] + size[5]
    if size[2] == b"X":
        pixels = pixels.swapaxes(0, 1)
        lines_along, columns_along = columns_along, lines_along
    if lines_along == b"+Y":  # y goes up
        pixels = pixels[::-1]
    return pixels[:, ::-1] if columns_along == b"-X" else pixels


def _head(data: bytes) -> tuple[str, NDArray[np.float32], int]:
    """Return the format, the factor on its light, and where the line of the size begins."""
    end = data.find(b"\n\n", 0, _LONGEST_HEAD)
    other = data.find(b"\n\r\n", 0, _LONGEST_HEAD)
    is_other = other >= 0 and (end < 0 or other < end)
    end, begin = (other, other + 3) if is_other else (end, end + 2)
    if end < 0:
        raise LoadError("its header does not end")
    format, exposure = _RGB, np.ones(3, np.float64)
    for line in data[:end].decode("latin-1").splitlines()[1:]:
        key, _, value = line.partition("=")
        match key.strip().upper():
            case "FORMAT":
                format = value.strip()
            case "EXPOSURE":
                exposure *= _positive(value, 1)
            case "COLORCORR":
                exposure *= _positive(value, 3)
    if format not in (_RGB, _XYZ):
        raise LoadError(f"its format is '{printable(format, 40)}', not {_RGB} or {_XYZ}")
    return format, exposure.astype(np.float32), begin


def _positive(text: str, count: int) -> NDArray[np.float64]:
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != count or not all(1e-30 < part < 1e30 for part in found):
        raise LoadError(f"its exposure '{printable(text, 40)}' is no number above 0")
    return np.array(found)


def _levels(raw: memoryview, lines: int, columns: int) -> NDArray[np.uint8]:
    """Return the bytes of all pixels, (lines, columns, 4)."""
    is_packed = _NARROWEST <= columns <= _WIDEST and len(raw) >= 4
    if not (is_packed and raw[0] == 2 and raw[1] == 2 and raw[2] < 128):
        return _with_repeats(raw, lines * columns).reshape(lines, columns, 4)
    levels = np.empty((lines, columns, 4), np.uint8)
    line, place = np.empty(4 * columns, np.uint8), 0
    mark = bytes((2, 2, columns >> 8, columns & 255))
    for row in levels:
        if raw[place : place + 4] != mark:
            raise LoadError(_damage(raw, place + 4))
        place = _unpacked(raw, place + 4, line)
        row[...] = line.reshape(4, columns).T
        check_time()
    return levels


def _unpacked(raw: memoryview, place: int, line: NDArray[np.uint8]) -> int:
    """Unpack the bytes of a line, one channel after the other; return where the next begins."""
    bytes_of = np.frombuffer(raw, np.uint8)
    done, all, last = 0, len(line), len(raw) - 1
    while done < all:
        if place >= last:
            raise LoadError("it is truncated")
        count = raw[place]
        if count > 128:
            count -= 128
            values: NDArray[np.uint8] | int = raw[place + 1]
            place += 2
        else:
            values = bytes_of[place + 1 : place + 1 + count]
            place += 1 + count
        if count == 0 or done + count > all or place > last + 1:
            raise LoadError(_damage(raw, place))
        line[done : done + count] = values
        done += count
    return place


def _damage(raw: memoryview, place: int) -> str:
    return "it is truncated" if place > len(raw) else "a line of its pixels is damaged"


def _with_repeats(raw: memoryview, count: int) -> NDArray[np.uint8]:
    """Return pixels in the older way: (1, 1, 1, n) repeats the pixel before n times.

    Further ones in a row count 256 times as much each.
    """
    stored = np.frombuffer(raw[: len(raw) // 4 * 4], np.uint8).reshape(-1, 4)
    is_repeat = (stored[:, :3] == 1).all(axis=1)
    if not is_repeat[:count].any():
        if len(stored) < count:
            raise LoadError("it is truncated")
        return stored[:count]
    places = np.arange(len(stored))
    source = np.maximum.accumulate(np.where(is_repeat, -1, places))
    digits = np.minimum(places - source - 1, 4)
    counts = np.where(is_repeat, stored[:, 3].astype(np.int64) << (8 * np.maximum(digits, 0)), 1)
    ends = np.cumsum(counts)
    enough = int(np.searchsorted(ends, count))
    if enough == len(ends):
        raise LoadError("it is truncated")
    if source[0] < 0:
        raise LoadError("a line of its pixels is damaged")
    counts[enough] -= ends[enough] - count
    pixels: NDArray[np.uint8] = stored[np.repeat(source[: enough + 1], counts[: enough + 1])]
    return pixels
