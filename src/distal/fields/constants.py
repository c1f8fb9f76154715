"""Numbers that several modules of the field library use.

Input: nothing. Output: constants in 64 bits.
"""

from __future__ import annotations

import math
from typing import Final

PI: Final = math.pi
TAU: Final = math.tau
HALF_ROOT: Final = 0.7071067811865476  # sqrt(1/2)
# sqrt(3); a point that is outside three sides of a box by r each is this times r from the box.
ROOT_THREE: Final = 1.7320508075688772
# Lower limit of divisors; far below any length in a scene.
TINY: Final = 1e-12
