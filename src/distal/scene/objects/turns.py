"""A warning about angles in radians that look like degrees.

Input: the angles of an author's rotation. Output: a warning at that line.
"""

from __future__ import annotations

import math
from typing import Any, Final

from distal.diagnostics import Span
from distal.scene.tree.errors import warn

# Rotations by 30, 45 or 90 radians are unlikely; 15 may be the last value of a loop.
LEAST_DEGREES: Final = 30
STEP_OF_DEGREES: Final = 15


def warn_of_degrees(place: Span | None, *angles: Any) -> None:
    """Warn of constant angles that are large multiples of 15: probably degrees."""
    for angle in angles:
        plain = isinstance(angle, int | float) and not isinstance(angle, bool)
        if plain and abs(angle) >= LEAST_DEGREES and angle % STEP_OF_DEGREES == 0:
            turns = abs(angle) / math.tau
            message = (
                f"angles are radians, and {angle:g} of them are {turns:.3g} turns; "
                f"for degrees write {angle:g} * deg"
            )
            warn(message, place)
