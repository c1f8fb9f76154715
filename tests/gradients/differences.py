"""Slopes by finite differences in 64 bits, and where there are none.

Input: a function of many points. Output: its slopes along each axis, and a mask of
the points where the function is smooth enough to have them. The mask looks at the function's values
alone, so it cannot hide a wrong gradient.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]
Function = Callable[[Doubles], Doubles]

# Of the longest step; the others are a half and a quarter. Error and rounding meet near it: fourth
# derivatives of 1e4 change the bend by 1e-8, rounding changes a slope by 1e-16 / 3e-5.
STEP: Final = 2.0**-13
TOLERANCE: Final = 1e-7


@dataclass(frozen=True, slots=True)
class Slopes:
    """Slopes at points, (n, size), and where they can be trusted, (n,)."""

    slopes: Doubles
    smooth: NDArray[np.bool_]

    def disagreement(self, gradient: Doubles) -> Doubles:
        """How far a gradient is off at each point, in units of what is allowed; 0 where unknown."""
        scale = 1.0 + np.abs(self.slopes).max(axis=1, keepdims=True)
        off = (np.abs(gradient - self.slopes) / (scale * TOLERANCE)).max(axis=1)
        off = np.where(np.isfinite(off), off, np.inf)
        return np.where(self.smooth, off, 0.0)


def differences(function: Function, points: Doubles) -> Slopes:
    """Measure a function of (n, size) points, or of (n,) numbers for size 1."""
    here = function(points)
    flat = points.reshape(len(points), -1)
    columns, masks = [], []
    for axis in range(flat.shape[1]):
        slope, smooth = _along(function, points, here, axis)
        columns.append(slope)
        masks.append(smooth)
    return Slopes(np.stack(columns, axis=1), np.logical_and.reduce(masks))


def _along(function: Function, points: Doubles, here: Doubles, axis: int) -> Any:
    direction = np.zeros((1, points.reshape(len(points), -1).shape[1]))
    direction[0, axis] = 1.0
    direction = direction.reshape((1,) * (points.ndim - 1) + (-1,))[..., : points.shape[-1]]
    if points.ndim == 1:
        direction = np.ones(1)
    central, gaps = [], []
    for step in (STEP, STEP / 2, STEP / 4):
        ahead = (function(points + step * direction) - here) / step
        behind = (here - function(points - step * direction)) / step
        central.append((ahead + behind) / 2)
        gaps.append(ahead - behind)
    # One-sided slopes differ by the bend times the step, which halves with it, unless a crease or a
    # jump lies within the step.
    scale = 1.0 + np.abs(central[2])
    bent = np.maximum(np.abs(gaps[0] - 2 * gaps[1]), np.abs(gaps[1] - 2 * gaps[2]))
    # Richardson's extrapolation of the two shorter steps.
    slope = (4 * central[2] - central[1]) / 3
    return slope, (bent <= TOLERANCE * scale) & np.isfinite(slope)
