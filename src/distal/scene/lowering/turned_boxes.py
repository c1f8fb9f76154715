"""Boxes of shapes that were turned, along their own axes.

Input: nodes. Output: expressions of numbers alone, which every target computes once per frame. The
box of a turned shape along the axes of space is larger than the shape; the box along the shape's
own axes is not, so that its sides lie in the faces of what was turned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate, takewhile
from typing import Final

from distal.fields.combine.joins import first_box
from distal.fields.extents import hull_of, overlap
from distal.fields.guarantees import Operator, Primitive
from distal.fields.place.solid import same_direction
from distal.fields.turned_boxes import carried_box, turned_hull, turned_overlap, upright_box
from distal.ir.build import compose, number
from distal.ir.nodes import Expr
from distal.ir.types import VEC3
from distal.lang.functions import Func
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values
from distal.scene.tree.varying import ZERO_CELL

# What the box of a combination is, by the rule of the box along the axes of space.
_COMBINED: Final[dict[Func | None, Func]] = {
    None: turned_hull,
    hull_of: turned_hull,
    overlap: turned_overlap,
}
_UNITS: Final = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def is_turned(node: Node) -> bool:
    """Return whether a subtree has a box along axes of its own, other than those of space."""
    return node.derived("is turned", lambda: _is_turned(node))


def _is_turned(node: Node) -> bool:
    rule = node.rule
    if node.flat or isinstance(rule, Primitive) or node.has_rows:
        return False
    if rule.turn is not None:
        return rule.turn is not same_direction or is_turned(node.children[0])
    if rule.combine is None or rule.point is not None or rule.finish is not None:
        return False
    if rule.bounds is first_box:
        return is_turned(node.children[0])
    return rule.bounds in _COMBINED and all(map(is_turned, node.children))


class TurnedBoxes:
    """Composes the boxes of turned subtrees as IR expressions."""

    def __init__(self, values: Values, bounds: BoundsComposer) -> None:
        self._values = values
        self._bounds = bounds
        self._call: Callable[..., Expr] = values.assembly.call

    def of(self, body: StatementList, node: Node, values: Sequence[Expr]) -> Expr:
        """Return the box of a subtree along its own axes, a ``TurnedBox``.

        Args:
            body: The statements to add to.
            node: The root of the subtree.
            values: The numbers of the subtree.
        """
        if not is_turned(node):
            upright = {"bounds": self._bounds.of(body, node, values).bounds}
            return body.let("axes", self._call(upright_box, upright))
        rule = node.rule
        assert isinstance(rule, Operator)
        own, shares = self._values.split(node, values)
        if rule.turn is not None or rule.bounds is first_box:
            inner = self.of(body, node.children[0], shares[0])
            return inner if rule.turn is None else self._carried(body, rule, own, inner)
        return self.joined(body, node, shares)[-1]

    def joined(
        self, body: StatementList, node: Node, shares: Sequence[Sequence[Expr]]
    ) -> list[Expr]:
        """Return the box of the first two children of a combination, of the first three, and so on.

        They end before the first child that is not turned.

        Args:
            body: The statements to add to.
            node: The node of the combination.
            shares: The numbers of each child.
        """
        assert isinstance(node.rule, Operator)
        rule = _COMBINED[node.rule.bounds]
        pairs = zip(node.children, shares, strict=True)
        turned = (
            self.of(body, *pair) for pair in takewhile(lambda pair: is_turned(pair[0]), pairs)
        )
        both = accumulate(turned, lambda a, b: body.let("axes", self._call(rule, {"a": a, "b": b})))
        return list(both)[1:]

    def _carried(
        self, body: StatementList, rule: Operator, own: dict[str, Expr], inner: Expr
    ) -> Expr:
        given = {**own, "cell": ZERO_CELL}
        origin: Expr = number(0.0, VEC3)
        if rule.point is not None:
            origin = self._call(rule.point, {**given, "p": origin})
        found = {"inner": inner, "origin": origin, "factor": number(1.0)}
        assert rule.turn is not None
        for name, unit in zip("xyz", _UNITS, strict=True):
            axis = compose(VEC3, *map(number, unit))
            found[f"turned_{name}"] = self._call(rule.turn, {**given, "p": axis})
        if rule.finish is not None:
            found["factor"] = self._call(rule.finish, {**given, "d": number(1.0)})
        return body.let("axes", self._call(carried_box, found))
