"""What is asked of a shape besides its distance, as functions: its gradient, its promises.

Input: a tree. Output: objects that the executor runs.
"""

from __future__ import annotations

from distal.frontend import Assembly
from distal.ir.build import field as field_of
from distal.ir.nodes import Construct, Gradient, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, tuple_type
from distal.lang.composed import Composed
from distal.scene.lowering.bounds import Promises
from distal.scene.lowering.shapes import ZERO_CELL, Composer
from distal.scene.tree.node import Node
from distal.scene.tree.values import Body, Values, plain_name


class GradientOf(Composed):
    """The gradient of a shape, as a function."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"gradient of {node.name}"
        self.result = VEC2 if node.flat else VEC3
        self.signature = (("p", self.result),)

    def compose(self, assembly: Assembly) -> str:
        """The function of a point."""
        node = self._node
        composer = Composer(assembly, [node])
        field = composer.field(node, composer.values.all(node), ZERO_CELL)
        p = Read("p", self.result)
        value = Gradient(field, p, False, self.result)
        params = (Param("p", self.result),)
        name = f"{plain_name(node.name)}_gradient"
        return assembly.define(name, params, self.result, (Return(value),), node.place)


class PromiseOf(Composed):
    """Slope, divisor, box and growth of a shape, as a function of nothing."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"promise of {node.name}"
        self.signature = ()
        corner = VEC2 if node.flat else VEC3
        self.result = tuple_type((FLOAT, FLOAT, corner, corner, FLOAT, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """The function that gives (slope, divisor, low, high, growth, side_growth)."""
        body, node = Body(), self._node
        values = Values(assembly)
        found = Promises(values).of(body, node, values.all(node))
        bounds = body.let("bounds", found.bounds)
        low, high = field_of(bounds, "low"), field_of(bounds, "high")
        parts = (found.slope, found.divisor, low, high, found.growth, found.side_growth)
        whole = Construct(parts, self.result)
        body.statements.append(Return(whole))
        return assembly.define("promise", (), self.result, body.statements, node.place)
