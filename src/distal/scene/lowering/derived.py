"""A shape's gradient and bounds, as functions that can be called.

Input: a tree. Output: objects that the executor runs.
"""

from __future__ import annotations

from typing import Final

from distal.frontend import Assembly
from distal.ir.nodes import Call, Gradient, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, tuple_type
from distal.lang.composed import Composed
from distal.scene.lowering.bounds import BoundsComposer, packed_types
from distal.scene.lowering.parts.table import RowsNode, rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values, plain_name

# With more parts that move, the box is one for all times and all values of parameters: its function
# would be long.
MOST_MOVING: Final = 512


class DistanceOf(Composed):
    """The value of a shape, as a function of a point."""

    result = FLOAT

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = node.name
        self.signature = (("p", VEC2 if node.flat else VEC3),)

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node, ((_, point),) = self._node, self.signature
        composer = ShapeComposer(assembly, [node])
        field = composer.field(node, composer.values.all(node), ZERO_CELL)
        value = Call(field.name, (Read("p", point), *field.captures), FLOAT)
        name = f"{plain_name(node.name)}_value"
        return assembly.define(name, (Param("p", point),), FLOAT, (Return(value),), node.place)


class GradientOf(Composed):
    """The gradient of a shape, as a function of a point."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"gradient of {node.name}"
        self.result = VEC2 if node.flat else VEC3
        self.signature = (("p", self.result),)

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = rolled_for(assembly, self._node, exact=True)
        composer = ShapeComposer(assembly, [node])
        field = composer.field(node, composer.values.all(node), ZERO_CELL)
        p = Read("p", self.result)
        value = Gradient(field, p, False, self.result)
        params = (Param("p", self.result),)
        name = f"{plain_name(node.name)}_gradient"
        return assembly.define(name, params, self.result, (Return(value),), node.place)


class BoundsOf(Composed):
    """Slope, divisor, box and growth of a shape, as a function without arguments."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"bounds of {node.name}"
        self.signature = ()
        self.result = tuple_type(packed_types(node.flat))

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name.

        It returns (slope, divisor, low, high, growth, side_growth).
        """
        body, node = StatementList(), rolled_for(assembly, self._node)
        moves = any(isinstance(n, RowsNode) and n.table.moves for n in node.walk())
        if moves and self._node.parts <= MOST_MOVING:
            node = self._node  # the box of a table holds its parts at all times
        values = Values(assembly)
        found = BoundsComposer(values).of(body, node, values.all(node))
        found = found.emptied(body, assembly.call)
        body.statements.append(Return(found.packed(body)))
        return assembly.define("bounds", (), self.result, body.statements, node.place)
