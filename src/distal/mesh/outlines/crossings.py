"""Whether closed polylines cross or touch: exact, in integers.

Input: polylines with integer coordinates below 2^29. Output: pairs of lines that meet where they
must not. Products of differences then have at most 61 bits.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from distal.mesh.outlines.tiles import Bools, Integers
from distal.polygons.whole_numbers import sorted_keys

LARGEST: Final = 2**29
_PAIRS_AT_ONCE: Final = 1 << 20


def crossing_lines(loops: list[Integers]) -> Integers:
    """Return the pairs of lines that have a point in common, of shape (n, 2).

    Lines are counted through all loops. Neighbors share their end, which is allowed; other common
    points are not.

    Args:
        loops: Points of each closed polyline, of shape (n, 2); the last is joined to the first.
    """
    starts = np.concatenate(loops)
    ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    offsets = np.cumsum([0, *(len(loop) for loop in loops)])
    following = np.arange(len(starts)) + 1
    following[offsets[1:] - 1] = offsets[:-1]
    first, second = _candidates(starts, ends)
    wrong = [np.empty((0, 2), np.int64)]
    for begin in range(0, len(first), _PAIRS_AT_ONCE):
        part = slice(begin, begin + _PAIRS_AT_ONCE)
        i, j = first[part], second[part]
        meets = _meet(starts[i], ends[i], starts[j], ends[j])
        # Where j follows i they share the end of i; they overlap if j turns straight back.
        for before, after in ((i, j), (j, i)):
            neighbors = following[before] == after
            back = _overlap(starts[before], ends[before], ends[after])
            meets = np.where(neighbors, back, meets)
        wrong.append(np.stack([i, j], axis=1)[meets])
    return np.concatenate(wrong)


def _candidates(starts: Integers, ends: Integers) -> tuple[Integers, Integers]:
    """Return pairs of lines whose pieces lie in one square of a grid, each pair once."""
    lengths = np.abs(ends - starts).max(axis=1)
    side = max(int(lengths.sum() // (len(lengths) + 16)), 1)
    counts = lengths // side + 1
    line = np.repeat(np.arange(len(starts)), counts)
    number = np.arange(len(line)) - np.repeat(np.cumsum(counts) - counts, counts)
    # A piece is within its two rounded ends, widened by one.
    way, count = (ends - starts)[line], counts[line][:, None]
    a = starts[line] + np.floor_divide(way * number[:, None], count)
    b = starts[line] + np.floor_divide(way * (number[:, None] + 1), count)
    low, high = (np.minimum(a, b) - 1) // side, (np.maximum(a, b) + 1) // side
    square, owner = [], []
    for x in range(int((high - low)[:, 0].max()) + 1):
        for y in range(int((high - low)[:, 1].max()) + 1):
            at = low + np.array((x, y))
            there = np.all(at <= high, axis=1)
            square.append((at[there, 0] + LARGEST << 31) + at[there, 1] + LARGEST)
            owner.append(line[there])
    return _pairs(np.concatenate(square), np.concatenate(owner))


def _pairs(square: Integers, owner: Integers) -> tuple[Integers, Integers]:
    """Return each pair of owners of one square, once."""
    order = np.lexsort((owner, square))
    square, owner = square[order], owner[order]
    found, gap = [np.empty(0, np.int64)], 1
    while True:
        same = np.flatnonzero(square[gap:] == square[:-gap]) if gap < len(square) else square[:0]
        if not len(same):
            break
        a, b = owner[same], owner[same + gap]  # in this order, since owners are sorted
        found.append(sorted_keys((a << 31 | b)[a != b]))
        gap += 1
    pairs = sorted_keys(np.concatenate(found))
    return pairs >> 31, pairs & (2**31 - 1)


def _side(a: Integers, b: Integers, p: Integers) -> Integers:
    """Return on which side of the line from a to b a point is: 1, 0 or -1."""
    way, to = b - a, p - a
    turned: Integers = np.sign(way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0])
    return turned


def _within(a: Integers, b: Integers, p: Integers) -> Bools:
    """Return whether a point on the line through a and b is between them."""
    found: Bools = np.all((np.minimum(a, b) <= p) & (p <= np.maximum(a, b)), axis=1)
    return found


def _meet(a: Integers, b: Integers, c: Integers, d: Integers) -> Bools:
    """Return whether the lines from a to b and from c to d have a point in common.

    Args:
        a: Start of the first line.
        b: End of the first line.
        c: Start of the second line.
        d: End of the second line.
    """
    of_c, of_d, of_a, of_b = _side(a, b, c), _side(a, b, d), _side(c, d, a), _side(c, d, b)
    meets: Bools = (of_c * of_d < 0) & (of_a * of_b < 0)
    for side, (p, q, r) in (
        (of_c, (a, b, c)),
        (of_d, (a, b, d)),
        (of_a, (c, d, a)),
        (of_b, (c, d, b)),
    ):
        meets |= (side == 0) & _within(p, q, r)
    return meets


def _overlap(a: Integers, b: Integers, d: Integers) -> Bools:
    """Return whether the line from b to d goes back along the line from a to b."""
    back = ((b - a) * (d - b)).sum(axis=1) < 0
    degenerate = np.all(a == b, axis=1) | np.all(b == d, axis=1)
    overlaps: Bools = (_side(a, b, d) == 0) & back | degenerate
    return overlaps
