"""The numbers between which built-ins stay, and where their arguments are held for it.

A built-in of ordinary numbers gives a finite number, on every target (decision 17). Where a
mathematical function has no value, or none that a float holds, its argument is held at the last
place where it has one: the logarithm of 0 is the logarithm of the smallest normal number. The
limits differ between floats of 32 and of 64 bits, so that each keeps its own range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

ORDINARY: Final = 2.0**60  # what arguments may be: a sum of squares is finite, four are
SMALLEST: Final = 2.0**-126  # the smallest normal float of 32 bits; GPUs take what is below for 0
LARGEST_POWER: Final = 2.0**126  # what exponentials and powers are held at
SMALLEST_64: Final = 2.0**-1022
LARGEST_POWER_64: Final = 2.0**1022
# Beyond it neighbouring floats are more than half a radian apart, and no angle is meant.
LARGEST_ANGLE: Final = 2.0**22
LARGEST_ANGLE_64: Final = 2.0**51
# Seconds from 0, twelve days: there floats of 32 bits are an eighth of a second apart.
LARGEST_TIME: Final = 2.0**20
# The tangent at a pole, at most: one over the smallest angle that is distinguished from 0.
SMALLEST_COSINE: Final = 2.0**-30
# Below it a divisor of a remainder counts as 0: the quotient of ordinary numbers is then finite.
SMALLEST_DIVISOR: Final = 2.0**-60
# Below it a matrix is singular.
SMALLEST_DETERMINANT: Final = 2.0**-100


@dataclass(frozen=True, slots=True)
class Held:
    """Between which numbers a built-in's only argument is held before it is applied.

    Attributes:
        low: The lowest, of 32 bits.
        high: The highest.
        low_64: The lowest of 64 bits, where that differs.
        high_64: The highest.
        by_targets: Whether a target's own function is given a held argument too; else only the
            functions that distal computes itself (CPU, reference, careful ones) are.
    """

    low: float = -math.inf
    high: float = math.inf
    low_64: float | None = None
    high_64: float | None = None
    by_targets: bool = True

    def limits(self, precision: int) -> tuple[float, float]:
        """The lowest and the highest for floats of so many bits."""
        if precision == 32:
            return self.low, self.high
        low = self.low if self.low_64 is None else self.low_64
        return low, self.high if self.high_64 is None else self.high_64


NOT_NEGATIVE: Final = Held(low=0.0)
POSITIVE: Final = Held(low=SMALLEST, low_64=SMALLEST_64)
EXPONENT: Final = Held(high=87.0, high_64=708.0)
EXPONENT_OF_2: Final = Held(high=126.0, high_64=1022.0)
HYPERBOLIC: Final = Held(-87.0, 87.0, -708.0, 708.0)
LEVEL: Final = Held(-20.0, 20.0)  # where the hyperbolic tangent has long been -1 and 1
UNIT: Final = Held(-1.0, 1.0)
ANGLE: Final = Held(
    -LARGEST_ANGLE, LARGEST_ANGLE, -LARGEST_ANGLE_64, LARGEST_ANGLE_64, by_targets=False
)


def smallest(precision: int) -> float:
    """The smallest normal float of so many bits."""
    return SMALLEST if precision == 32 else SMALLEST_64


def largest_power(precision: int) -> float:
    """What powers are held at."""
    return LARGEST_POWER if precision == 32 else LARGEST_POWER_64
