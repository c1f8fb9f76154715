"""Reads NRRD, in one file or as a header (.nhdr) with a file of samples beside it.

Input: the bytes of a file, and its folder. Output: samples with their place. Spaces of patients
become right, anterior, superior, as in NIfTI; lengths with a unit become millimeters.

Source: Nearly Raw Raster Data, teem.sourceforge.net/nrrd/format.html.
"""

from __future__ import annotations

import bz2
import gzip
import io
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from distal.diagnostics import LoadError, printable
from distal.foreign_files import Memory, opened
from distal.polygons.volume_samples import (
    Buffer,
    VolumeSamples,
    check_count,
    checked_samples,
    placed,
    positive,
    samples_of,
    unpacked,
)

_TYPES: Final = {
    **dict.fromkeys(("signed char", "int8", "int8_t"), "i1"),
    **dict.fromkeys(("uchar", "unsigned char", "uint8", "uint8_t"), "u1"),
    **dict.fromkeys(
        ("short", "short int", "signed short", "signed short int", "int16", "int16_t"), "i2"
    ),
    **dict.fromkeys(("ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"), "u2"),
    **dict.fromkeys(("int", "signed int", "int32", "int32_t"), "i4"),
    **dict.fromkeys(("uint", "unsigned int", "uint32", "uint32_t"), "u4"),
    **dict.fromkeys(("longlong", "long long", "long long int", "signed long long", "int64"), "i8"),
    **dict.fromkeys(("signed long long int", "int64_t"), "i8"),
    **dict.fromkeys(("ulonglong", "unsigned long long", "unsigned long long int"), "u8"),
    **dict.fromkeys(("uint64", "uint64_t"), "u8"),
    "float": "f4",
    "double": "f8",
}
# Factors on the coordinates of a space that make them right, anterior, superior.
_SPACES: Final[dict[str, tuple[float, float, float]]] = {
    **dict.fromkeys(("right-anterior-superior", "ras"), (1.0, 1.0, 1.0)),
    **dict.fromkeys(("left-anterior-superior", "las"), (-1.0, 1.0, 1.0)),
    **dict.fromkeys(("left-posterior-superior", "lps"), (-1.0, -1.0, 1.0)),
    **dict.fromkeys(("scanner-xyz", "3d-right-handed", ""), (1.0, 1.0, 1.0)),
}
_MILLIMETERS: Final = {
    "m": 1000.0,
    "cm": 10.0,
    "mm": 1.0,
    **dict.fromkeys(("um", "\u00b5m", "\u03bcm", "micron", "microns"), 0.001),
    "nm": 1e-6,
}
_VECTOR: Final = re.compile(r"\(([^()]*)\)")
_LONGEST_HEAD: Final = 65536


def read_nrrd(data: bytes, folder: Path, max_memory: Memory | None = None) -> VolumeSamples:
    """Return the samples of an NRRD file, whose first axis is x.

    Args:
        data: The file.
        folder: Where it is: a file of samples is beside it.
        max_memory: The most bytes that a file of samples may become; None: by its size.
    """
    if not data.startswith(b"NRRD"):
        raise LoadError("it does not begin with the header of NRRD")
    blank = re.search(rb"\r?\n\r?\n", data[: _LONGEST_HEAD + 4])
    end, begin = blank.span() if blank else (len(data), len(data))
    fields = _fields(data[: min(end, _LONGEST_HEAD)])
    detached = fields.get("data file", fields.get("datafile"))
    if detached is None and blank is None:
        raise LoadError("it does not begin with the header of NRRD")
    if detached is None:
        return _read(fields, memoryview(data)[begin:])
    if not re.fullmatch(r"[^/\\:%]+", detached) or detached.upper().startswith("LIST"):
        raise LoadError(
            f"its samples are in '{printable(detached, 40)}', which is no single file beside it: "
            "save it as one file"
        )
    with opened("volume", folder / detached, max_memory=max_memory, option=True) as samples:
        return _read(fields, memoryview(samples))


def _fields(head: bytes) -> dict[str, str]:
    fields: dict[str, str] = {}
    for line in head.decode("utf-8", "replace").splitlines()[1:]:
        key, colon, value = line.partition(":")
        # ``key:=value`` is a note of some program.
        if colon and not line.startswith("#") and not value.startswith("="):
            fields[key.strip().lower()] = value.strip()
    return fields


