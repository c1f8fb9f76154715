"""Reads volumes: NumPy, NRRD and NIfTI.

Input: a path. Output: samples (z, y, x), how far apart they are, and where they are; and the field
that ``VolumeField`` takes.
"""

from __future__ import annotations

import io
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import Memory, opened
from distal.lang.resources import AXES
from distal.polygons.nifti import read_nifti
from distal.polygons.nrrd import read_nrrd
from distal.polygons.volume_samples import (
    VolumeSamples,
    checked_samples,
    matrix_of,
    of_array,
    samples_of,
)

__all__ = ["VolumeSamples", "field_of", "matrix_of", "notice_of", "of_array", "read_volume"]
VOLUME_FORMATS: Final = (".npy", ".nrrd", ".nhdr", ".nii", ".nii.gz")
_NPY_HEADERS: Final[dict[tuple[int, int], Callable[..., Any]]] = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


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
    if suffix not in VOLUME_FORMATS:
        known = ", ".join(VOLUME_FORMATS)
        raise LoadError(f"cannot read '{printable(path)}': a volume's suffix is one of {known}")
    with opened("volume", path, max_memory=max_memory, option=True) as data:
        match suffix:
            case ".npy":
                return read_npy(data)
            case ".nrrd" | ".nhdr":
                return read_nrrd(data, path.parent, max_memory)
            case _:
                return read_nifti(data)


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
    if dtype.hasobject or dtype.kind not in "fiub" or len(sizes) != 3:
        raise LoadError(f"samples are numbers (z, y, x), 2 or more along each, not {dtype} {sizes}")
    sizes = tuple(reversed(sizes)) if is_fortran else sizes
    values = samples_of(memoryview(data)[file.tell() :], dtype, sizes)
    values = values.T if is_fortran else values
    return VolumeSamples(checked_samples(values), None, is_mask=dtype.kind == "b")
