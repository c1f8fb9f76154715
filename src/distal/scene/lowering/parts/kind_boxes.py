"""The boxes of all parts of a kind, computed together.

Input: a kind of parts. Output: arrays of corners, one row for each part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, Type, tuple_type
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.tree.calls import COLUMN
from distal.scene.tree.values import StatementList, Values

Floats = NDArray[np.float64]


def boxes_of(kind: PartKind) -> tuple[Floats, Floats, float]:
    """Return the low and the high corners of the parts of a kind, each (n, 3), and their slope."""
    found = executor().call(BoxOfKind(kind), tuple(columns_of(kind)), {}, device="reference")
    size = (len(kind.members), 3)
    low, high, slope = (np.asarray(part, np.float64) for part in found)
    return np.broadcast_to(low, size), np.broadcast_to(high, size), float(slope.max())


def columns_of(kind: PartKind) -> list[Floats]:
    """Return the columns of a kind's table: arrays (n,) or (n, components)."""
    return [np.array([n.value for n in column]) for column in zip(*kind.numbers, strict=True)]


class BoxOfKind(Composed):
    """The box and the slope of a part of a kind, from the numbers of its row."""

    def __init__(self, kind: PartKind) -> None:
        self.name = f"boxes of {kind.node.name}"
        self._kind = kind
        numbers = kind.numbers[0]
        self.signature = tuple((f"column_{i}", n.type) for i, n in enumerate(numbers))
        self.result: Type = tuple_type((VEC3, VEC3, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        for number, (name, type) in zip(self._kind.columns, self.signature, strict=True):
            assembly.made[COLUMN, number] = Read(name, type)
        values = Values(assembly)
        body = StatementList(taken={name for name, _ in self.signature})
        node = self._kind.node
        found = BoundsComposer(values).of(body, node, values.all(node))
        box = body.let("box", found.bounds)
        corners = Construct((field(box, "low"), field(box, "high"), found.slope), self.result)
        body.statements.append(Return(corners))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("box", params, self.result, body.statements)
