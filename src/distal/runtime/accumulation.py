"""A picture whose pixels are the mean of ever more samples, until it is good enough.

Input: a program that renders a number of samples from a number on, and when to end. Output: the
mean of all samples as linear light, how many there are, and how large its error is. Sums are those
of 64-bit floats, so they do not drift. Does not depend on what a sample is.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.render_options import Progress, Refinement
from distal.runtime import settling
from distal.runtime.allocation import Pass, next_pass, share_done

# No error is estimated from fewer passes.
FEWEST_PASSES: Final = 4
_BLOCK: Final = 2**12  # pixels that are added together: their numbers stay in the cache

# Renders a pass, with a callback for progress: the means of its samples, of the pixels in the order
# of ``Pass.places``, or of all as (height, width, 4).
Rendered = Callable[[Pass, Progress | None], NDArray[np.float32]]


def _luma_of(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the luma of light, by Rec. 709.

    Not as a product of matrices: for one, OpenBLAS wakes threads, which then turn idle for as long
    as a pass takes.
    """
    red, green, blue = light[..., 0], light[..., 1], light[..., 2]
    found: NDArray[np.float64] = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    return found


@dataclass(slots=True)
class Film:
    """The sums of a picture's samples.

    Attributes:
        sums: Light of each pixel times alpha, and alpha, summed over the samples; float64, (height,
            width, 4).
        spread: Sum over the samples of the squared difference of luma from its mean, float64.
        samples: The number of samples of each pixel, int32.
        passes: The number of passes that each pixel was in, int32.
        steps: How the luma of each pixel settles (``settling``), float64, (3, height, width).
        signed: Whether samples may have negative weights. Alpha is then 0 or 1.
    """

    sums: NDArray[np.float64]
    spread: NDArray[np.float64]
    samples: NDArray[np.int32]
    passes: NDArray[np.int32]
    steps: NDArray[np.float64]
    signed: bool = False

    @classmethod
    def empty(cls, width: int, height: int, *, signed: bool = False) -> Film:
        """Return a film without samples."""
        samples, passes = np.zeros((2, height, width), np.int32)
        sums, spread = np.zeros((height, width, 4)), np.zeros((height, width))
        return cls(sums, spread, samples, passes, np.zeros((3, height, width)), signed)

    def add(
        self, light: NDArray[np.float32], count: int, places: NDArray[np.int32] | None = None
    ) -> None:
        """Add a pass.

        Args:
            light: The mean of its samples: linear light times alpha, and alpha.
            count: The number of its samples in each pixel.
            places: The indices of its pixels, from the top row on; None for all.
        """
        of_pass = light.reshape(-1, 4)
        for begin in range(0, len(of_pass), _BLOCK):
            block = slice(begin, begin + _BLOCK)
            self._add_block(of_pass[block], count, block if places is None else places[block])

    def _add_block(self, light: NDArray[np.float32], count: int, where: Any) -> None:
        """Add some pixels of a pass: their light, at these indices."""
        sums, spread = self.sums.reshape(-1, 4), self.spread.reshape(-1)
        samples, passes = self.samples.reshape(-1), self.passes.reshape(-1)
        added = light.astype(np.float64)
        before, known = samples[where], sums[where]
        # The difference of the pass from what was there, by Welford's and Chan's formula.
        mean = known / np.maximum(before, 1)[:, None]
        if self.signed:  # alpha is the weight, by which the light is divided in the end
            mean *= (added[:, 3] / np.where(mean[:, 3] > 0.0, mean[:, 3], 1.0))[:, None]
        apart = _luma_of(added - mean)
        spread[where] += before * count / (before + count) * apart * apart
        sums[where] = known + added * count
        samples[where] = now = before + count
        passes[where] += 1
        if int(now[0]) & (int(now[0]) - 1) == 0:  # all pixels of a pass have the same number
            alpha = np.maximum(sums[where][:, 3], 1e-30) if self.signed else now
            settling.advance(self.steps.reshape(3, -1), where, _luma_of(sums[where]) / alpha)

    @property
    def light(self) -> NDArray[np.float32]:
        """Linear light and straight alpha: the mean of the samples."""
        mean = self.sums / np.maximum(self.samples, 1)[..., None]
        mean[..., :3] /= np.maximum(mean[..., 3:], 1e-6)
        alpha = np.rint(mean[..., 3]) if self.signed else mean[..., 3]
        mean[..., 3] = np.clip(alpha, 0.0, 1.0)
        return mean.astype(np.float32)

    @property
    def luma(self) -> NDArray[np.float64]:
        """The luma of each pixel."""
        found: NDArray[np.float64] = _luma_of(self.sums) / np.maximum(self.samples, 1)
        return found

    @property
    def sample_variance(self) -> NDArray[np.float64]:
        """The variance of the luma of one sample, as if samples were independent.

        From the differences between passes. The variance of a pixel is this, divided by the number
        of its samples, if its samples have nothing in common; they are better distributed than
        that, so that smooth surfaces settle faster.
        """
        unknown = np.where(self.passes < 2, np.inf, 0.0)
        found: NDArray[np.float64] = self.spread / np.maximum(self.passes - 1, 1) + unknown
        return found

    @property
    def effective_variance(self) -> NDArray[np.float64]:
        """The variance of a pixel's luma times the number of its samples."""
        found = self.sample_variance
        return found * settling.share_that_is_left(self.steps, self.samples, found)

    @property
    def variance(self) -> NDArray[np.float64]:
        """The variance of each pixel's luma: its squared standard error."""
        found: NDArray[np.float64] = self.effective_variance / np.maximum(self.samples, 1)
        return found

    @property
    def relative_variance(self) -> NDArray[np.float64]:
        """``effective_variance``; of a pixel brighter than white, relative to its luma."""
        found: NDArray[np.float64] = self.effective_variance / np.maximum(self.luma, 1.0) ** 2
        return found

    @property
    def noise(self) -> float:
        """The root mean square of the standard errors; of a pixel brighter than white, relative.

        Infinite while there are too few passes.
        """
        if int(self.passes.min()) < FEWEST_PASSES:
            return float("inf")
        return float(np.sqrt(np.mean(self.relative_variance / self.samples)))

    def figures(self) -> dict[str, Any]:
        """Return what is recorded of a picture."""
        noise, mean = self.noise, float(self.samples.mean())
        count = int(mean) if mean == int(mean) else mean
        return {"samples": count, "noise": None if np.isinf(noise) else noise}


def accumulate(
    film: Film,
    rendered: Rendered,
    refinement: Refinement,
    watch: Callable[[Film], None] | None,
    progress: Progress | None,
) -> None:
    """Add samples to a film until it has enough of them, the time is over or the error is small.

    Args:
        film: The film.
        rendered: Renders a pass.
        refinement: When to end.
        watch: Called after each pass.
        progress: Called with the finished share, from 0 to 1.
    """
    begin = time.perf_counter()
    limit = refinement.time_limit
    shown = 0.0

    def report(share: float) -> None:
        nonlocal shown
        if limit is not None:
            share = max(share, (time.perf_counter() - begin) / limit)
        shown = max(shown, min(share, 1.0))
        if progress is not None:
            progress(shown)

    while (following := next_pass(film, refinement)) is not None:
        done = share_done(film, refinement)
        width = following.count * following.pixels(film.samples.size) / film.samples.size
        width /= max(float(film.samples.mean()) / done if done > 0.0 else refinement.samples, 1.0)

        def part(share: float, done: float = done, width: float = width) -> None:
            report(done + share * width)

        film.add(rendered(following, part), following.count, following.places)
        if watch is not None:
            watch(film)
        if limit is not None and time.perf_counter() - begin >= limit:
            break
    report(1.0)
