"""Reads volumes: NumPy, NRRD and NIfTI.

Input: a path. Output: samples (z, y, x), and how far apart they are. Orientations and units that a
file names are left out.

Source: Nearly Raw Raster Data, teem.sourceforge.net/nrrd; NIfTI-1 Data Format, nifti.nimh.nih.gov.
"""

from __future__ import annotations

import gzip
import io
import itertools
import math
import struct
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.devices.resources import float_type
from distal.diagnostics import LoadError, printable
from distal.foreign_files import Memory, need, opened
from distal.lang.resources import AXES

# Those near the surface are kept: ``bricks.MOST_NUMBERS``.
MOST_SAMPLES: Final = 2**26
# Bytes that a sample costs at the peak of an import.
SAMPLE_BYTES: Final = 24
_NIFTI_HEAD: Final = 352
_FARTHEST: Final = (
    2**26
)  # where the samples of NIfTI begin: before them are texts of other programs
_NPY_HEADERS: Final[dict[tuple[int, int], Callable[..., Any]]] = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}
Buffer: TypeAlias = bytes | memoryview
_NRRD_TYPES: Final = {
    **dict.fromkeys(("signed char", "int8", "int8_t"), "i1"),
    **dict.fromkeys(("uchar", "unsigned char", "uint8", "uint8_t"), "u1"),
    **dict.fromkeys(("short", "short int", "int16", "int16_t"), "i2"),
    **dict.fromkeys(("ushort", "unsigned short", "uint16", "uint16_t"), "u2"),
    **dict.fromkeys(("int", "signed int", "int32", "int32_t"), "i4"),
    **dict.fromkeys(("uint", "unsigned int", "uint32", "uint32_t"), "u4"),
    "float": "f4",
    "double": "f8",
}
_NIFTI_TYPES: Final = {
    2: "u1",
    4: "i2",
    8: "i4",
    16: "f4",
    64: "f8",
    256: "i1",
    512: "u2",
    768: "u4",
}


@dataclass(frozen=True, slots=True, eq=False)
class VolumeSamples:
    """The samples of a volume.

    Attributes:
        values: float32, (z, y, x); float64 if 32 bits do not hold what the array has.
        spacing: The distance of two samples along x, y and z; None if the file does not say it.
    """

    values: NDArray[Any]
    spacing: tuple[float, float, float] | None


def read_volume(path: Path, max_memory: Memory | None = None) -> VolumeSamples:
    """Return the samples of a file.

    Args:
        path: The file.
        max_memory: The most bytes that it may become; None: by its size.

    Raises:
        LoadError: The file cannot be read, or is not what its suffix says.
    """
    name = path.name.lower()
    suffix = ".nii.gz" if name.endswith(".nii.gz") else path.suffix.lower()
    read = VOLUME_FORMATS.get(suffix)
    if read is None:
        known = ", ".join(VOLUME_FORMATS)
        raise LoadError(f"cannot read '{printable(path)}': a volume's suffix is one of {known}")
    with opened("volume", path, max_memory=max_memory, option=True) as data:
        return read(data)


