"""The size of a solid, measured: boxes that shapes declare may be larger.

Input: a shape's kernels and the box that it declares. Output: the largest side of the solid itself.
Does not depend on cells: it decides how long they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from distal.ir.types import VEC3, Type
from distal.mesh.arithmetic import distance_to_field, distance_value, smooth_point
from distal.mesh.bricks import HALF_DIAGONAL
from distal.mesh.extract import Extent
from distal.mesh.kernels import FieldKernels
from distal.mesh.solid import Bools, Floats
from distal.mesh.tables import CORNERS

# Blocks along the largest side of the box at first.
_FIRST: Final = 8
# Blocks are halved until none sticks out of the part of the solid that is known by more than this
# share of the declared box, or until there are so many.
_CLOSE: Final = 1.0 / 64.0
_MOST_BLOCKS: Final = 20_000
# A declared box is tight if the solid is at least this share of its largest side.
_TIGHT: Final = 0.97
# A point is one of the surface if it is closer than this share of a block.
_ON_SURFACE: Final = 1e-3
_P: Final[list[tuple[str, Type]]] = [("p", VEC3)]
_CLAMPED: Final[list[tuple[str, Type]]] = [("mean", VEC3), ("low", VEC3), ("high", VEC3)]


def with_size(kernels: FieldKernels, extent: Extent) -> Extent:
    """Return an extent with the size of the solid, if its box is clearly larger.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
    """
    measured = largest_side(kernels, extent)
    return replace(extent, measured=measured) if measured < _TIGHT * extent.size else extent


def largest_side(kernels: FieldKernels, extent: Extent) -> float:
    """Return the largest side of a box around a solid, but for a share of its size.

    Where it is not certain, it is larger, up to that of the declared box. Where that is tight, the
    work ends as soon as this is known.

    Args:
        kernels: The shape.
        extent: The box that it declares, and its slope.
    """
    side = extent.size / _FIRST
    x, y, z = np.maximum(np.ceil((extent.high - extent.low) / side).astype(np.int64), 1).tolist()
    middles = extent.low + side * (np.indices((x, y, z)).reshape(3, -1).T + 0.5)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    while len(middles) <= _MOST_BLOCKS:
        middles, points = _looked_at(kernels, extent, middles, side)
        if len(points):
            low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
        largest = float((high - low).max())
        if largest >= _TIGHT * extent.size:
            return extent.size
        if len(middles):
            beyond = _reaches_out(middles, 0.5 * side, low, high, _CLOSE * extent.size)
            middles = middles[beyond]
        if not len(middles):
            return largest if largest > 0.0 else extent.size
        side *= 0.5
        middles = (middles[:, None] + side * (np.array(CORNERS) - 0.5)[None]).reshape(-1, 3)
    low = np.minimum(low, np.maximum(middles.min(axis=0) - 0.5 * side, extent.low))
    high = np.maximum(high, np.minimum(middles.max(axis=0) + 0.5 * side, extent.high))
    return float((high - low).max())


def _looked_at(
    kernels: FieldKernels, extent: Extent, middles: Floats, side: float
) -> tuple[Floats, Floats]:
    """Return the blocks that may contain a part of the solid, and points of the solid."""
    values = kernels.call(distance_value, middles, types=_P)
    slopes = extent.slopes
    reach = min(slopes.divisor, slopes.slope) * side * HALF_DIAGONAL
    middles, values = middles[~(values > reach)], values[~(values > reach)]
    if not len(middles):
        return middles, middles
    ends = middles - 0.5 * side, middles + 0.5 * side
    near = kernels.call(smooth_point, middles, *ends, types=_CLAMPED)
    off = kernels.call(distance_to_field, near, types=_P)
    return middles, np.concatenate([middles[values <= 0.0], near[off <= _ON_SURFACE * side]])


def _reaches_out(middles: Floats, half: float, low: Floats, high: Floats, close: float) -> Bools:
    """Return the blocks that can make the largest side of a box larger, by more than is close."""
    beyond = (middles - half < low - close) | (middles + half > high + close)
    least, most = (middles - half).min(axis=0), (middles + half).max(axis=0)
    largest = (high - low).max() + close
    found: Bools = np.any(
        beyond & (np.maximum(most, high) - np.minimum(least, low) > largest), axis=1
    )
    return found
