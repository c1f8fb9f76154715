"""What is checked: a field with the promises made about it.

Input: a sample of a row, or anything else that answers at points. Output: a
``Subject``. Knows neither how points are chosen nor what is held against what.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from distal.fields.guarantees import Guarantee
from tests.fields.rows import Doubles, Sample, dimension_of


@dataclass(frozen=True, slots=True)
class Subject:
    """A field and its promises.

    Attributes:
        name: What a finding calls it, numbers and all.
        evaluate: Distances and gradients at points, in 64 bits.
        dimension: 2 or 3.
        claims: What it promises besides its slope.
        slope: Bound on |gradient| everywhere.
        divisor: What a marcher divides values by before it steps that far.
        low: Lower corner of its box; minus infinity where it has no end.
        high: Upper corner.
        signed: Whether it may have an inside.
        hollow: Whether its inside may be empty all the same, with a wall of thickness 0 for one.
        empty: Whether even its surface may be: an intersection's may, and a fractal's.
        estimate: Whether its slope is an estimate.
        growth: How far from the box a point may be for each unit of its value.
        side_growth: The same for each side of the box.
    """

    name: str
    evaluate: Callable[[Doubles], tuple[Any, Any]]
    dimension: int
    claims: frozenset[Guarantee]
    slope: float
    divisor: float
    low: Doubles
    high: Doubles
    signed: bool = True
    hollow: bool = False
    empty: bool = False
    estimate: bool = False
    growth: float = np.inf
    side_growth: float = np.inf

    def value(self, points: Doubles) -> Doubles:
        """Distances at points."""
        return np.asarray(self.evaluate(points)[0], np.float64)

    @property
    def region(self) -> tuple[Doubles, Doubles]:
        """Where there is something to look at: the box, cut off where it has no end."""
        low = np.where(np.isfinite(self.low), self.low, np.minimum(-2.0, self.high - 4.0))
        high = np.where(np.isfinite(self.high), self.high, np.maximum(2.0, low + 4.0))
        return low, np.maximum(high, low)

    @property
    def scale(self) -> float:
        """The largest side of the region: what lengths are compared with."""
        low, high = self.region
        return float(max(np.max(high - low), np.max(np.abs(low)), np.max(np.abs(high)), 1e-3))


def subject_of(sample: Sample) -> Subject:
    """A row with numbers, as a subject."""
    slope, low, high, growth, side_growth = sample.promise()
    row = sample.row
    zeros = any(n in row.limits and 0.0 in np.ravel(v) for n, v in sample.numbers.items())
    return Subject(
        str(sample),
        sample.evaluate,
        dimension_of(row.distance),
        row.claims,
        slope,
        1.0 if Guarantee.LOWER_BOUND in row.claims else slope,
        low,
        high,
        row.signed,
        hollow=zeros,
        empty=row.estimate,
        estimate=row.estimate,
        growth=growth,
        side_growth=side_growth,
    )
