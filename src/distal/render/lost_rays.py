"""Rays that end without an answer: marks in a pixel's alpha, so that they can be counted.

Input: alpha, from -1 to 1, and why rays of the pixel were lost. Output: one number that carries
both. Only pictures of linear light are marked; the executor removes the marks and counts them.
"""

from __future__ import annotations

from typing import Final

from distal.lang import exp2, floor, func, select, struct
from distal.render.march import OUT_OF_STEPS, TOO_FAR

# Why rays were lost, as bits.
STEPS: Final = 1
FAR: Final = 2
SHADOWS: Final = 4
# Not lost, but counted as well: the camera's ray began inside a solid.
INSIDE: Final = 8
# Alpha is between -1 and 1, so multiples of 4 can be added to it.
MARK: Final = 4.0
LOWEST: Final = 1.5


@struct
class Marked:
    """An alpha, and why rays were lost: a sum of STEPS, FAR, SHADOWS and INSIDE."""

    alpha: float
    lost: int


@func
def reason(lost: int) -> int:
    """Return the bit for the way in which a ray ended (``march.Hit.lost``)."""
    if lost == OUT_OF_STEPS:
        return STEPS
    return FAR if lost == TOO_FAR else 0


@func
def has(lost: int, bit: int) -> bool:
    """Return whether a sum of bits has one; without bit operations, which GLSL ES 1.00 lacks."""
    return floor(float(lost) / float(bit)) % 2.0 > 0.5


@func
def merged(a: int, b: int) -> int:
    """Return the bits that one of two sums has, or both."""
    if b == 0:  # nearly always
        return a
    total = 0
    for k in range(4):
        bit = int(exp2(float(k)) + 0.5)
        total += select(has(a, bit) or has(b, bit), bit, 0)
    return total


@func
def marked(alpha: float, lost: int, counted: bool) -> float:
    """Return an alpha that carries why rays were lost, if they are counted."""
    if counted:
        return alpha + MARK * float(lost)
    return alpha


@func
def unmarked(alpha: float) -> Marked:
    """Return the alpha and the marks of a marked alpha."""
    lost = floor((alpha + LOWEST) / MARK)
    return Marked(alpha - MARK * lost, int(lost))
