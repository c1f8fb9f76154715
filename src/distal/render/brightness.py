"""Tables of an environment map's brightness, by which paths choose directions.

Input: an equirectangular picture in linear light, top row first. Output: the cells that
``surroundings.sample_surroundings`` reads. Made once, in Python.
"""

from __future__ import annotations

import math
from typing import Any, Final

# The largest table: cells of 1.4 degrees. The share of directions that are spread over the whole
# sphere, because a cell may be black where its interpolated neighbors are not.
MOST_ROWS: Final = 128
MOST_COLUMNS: Final = 256
EVENLY: Final = 0.05


def brightness_table(texels: Any) -> tuple[int, int, list[tuple[float, float, float]]]:
    """Return rows, columns and the cells of a picture's table, for ``sample_surroundings``.

    Each cell has a threshold, the number of another cell, and the density of its directions by
    solid angle: of a random number, a cell and a fraction, the fraction chooses this cell or the
    other.

    Args:
        texels: Array (height, width, 3 or more) of linear light, top row first.

    Source: Michael Vose, "A Linear Algorithm For Generating Random Numbers With a Given
        Distribution" (1991).
    """
    height, width = int(texels.shape[0]), int(texels.shape[1])
    rows, columns = min(height, MOST_ROWS), min(width, MOST_COLUMNS)
    areas, lights = [], []
    for row in range(rows - 1, -1, -1):
        top, bottom = math.cos(math.pi * row / rows), math.cos(math.pi * (row + 1) / rows)
        area = 2.0 * math.pi / columns * (top - bottom)
        first, last = row * height // rows, (row + 1) * height // rows
        begin = max(first - 1, 0)  # with the rows beside, which it is interpolated with
        near = between_texels(texels[begin : last + 1, :, :3].max(axis=-1))
        band = near[first - begin : last - begin].mean(axis=0)
        for column in range(columns):
            part = band[column * width // columns : (column + 1) * width // columns]
            areas.append(area)
            lights.append(area * float(part.mean()))
    total = math.fsum(lights)
    even = EVENLY if total > 0.0 else 1.0
    scale = (1.0 - even) / total if total > 0.0 else 0.0
    chances = [
        even * area / (4.0 * math.pi) + scale * light
        for area, light in zip(areas, lights, strict=True)
    ]
    thresholds, others = alias_table(chances)
    cells = [
        (threshold, float(other), chance / area)
        for threshold, other, chance, area in zip(thresholds, others, chances, areas, strict=True)
    ]
    return rows, columns, cells


def between_texels(values: Any) -> Any:
    """Return the mean of the interpolated picture over the area of each texel.

    Linear interpolation gives an eighth of it to each neighbor across, and along. The picture ends
    at its top and bottom, and is closed around.

    Args:
        values: Array (height, width).
    """
    across = 0.75 * values + 0.125 * values[:, range(-1, values.shape[1] - 1)]
    across += 0.125 * values[:, [*range(1, values.shape[1]), 0]]
    above = across[[0, *range(values.shape[0] - 1)]]
    below = across[[*range(1, values.shape[0]), values.shape[0] - 1]]
    return 0.75 * across + 0.125 * (above + below)


def alias_table(chances: list[float]) -> tuple[list[float], list[int]]:
    """Return a threshold and another number for each number, by Vose's method.

    Args:
        chances: The probability of each number.
    """
    count = len(chances)
    total = math.fsum(chances)
    scaled = [chance * count / total for chance in chances]
    thresholds, others = [1.0] * count, list(range(count))
    small = [i for i in range(count) if scaled[i] < 1.0]
    large = [i for i in range(count) if scaled[i] >= 1.0]
    while small and large:
        low, high = small.pop(), large[-1]
        thresholds[low], others[low] = scaled[low], high
        scaled[high] -= 1.0 - scaled[low]
        if scaled[high] < 1.0:
            small.append(large.pop())
    return thresholds, others
