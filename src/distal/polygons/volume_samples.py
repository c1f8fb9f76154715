"""The samples of a volume, and where they are.

Input: numbers from a file or an array. Output: ``VolumeSamples``. Does not read files.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import need
from distal.pixels.arrays import float_type

# Those near the surface are kept: ``bricks.MOST_NUMBERS``.
MOST_SAMPLES: Final = 2**26
# Bytes that a sample costs at the peak of an import.
SAMPLE_BYTES: Final = 24
# The cosine of what is a right angle in a file, whose numbers may have few digits.
_RIGHT: Final = 1e-4
Buffer: TypeAlias = bytes | memoryview
Vector: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Orientation:
    """Where the samples of a file are in its world.

    Attributes:
        directions: Where the axes x, y and z of the samples point, of length 1.
        first: Where the first sample is; None: the middle of the volume is the origin.
    """

    directions: tuple[Vector, Vector, Vector]
    first: Vector | None


@dataclass(frozen=True, slots=True, eq=False)
class VolumeSamples:
    """The samples of a volume.

    Attributes:
        values: float32, (z, y, x); float64 if 32 bits do not hold what the array has.
        spacing: The distance of two samples along x, y and z; None if the file does not say it.
        orientation: Where they are; None if the file does not say it.
        is_mask: Whether they were bools: 1 is inside, 0 is outside.
    """

    values: NDArray[Any]
    spacing: Vector | None
    orientation: Orientation | None = None
    is_mask: bool = False


def checked_samples(values: Any) -> NDArray[Any]:
    """Return samples as floats of 32 bits, or of 64 if 32 do not hold them exactly.

    Raises:
        LoadError: They are no numbers (z, y, x), too many, or not finite.
    """
    try:
        array = np.asarray(values)
    except ValueError:
        raise LoadError("samples are an array (z, y, x), not rows of different lengths") from None
    if array.ndim != 3 or array.dtype.kind not in "fiub" or min(array.shape, default=0) < 2:
        raise LoadError(
            f"samples are numbers (z, y, x), 2 or more along each, not {array.dtype} {array.shape}"
        )
    type = float_type(array)
    check_count(array.shape, SAMPLE_BYTES * type.itemsize // 4)
    with np.errstate(over="ignore"):
        samples = array.astype(type)
    if not np.isfinite(samples).all():
        raise LoadError("a sample is not finite")
    return np.ascontiguousarray(samples)


def of_array(values: Any) -> VolumeSamples:
    """Return the samples of an array or nested lists; see ``checked_samples``."""
    samples = checked_samples(values)
    return VolumeSamples(samples, None, is_mask=np.asarray(values).dtype.kind == "b")


def check_count(sizes: Sequence[int], each: int = SAMPLE_BYTES) -> int:
    """Return the number of samples.

    Raises:
        LoadError: A volume has fewer, or the file may not become as many.
    """
    count = math.prod(sizes)
    if count > MOST_SAMPLES:
        raise LoadError(f"{count:,} samples are more than {MOST_SAMPLES:,}: leave some out")
    need(count * each, f"{' x '.join(f'{size:,}' for size in sizes)} samples")
    return count


def samples_of(raw: Buffer, dtype: np.dtype[Any], sizes: Sequence[int]) -> NDArray[Any]:
    """Return the samples of bytes, whose last axis changes first."""
    count = check_count(sizes)
    if len(raw) < count * dtype.itemsize:
        there = len(raw) // dtype.itemsize
        raise LoadError(f"it announces {count:,} samples and contains {there:,}: it is truncated")
    return np.frombuffer(raw, dtype, count).reshape(tuple(sizes))


def unpacked(file: Any, most: int) -> bytes:
    """Return the next bytes of a packed file, at most so many."""
    try:
        data: bytes = file.read(most)
    except (OSError, EOFError, zlib.error):
        raise LoadError("its compressed part is damaged") from None
    return data


def positive(spacing: Sequence[float]) -> Vector | None:
    """Return three distances of samples; None if they are no such."""
    if len(spacing) != 3 or not all(0.0 < abs(s) < 1e15 for s in spacing):
        return None
    x, y, z = (abs(s) for s in spacing)
    return x, y, z


def placed(
    values: Any, steps: Sequence[Sequence[float]], first: Sequence[float] | None
) -> VolumeSamples:
    """Return samples with their place.

    Args:
        values: The samples, (z, y, x).
        steps: The vectors from a sample to the next one along x, y and z.
        first: Where the first sample is, or None.

    Raises:
        LoadError: The vectors span no volume.
    """
    numbers = [*itertools.chain(*steps), *(first or ())]
    spacing = positive([math.hypot(*step) for step in steps])
    if spacing is None or not all(abs(number) < 1e15 for number in numbers):
        raise LoadError("the vectors from sample to sample are 0 or not finite")
    x, y, z = (
        (step[0] / length, step[1] / length, step[2] / length)
        for step, length in zip(steps, spacing, strict=True)
    )
    if abs(np.linalg.det(np.array((x, y, z)))) < 1e-3:
        raise LoadError("the vectors from sample to sample lie in a plane")
    origin = None if first is None else (first[0], first[1], first[2])
    return VolumeSamples(checked_samples(values), spacing, Orientation((x, y, z), origin))


def matrix_of(samples: VolumeSamples, spacing: Vector | None) -> list[list[float]] | None:
    """Return the matrix, three rows of four, that places a centered volume; None: none does.

    Args:
        samples: The samples.
        spacing: Distances that the author gives in place of those of the file, whose middle then
            is the origin; or None.
    """
    orientation = samples.orientation
    if orientation is None:
        return None
    middle = [0.0, 0.0, 0.0]
    if orientation.first is not None and spacing is None and samples.spacing is not None:
        counts = samples.values.shape[::-1]
        middle = [
            orientation.first[row]
            + sum(
                0.5 * (count - 1) * step * direction[row]
                for count, step, direction in zip(
                    counts, samples.spacing, orientation.directions, strict=True
                )
            )
            for row in range(3)
        ]
    axes = np.array(orientation.directions).T
    if np.abs(axes.T @ axes - np.eye(3)).max() < _RIGHT:
        left, _, right = np.linalg.svd(axes)
        axes = left @ right  # the nearest matrix of exactly right angles
    return [[*map(float, row), at] for row, at in zip(axes, middle, strict=True)]
