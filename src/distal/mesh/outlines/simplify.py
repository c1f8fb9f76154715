"""Leave out points of closed polylines that are not needed within a distance.

Input: polylines and a distance. Output: the indices of the points that stay. Corners stay if they
are farther from the line of the others. The result may cross itself; the caller tests it.

Source: David Douglas, Thomas Peucker, "Algorithms for the Reduction of the Number of Points
    Required to Represent a Digitized Line or its Caricature" (1973).
"""

from __future__ import annotations

import numpy as np

from distal.mesh.kernels import rows_of
from distal.mesh.outlines.arithmetic import distance_to_line
from distal.mesh.outlines.tiles import Bools, Floats, Integers


def kept_points(loops: list[Floats], corners: list[Bools], distance: float) -> list[Integers]:
    """Return which points of each polyline stay, at least three.

    Args:
        loops: Points of each closed polyline, of shape (n, 2).
        corners: Which of them are corners of the shape.
        distance: How far a point that is left out may be from the line that replaces it.
    """
    firsts = [_first(loop, corner) for loop, corner in zip(loops, corners, strict=True)]
    turned = [np.roll(loop, -first, axis=0) for loop, first in zip(loops, firsts, strict=True)]
    points = np.concatenate([np.concatenate([loop, loop[:1]]) for loop in turned])
    offsets = np.cumsum([0, *(len(loop) + 1 for loop in loops)])
    keep = np.zeros(len(points), np.bool_)
    low, high = _halves(turned, offsets[:-1])
    keep[low] = True
    # The first point is far from the second one, and a third makes the loop a triangle at least.
    at, reach = _farthest(points, low, high)
    best = np.where(reach[::2] >= reach[1::2], at[::2], at[1::2])
    keep[best] = True
    while len(low):
        at, reach = _farthest(points, low, high)
        split = keep[at] | (reach > distance)
        keep[at[split]] = True
        low, at, high = low[split], at[split], high[split]
        low, high = np.concatenate([low, at]), np.concatenate([at, high])
        longer = high - low > 1
        low, high = low[longer], high[longer]
    found = []
    for loop, begin, first in zip(turned, offsets[:-1], firsts, strict=True):
        kept = _without_straight(loop, np.flatnonzero(keep[begin : begin + len(loop)]))
        found.append((kept + first) % len(loop))
    return found


def _first(loop: Floats, corner: Bools) -> int:
    """Return the point with which a polyline begins: its first corner, else its leftmost point."""
    if corner.any():
        return int(np.argmax(corner))
    return int(np.lexsort((loop[:, 1], loop[:, 0]))[0])


def _halves(loops: list[Floats], offsets: Integers) -> tuple[Integers, Integers]:
    """Return two chains for each loop: to the point farthest from the first one, and back."""
    low, high = [], []
    for loop, offset in zip(loops, offsets.tolist(), strict=True):
        away = ((loop - loop[0]) ** 2).sum(axis=1)
        middle = min(max(int(np.argmax(away)), 2), len(loop) - 2)
        low += [offset, offset + middle]
        high += [offset + middle, offset + len(loop)]
    return np.array(low, np.int64), np.array(high, np.int64)


def _farthest(points: Floats, low: Integers, high: Integers) -> tuple[Integers, Floats]:
    """Return the point of each chain that is farthest from the line between its ends, and how far.

    Args:
        points: All points.
        low: The first point of each chain.
        high: The last point of each chain, at least two after the first.
    """
    counts = high - low - 1
    begins = np.cumsum(counts) - counts
    chain = np.repeat(np.arange(len(low)), counts)
    inner = np.arange(len(chain)) - begins[chain] + low[chain] + 1
    away = rows_of(distance_to_line, points[inner], points[low[chain]], points[high[chain]])
    most = np.maximum.reduceat(away, begins)
    hits = np.flatnonzero(away == most[chain])
    _, first = np.unique(chain[hits], return_index=True)
    return inner[hits[first]], most


def _without_straight(loop: Floats, kept: Integers) -> Integers:
    """Return the points that stay, without those on the line between their neighbors."""
    found = loop[kept]
    if len(kept) > 3:
        before, after = np.roll(found, 1, axis=0), np.roll(found, -1, axis=0)
        size = float(np.ptp(found, axis=0).max())
        straight = rows_of(distance_to_line, found, before, after) < 1e-9 * size
        straight &= ~np.roll(straight, 1)
        if len(kept) - int(straight.sum()) >= 3:
            kept = kept[~straight]
    return kept
