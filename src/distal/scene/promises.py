"""What a tree promises: a bound on its slope, a safe divisor for marching, a box around it.

What flows in: nodes and the rules of their rows. What flows out: expressions of numbers alone,
which every target computes once a frame: parameters move them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from distal.fields.boxes import everywhere, everywhere2, hull, hull2
from distal.fields.claims import Bounds2, Claim, Operator, Primitive
from distal.ir.build import builtin, multiply
from distal.ir.build import number as constant_number
from distal.ir.nodes import Expr
from distal.lang.functions import Func
from distal.scene.node import Node
from distal.scene.values import Body, Values


@dataclass(frozen=True, slots=True)
class Promise:
    """What is known of a subtree.

    Attributes:
        slope: Bound on |gradient| everywhere.
        divisor: What to divide the value by for a step that never passes the surface.
        bounds: ``Bounds`` or ``Bounds2`` around surface and inside.
    """

    slope: Expr
    divisor: Expr
    bounds: Expr


# What rules, and the functions of operators, may ask of the children.
PROMISED: Final = frozenset(("slope", "slope_a", "slope_b", "bounds", "bounds_a", "bounds_b"))


class Promises:
    """Composes the promises of subtrees."""

    def __init__(self, values: Values) -> None:
        self._values = values
        self._call = values.assembly.call

    def of(self, body: Body, node: Node, values: Sequence[Expr]) -> Promise:
        """The promise of a subtree with these numbers."""
        own, shares = self._values.split(node, values)
        rule = node.rule
        if isinstance(rule, Primitive):
            return self._leaf(body, node, rule, own)
        inner = [
            self.of(body, child, share) for child, share in zip(node.children, shares, strict=True)
        ]
        if len(inner) == 1:
            return self._one(body, rule, inner[0], own)
        if rule.bounds is None and rule.slope is None:
            return self._halved(body, rule, inner, own)
        result = inner[0]
        for other in inner[1:]:
            result = self._two(body, rule, result, other, own)
        return result

    def _halved(
        self, body: Body, rule: Operator, inner: Sequence[Promise], own: Mapping[str, Expr]
    ) -> Promise:
        """Many joined, the halves first: a chain of hundreds would be as deep as it is long."""
        if len(inner) == 1:
            return inner[0]
        middle = len(inner) // 2
        a = self._halved(body, rule, inner[:middle], own)
        return self._two(body, rule, a, self._halved(body, rule, inner[middle:], own), own)

    def given(self, body: Body, node: Node, shares: Sequence[Sequence[Expr]]) -> dict[str, Expr]:
        """What the children promise, under the names that an operator's functions ask for."""
        inner = [
            self.of(body, child, share) for child, share in zip(node.children, shares, strict=True)
        ]
        return _named(inner[0], inner[1] if len(inner) > 1 else None)

    def _leaf(self, body: Body, node: Node, rule: Primitive, own: Mapping[str, Expr]) -> Promise:
        slope: Expr = constant_number(1.0)
        if isinstance(rule.slope, Func):
            slope = body.let("slope", self._call(rule.slope, own))
        else:
            slope = constant_number(rule.slope)
        whole = everywhere2 if node.flat else everywhere
        bounds = body.let("bounds", self._call(rule.bounds or whole, own))
        lower = Claim.LOWER_BOUND in rule.claims
        return Promise(slope, constant_number(1.0) if lower else slope, bounds)

    def _one(self, body: Body, rule: Operator, child: Promise, own: Mapping[str, Expr]) -> Promise:
        given = {**own, **_named(child, None)}
        slope = self._slope(body, rule, child.slope, given)
        bounds = child.bounds
        if rule.bounds is not None:
            bounds = body.let("bounds", self._call(rule.bounds, given))
        kept = Claim.LOWER_BOUND in rule.keeps
        return Promise(slope, child.divisor if kept else slope, bounds)

    def _two(
        self, body: Body, rule: Operator, a: Promise, b: Promise, own: Mapping[str, Expr]
    ) -> Promise:
        given = {**own, **_named(a, b)}
        larger = body.let("slope", builtin("max", a.slope, b.slope))
        slope = self._slope(body, rule, larger, given)
        flat = a.bounds.type is self._values.assembly.struct(Bounds2)
        around = rule.bounds or (hull2 if flat else hull)
        bounds = body.let("bounds", self._call(around, given))
        divisor = slope
        if Claim.LOWER_BOUND in rule.keeps:
            divisor = body.let("divisor", builtin("max", a.divisor, b.divisor))
        return Promise(slope, divisor, bounds)

    def _slope(self, body: Body, rule: Operator, child: Expr, given: Mapping[str, Expr]) -> Expr:
        if rule.slope is None:
            return child
        if isinstance(rule.slope, Func):
            return body.let("slope", self._call(rule.slope, given))
        return body.let("slope", multiply(child, constant_number(rule.slope)))


class RememberedPromises(Promises):
    """Promises of one function: that of every node is made once, and kept."""

    def __init__(self, values: Values) -> None:
        super().__init__(values)
        self.found: dict[int, Promise] = {}

    def of(self, body: Body, node: Node, values: Sequence[Expr]) -> Promise:
        """The promise of a subtree, made once."""
        known = self.found.get(id(node))
        if known is None:
            known = self.found[id(node)] = super().of(body, node, values)
        return known


def _named(a: Promise, b: Promise | None) -> dict[str, Expr]:
    if b is None:
        return {"slope": a.slope, "bounds": a.bounds}
    return {
        "slope_a": a.slope,
        "slope_b": b.slope,
        "bounds_a": a.bounds,
        "bounds_b": b.bounds,
    }