def checked_samples(values: Any) -> NDArray[Any]:
    """Return samples as floats of 32 bits, or of 64 if 32 do not hold them exactly.

    Raises:
        LoadError: They are no numbers (z, y, x), too many, or not finite.
    """
    try:
        array = np.asarray(values)
    except ValueError:
        raise LoadError("samples are an array (z, y, x), not rows of different lengths") from None
    if array.ndim != 3 or array.dtype.kind not in "fiu" or min(array.shape, default=0) < 2:
        raise LoadError(
            f"samples are numbers (z, y, x), 2 or more along each, not {array.dtype} {array.shape}"
        )
    type = float_type(array)
    _check_count(array.shape, SAMPLE_BYTES * type.itemsize // 4)
    with np.errstate(over="ignore"):
        samples = array.astype(type)
    if not np.isfinite(samples).all():
        raise LoadError("a sample is not finite")
    return np.ascontiguousarray(samples)


def _check_count(sizes: Sequence[int], each: int = SAMPLE_BYTES) -> int:
    """Return the number of samples.

    Raises:
        LoadError: A volume has fewer, or the file may not become as many.
    """
    count = math.prod(sizes)
    if count > MOST_SAMPLES:
        raise LoadError(f"{count:,} samples are more than {MOST_SAMPLES:,}: leave some out")
    need(count * each, f"{' x '.join(f'{size:,}' for size in sizes)} samples")
    return count


@dataclass(frozen=True, slots=True, eq=False)
class FieldSamples:
    """Samples as ``VolumeField`` takes them.

    Attributes:
        values: Of the samples' type, (z, y, x), negative inside.
        size: The size of the cells of all samples together.
        scale: By what the values are multiplied, so that neighbors differ by at most their
            distance; 1 or less for distances.
    """

    values: NDArray[Any]
    size: tuple[float, float, float]
    scale: float


def field_of(
    samples: NDArray[Any],
    axes: str,
    spacing: tuple[float, float, float],
    level: float | None,
) -> FieldSamples:
    """Return a field from samples.

    Args:
        samples: The samples.
        axes: What their axes are, "zyx" or another order.
        spacing: Their distances along x, y and z.
        level: The value at the surface, more than which is inside; None for distances, which are
            negative inside.

    Raises:
        LoadError: Nothing is inside.
    """
    values = samples.transpose([axes.index(axis) for axis in AXES])
    if level is not None:
        values = samples.dtype.type(level) - values
    if not (values < 0.0).any():
        low, high = float(samples.min()), float(samples.max())
        fix = "give level=" if level is None else "give another level"
        raise LoadError(f"nothing is inside: the samples are {low:g} to {high:g}; {fix}")
    steepest = max(
        _largest_step(values, axis) / step for axis, step in enumerate(reversed(spacing))
    )
    if steepest == 0.0:
        raise LoadError("all samples are equal: there is no surface")
    # Distances that were rounded to 32 bits are left as they are.
    is_fair = level is None and steepest <= 1.0 + 1e-4
    z, y, x = values.shape
    size = x * spacing[0], y * spacing[1], z * spacing[2]
    return FieldSamples(np.ascontiguousarray(values), size, 1.0 if is_fair else 1.0 / steepest)


def _largest_step(values: NDArray[Any], axis: int) -> float:
    """Return the largest difference of neighbors along an axis, a slice at a time."""
    if axis == 0:
        pairs = itertools.pairwise(values)
        return max(float(np.abs(after - before).max()) for before, after in pairs)
    return max(float(np.abs(np.diff(each, axis=axis - 1)).max()) for each in values)


def notice_of(name: str, field: FieldSamples, spacing: tuple[float, float, float]) -> str:
    """Return one line about what a volume's field can show, and how to show more.

    Args:
        name: The file, or "array".
        field: The field.
        spacing: The distances of samples along x, y and z.
    """
    z, y, x = field.values.shape
    steps = " x ".join(f"{step:.4g}" for step in spacing)
    # The volume is all that is known: how far it is from what was measured, it does not say.
    values = "values are no distances: rays take more steps; " if field.scale != 1.0 else ""
    return (
        f"'{name}' has {x} x {y} x {z} samples, {steps} apart: between them it is interpolated, "
        f"and parts thinner than {max(spacing):.4g} may be missing; {values}more samples are "
        "finer, or spacing= if they are another distance apart"
    )


def read_npy(data: bytes) -> VolumeSamples:
    """Return the samples of a NumPy file, (z, y, x)."""
    if data.startswith(b"PK"):
        raise LoadError("it is an archive of arrays: save one array with numpy.save")
    file = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(file)
        read = _NPY_HEADERS[version]
        sizes, is_fortran, dtype = read(file)
    except KeyError:
        raise LoadError("it is of a later version of NumPy's format") from None
    except Exception as error:  # NumPy evaluates the header: many kinds of exceptions
        raise LoadError(f"NumPy says: {printable(error):.100}") from None
    if dtype.hasobject or dtype.kind not in "fiu" or len(sizes) != 3:
        raise LoadError(f"samples are numbers (z, y, x), 2 or more along each, not {dtype} {sizes}")
    sizes = tuple(reversed(sizes)) if is_fortran else sizes
    values = _samples(memoryview(data)[file.tell() :], dtype, sizes)
    return VolumeSamples(checked_samples(values.T if is_fortran else values), None)


def read_nrrd(data: bytes) -> VolumeSamples:
    """Return the samples of an NRRD file, whose first axis is x."""
    end = b"\r\n\r\n" if b"\r\n" in data[:80] else b"\n\n"
    head, blank, body = data.partition(end)
    if not data.startswith(b"NRRD") or not blank or len(head) > 65536:
        raise LoadError("it does not begin with the header of NRRD")
    fields: dict[str, str] = {}
    for line in head.decode("ascii", "replace").splitlines()[1:]:
        key, colon, value = line.partition(":")
        if colon and not line.startswith("#"):
            fields[key.strip().lower()] = value.lstrip("=").strip()
    if "data file" in fields or "datafile" in fields:
        raise LoadError("its samples are in another file: save it as one file")
    type = _NRRD_TYPES.get(fields.get("type", ""))
    sizes = _numbers(fields.get("sizes", ""))
    if type is None or len(sizes) != 3 or not all(s.is_integer() and s >= 1 for s in sizes):
        raise LoadError("it is no volume of numbers with one component")
    order = ">" if fields.get("endian", "little") == "big" else "<"
    dtype, along = np.dtype(order + type), [int(s) for s in reversed(sizes)]
    length = _check_count(along) * dtype.itemsize
    raw: Buffer
    match fields.get("encoding", ""):
        case "raw":
            raw = body
        case "gzip" | "gz":
            with gzip.open(io.BytesIO(body)) as file:
                raw = _unpacked(file, length + 1)  # one more, so that the checksum is compared
        case other:
            raise LoadError(f"its encoding '{other:.20}' is not read: save it as raw or gzip")
    values = _samples(raw, dtype, along)
    return VolumeSamples(checked_samples(values), _nrrd_spacing(fields))


def _nrrd_spacing(fields: dict[str, str]) -> tuple[float, float, float] | None:
    spacing = _numbers(fields.get("spacings", ""))
    if "space directions" in fields:
        words = fields["space directions"].replace(",", " ").replace("(", " ").replace(")", " ")
        numbers = _numbers(words)
        if len(numbers) == 9:
            spacing = [math.hypot(*numbers[i : i + 3]) for i in (0, 3, 6)]
    return _positive(spacing)


def read_nifti(data: bytes) -> VolumeSamples:
    """Return the samples of a NIfTI-1 file, whose first axis is x."""
    whole = io.BytesIO(data)
    if data[:2] == b"\x1f\x8b":
        with gzip.open(whole) as file:
            return _read_nifti(file)
    return _read_nifti(whole)


def _read_nifti(file: Any) -> VolumeSamples:
    head = _unpacked(file, _NIFTI_HEAD)
    if len(head) < _NIFTI_HEAD or head[344:348] != b"n+1\0":
        raise LoadError("it does not begin with the header of NIfTI-1 in one file")
    order = "<" if struct.unpack_from("<i", head)[0] == 348 else ">"
    dims = struct.unpack_from(f"{order}8h", head, 40)
    if not 3 <= dims[0] <= 7 or min(dims[1:4]) < 1 or any(d > 1 for d in dims[4 : dims[0] + 1]):
        raise LoadError("it is no volume with one sample at each place")
    type = _NIFTI_TYPES.get(struct.unpack_from(f"{order}h", head, 70)[0])
    if type is None:
        raise LoadError("its samples are no real numbers")
    spacing = struct.unpack_from(f"{order}8f", head, 76)[1:4]
    begin, slope, shift = struct.unpack_from(f"{order}3f", head, 108)
    if not 0.0 <= begin < _FARTHEST:
        raise LoadError("it is truncated")
    dtype, sizes = np.dtype(order + type), dims[3:0:-1]
    length = int(begin) + _check_count(sizes) * dtype.itemsize
    whole = head + _unpacked(file, max(length - _NIFTI_HEAD, 0) + 1)
    values = _samples(memoryview(whole)[int(begin) :], dtype, sizes)
    if math.isfinite(slope) and slope != 0.0 and math.isfinite(shift):
        scaled = np.empty(values.shape, np.float32)
        with np.errstate(all="ignore"):
            for row, each in zip(scaled, values, strict=True):
                row[...] = each.astype(np.float64) * slope + shift
        values = scaled
    return VolumeSamples(checked_samples(values), _positive(spacing))


def _samples(raw: Buffer, dtype: np.dtype[Any], sizes: Sequence[int]) -> NDArray[Any]:
    """Return the samples of bytes, whose last axis changes first."""
    count = _check_count(sizes)
    if len(raw) < count * dtype.itemsize:
        there = len(raw) // dtype.itemsize
        raise LoadError(f"it announces {count:,} samples and contains {there:,}: it is truncated")
    return np.frombuffer(raw, dtype, count).reshape(tuple(sizes))


def _unpacked(file: Any, most: int) -> bytes:
    """Return the next bytes of a packed file, at most so many."""
    try:
        data: bytes = file.read(most)
    except (OSError, EOFError, zlib.error):
        raise LoadError("its compressed part is damaged") from None
    return data


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return []


def _positive(spacing: Sequence[float]) -> tuple[float, float, float] | None:
    if len(spacing) != 3 or not all(0.0 < abs(s) < 1e15 for s in spacing):
        return None
    x, y, z = (abs(s) for s in spacing)
    return x, y, z


VOLUME_FORMATS: Final[dict[str, Callable[[bytes], VolumeSamples]]] = {
    ".npy": read_npy,
    ".nrrd": read_nrrd,
    ".nii": read_nifti,
    ".nii.gz": read_nifti,
}
