"""The numbers of planes that cut a scene open and of rulers on it, for windows and pages.

Input: the size of a scene, places, lengths. Output: numbers. ``tools/gen_player.py`` translates
this module to TypeScript, so it is written in the subset of Python that this tool supports. It
depends on neither windows nor pages.
"""

from __future__ import annotations

from typing import Final

from distal.scene.viewing.interaction import rounded

# A step of a plane, and the distance of two lines on its faces, as parts of the scene's size.
CUT_STEP: Final = 0.025
CUT_LINES: Final = 0.02


def cut_place(low: float, high: float, share: float) -> float:
    """Return the place of a plane at a share of the way along a box."""
    return low + share * (high - low)


def cut_lines(diagonal: float) -> float:
    """Return the distance of the lines on cut faces, for the diagonal of a scene's box."""
    return CUT_LINES * diagonal


def measured(value: float, pixel: float) -> float:
    """Return a length rounded to about a hundredth of a pixel, as nobody points more exactly."""
    return rounded(value, 10.0 * pixel)
