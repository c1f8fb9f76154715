"""The limits within which built-ins stay finite, and the ranges their arguments are clamped to.

A built-in of ordinary numbers gives a finite number, on every target (decision 17). Where a
mathematical function is undefined, or its value is too large for a float, its argument is clamped
to the nearest argument with a finite value: the logarithm of 0 is the logarithm of the smallest
normal number. Floats of 32 and of 64 bits have different limits, so that each uses its own range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

ORDINARY: Final = 2.0**60  # largest ordinary argument: a sum of four such squares is finite
SMALLEST: Final = 2.0**-126  # smallest normal 32-bit float; GPUs flush smaller numbers to 0
LARGEST_POWER: Final = 2.0**126  # upper limit of exponentials and powers
SMALLEST_64: Final = 2.0**-1022
LARGEST_POWER_64: Final = 2.0**1022
# Above this, neighboring floats are more than half a radian apart, so angles have no meaning.
LARGEST_ANGLE: Final = 2.0**22
LARGEST_ANGLE_64: Final = 2.0**51
# Seconds from 0, about twelve days: there, 32-bit floats are an eighth of a second apart.
LARGEST_TIME: Final = 2.0**20
# Limits the tangent at a pole: 1 / (the smallest angle that is distinguished from 0).
SMALLEST_COSINE: Final = 2.0**-30
# A smaller divisor of a remainder counts as 0, so that a quotient of ordinary numbers is finite.
SMALLEST_DIVISOR: Final = 2.0**-60
# The largest floats below 1: a normal number times this is its neighbor in the direction of 0.
BELOW_ONE: Final = 1.0 - 2.0**-24
BELOW_ONE_64: Final = 1.0 - 2.0**-53
# A matrix with a smaller determinant is singular.
SMALLEST_DETERMINANT: Final = 2.0**-100


@dataclass(frozen=True, slots=True)
class Held:
    """The range to which a built-in's only argument is clamped before the function is applied.

    Attributes:
        low: The lower limit for 32-bit floats.
        high: The upper limit for 32-bit floats.
        low_64: The lower limit for 64-bit floats; None: the same as ``low``.
        high_64: The upper limit for 64-bit floats; None: the same as ``high``.
        by_targets: Whether the argument is also clamped for a target's own function; if False, only
            for the functions that distal computes itself (CPU, reference, careful ones).
    """

    low: float = -math.inf
    high: float = math.inf
    low_64: float | None = None
    high_64: float | None = None
    by_targets: bool = True

    def limits(self, precision: int) -> tuple[float, float]:
        """Return the lower and the upper limit for floats with ``precision`` bits."""
        if precision == 32:
            return self.low, self.high
        low = self.low if self.low_64 is None else self.low_64
        return low, self.high if self.high_64 is None else self.high_64


NOT_NEGATIVE: Final = Held(low=0.0)
POSITIVE: Final = Held(low=SMALLEST, low_64=SMALLEST_64)
EXPONENT: Final = Held(high=87.0, high_64=708.0)
EXPONENT_OF_2: Final = Held(high=126.0, high_64=1022.0)
HYPERBOLIC: Final = Held(-87.0, 87.0, -708.0, 708.0)
LEVEL: Final = Held(-20.0, 20.0)  # beyond, the hyperbolic tangent is -1 or 1 in floats
UNIT: Final = Held(-1.0, 1.0)
ANGLE: Final = Held(
    -LARGEST_ANGLE, LARGEST_ANGLE, -LARGEST_ANGLE_64, LARGEST_ANGLE_64, by_targets=False
)


def smallest(precision: int) -> float:
    """Return the smallest normal float with ``precision`` bits."""
    return SMALLEST if precision == 32 else SMALLEST_64


def below_one(precision: int) -> float:
    """Return the largest float below 1 with ``precision`` bits."""
    return BELOW_ONE if precision == 32 else BELOW_ONE_64


def largest_power(precision: int) -> float:
    """Return the upper limit of powers for floats with ``precision`` bits."""
    return LARGEST_POWER if precision == 32 else LARGEST_POWER_64


# Seconds between two frames, where nothing else says how many there are.
FRAME_SECONDS: Final = 1.0 / 60.0
