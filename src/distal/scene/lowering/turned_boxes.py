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
from distal.fields.place.flat import UPRIGHT_TURNS
from distal.fields.turned_boxes import (
    carried_box,
    turned_hull,
    turned_overlap,
    upright_box,
    upright_rectangle,
)
from distal.ir.build import compose, number
from distal.ir.nodes import Expr
from distal.ir.types import VEC2, VEC3
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
_AXES: Final = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def is_turned(node: Node) -> bool:
    """Return whether a subtree has a box along axes of its own, other than those of space."""
    return node.derived("is turned", lambda: _is_turned(node))


def _is_turned(node: Node) -> bool:
    rule = node.rule
    if isinstance(rule, Primitive) or node.has_rows:
        return False
    if rule.turn is not None:
        return rule.turn not in UPRIGHT_TURNS or is_turned(node.children[0])
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
            make = upright_rectangle if node.flat else upright_box
            return body.let("axes", self._call(make, upright))
        rule = node.rule
        assert isinstance(rule, Operator)
        own, shares = self._values.split(node, values)
        if rule.turn is not None:
            inner = self.of(body, node.children[0], shares[0])
            return self._carried(body, rule, own, inner, flat=node.flat)
        if rule.bounds is first_box:
            return self.of(body, node.children[0], shares[0])
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
        turned = takewhile(lambda pair: is_turned(pair[0]), pairs)
        boxes = (self.of(body, child, share) for child, share in turned)
        both = accumulate(boxes, lambda a, b: body.let("axes", self._call(rule, {"a": a, "b": b})))
        return list(both)[1:]

    def _carried(
        self, body: StatementList, rule: Operator, own: dict[str, Expr], inner: Expr, *, flat: bool
    ) -> Expr:
        """Return the box of a shape after a rigid move or a uniform scale.

        Args:
            body: The statements to add to.
            rule: The operator.
            own: The operator's numbers, by name.
            inner: The box before.
            flat: Whether the shape lies in the plane, which keeps the z axis.
        """
        assert rule.turn is not None
        given = {**own, "cell": ZERO_CELL}
        found = {"inner": inner, "origin": number(0.0, VEC3), "factor": number(1.0)}
        if rule.point is not None:
            origin = number(0.0, VEC2 if flat else VEC3)
            found["origin"] = _in_space(self._call(rule.point, {**given, "p": origin}))
        for name, axis in zip("xyz", _AXES, strict=True):
            found[f"turned_{name}"] = way = compose(VEC3, *map(number, axis))
            if flat and name == "z":
                continue
            p = compose(VEC2, *map(number, axis[:2])) if flat else way
            found[f"turned_{name}"] = _in_space(self._call(rule.turn, {**given, "p": p}))
        if rule.finish is not None:
            found["factor"] = self._call(rule.finish, {**given, "d": number(1.0)})
        return body.let("axes", self._call(carried_box, found))


def _in_space(v: Expr) -> Expr:
    return v if v.type is VEC3 else compose(VEC3, v, number(0.0))
