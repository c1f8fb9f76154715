"""Fewer colors, for printers that have a few filaments.

Input: linear colors and a number. Output: a palette of at most so many colors, each the mean of
those that it stands for, and the nearest of them for any color. Which belong together, Pillow's
median cut and k-means decide, in display values.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.mesh import triangle_arithmetic
from distal.mesh.files.parts import display_codes, display_values
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Floats, Integers
from distal.packages import imported

MOST: Final = 256
# Rows of the image that Pillow is given have at most this length.
_WIDTH: Final = 4096


def palette_of(colors: Floats, count: int) -> Floats:
    """Return at most ``count`` colors that stand for many: the means of their groups.

    Args:
        colors: Linear, of shape (n, 3).
        count: From 1 to 256.
    """
    found: Floats = np.unique(colors, axis=0)
    if len(found) <= count:
        return found
    groups = _groups(display_codes(colors), count)
    sizes = np.bincount(groups, minlength=count)
    sums = [np.bincount(groups, colors[:, i], minlength=count) for i in range(3)]
    means: Floats = np.stack(sums, axis=1)[sizes > 0] / sizes[sizes > 0, None]
    return means


def nearest(palette: Floats, colors: Floats) -> Floats:
    """Return the color of a palette that is nearest to each color, in display values.

    Args:
        palette: Linear, of shape (k, 3).
        colors: Linear, of shape (n, 3).
    """
    known, shown = display_values(palette), display_values(colors)
    least, which = np.full(len(colors), np.inf), np.zeros(len(colors), np.int64)
    for number, entry in enumerate(known):
        distance = rows_of(triangle_arithmetic.between, shown, np.broadcast_to(entry, shown.shape))
        which[distance < least] = number
        least = np.minimum(least, distance)
    return palette[which]


def _groups(codes: NDArray[np.uint8], count: int) -> Integers:
    """Return the number of the group of each color."""
    pillow = imported("PIL.Image")
    padding = -len(codes) % min(_WIDTH, len(codes))
    rows = np.concatenate([codes, codes[:1].repeat(padding, axis=0)])
    image = pillow.fromarray(rows.reshape(-1, min(_WIDTH, len(codes)), 3))
    made = image.quantize(count, method=pillow.Quantize.MEDIANCUT, kmeans=1)
    return np.asarray(made).reshape(-1)[: len(codes)].astype(np.int64)
