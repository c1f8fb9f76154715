"""Where the appearance jumps: on lines, and within triangles.

Input: ends of lines or corners of triangles, and a function that gives the appearance of places as
rows of numbers. Output: the place on each line; whether there is one. Does not depend on meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeAlias

import numpy as np

from distal.mesh import triangle_arithmetic
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Bools, Floats, Integers

# From places, (n, 3), to their appearance, (n, k): colors and other numbers, about 0 to 1.
Appearance: TypeAlias = Callable[[Floats], Floats]
# From the numbers of some sides, and a share of each, to the appearance there.
_Seen: TypeAlias = Callable[[Integers, Floats], Floats]

# Numbers that change by less are the same appearance.
DIFFERENT: Final = 1.0 / 256.0
# Borders closer to the end of a side than this share of it are moved to the end.
NEAR_END: Final = 0.01
# Sides are looked at in so many pieces, so a strip that is wider than a piece is seen.
PIECES: Final = 4
# A piece is halved so often: its last part is 1e-6 of the side.
_HALVINGS: Final = 18
# A gradient is narrow if half of a side has this share of its change, and the change is visible.
_HELD: Final = 0.8
_VISIBLE: Final = 1.0 / 16.0


def border_between(a: Floats, b: Floats, appearance: Appearance, *, narrow: bool) -> Floats:
    """Return the share of the way from a to b at which the appearance jumps; 0 if nowhere.

    Args:
        a: The first end of each side.
        b: The second.
        appearance: Gives the appearance of places.
        narrow: Whether narrow gradients count.
    """

    def seen(rows: Any, share: Any) -> Floats:
        return appearance(rows_of(triangle_arithmetic.along, a[rows], b[rows], share))

    every = np.arange(len(a))
    ends = np.linspace(0.0, 1.0, PIECES + 1)
    samples = np.stack([seen(every, np.full(len(a), end)) for end in ends], axis=1)
    changes = change(samples[:, :-1], samples[:, 1:])
    piece = np.argmax(changes, axis=1)
    rows = np.flatnonzero(changes[every, piece] > DIFFERENT)
    found = np.zeros(len(a))
    if not len(rows):
        return found
    piece = piece[rows]
    low, high = (samples[rows, piece], samples[rows, piece + 1])
    share, jumps = _jump(seen, rows, ends[piece], ends[piece + 1], low, high)
    found[rows[jumps]] = share[jumps]
    if narrow:
        rows = rows[~jumps]
        halves = change(samples[rows][:, :-2], samples[rows][:, 2:])
        first = np.argmax(halves, axis=1)
        held = halves[np.arange(len(rows)), first]
        some = held > np.maximum(_HELD * change(samples[rows, 0], samples[rows, -1]), _VISIBLE)
        rows, first = rows[some], first[some]
        low, high = samples[rows, first], samples[rows, first + 2]
        found[rows] = _middle_of_change(seen, rows, ends[first], ends[first + 2], low, high)
    found[(found < NEAR_END) | (found > 1.0 - NEAR_END)] = 0.0
    return found


def _jump(
    seen: _Seen, rows: Integers, low: Floats, high: Floats, at_low: Floats, at_high: Floats
) -> tuple[Floats, Bools]:
    """Return where the appearance changes most within a part of each side, and whether it jumps.

    Args:
        seen: Gives the appearance at a share of some sides.
        rows: The sides.
        low: The share at which the part begins.
        high: The share at which it ends.
        at_low: The appearance at its beginning.
        at_high: The appearance at its end.
    """
    for _halving in range(_HALVINGS):
        middle = (low + high) / 2.0
        at_middle = seen(rows, middle)
        upper = change(at_middle, at_high) > change(at_low, at_middle)
        low, high = np.where(upper, middle, low), np.where(upper, high, middle)
        at_low = np.where(upper[:, None], at_middle, at_low)
        at_high = np.where(upper[:, None], at_high, at_middle)
    return (low + high) / 2.0, change(at_low, at_high) > DIFFERENT


def _middle_of_change(
    seen: _Seen, rows: Integers, low: Floats, high: Floats, at_low: Floats, at_high: Floats
) -> Floats:
    """Return where the appearance becomes closer to that at the end of a part of each side.

    Args:
        seen: Gives the appearance at a share of some sides.
        rows: The sides.
        low: The share at which the part begins.
        high: The share at which it ends.
        at_low: The appearance at its beginning.
        at_high: The appearance at its end.
    """
    if not len(rows):
        return low
    for _halving in range(_HALVINGS):
        middle = (low + high) / 2.0
        at_middle = seen(rows, middle)
        upper = change(at_low, at_middle) < change(at_middle, at_high)
        low, high = np.where(upper, middle, low), np.where(upper, high, middle)
    return (low + high) / 2.0


def change(one: Floats, other: Floats) -> Floats:
    """Return the largest difference of any number of two appearances."""
    found: Floats = np.abs(one - other).max(axis=-1)
    return found


def has_border(corners: Floats, count: int, appearance: Appearance) -> Bools:
    """Return in which triangles the appearance jumps.

    Args:
        corners: Of shape (n, 3, 3).
        count: How many pieces there are along each side.
        appearance: Gives the appearance of places.
    """
    a, b = (grid.reshape(-1) for grid in np.meshgrid(*[np.arange(count + 1)] * 2, indexing="ij"))
    inside = a + b <= count
    number = np.full((count + 1, count + 1), -1, np.int64)
    number[a[inside], b[inside]] = np.arange(int(inside.sum()))
    weights = np.stack([count - a - b, a, b], axis=1)[inside] / count
    places = np.einsum("kc,ncd->nkd", weights, corners)
    seen = appearance(places.reshape(-1, 3)).reshape(*places.shape[:2], -1)
    pairs = [(number[:-1].reshape(-1), number[1:].reshape(-1))]
    pairs.append((number[:, :-1].reshape(-1), number[:, 1:].reshape(-1)))
    one, other = (np.concatenate([pair[i] for pair in pairs]) for i in range(2))
    one, other = one[(one >= 0) & (other >= 0)], other[(one >= 0) & (other >= 0)]
    changes = change(seen[:, one], seen[:, other])
    pair = changes.argmax(axis=1)
    every = np.arange(len(corners))
    rows = np.flatnonzero(changes[every, pair] > DIFFERENT)
    found = np.zeros(len(corners), np.bool_)
    if len(rows):
        low, high = places[rows, one[pair[rows]]], places[rows, other[pair[rows]]]
        jump = border_between(low, high, appearance, narrow=False)
        found[rows] = jump > 0.0
    return found


def has_two_borders(a: Floats, b: Floats, appearance: Appearance) -> Bools:
    """Return on which lines from a to b the appearance jumps twice."""
    ends = [
        rows_of(triangle_arithmetic.along, a, b, np.full(len(a), share))
        for share in np.linspace(0.0, 1.0, PIECES + 1)
    ]
    changes = change(*(np.stack([appearance(p) for p in e], axis=1) for e in (ends[:-1], ends[1:])))
    found = np.zeros(len(a), np.bool_)
    rows = np.flatnonzero((changes > DIFFERENT).sum(axis=1) > 1)
    if len(rows):
        two = np.argsort(-changes[rows], axis=1, kind="stable")[:, :2]
        places = np.stack(ends, axis=1)
        jumps = [
            border_between(
                places[rows, two[:, i]], places[rows, two[:, i] + 1], appearance, narrow=False
            )
            > 0.0
            for i in range(2)
        ]
        found[rows] = jumps[0] & jumps[1]
    return found
