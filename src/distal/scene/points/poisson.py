"""Poisson-disk samples: points that are random, but never nearer to each other than a distance.

Input: candidates in random order, and a distance or a count. Output: indices of the candidates that
are kept. A candidate is kept if no kept one before it is nearer than the distance ("dart
throwing"). All decisions are comparisons of distances in double precision, so the same candidates
give the same points on every machine. Does not depend on where candidates come from.

Source: Cook, "Stochastic Sampling in Computer Graphics", 1986. The parallel form, in which every
candidate that comes before all of its rivals is kept at once, is that of Blelloch, Fineman and
Shun, "Greedy Sequential Maximal Independent Set and Matching are Parallel on Average", 2012; it
gives the same result as the sequential one.
"""

from __future__ import annotations

import itertools
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.int64]
Mask: TypeAlias = NDArray[np.bool_]

# The share of a line, an area or a volume that is covered by disks of half the distance when no
# candidate is left (random sequential addition: Renyi 1958; Feder 1980; Talbot et al. 1991), with a
# margin.
COVERED: Final = {1: 0.76, 2: 0.56, 3: 0.40}
# Volume of a ball of diameter 1 in one, two and three dimensions.
BALL: Final = {1: 1.0, 2: np.pi / 4.0, 3: np.pi / 6.0}
# How near the count that a distance gives is to the requested one when the search ends.
CLOSE_ENOUGH: Final = 0.01
MOST_STEPS: Final = 16


def count_for(distance: float, size: float, dimensions: int) -> float:
    """Return about how many points have a distance from each other.

    Args:
        distance: The least distance of points.
        size: Length, area or volume of the domain.
        dimensions: 1, 2 or 3.
    """
    return COVERED[dimensions] * size / (BALL[dimensions] * distance**dimensions)


def distance_for(count: int, size: float, dimensions: int) -> float:
    """Return about the largest distance that so many points may have from each other.

    Args:
        count: Number of points.
        size: Length, area or volume of the domain.
        dimensions: 1, 2 or 3.
    """
    covered = COVERED[dimensions] * size / (BALL[dimensions] * count)
    return float(covered ** (1.0 / dimensions))


def kept_with_distance(candidates: Floats, distance: float) -> Indices:
    """Return the candidates to keep, in their order, so that none are nearer than ``distance``."""
    first, second, _ = near_pairs(candidates, distance)
    return _independent(len(candidates), first, second)


def kept_of_count(
    candidates: Floats, inside: Mask, count: int, longest: float, dimensions: int
) -> Indices:
    """Return ``count`` candidates that are as far from each other as found.

    A search finds a distance that keeps the count or a little more; of these, the first are kept.

    Args:
        candidates: The candidates in random order.
        inside: Which of them may be kept, at least ``count``; others only keep these away.
        count: How many to keep.
        longest: A distance at which fewer than ``count`` are kept, or not many more.
        dimensions: 1, 2 or 3: the count is in inverse proportion to this power of the distance.
    """
    first, second, apart = near_pairs(candidates, longest)
    low, high, distance = 0.0, longest, longest
    best = np.flatnonzero(inside)[:count]
    for _ in range(MOST_STEPS):
        near = apart < distance
        kept = _independent(len(candidates), first[near], second[near])
        kept = kept[inside[kept]]
        if len(kept) < count:
            high = distance
            first, second, apart = first[near], second[near], apart[near]
        else:
            low, best = distance, kept[:count]
            if distance == longest or len(kept) <= (1.0 + CLOSE_ENOUGH) * count:
                break
        aim = (1.0 + 0.5 * CLOSE_ENOUGH) * count
        distance *= float((len(kept) / aim) ** (1.0 / dimensions))
        if not low < distance < high:
            distance = 0.5 * (low + high)
    return best


def near_pairs(points: Floats, distance: float) -> tuple[Indices, Indices, Floats]:
    """Return all pairs of points that are nearer than a distance: indices, and their distances.

    The first index of a pair is the smaller one. Points are sorted into cells as large as the
    distance, so that pairs are in the same cell or in adjacent ones.
    """
    cells = np.floor((points - points.min(axis=0)) / distance).astype(np.int64) + 1
    sizes = cells.max(axis=0) + 2
    weights = np.concatenate((np.cumprod(sizes[::-1])[-2::-1], [1]))
    keys = cells @ weights
    order = np.argsort(keys, kind="stable")
    sorted_keys = keys[order]
    ordered = points[order]
    firsts, seconds, distances = [], [], []
    # Half of the neighbors: the others find these.
    around = itertools.product((-1, 0, 1), repeat=points.shape[1])
    for offset in (o for o in around if o >= (0,) * len(o)):
        wanted = sorted_keys + np.dot(offset, weights)
        start = np.searchsorted(sorted_keys, wanted, side="left")
        end = np.searchsorted(sorted_keys, wanted, side="right")
        if not any(offset):
            start = np.arange(len(order)) + 1  # each pair in a cell once
        counts = np.maximum(end - start, 0)
        own = np.repeat(np.arange(len(order)), counts)
        skipped = np.cumsum(counts) - counts
        other = np.arange(len(own)) + np.repeat(start - skipped, counts)
        step = ordered[own] - ordered[other]
        squared = np.einsum("ij,ij->i", step, step)
        near = squared < distance * distance
        firsts.append(order[own[near]])
        seconds.append(order[other[near]])
        distances.append(np.sqrt(squared[near]))
    a, b = np.concatenate(firsts), np.concatenate(seconds)
    return np.minimum(a, b), np.maximum(a, b), np.concatenate(distances)


def _independent(count: int, first: Indices, second: Indices) -> Indices:
    """Return the items that greedy choice keeps: each with no kept item before it among its rivals.

    Args:
        count: Number of items.
        first: The smaller index of each pair of rivals.
        second: The larger index of each pair.
    """
    undecided = np.ones(count, dtype=np.bool_)
    kept = np.zeros(count, dtype=np.bool_)
    while len(first):
        # An item is kept if no undecided rival comes before it.
        later = np.zeros(count, dtype=np.bool_)
        later[second] = True
        now = undecided & ~later
        kept |= now
        undecided &= ~now
        undecided[second[now[first]]] = False
        left = undecided[first] & undecided[second]
        first, second = first[left], second[left]
    kept |= undecided
    return np.flatnonzero(kept)
