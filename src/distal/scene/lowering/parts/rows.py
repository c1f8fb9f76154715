"""The rows of a table of parts, and the tree of their boxes, as arrays.

Input: kinds of parts. Output: buffers. A row is a few vec4: the number of the kind, that of the
part among those of its kind, then the columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from distal.fields.guarantees import ENDLESS
from distal.lang.resources import Buffer
from distal.scene.lowering.parts.box_tree import box_tree
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.kind_boxes import boxes_of, columns_of
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.lowering.parts.table import PartTable


@dataclass(frozen=True, slots=True)
class Rows:
    """The parts with finite boxes.

    Attributes:
        kinds: The kinds, without their infinite parts.
        low: The low corners of the boxes, kind after kind.
        high: The high corners.
        slope: Lipschitz bound (slope) of all parts.
        infinite: The other parts.
    """

    kinds: Sequence[PartKind]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    slope: float
    infinite: Sequence[UnionMember]

    @property
    def count(self) -> int:
        """The number of parts with finite boxes."""
        return len(self.low)

    def table(self) -> PartTable:
        """Return the table of the parts with finite boxes."""
        rows, places = _rows(self.kinds)
        tree = box_tree(self.low, self.high, places)
        low, high = self.low.min(axis=0), self.high.max(axis=0)
        corners = tuple(map(float, low)), tuple(map(float, high))
        return PartTable(self.kinds, Buffer(tree), Buffer(rows), *corners, self.slope)


def rows_of(kinds: Sequence[PartKind]) -> Rows:
    """Return the parts of several kinds that have finite boxes."""
    finite: list[PartKind] = []
    infinite: list[UnionMember] = []
    steepest = 0.0
    lows, highs = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for kind in kinds:
        low, high, slope = boxes_of(kind)
        farthest = np.maximum(np.abs(low), np.abs(high)).max(axis=1)
        is_finite = np.asarray(farthest < ENDLESS)  # False for NaN
        infinite += [m for m, found in zip(kind.members, is_finite, strict=True) if not found]
        if is_finite.any():
            finite.append(_chosen(kind, is_finite))
            lows.append(low[is_finite])
            highs.append(high[is_finite])
            steepest = max(steepest, slope)
    return Rows(finite, np.concatenate(lows), np.concatenate(highs), steepest, infinite)


def _chosen(kind: PartKind, chosen: NDArray[np.bool_]) -> PartKind:
    if chosen.all():
        return kind
    members = [m for m, keep in zip(kind.members, chosen, strict=True) if keep]
    numbers = [row for row, keep in zip(kind.numbers, chosen, strict=True) if keep]
    return replace(kind, members=members, numbers=numbers)


def _rows(kinds: Sequence[PartKind]) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Return the rows of all parts, and the number of each part's first vec4."""
    rows: list[NDArray[np.float32]] = []
    places: list[NDArray[np.int64]] = []
    begin = 0
    for k, kind in enumerate(kinds):
        count = len(kind.members)
        made = np.zeros((count, 4 * kind.stride), np.float32)
        made[:, 0] = k
        made[:, 1] = np.arange(count)
        for first, column in zip(kind.columns.values(), columns_of(kind), strict=True):
            values = column.reshape(count, -1)
            made[:, first : first + values.shape[1]] = values
        rows.append(made.reshape(-1, 4))
        places.append(begin + kind.stride * np.arange(count))
        begin += kind.stride * count
    return np.concatenate(rows), np.concatenate(places)
