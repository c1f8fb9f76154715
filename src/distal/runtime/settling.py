"""How fast the pixels of a picture settle, from the differences at each doubling of their samples.

Input: the luma of each pixel when the number of its samples is a power of two. Output: the variance
of a pixel in parts of what it would be if its samples were independent.

The samples of a pixel are points of a sequence that fills its square ever more evenly, so the mean
of n of them may have a variance V(n) that falls faster than 1/n: c n^-a, with a = 1 for noise and
up to 3 on smooth surfaces. The squared difference of the mean over n samples from that over the
first half of them has the mean

    D(n) = V(n) (2^a - 1),

because the variances of both halves are 2^a V(n), and the rest of the difference is what they have
in common. D(n / 2) / D(n) is 2^a. Both follow from three numbers of a pixel; their means are taken
over the pixels of tiles and their neighbors.

Source: Art Owen, "Scrambled Net Variance for Integrals of Smooth Functions" (1997), for the rates.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.runtime.allocation import TILE_PX, by_pixel, over_neighbors, over_tiles

# The rows of the steps: the mean at the last power of two, and the squared differences there and
# at the one before.
_MEAN: Final = 0
_LAST: Final = 1
_BEFORE: Final = 2
# 2^a for noise, and for smooth surfaces. Up to the limit it is taken for noise: of a few bright
# samples a larger ratio may be chance, and errors are rather stated too large.
_SLOWEST: Final = 2.0
_LIMIT: Final = 3.0
_FASTEST: Final = 8.0
_SAFETY: Final = 1.2
# From so few samples on there are two differences, the first of them of more than one sample.
_FEWEST_SAMPLES: Final = 8
# The rate of fewer pixels is not known well enough.
_FEWEST_PIXELS: Final = 1024
# The square of the mean difference by the mean square is 1/3 for normal errors; less than this
# many of so many pixels have the weight of all.
_MOST_BRIGHT: Final = 50.0


def advance(steps: NDArray[np.float64], where: Any, luma: NDArray[np.float64]) -> None:
    """Take note of the means of some pixels whose number of samples has become a power of two.

    Args:
        steps: The steps of all pixels, (3, number of pixels); changed in place.
        where: The indices of the pixels.
        luma: Their means.
    """
    steps[_BEFORE, where] = steps[_LAST, where]
    steps[_LAST, where] = (luma - steps[_MEAN, where]) ** 2
    steps[_MEAN, where] = luma


def share_that_is_left(
    steps: NDArray[np.float64], samples: NDArray[np.int32], variance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the variance of each pixel, in parts of that of independent samples; at most 1.

    It is 1 as long as too little is known.

    Args:
        steps: The steps, (3, height, width).
        samples: The number of samples of each pixel, equal in each tile.
        variance: The variance of one sample, (height, width).
    """
    height, width = samples.shape
    is_known = samples.size >= _FEWEST_PIXELS and int(samples.min()) >= _FEWEST_SAMPLES
    if not is_known or not np.isfinite(variance).all():
        return np.ones((height, width))
    doubled = 2.0 ** np.floor(np.log2(samples))
    last, before, independent = (
        over_neighbors(over_tiles(part))
        for part in (doubled * steps[_LAST], doubled * steps[_BEFORE], variance)
    )
    rate = np.minimum(before / np.maximum(last, 1e-300), _FASTEST)
    rate = np.where(rate < _LIMIT, _SLOWEST, rate)
    found = _SAFETY * last / (rate - 1.0) / np.maximum(independent, 1e-300)
    found *= _since_doubling(samples[::TILE_PX, ::TILE_PX], np.log2(rate))
    # A few bright pixels may make up the sum; then it says nothing.
    squares = over_neighbors(over_tiles((doubled * steps[_LAST]) ** 2))
    found[last**2 * _FEWEST_PIXELS < _MOST_BRIGHT * squares] = 1.0
    return by_pixel(np.minimum(found, 1.0), width, height)


def _since_doubling(
    samples: NDArray[np.int32], exponent: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return n V(n) in parts of that at the last power of two.

    n samples are runs of powers of two, as in the binary number, that are taken for independent.

    Args:
        samples: The number of samples n.
        exponent: The exponent a.
    """
    whole = 2.0 ** np.floor(np.log2(samples))
    total = np.zeros(samples.shape)
    for bit in range(31):
        run = samples & (1 << bit)
        total += run * (whole / np.maximum(run, 1)) ** (exponent - 1.0)
    found: NDArray[np.float64] = total / samples
    return found
