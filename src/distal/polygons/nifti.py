"""Reads NIfTI-1 and NIfTI-2 in one file.

Input: the bytes of a file. Output: samples with their place in the standard's world: x to the
right of the patient, y to the front (anterior), z up (superior), in millimeters.

Source: nifti.nimh.nih.gov, nifti1.h and nifti2.h. The affine of the sform comes first, then the
quaternion of the qform; without both, only the spacing is known.
"""

from __future__ import annotations

import gzip
import io
import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.diagnostics import LoadError
from distal.polygons.volume_samples import (
    Vector,
    VolumeSamples,
    check_count,
    checked_samples,
    placed,
    positive,
    samples_of,
    unpacked,
)


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where the fields of a header are.

    Attributes:
        bytes: Bytes of the header.
        rounding: Of a sum of squares of its numbers.
        fields: A form of ``struct``, and bytes from the begin.
    """

    bytes: int
    rounding: float
    fields: Mapping[str, tuple[str, int]]


_LAYOUTS: Final = {
    348: _Layout(
        352,
        4e-7,
        {
            "dims": ("8h", 40),
            "type": ("h", 70),
            "pixdim": ("8f", 76),
            "begin": ("f", 108),
            "scaling": ("2f", 112),
            "units": ("B", 123),
            "codes": ("2h", 252),
            "qform": ("6f", 256),
            "sform": ("12f", 280),
        },
    ),
    540: _Layout(
        544,
        1e-14,
        {
            "dims": ("8q", 16),
            "type": ("h", 12),
            "pixdim": ("8d", 104),
            "begin": ("q", 168),
            "scaling": ("2d", 176),
            "units": ("i", 500),
            "codes": ("2i", 344),
            "qform": ("6d", 352),
            "sform": ("12d", 400),
        },
    ),
}
_MAGIC: Final = {348: (344, b"n+1\0"), 540: (4, b"n+2\0\r\n\x1a\n")}
_TYPES: Final = {
    2: "u1",
    4: "i2",
    8: "i4",
    16: "f4",
    64: "f8",
    256: "i1",
    512: "u2",
    768: "u4",
    1024: "i8",
    1280: "u8",
}
# The three lowest bits of the units: not said, meters, millimeters, micrometers.
_MILLIMETERS: Final = {0: 1.0, 1: 1000.0, 2: 1.0, 3: 0.001}
_FARTHEST: Final = 2**26  # where the samples begin: before them are texts of other programs


def read_nifti(data: bytes) -> VolumeSamples:
    """Return the samples of a NIfTI file, whose first axis is x."""
    if data[:2] == b"\x1f\x8b":
        with gzip.open(io.BytesIO(data)) as file:
            return _read(file)
    return _read(io.BytesIO(data))


def _read(file: Any) -> VolumeSamples:
    head = unpacked(file, 4)
    orders = {struct.pack(order + "i", size): (order, size) for order in "<>" for size in _LAYOUTS}
    order, size = orders.get(head, ("<", 348))
    layout, (at, magic) = _LAYOUTS[size], _MAGIC[size]
    head += unpacked(file, layout.bytes - 4)
    if len(head) < layout.bytes or head[at : at + len(magic)] != magic:
        raise LoadError("it does not begin with the header of NIfTI in one file")
    fields: dict[str, Any] = {
        name: struct.unpack_from(order + form, head, offset)
        for name, (form, offset) in layout.fields.items()
    }
    dims, (begin,) = fields["dims"], fields["begin"]
    if not 3 <= dims[0] <= 7 or min(dims[1:4]) < 1 or any(d > 1 for d in dims[4 : dims[0] + 1]):
        raise LoadError("it is no volume with one sample at each place")
    type = _TYPES.get(fields["type"][0])
    if type is None:
        raise LoadError("its samples are no real numbers")
    if not 0.0 <= begin < _FARTHEST:
        raise LoadError("it is truncated")
    dtype, sizes = np.dtype(order + type), dims[3:0:-1]
    length = int(begin) + check_count(sizes) * dtype.itemsize
    whole = head + unpacked(file, max(length - layout.bytes, 0) + 1)
    values = _scaled(samples_of(memoryview(whole)[int(begin) :], dtype, sizes), *fields["scaling"])
    unit = _MILLIMETERS.get(fields["units"][0] & 7, 1.0)
    affine = _affine(fields, layout.rounding)
    if affine is None:
        spacing = positive([unit * step for step in fields["pixdim"][1:4]])
        return VolumeSamples(checked_samples(values), spacing)
    columns = [[unit * row[i] for row in affine] for i in range(4)]
    return placed(values, columns[:3], columns[3])


def _scaled(values: Any, slope: float, shift: float) -> Any:
    if not (math.isfinite(slope) and slope != 0.0 and math.isfinite(shift)):
        return values
    scaled = np.empty(values.shape, np.float32)
    with np.errstate(all="ignore"):
        for row, each in zip(scaled, values, strict=True):
            row[...] = each.astype(np.float64) * slope + shift
    return scaled


def _affine(fields: Mapping[str, Any], rounding: float) -> list[tuple[float, ...]] | None:
    """Return the three rows from indices to the world; None if the file has none.

    Args:
        fields: The header.
        rounding: Of a sum of its numbers' squares.
    """
    by_quaternion, by_rows = fields["codes"]
    if by_rows > 0:
        rows = fields["sform"]
        return [rows[0:4], rows[4:8], rows[8:12]]
    if by_quaternion <= 0:
        return None
    sign = -1.0 if fields["pixdim"][0] < 0.0 else 1.0
    spacing = positive(fields["pixdim"][1:4])
    if spacing is None:
        raise LoadError("the distances of its samples are 0 or not finite")
    x, y, z = spacing
    b, c, d, *shift = fields["qform"]
    turned = _rotation(b, c, d, rounding)
    return [
        (row[0] * x, row[1] * y, row[2] * z * sign, at)
        for row, at in zip(turned, shift, strict=True)
    ]


def _rotation(b: float, c: float, d: float, rounding: float) -> tuple[Vector, Vector, Vector]:
    """Return the rows of a rotation, from the last three parts of a unit quaternion."""
    square = b * b + c * c + d * d
    if not square < 1e30:
        raise LoadError("its rotation is not finite")
    a = 0.0
    if square > 1.0 - rounding:  # half a turn: the root of the rounding would be a large part
        b, c, d = (part / math.sqrt(square) for part in (b, c, d))
    else:
        a = math.sqrt(1.0 - square)
    return (
        (a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)),
        (2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)),
        (2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c),
    )
