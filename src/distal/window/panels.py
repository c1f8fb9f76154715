"""Panels: the small pictures that a window draws over the large one.

Input: pixels and a position. Output: a ``Panel``, clipped to the window, or blended into a picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """A small picture over the large one.

    Attributes:
        x: Pixels from the left of the window.
        y: Pixels from the top of the window.
        pixels: uint8, (height, width, 4), straight alpha.
    """

    x: int
    y: int
    pixels: NDArray[np.uint8]


def clipped(panel: Panel, size: tuple[int, int]) -> Panel:
    """Clip a panel to a window of the given size in pixels."""
    left, top = max(panel.x, 0), max(panel.y, 0)
    pixels = panel.pixels[top - panel.y : size[1] - panel.y, left - panel.x : size[0] - panel.x]
    if left >= size[0] or top >= size[1]:
        pixels = panel.pixels[:0]
    return Panel(left, top, pixels)


def blended(pixels: NDArray[np.float32], panels: Sequence[Panel]) -> NDArray[np.float32]:
    """Return a picture of display values with panels over it, the lowest first.

    Args:
        pixels: float32, (height, width, 4), straight alpha.
        panels: The panels, inside of the picture.
    """
    made = np.array(pixels, np.float32)
    for panel in panels:
        down, across = panel.pixels.shape[:2]
        under = made[panel.y : panel.y + down, panel.x : panel.x + across]
        over = panel.pixels.astype(np.float32) / 255.0
        share = over[..., 3:]
        alpha = share + under[..., 3:] * (1.0 - share)
        color = over[..., :3] * share + under[..., :3] * under[..., 3:] * (1.0 - share)
        under[..., :3] = np.where(alpha > 0.0, color / np.maximum(alpha, 1e-6), under[..., :3])
        under[..., 3:] = alpha
    return made
