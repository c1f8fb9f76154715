"""Samples of a grid in bricks near the surface, as the shape ``BrickField`` reads them.

Input: all samples of a grid, or those of some bricks and the values at the corners of all. Output:
one array of numbers. Where a brick is stored, samples are unchanged as long as they are nearer than
``reach``; farther away they are lowered, so that values continue across the sides of bricks.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError

CELLS: Final = 8  # along each side of a brick
SIDE: Final = CELLS + 1  # samples along it
# Bricks that come nearer to the surface than this many samples are stored.
REACH: Final = 4
# All numbers of a field: 128 MiB, what WebGPU's devices bind as one buffer without more.
MOST_NUMBERS: Final = 2**25
# The most samples of a grid that is stored as a whole: as texels, of 16 bytes.
MOST_DENSE: Final = 2**24
# Bricks are chosen if they have at most this share of the grid's numbers.
_WORTH_IT: Final = 0.5
# Steps from a brick to the 26 about it.
ABOUT: Final = [step for step in itertools.product((-1, 0, 1), repeat=3) if step != (0, 0, 0)]
_AT_ONCE: Final = 1024  # bricks


@dataclass(frozen=True, slots=True, eq=False)
class BrickSamples:
    """The samples of a grid in bricks.

    Attributes:
        numbers: Of the samples' type: ``values`` of ``fields.solids.bricks.brick_field``.
        samples: The number of samples along x, y and z.
        reach: Its ``reach``.
        stored: The number of bricks that are stored.
    """

    numbers: NDArray[Any]
    samples: tuple[int, int, int]
    reach: float
    stored: int


@dataclass(frozen=True, slots=True, eq=False)
class KnownBricks:
    """What is known of a grid.

    Attributes:
        places: Which bricks have samples, (n, 3) along z, y and x, in the order of their places.
        values: Their samples, (n, 9, 9, 9).
        corners: Values at the corners of all bricks, (z, y, x).
        margin: By how much the interpolation of values at corners exceeds distances at most.
    """

    places: NDArray[np.int64]
    values: NDArray[Any]
    corners: NDArray[Any]
    margin: float


Steps = tuple[float, float, float]


def bricks_along(samples: int) -> int:
    """Return the number of bricks for so many samples."""
    return max(1, -(-(samples - 1) // CELLS))


def numbers_of(bricks: tuple[int, ...], stored: int) -> int:
    """Return how many numbers a field has: (bricks along each axis), and how many are stored."""
    return math.prod(bricks) + math.prod(n + 1 for n in bricks) + stored * SIDE**3


def from_grid(
    values: NDArray[Any], steps: Steps, margin: float | None = None
) -> BrickSamples | None:
    """Return the bricks of a grid of samples; None if the grid is small and they save little.

    Args:
        values: The samples, (z, y, x); neighbors differ by at most their distance.
        steps: The distances of samples along z, y and x.
        margin: ``KnownBricks.margin``; None: what holds for all samples.

    Raises:
        LoadError: There are too many bricks.
    """
    reach = REACH * max(steps)
    count = tuple(bricks_along(n) for n in values.shape)
    # The shape ends at the last sample; what follows fills the last brick.
    more = [(0, CELLS * n + 1 - m) for n, m in zip(count, values.shape, strict=True)]
    whole = np.pad(values, more, mode="edge") if any(b for _, b in more) else values
    least = _least(np.abs(whole))
    places = np.argwhere(least < reach)
    needed = numbers_of(count, len(places))
    if values.size <= MOST_DENSE and needed > _WORTH_IT * values.size:
        return None
    check_size(count, len(places))
    known = KnownBricks(
        places,
        _gathered(whole, places),
        np.ascontiguousarray(whole[::CELLS, ::CELLS, ::CELLS]),
        # Values differ by at most the way along the axes. On average over the corners, with the
        # weights of the interpolation, that is half of a brick along each at most.
        0.5 * CELLS * sum(steps) if margin is None else margin,
    )
    z, y, x = values.shape
    return assembled(known, steps, reach, (x, y, z))


def check_size(bricks: tuple[int, ...], stored: int) -> None:
    """Check that a field is not too large.

    Raises:
        LoadError: It has more than ``MOST_NUMBERS`` numbers.
    """
    if numbers_of(bricks, stored) > MOST_NUMBERS:
        raise LoadError(
            f"the samples near the surface are {numbers_of(bricks, stored):,} numbers, more than "
            f"{MOST_NUMBERS:,}: leave some out"
        )


def assembled(
    known: KnownBricks, steps: Steps, reach: float, samples: tuple[int, int, int]
) -> BrickSamples:
    """Return the numbers of a field.

    Args:
        known: What is known; bricks with samples contain all places that are nearer than ``reach``.
        steps: The distances of samples along z, y and x.
        reach: The least distance in bricks that are not stored.
        samples: The number of samples along x, y and z.
    """
    nearest = np.abs(known.values).reshape(len(known.values), -1).min(axis=1, initial=np.inf)
    places, values = known.places[nearest < reach], known.values[nearest < reach]
    count = tuple(n - 1 for n in known.corners.shape)
    number = values.dtype.type
    index = np.where(known.corners[:-1, :-1, :-1] < 0.0, number(-1), number(0))
    z, y, x = places.T
    index[z, y, x] = np.arange(1, len(places) + 1)
    is_stored = np.zeros(tuple(n + 2 for n in count), bool)
    is_stored[z + 1, y + 1, x + 1] = True
    away = np.abs(known.corners) - number(known.margin)
    for step in itertools.product((0, 1), repeat=3):
        at = tuple(places[:, axis] + step[axis] for axis in range(3))
        away[at] = np.minimum(away[at], number(reach))
    _lower(away, steps)
    _cap(values, is_stored, places, steps, reach)
    numbers = np.concatenate([index.reshape(-1), away.reshape(-1), values.reshape(-1)])
    return BrickSamples(numbers.astype(number, copy=False), samples, reach, len(places))


def _lower(away: NDArray[Any], steps: Steps) -> None:
    """Lower values at corners until neighbors differ by at most their distance.

    What is interpolated between them is then no steeper than between samples.
    """
    total = np.inf
    while total > (total := float(away.sum(dtype=np.float64))):
        for axis in range(3):
            along, far = np.moveaxis(away, axis, 0), away.dtype.type(CELLS * steps[axis])
            for each in (along, along[::-1]):
                for before, here in itertools.pairwise(each):
                    np.minimum(here, before + far, out=here)


def _cap(
    values: NDArray[Any],
    is_stored: NDArray[np.bool_],
    places: NDArray[np.int64],
    steps: Steps,
    reach: float,
) -> None:
    """Lower samples to ``reach`` plus their distance from the nearest brick that is not stored.

    On the sides of that brick they are ``reach``, as the field is there. A brick that is farther
    than those about a sample's own one counts as one brick away.

    Args:
        values: The samples, (n, 9, 9, 9); changed in place.
        is_stored: Which bricks are stored, with a border of one brick. Nothing is beyond the grid,
            where the field is not asked: no sample is lowered for it.
        places: Which bricks these are.
        steps: The distances of samples along z, y and x.
        reach: The least distance in bricks that are not stored.
    """
    is_missing = ~is_stored
    for axis in range(3):
        border = np.moveaxis(is_missing, axis, 0)
        border[0] = border[-1] = False
    number = values.dtype.type
    away = {step: _distances_from(step, steps).astype(number) for step in ABOUT}
    farthest = number(reach + CELLS * min(steps))
    for start in range(0, len(places), _AT_ONCE):
        part = values[start : start + _AT_ONCE]
        z, y, x = places[start : start + _AT_ONCE].T + 1
        cap = np.full(part.shape, farthest)
        for step, distance in away.items():
            asked = is_missing[z + step[0], y + step[1], x + step[2]]
            cap[asked] = np.minimum(cap[asked], number(reach) + distance)
        np.clip(part, -cap, cap, out=part)


def _distances_from(step: tuple[int, ...], steps: Steps) -> NDArray[np.float64]:
    """Return the distances of a brick's samples from the brick that is a step away, (9, 9, 9)."""
    at = np.arange(SIDE)
    along = {-1: at, 0: np.zeros(SIDE), 1: CELLS - at}
    z, y, x = (along[step[axis]] * steps[axis] for axis in range(3))
    squared = (z * z)[:, None, None] + (y * y)[:, None] + x * x
    found: NDArray[np.float64] = np.sqrt(squared)
    return found


def _least(values: NDArray[Any]) -> NDArray[Any]:
    """Return the least of the samples of each brick."""
    for axis in range(3):
        along = np.moveaxis(values, axis, 0)
        least = along[:-1:CELLS]
        for step in range(1, SIDE):
            least = np.minimum(least, along[step::CELLS][: len(least)])
        values = np.moveaxis(least, 0, axis)
    return values


def _gathered(values: NDArray[Any], places: NDArray[np.int64]) -> NDArray[Any]:
    """Return the samples of bricks, (n, 9, 9, 9)."""
    found = np.empty((len(places), SIDE, SIDE, SIDE), values.dtype)
    for part in _parts(len(places)):
        z, y, x = places[part].T * CELLS
        rows = np.arange(SIDE)
        found[part] = values[
            (z[:, None] + rows)[:, :, None, None],
            (y[:, None] + rows)[:, None, :, None],
            (x[:, None] + rows)[:, None, None, :],
        ]
    return found


def _parts(count: int) -> Iterator[slice]:
    """Return slices of rows that are worked on at once."""
    return (slice(start, start + _AT_ONCE) for start in range(0, count, _AT_ONCE))
