"""The bounds of every shape of a tree as numbers: slope, divisor, box.

Input: a tree. Output: bounds for each node, computed in one call.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from distal.fields.guarantees import ended
from distal.frontend import Assembly
from distal.ir.build import compose, index, number, swizzle
from distal.ir.build import field as field_of
from distal.ir.nodes import Construct, Expr, Param, Read, Return
from distal.ir.types import FLOAT, INT, VEC3, Array, Vector, tuple_type
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.bounds import RememberedBounds, ShapeBounds
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values


@dataclass(frozen=True, slots=True)
class NodeBounds:
    """The bounds of a shape at one time, for one set of parameter values.

    Attributes:
        slope: Bound on |gradient|.
        divisor: Number by which marchers divide distances.
        low: Lower corner of its box; a flat shape's third number is 0.
        high: Upper corner.
    """

    slope: float
    divisor: float
    low: tuple[float, ...]
    high: tuple[float, ...]

    @property
    def finite(self) -> bool:
        """Whether the box is finite on all sides."""
        return all(map(np.isfinite, (*self.low, *self.high)))


def bounds_of_nodes(root: Node, params: Mapping[str, Any], time: float) -> dict[int, NodeBounds]:
    """Return the bounds of each node of a tree, by the id of the node.

    Args:
        root: The root of the tree.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
    """
    nodes = list(root.walk())
    which = np.arange(len(nodes), dtype=np.int32)
    asked = _BoundsByNumber(root, nodes)
    # Interpreted, because compiling the bounds of a thousand shapes takes half a minute.
    rows = executor().call(asked, (which,), {}, params=params, time=time, device="reference")
    slopes, divisors, lows, highs = (np.asarray(part, np.float64) for part in rows)
    return {
        id(node): NodeBounds(
            ended(slopes[i]),
            ended(divisors[i]),
            tuple(map(ended, lows[i])),
            tuple(map(ended, highs[i])),
        )
        for i, node in enumerate(nodes)
    }


class _BoundsByNumber(Composed):
    """The bounds of a node, selected by its number."""

    def __init__(self, root: Node, nodes: Sequence[Node]) -> None:
        self._root, self._nodes = root, nodes
        self.name = f"bounds of {root.name}"
        self.signature = (("i", INT),)
        self.result = tuple_type((FLOAT, FLOAT, VEC3, VEC3))

    def compose(self, assembly: Assembly) -> str:
        """Add the function of the number, and return its name."""
        body = StatementList(taken={"i"})
        values = Values(assembly)
        composer = RememberedBounds(values)
        composer.of(body, self._root, values.all(self._root))
        rows = []
        for node in self._nodes:
            # What is below a turn was asked for its box along other axes.
            own = composer.found.get(id(node)) or composer.of(body, node, values.all(node))
            rows.append(_columns(own))
        which = Read("i", INT)
        picked: list[Expr] = []
        # One list for each column: a chain of a thousand ifs would be too deep for the passes.
        for name, column in zip(
            ("slope", "divisor", "low", "high"), zip(*rows, strict=True), strict=True
        ):
            whole = Construct(column, Array(column[0].type, len(column)))
            picked.append(index(body.let(name, whole), which))
        body.statements.append(Return(Construct(tuple(picked), self.result)))
        params = (Param("i", INT),)
        return assembly.define("bounds", params, self.result, body.statements)


def _columns(bounds: ShapeBounds) -> tuple[Expr, ...]:
    corners = (field_of(bounds.bounds, name) for name in ("low", "high"))
    return (bounds.slope, bounds.divisor, *map(_in_space, corners))


def _in_space(corner: Expr) -> Expr:
    assert isinstance(corner.type, Vector)
    if corner.type is VEC3:
        return corner
    return compose(VEC3, swizzle(corner, "x"), swizzle(corner, "y"), number(0.0))
