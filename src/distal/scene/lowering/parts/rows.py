"""The rows of a table of parts, and the tree of their boxes, as arrays.

Input: kinds of parts. Output: buffers. A row is a few vec4: the number of the kind, that of the
part among those of its kind, then the columns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from distal.fields.guarantees import ENDLESS
from distal.lang.resources import Buffer
from distal.scene.lowering.parts.box_tree import box_tree
from distal.scene.lowering.parts.kind_boxes import (
    Floats,
    KindBounds,
    bounds_of,
    columns_of,
    swept_bounds_of,
)
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.lowering.parts.moving_boxes import MovingBoxes, is_refitted
from distal.scene.lowering.parts.table import (
    ENDLESS_MOTION,
    ENDLESS_SLOPE,
    INFINITE,
    PartTable,
)


@dataclass(frozen=True, slots=True)
class Rows:
    """The parts that a table can hold.

    Attributes:
        kinds: The kinds, without their other parts.
        first: The bounds of the parts of each kind, for the defaults of parameters at time 0.
        swept: Bounds that hold at all times and for all values of the parameters.
        refused: The other parts, with the reason.
    """

    kinds: Sequence[PartKind]
    first: Sequence[KindBounds]
    swept: Sequence[KindBounds]
    refused: Mapping[int, str]

    @property
    def count(self) -> int:
        """The number of parts."""
        return sum(len(kind.members) for kind in self.kinds)

    def table(self) -> PartTable:
        """Return the table of the parts."""
        factors = [1.0 / np.maximum(swept.divisor, 1.0) for swept in self.swept]
        rows, places = row_data(self.kinds, factors)
        order = box_tree(*_corners(self.first), places)
        low, high = _corners(self.swept)
        boxes = Buffer(order.filled(low, high))
        if any(map(is_refitted, self.kinds)):
            boxes = MovingBoxes.of_kinds(boxes.data, self.kinds, self.swept, order)
        lowest, highest = low.min(axis=0).tolist(), high.max(axis=0).tolist()
        corners = tuple(lowest), tuple(highest)
        slope, divisor = (
            max(float(getattr(swept, name).max()) for swept in self.swept)
            for name in ("slope", "divisor")
        )
        return PartTable(self.kinds, boxes, Buffer(rows), *corners, slope, divisor)


def _corners(bounds: Sequence[KindBounds]) -> tuple[Floats, Floats]:
    low, high = ([getattr(b, name) for b in bounds] for name in ("low", "high"))
    return np.concatenate(low), np.concatenate(high)


def rows_of(kinds: Sequence[PartKind]) -> Rows:
    """Return the parts of several kinds that a table can hold.

    A table holds a part if it has a finite box at all times and for all values of the parameters,
    and a number that makes distances of its values.
    """
    held: list[PartKind] = []
    firsts: list[KindBounds] = []
    swepts: list[KindBounds] = []
    refused: dict[int, str] = {}
    for kind in kinds:
        first = bounds_of(kind)
        swept = swept_bounds_of(kind) if kind.moving else first
        rules = (
            (INFINITE, _is_finite(first)),
            (ENDLESS_MOTION, _is_finite(swept)),
            (ENDLESS_SLOPE, np.asarray(swept.divisor < ENDLESS)),  # False for NaN
        )
        fits = np.ones(len(kind.members), bool)
        for reason, keeps in rules:
            for i in np.flatnonzero(fits & ~keeps).tolist():
                refused[id(kind.members[i])] = reason
            fits &= keeps
        if fits.any():
            held.append(_chosen(kind, fits))
            firsts.append(first.chosen(fits))
            swepts.append(swept.chosen(fits))
    return Rows(held, firsts, swepts, refused)


def _is_finite(bounds: KindBounds) -> NDArray[np.bool_]:
    farthest = np.maximum(np.abs(bounds.low), np.abs(bounds.high)).max(axis=1)
    return np.asarray(farthest < ENDLESS)  # False for NaN


def _chosen(kind: PartKind, chosen: NDArray[np.bool_]) -> PartKind:
    if chosen.all():
        return kind
    members = [m for m, keep in zip(kind.members, chosen, strict=True) if keep]
    values = [row for row, keep in zip(kind.values, chosen, strict=True) if keep]
    return replace(kind, members=members, values=values)


def row_data(
    kinds: Sequence[PartKind], factors: Sequence[Floats]
) -> tuple[Floats, NDArray[np.int64]]:
    """Return the rows of all parts, and the number of each part's first vec4.

    ``factors`` are the numbers that make distances of the parts' values, by kind.
    """
    rows: list[Floats] = []
    places: list[NDArray[np.int64]] = []
    begin = 0
    for k, kind in enumerate(kinds):
        count = len(kind.members)
        made = np.zeros((count, 4 * kind.stride))
        made[:, 0] = k
        made[:, 1] = np.arange(count)
        for column, values in zip(kind.columns, columns_of(kind), strict=True):
            made[:, column.first : column.first + column.floats] = values.reshape(count, -1)
        if kind.factor is not None:
            made[:, kind.factor] = factors[k]
        rows.append(made.reshape(-1, 4))
        places.append(begin + kind.stride * np.arange(count))
        begin += kind.stride * count
    return np.concatenate(rows), np.concatenate(places)
