"""A picture whose pixels are the mean of ever more samples, until it is good enough.

Input: a program that renders a number of samples from a number on, and when to end. Output: the
mean of all samples as linear light, how many there are, and how large its error is. Sums are those
of 64-bit floats, so they do not drift. Does not depend on what a sample is.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.render_options import Progress, Refinement

# Samples of a pass: few at first, so that there is soon a picture and an estimate of its error.
MOST_OF_A_PASS: Final = 16
# No error is estimated from fewer passes.
_FEWEST_PASSES: Final = 4
_LUMA: Final = np.array([0.2126, 0.7152, 0.0722])  # Rec. 709

# Renders a pass: the first sample's number, the number of samples, a callback for progress.
Pass = Callable[[int, int, Progress | None], NDArray[np.float32]]


@dataclass(slots=True)
class Film:
    """The sums of a picture's samples.

    Attributes:
        sums: Light of each pixel times alpha, and alpha, summed over the samples; float64, (height,
            width, 4).
        spread: Sum over the samples of the squared difference of luma from its mean, float64.
        samples: The number of samples of each pixel.
        passes: The number of passes.
    """

    sums: NDArray[np.float64]
    spread: NDArray[np.float64]
    samples: int = 0
    passes: int = 0

    @classmethod
    def empty(cls, width: int, height: int) -> Film:
        """Return a film without samples."""
        return cls(np.zeros((height, width, 4)), np.zeros((height, width)))

    def add(self, light: NDArray[np.float32], count: int) -> None:
        """Add a pass.

        Args:
            light: The mean of its samples: linear light and straight alpha.
            count: The number of its samples.
        """
        added = light.astype(np.float64)
        added[..., :3] *= added[..., 3:]
        added *= count
        if self.samples:
            # The difference of the pass from what was there, by Welford's and Chan's formula.
            apart = (added / count - self.sums / self.samples)[..., :3] @ _LUMA
            weight = self.samples * count / (self.samples + count)
            self.spread += weight * apart * apart
        self.sums += added
        self.samples += count
        self.passes += 1

    @property
    def light(self) -> NDArray[np.float32]:
        """Linear light and straight alpha: the mean of the samples."""
        mean = self.sums / max(self.samples, 1)
        mean[..., :3] /= np.maximum(mean[..., 3:], 1e-6)
        return mean.astype(np.float32)

    @property
    def errors(self) -> NDArray[np.float64]:
        """The standard error of each pixel's luma, from the differences between passes."""
        if self.passes < 2:
            return np.full(self.spread.shape, np.inf)
        return np.sqrt(self.spread / ((self.passes - 1) * self.samples))

    @property
    def noise(self) -> float:
        """The root mean square of the standard errors; of a pixel brighter than white, relative.

        Infinite while there are too few passes.
        """
        if self.passes < _FEWEST_PASSES:
            return float("inf")
        luma = self.sums[..., :3] @ _LUMA / self.samples
        return float(np.sqrt(np.mean((self.errors / np.maximum(luma, 1.0)) ** 2)))

    def figures(self) -> dict[str, Any]:
        """Return what is recorded of a picture."""
        noise = self.noise
        return {"samples": self.samples, "noise": None if np.isinf(noise) else noise}


def passes(begun: int, samples: int) -> Iterator[tuple[int, int]]:
    """Yield the first sample and the number of samples of each pass.

    The passes of a picture that is continued are those of one that was not broken off.

    Args:
        begun: The samples that are there already.
        samples: The number of samples in the end.
    """
    first, count = 0, 1
    while first < samples:
        count = min(count, samples - first)
        if first >= begun:
            yield first, count
        first += count
        count = min(max(first, 1), MOST_OF_A_PASS)


def accumulate(
    film: Film,
    rendered: Pass,
    refinement: Refinement,
    keep: Callable[[Film], None] | None,
    progress: Progress | None,
) -> None:
    """Add samples to a film until it has enough of them, the time is over or the error is small.

    Args:
        film: The film.
        rendered: Renders a pass.
        refinement: When to end.
        keep: Called after each pass.
        progress: Called with the finished share, from 0 to 1.
    """
    begin = time.perf_counter()
    limit = refinement.time_limit
    for first, count in passes(film.samples, refinement.samples):
        done = first / refinement.samples

        def part(
            share: float, done: float = done, width: float = count / refinement.samples
        ) -> None:
            whole = done + share * width
            if limit is not None:
                whole = max(whole, min((time.perf_counter() - begin) / limit, 1.0))
            if progress is not None:
                progress(whole)

        film.add(rendered(first, count, part), count)
        if keep is not None:
            keep(film)
        if limit is not None and time.perf_counter() - begin >= limit:
            break
        if refinement.noise is not None and film.noise <= refinement.noise:
            break
    if progress is not None:
        progress(1.0)