def _read(fields: Mapping[str, str], body: memoryview) -> VolumeSamples:
    type = _TYPES.get(fields.get("type", ""))
    sizes = _numbers(fields.get("sizes", ""))
    if type is None or len(sizes) != 3 or not all(s.is_integer() and s >= 1 for s in sizes):
        raise LoadError("it is no volume of numbers with one component")
    for skip in ("line skip", "lineskip", "byte skip", "byteskip"):
        if fields.get(skip, "0") != "0":
            raise LoadError(f"it has a '{skip}' before its samples: save it without")
    order = ">" if fields.get("endian", "little").lower() == "big" else "<"
    dtype, along = np.dtype(order + type), [int(s) for s in reversed(sizes)]
    length = check_count(along) * dtype.itemsize
    values = samples_of(_unpacked(fields.get("encoding", ""), body, length), dtype, along)
    return _placed(fields, values)


def _unpacked(encoding: str, body: memoryview, length: int) -> Buffer:
    match encoding.lower():
        case "raw":
            return body
        case "gzip" | "gz":
            with gzip.open(io.BytesIO(body)) as file:
                return unpacked(file, length + 1)  # one more, so that the checksum is compared
        case "bzip2" | "bz2":
            with bz2.open(io.BytesIO(body)) as packed:
                return unpacked(packed, length + 1)
    raise LoadError(
        f"its encoding '{printable(encoding, 20)}' is not read: save it as raw, gzip or bzip2"
    )


def _placed(fields: Mapping[str, str], values: Any) -> VolumeSamples:
    directions = fields.get("space directions")
    if directions is None:
        units = _units(fields.get("units", ""))
        spacing = _spacings(fields)
        if len(spacing) == 3:
            spacing = [u * s for u, s in zip(units, spacing, strict=True)]
        return VolumeSamples(checked_samples(values), positive(spacing))
    space = fields.get("space", "")
    factors = _SPACES.get(space.lower())
    if factors is None:
        names = "RAS, LAS or LPS"
        raise LoadError(f"its space '{printable(space, 40)}' is not read: save it in {names}")
    units = _units(fields.get("space units", ""))
    scale = [u * f for u, f in zip(units, factors, strict=True)]
    steps = [_scaled(vector, scale) for vector in _VECTOR.findall(directions)]
    if len(steps) != 3:
        raise LoadError(f"its space directions are {len(steps)} vectors, not 3")
    origin = _VECTOR.findall(fields.get("space origin", ""))
    return placed(values, steps, _scaled(origin[0], scale) if origin else None)


def _spacings(fields: Mapping[str, str]) -> list[float]:
    """Return the distances of samples: as they are written, or from the ends of the axes."""
    low, high = (_numbers(fields.get(f"axis {end}", "")) for end in ("mins", "maxs"))
    counts = _numbers(fields.get("sizes", ""))
    if "spacings" in fields or not len(low) == len(high) == len(counts):
        return _numbers(fields.get("spacings", ""))
    centers = fields.get("centers", fields.get("centerings", "")).split()
    if len(centers) != len(low) or not {"cell", "node"}.issuperset(centers):
        raise LoadError(
            "it has 'axis mins' and 'axis maxs', and nothing says whether samples are at the ends: "
            "save it with 'spacings', or with 'centers'"
        )
    return [
        (b - a) / max(count - (center == "node"), 1)
        for a, b, count, center in zip(low, high, counts, centers, strict=True)
    ]


def _scaled(text: str, scale: list[float]) -> list[float]:
    numbers = _numbers(text.replace(",", " "))
    if len(numbers) != 3:
        raise LoadError(f"'({printable(text, 40)})' is no vector of 3 numbers")
    return [number * factor for number, factor in zip(numbers, scale, strict=True)]


def _units(text: str) -> list[float]:
    """Return what millimeters the unit of each axis is; 1 if it is not said."""
    names = re.findall(r'"([^"]*)"', text)
    if len(names) != 3:
        return [1.0, 1.0, 1.0]
    return [_MILLIMETERS.get(name.strip().lower(), 1.0) for name in names]


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return []
