"""Fewer colors, for printers that have a few filaments.

Input: linear colors of triangles and a number. Output: the same rows with at most so many different
colors: each the mean of those that it stands for. Which belong together, Pillow's median cut and
k-means decide, in display values.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.mesh.files.parts import display_codes
from distal.mesh.solid import Floats, Integers
from distal.packages import imported

MOST: Final = 256
# Rows of the image that Pillow is given have at most this length.
_WIDTH: Final = 4096


def reduced(colors: Floats, count: int) -> Floats:
    """Return the colors with at most ``count`` different ones.

    Args:
        colors: Linear, of shape (n, 3).
        count: From 1 to 256.
    """
    if len(np.unique(colors, axis=0)) <= count:
        return colors
    groups = _groups(display_codes(colors), count)
    sizes = np.bincount(groups, minlength=count)
    sums = [np.bincount(groups, colors[:, i], minlength=count) for i in range(3)]
    means: Floats = np.stack(sums, axis=1) / np.maximum(sizes, 1)[:, None]
    return means[groups]


def _groups(codes: NDArray[np.uint8], count: int) -> Integers:
    """Return the number of the group of each color."""
    pillow = imported("PIL.Image")
    padding = -len(codes) % min(_WIDTH, len(codes))
    rows = np.concatenate([codes, codes[:1].repeat(padding, axis=0)])
    image = pillow.fromarray(rows.reshape(-1, min(_WIDTH, len(codes)), 3))
    made = image.quantize(count, method=pillow.Quantize.MEDIANCUT, kmeans=1)
    return np.asarray(made).reshape(-1)[: len(codes)].astype(np.int64)
