"""The width of a tree: the side of the largest cubic cells that find all of it.

Input: a tree whose primitives and operators declare their widths (``fields.widths``). Output: an
expression of numbers alone. Whether it is known does not depend on the numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from distal.fields.combine.joins import COMPLEMENT
from distal.fields.guarantees import UNBOUNDED, Operator, Primitive, Rule
from distal.ir.build import builtin, divide
from distal.ir.build import number as constant_number
from distal.ir.nodes import Expr
from distal.lang.functions import Func
from distal.scene.lowering.bounds import RememberedBounds, ShapeBounds
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values
from distal.scene.tree.varying import VaryingNumber

# 1 for what is a part of the solid, -1 for what is cut out of it.
SIDE = "side"
# How many times as fast the values of a shape change as those of the shape that it deforms.
STRETCH = "stretch"


def has_width(node: Node) -> bool:
    """Return whether the widths of all primitives of a tree are known.

    Those that differ from cell to cell, or from place to place, are not.
    """
    for inner in node.walk():
        rule = inner.rule
        varies = any(isinstance(value, VaryingNumber) for value in inner.constants.values())
        if varies or (isinstance(rule, Primitive) and rule.width is None):
            return False
    return True


class SurfaceBounds(RememberedBounds):
    """Bounds around surfaces alone: what is cut out has the box of its surface."""

    def _one(
        self, body: StatementList, rule: Operator, child: ShapeBounds, own: Mapping[str, Expr]
    ) -> ShapeBounds:
        return child if rule is COMPLEMENT else super()._one(body, rule, child, own)


class WidthComposer:
    """Composes the widths of subtrees.

    Args:
        values: The numbers of the program's nodes.
        bounds: The bounds of its subtrees.
    """

    def __init__(self, values: Values, bounds: SurfaceBounds) -> None:
        self._values = values
        self._bounds = bounds

    def of(self, body: StatementList, node: Node, values: Sequence[Expr]) -> Expr:
        """Return the width of a subtree; ``UNBOUNDED`` for primitives that declare none.

        Args:
            body: The statements to add to.
            node: The root of the subtree.
            values: The numbers of the subtree.
        """
        own, shares = self._values.split(node, values)
        rule = node.rule
        if isinstance(rule, Primitive):
            return self._number(body, UNBOUNDED if rule.width is None else rule.width, own)
        pairs = list(zip(node.children, shares, strict=True))
        inner = [self.of(body, child, share) for child, share in pairs]
        least = inner[0]
        for other in inner[1:]:
            least = body.let("width", builtin("min", least, other))
        if rule.width is None:
            return least
        given = {**own, **self._bounds.given(body, node, shares), "child_width": least}
        given[SIDE] = constant_number(_side_of(node.children[0]))
        if STRETCH in self._values.assembly.parameter_names(rule.width):
            whole = self._bounds.of(body, node, values).slope
            given[STRETCH] = body.let(STRETCH, divide(whole, given["slope"]))
        return self._number(body, rule.width, given)

    def _number(self, body: StatementList, rule: Rule, given: Mapping[str, Expr]) -> Expr:
        if isinstance(rule, Func):
            return body.let("width", self._values.assembly.call(rule, given))
        return constant_number(float(rule))


def _side_of(node: Node) -> float:
    """Return -1 if what is below operators on one shape is cut out, else 1."""
    side = 1.0
    while len(node.children) == 1:
        side = -side if node.rule is COMPLEMENT else side
        node = node.children[0]
    return side
