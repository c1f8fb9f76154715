"""Easing functions from 0 to 1: how a transition starts and ends.

Input: the progress, from 0 to 1, and the easing (a choice fixed when the scene is compiled).
Output: the eased progress, from 0 to 1, and the largest derivative, which the slopes of operators
depend on. All but the bounce increase monotonically.
"""

from __future__ import annotations

from distal.fields.constants import PI
from distal.lang import clamp, cos, func

LINEAR = 0
SMOOTH = 1  # 3t^2 - 2t^3: derivative 0 at both ends
SMOOTHER = 2  # second derivative also 0 at both ends
SINE = 3
SLOW_START = 4
SLOW_END = 5
CUBIC = 6  # slow at both ends, fast in the middle
QUARTIC = 7
QUINTIC = 8
BOUNCE = 9  # falls to 1 and bounces three times

EASES = (
    "linear",
    "smooth",
    "smoother",
    "sine",
    "slow start",
    "slow end",
    "cubic",
    "quartic",
    "quintic",
    "bounce",
)
# The bounce is made of parabolas of one steepness, each from one landing to the next, in units of
# 1 / BOUNCES; source: Robert Penner, "Motion, tweening, and easing" (2002).
BOUNCES = 2.75


@func
def bounced(x: float) -> float:
    """Return the height of a ball that falls from 0 to 1 and bounces three times."""
    t = x * BOUNCES
    if t < 1.0:
        return t * t
    if t < 2.0:
        return (t - 1.5) * (t - 1.5) + 0.75
    if t < 2.5:
        return (t - 2.25) * (t - 2.25) + 0.9375
    return (t - 2.625) * (t - 2.625) + 0.984375


@func
def eased(t: float, ease: int) -> float:
    """Return the eased progress; ``t`` is clamped to 0 to 1."""
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
    if ease == QUARTIC:
        rest = 1.0 - x
        return 8.0 * x**4 if x < 0.5 else 1.0 - 8.0 * rest**4
    if ease == QUINTIC:
        rest = 1.0 - x
        return 16.0 * x**5 if x < 0.5 else 1.0 - 16.0 * rest**5
    if ease == BOUNCE:
        return bounced(x)
    return x


@func
def ease_slope(ease: int) -> float:
    """Return the largest derivative of ``eased``."""
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
    if ease == QUARTIC:
        return 4.0
    if ease == QUINTIC:
        return 5.0
    if ease == BOUNCE:
        return 2.0 * BOUNCES
    return 1.0


def ease_requirement(ease: int) -> str | None:
    """Return why an easing is invalid, or None."""
    if 0 <= ease < len(EASES):
        return None
    listed = ", ".join(f"{i} {name}" for i, name in enumerate(EASES))
    return f"ease must be one of {listed}"
