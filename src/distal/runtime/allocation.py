"""Which pixels of a picture get the next samples, and how many.

Input: the samples and the estimated variance of each pixel, and when the picture is finished.
Output: the next pass. It depends on nothing else, so a picture that is continued gets the passes of
one that was not broken off.

Without a limit of the error all pixels get the same number of samples. With one, samples go where
the error is: for a given number of samples the mean squared error is smallest if each pixel's
number is proportional to its standard deviation (Neyman's allocation). The deviation is that of a
tile of pixels, and each tile has some samples before its estimate counts.

Source: Jerzy Neyman, "On the Two Different Aspects of the Representative Method" (1934).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from distal.lang.render_options import Refinement

# Samples of a pass: few at first, so that there is soon a picture and an estimate of its error.
MOST_OF_A_PASS: Final = 16
TILE_PX: Final = 16
# Samples in each pixel before the estimated error decides. What fewer samples do not find at all,
# in none of the 256 pixels of a tile or its neighbors, gets no more of them.
FEWEST_SAMPLES: Final = 64
# Pixels of a pass are listed square by square of this side, as the CPU computes them together.
_SQUARE_PX: Final = 8


class MeasuredFilm(Protocol):
    """The film, as far as passes depend on it; see ``accumulation.Film``."""

    samples: NDArray[np.int32]

    @property
    def relative_variance(self) -> NDArray[np.float64]:
        """The variance of a sample; of a pixel brighter than white, relative to it."""

    @property
    def noise(self) -> float:
        """The estimated error of the picture."""


@dataclass(frozen=True, slots=True)
class Pass:
    """Samples that are rendered together.

    Attributes:
        first: The number of the first sample.
        count: The number of samples in each pixel.
        places: The indices of the pixels, from the top row on; None for all.
    """

    first: int
    count: int
    places: NDArray[np.int32] | None = None

    def pixels(self, all_of_them: int) -> int:
        """Return the number of pixels, of a picture that has so many."""
        return all_of_them if self.places is None else len(self.places)


def pass_size(first: int, refinement: Refinement) -> int:
    """Return the number of samples of the pass that begins with a sample.

    Passes begin at fixed numbers: 0, 1, 2, 4, 8, 16, and multiples of 16. While the shutter is
    open each sample is a pass, because all pixels of a pass have the same time.
    """
    if refinement.shutter > 0.0:
        return 1
    size = MOST_OF_A_PASS - first % MOST_OF_A_PASS
    if first < MOST_OF_A_PASS:
        size = (1 << first.bit_length()) - first
    return min(size, refinement.samples - first)


def next_pass(film: MeasuredFilm, refinement: Refinement) -> Pass | None:
    """Return the next pass; None if the picture is finished.

    Of the tiles that need more samples those with the fewest come first, so all pixels of a pass
    have the same number of samples.
    """
    if refinement.noise is not None and film.noise <= refinement.noise:
        return None
    needed = np.minimum(wanted(film, refinement), refinement.samples)
    tiles = film.samples[::TILE_PX, ::TILE_PX]
    short = tiles < needed
    if not short.any():
        return None
    first = int(tiles[short].min())
    chosen = short & (tiles == first)
    count = pass_size(first, refinement)
    if chosen.all():
        return Pass(first, count)
    height, width = film.samples.shape
    return Pass(first, count, _listed(by_pixel(chosen, width, height)))


def wanted(film: MeasuredFilm, refinement: Refinement) -> NDArray[np.float64]:
    """Return the number of samples that the pixels of each tile need for the wanted error."""
    tiles = film.samples[::TILE_PX, ::TILE_PX]
    if refinement.noise is None:
        return np.full(tiles.shape, float(refinement.samples))
    if int(tiles.min()) < min(FEWEST_SAMPLES, refinement.samples):
        return np.full(tiles.shape, float(FEWEST_SAMPLES))
    deviation = np.sqrt(_with_neighbors(over_tiles(film.relative_variance)))
    mean = np.average(deviation, weights=_tile_sizes(film.samples.shape))
    needed: NDArray[np.float64] = deviation * (mean / refinement.noise**2)
    return np.maximum(needed, float(FEWEST_SAMPLES))


def share_done(film: MeasuredFilm, refinement: Refinement) -> float:
    """Return the share of the samples that the film already has."""
    if refinement.noise is None or int(film.samples.min()) < FEWEST_SAMPLES:
        return float(film.samples.mean()) / refinement.samples
    needed = np.clip(wanted(film, refinement), 1.0, refinement.samples)
    sizes = _tile_sizes(film.samples.shape)
    tiles = film.samples[::TILE_PX, ::TILE_PX]
    total = np.sum(np.maximum(needed, tiles) * sizes)
    return float(np.sum(tiles * sizes) / total)


def over_tiles(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of the pixels of each tile."""
    rows, columns = (np.arange(0, side, TILE_PX) for side in values.shape)
    sums = np.add.reduceat(np.add.reduceat(values, rows, axis=0), columns, axis=1)
    found: NDArray[np.float64] = sums / _tile_sizes(values.shape)
    return found


def by_pixel(tiles: NDArray[Any], width: int, height: int) -> NDArray[Any]:
    """Return the value of each pixel's tile."""
    whole = np.repeat(np.repeat(tiles, TILE_PX, axis=0), TILE_PX, axis=1)
    return whole[:height, :width]


def _tile_sizes(shape: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the number of pixels of each tile."""
    down, across = (np.diff(np.append(np.arange(0, side, TILE_PX), side)) for side in shape)
    return np.asarray(down[:, None] * across[None, :], np.int64)


def over_neighbors(tiles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of each tile and its eight neighbors."""
    padded = np.pad(tiles, 1, mode="edge")
    height, width = tiles.shape
    around = sum(padded[i : i + height, j : j + width] for i in range(3) for j in range(3))
    return np.asarray(around) / 9.0


def _with_neighbors(tiles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return each tile's value, but at least a quarter of the mean with its eight neighbors."""
    return np.maximum(tiles, 0.25 * over_neighbors(tiles))


def _listed(chosen: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return the indices of the pixels, square by square."""
    rows, columns = np.nonzero(chosen)
    squares = rows // _SQUARE_PX * (chosen.shape[1] // _SQUARE_PX + 1) + columns // _SQUARE_PX
    order = np.argsort(squares, kind="stable")
    return np.asarray((rows * chosen.shape[1] + columns)[order], np.int32)
