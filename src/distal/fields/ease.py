"""Ways from 0 to 1: how a transition starts and ends.

Input: how far along, from 0 to 1, and which way (a choice fixed when it is compiled). Output: how
much of the change is done, from 0 to 1, and the steepest rise, which the slopes of operators rest
on. All rise everywhere.
"""

from __future__ import annotations

from distal.fields.constants import PI
from distal.lang import clamp, cos, func

LINEAR = 0
SMOOTH = 1  # 3t^2 - 2t^3: starts and ends at rest
SMOOTHER = 2  # also without a jump in the second derivative
SINE = 3
SLOW_START = 4
SLOW_END = 5
CUBIC = 6  # slow at both ends, fast in the middle

EASES = ("linear", "smooth", "smoother", "sine", "slow start", "slow end", "cubic")


@func
def eased(t: float, ease: int) -> float:
    """How much of a change is done; ``t`` outside 0 to 1 counts as the nearer end."""
    x = clamp(t, 0.0, 1.0)
    if ease == SMOOTH:
        return x * x * (3.0 - 2.0 * x)
    if ease == SMOOTHER:
        return x * x * x * (10.0 + x * (6.0 * x - 15.0))
    if ease == SINE:
        return 0.5 - 0.5 * cos(PI * x)
    if ease == SLOW_START:
        return x * x
    if ease == SLOW_END:
        return x * (2.0 - x)
    if ease == CUBIC:
        rest = 1.0 - x
        return 4.0 * x * x * x if x < 0.5 else 1.0 - 4.0 * rest * rest * rest
    return x


@func
def ease_slope(ease: int) -> float:
    """The steepest rise of ``eased``."""
    if ease == SMOOTH:
        return 1.5
    if ease == SMOOTHER:
        return 1.875
    if ease == SINE:
        return 0.5 * PI
    if ease == SLOW_START or ease == SLOW_END:  # noqa: SIM109
        return 2.0
    if ease == CUBIC:
        return 3.0
    return 1.0


def ease_requirement(ease: int) -> str | None:
    """Why an ease does not exist, or None."""
    if 0 <= ease < len(EASES):
        return None
    listed = ", ".join(f"{i} {name}" for i, name in enumerate(EASES))
    return f"ease must be one of {listed}"
