"""Whether eight cells can be one: what their samples say, as scene code.

Input: the samples of a block of cells. Output: a distance. One row for each block. Needs no field.
"""

from __future__ import annotations

from distal.lang import abs, array, func, length, max, vec3


@func
def unsaid_by_corners(values: array[float, 27], size: float) -> float:  # type: ignore[valid-type]
    """Return how far a block's surface is from what its corners say.

    Between the corners values are interpolated. The other samples close to the surface differ from
    that by a distance, to first order.

    Args:
        values: The samples, three along each axis: z fastest, then y, then x.
        size: The side of the block.
    """
    slope = vec3(0.0)
    for j in range(8):
        corner = values[j // 4 * 18 + j // 2 % 2 * 6 + j % 2 * 2]
        slope += vec3(
            corner if j // 4 == 1 else -corner,
            corner if j // 2 % 2 == 1 else -corner,
            corner if j % 2 == 1 else -corner,
        )
    # The mean change over the block; half of it is as far away as the block's middle is.
    change = max(length(slope) * 0.25, 1e-300)
    largest = 0.0
    for i in range(27):
        total = 0.0
        for j in range(8):
            corner = values[j // 4 * 18 + j // 2 % 2 * 6 + j % 2 * 2]
            weight = share(i // 9, j // 4) * share(i // 3 % 3, j // 2 % 2) * share(i % 3, j % 2)
            total += weight * corner
        if abs(values[i]) < 0.5 * change:
            largest = max(largest, abs(total - values[i]))
    return largest * size / change


@func
def share(place: int, end: int) -> float:
    """Return the weight of an end of an interval, 0 or 1, at its start, its middle or its end."""
    upper = 0.5 * float(place)
    return upper if end == 1 else 1.0 - upper
