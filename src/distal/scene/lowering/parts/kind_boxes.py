"""The boxes of all parts of a kind, computed together.

Input: a kind of parts. Output: arrays of corners, one row for each part: at a time, or around all
places where a part may be at any time and for any values of the parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Type, tuple_type
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.tree.conversion import Plain
from distal.scene.tree.values import StatementList, Values

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class KindBounds:
    """What bounds the parts of a kind.

    Attributes:
        low: The low corners of their boxes (n, 3).
        high: The high corners (n, 3).
        slope: Lipschitz bound (slope) of each (n,).
        divisor: The number that makes distances of the values of each (n,).
        growth: How fast the sides of each box grow with the level (``fields.guarantees``) (n,).
    """

    low: Floats
    high: Floats
    slope: Floats
    divisor: Floats
    growth: Floats

    @staticmethod
    def of(kind: PartKind, found: Any) -> KindBounds:
        """Return what a function of a kind's columns found; one row stands for all parts."""
        count = len(kind.members)
        low, high, *numbers = (np.asarray(part, np.float64) for part in found)
        corners = (np.broadcast_to(corner, (count, 3)) for corner in (low, high))
        return KindBounds(*corners, *(np.broadcast_to(n, (count,)) for n in numbers))

    def chosen(self, fits: NDArray[np.bool_]) -> KindBounds:
        """Return the bounds of some of the parts."""
        parts = (self.low, self.high, self.slope, self.divisor, self.growth)
        return KindBounds(*(part[fits] for part in parts))


def bounds_of(kind: PartKind) -> KindBounds:
    """Return the bounds of the parts of a kind, for the defaults of parameters at time 0."""
    boxes, columns = BoxOfKind(kind), tuple(columns_of(kind))
    return KindBounds.of(kind, executor().call(boxes, columns, {}, device="reference"))


def swept_bounds_of(kind: PartKind) -> KindBounds:
    """Return bounds that hold at all times and for all values of the parameters.

    Where none are known, they are infinite.
    """
    if not kind.moving:
        return bounds_of(kind)
    ends = executor().sweep(BoxOfKind(kind), columns_of(kind))
    low = np.stack([np.broadcast_to(a, len(kind.members)) for a, _ in ends[:3]], axis=1)
    high = np.stack([np.broadcast_to(b, len(kind.members)) for _, b in ends[3:6]], axis=1)
    return KindBounds.of(kind, (low, high, *(end for _, end in ends[6:9])))


def columns_of(kind: PartKind) -> list[Floats]:
    """Return the columns of a kind's table: arrays (n,) or (n, components)."""
    columns = zip(kind.columns, zip(*kind.values, strict=True), strict=True)
    return [_array(column.floats, values) for column, values in columns]


def _array(floats: int, values: Sequence[Plain]) -> Floats:
    """Return one row of floats for each value, or a number for each if they have one float."""
    if floats == 1:
        return np.array(values, np.float64)
    flat = chain.from_iterable(cast("Sequence[tuple[float, ...]]", values))
    return np.fromiter(flat, np.float64, floats * len(values)).reshape(-1, floats)


class BoxOfKind(Composed):
    """The box, slope, divisor and growth of a part of a kind, from the numbers of its row."""

    def __init__(self, kind: PartKind) -> None:
        self.name = f"boxes of {kind.node.name}"
        self._kind = kind
        self.signature = tuple((f"column_{i}", c.type) for i, c in enumerate(kind.columns))
        corner = VEC2 if kind.node.flat else VEC3
        self.result: Type = tuple_type((corner, corner, FLOAT, FLOAT, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        self._kind.read(assembly, [Read(name, type) for name, type in self.signature])
        values = Values(assembly)
        body = StatementList(taken={name for name, _ in self.signature})
        node = self._kind.node
        found = BoundsComposer(values).of(body, node, values.all(node))
        box = body.let("box", found.bounds)
        corners = (field(box, "low"), field(box, "high"))
        parts = (*corners, found.slope, found.divisor, found.side_growth)
        body.statements.append(Return(Construct(parts, self.result)))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("box", params, self.result, body.statements)
