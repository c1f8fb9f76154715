"""Bounds of a tree: its Lipschitz bound (slope), a divisor for marching, its box, its growth.

Input: nodes and the rules of their primitives and operators. Output: expressions of numbers alone,
which every target computes once per frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, assert_never

from distal.fields.boxes import everywhere, everywhere2, hull, hull2
from distal.fields.combine.alternatives import NOTHINGS, SELECT, box_if
from distal.fields.combine.joins import COMPLEMENT
from distal.fields.extents import overlap
from distal.fields.guarantees import (
    BOUNDS_OF_CHILD,
    UNBOUNDED,
    Bounds,
    Bounds2,
    Growth,
    Guarantee,
    Operator,
    Primitive,
    Rule,
)
from distal.fields.repeat.varied import IN_CELLS
from distal.ir.build import builtin, field, multiply, select
from distal.ir.build import number as constant_number
from distal.ir.contents import contents
from distal.ir.nodes import Call, Const, Construct, Expr, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Type, tuple_type
from distal.lang.functions import Func
from distal.scene.lowering.box_axes import (
    AT_ONCE,
    BoxAxes,
    is_cut_twice,
    is_move,
    passes_axes,
    turns_boxes_again,
)
from distal.scene.lowering.existence import NEVER, exists_after, exists_of_either
from distal.scene.lowering.parts.table import PartTable, RowsNode
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values, plain_name
from distal.scene.tree.varying import varied_in


@dataclass(frozen=True, slots=True)
class ShapeBounds:
    """The bounds of a subtree.

    Attributes:
        slope: Bound on |gradient| everywhere.
        divisor: Number by which a value is divided to get a step that never passes the surface.
        bounds: ``Bounds`` or ``Bounds2`` around the surface and the inside.
        growth: How far from the box a point may be, at most, for each unit of its value.
        side_growth: The same for each side of the box.
        exists: Whether there is anything, a bool; None if there always is. Where there is nothing,
            the others are those of what would be there, or of what it is united with.
    """

    slope: Expr
    divisor: Expr
    bounds: Expr
    growth: Expr
    side_growth: Expr
    exists: Expr | None = None

    def emptied(self, body: StatementList, call: Callable[..., Expr]) -> ShapeBounds:
        """Return the bounds with a box that contains no point where there is nothing.

        Args:
            body: The statements to add to.
            call: Adds a call of a library function (``Assembly.call``).
        """
        if self.exists is None:
            return self
        box = body.let("bounds", call(box_if, {"bounds": self.bounds, "exists": self.exists}))
        return replace(self, bounds=box)

    def packed(self, body: StatementList) -> Expr:
        """Return (slope, divisor, low, high, growth, side_growth) as one ``packed_type``."""
        bounds = body.let("bounds", self.bounds)
        low, high = field(bounds, "low"), field(bounds, "high")
        parts = (self.slope, self.divisor, low, high, self.growth, self.side_growth)
        return Construct(parts, tuple_type(tuple(part.type for part in parts)))


PACKED: Final = ("slope", "divisor", "low", "high", "growth", "side_growth")


def packed_types(flat: bool) -> tuple[Type, ...]:
    """Return the types of the parts of ``packed``."""
    corner = VEC2 if flat else VEC3
    return (FLOAT, FLOAT, corner, corner, FLOAT, FLOAT)


ONE: Final = constant_number(1.0)
UNKNOWN: Final = constant_number(UNBOUNDED)


# The names of ``packed`` as attributes.
PARTS_OF_BOUNDS: Final = ("slope", "divisor", "bounds", "growth", "side_growth")

# The parts of bounds that are numbers, and constant for many shapes.
NUMBERS: Final = ("slope", "divisor", "growth", "side_growth")


def _is_closed(values: Sequence[Expr]) -> bool:
    """Return whether values are the same in every function: they read no parameters or locals."""
    return not any(contents(value).reads for value in values)


def _folds(rule: Operator) -> bool:
    """Return whether an operator's bounds are composed child by child, because order matters."""
    return rule.bounds is not None or rule.slope is not None


class BoundsComposer:
    """Composes the bounds of subtrees as IR expressions."""

    def __init__(self, values: Values) -> None:
        self._values = values
        self._call = values.assembly.call

    def of(
        self,
        body: StatementList,
        node: Node,
        values: Sequence[Expr],
        axes: BoxAxes | None = None,
    ) -> ShapeBounds:
        """Return the bounds of a subtree with these numbers.

        Args:
            body: The statements to add to.
            node: The root of the subtree.
            values: The numbers of the subtree.
            axes: The axes of the box, seen from the subtree; None for those of its own space.
        """
        if axes is not None or turns_boxes_again(node):
            return self._along(body, node, values, axes or BoxAxes.own())
        if isinstance(node, RowsNode):
            return self._of_table(node.table)
        own, shares = self._values.split(node, values)
        rule = node.rule
        if isinstance(rule, Primitive):
            return self.of_primitive(body, rule, own, flat=node.flat)
        children = list(zip(node.children, shares, strict=True))
        is_grouped = len(children) > AT_ONCE and _is_closed(values) and not _folds(rule)
        if is_grouped and not varied_in(node):
            return self._of_many(body, rule, children, own, flat=node.flat)
        inner = [self.of(body, child, share) for child, share in children]
        return self.of_operator(body, rule, inner, own)

    def _along(
        self, body: StatementList, node: Node, values: Sequence[Expr], axes: BoxAxes
    ) -> ShapeBounds:
        """Return the bounds of a subtree with a box along some axes."""
        if not passes_axes(node):
            # How far the values grow is known of the shape's own box, in any direction.
            found = self.of(body, node, values)
            box = axes.box(body, self._call, found.bounds)
            return replace(found, bounds=box, side_growth=found.growth)
        own, shares = self._values.split(node, values)
        rule = node.rule
        assert isinstance(rule, Operator)
        if is_move(rule):
            below = axes.below(body, self._call, rule, own)
            found = self.of(body, node.children[0], shares[0], below)
            return replace(found, bounds=axes.above(body, self._call, rule, own, found.bounds))
        children = list(zip(node.children, shares, strict=True))
        below = axes.inside(rule)
        inner = [self.of(body, child, share, below) for child, share in children]
        found = self.of_operator(body, rule, inner, own)
        if not is_cut_twice(rule, axes):
            return found
        plain = BoxAxes.own(below.overlaps)
        inner = [self.of(body, child, share, plain) for child, share in children]
        turned = self.of_operator(body, rule, inner, own)
        both = {
            "bounds_a": found.bounds,
            "bounds_b": axes.box(body, self._call, turned.bounds),
        }
        box = body.let("bounds", self._call(overlap, both))
        # A side of the turned box is as far as its corner, and a corner of both is passed by sides.
        side_growth = _larger(body, "side_growth", found.side_growth, turned.growth)
        growth = _corner_growth(body, side_growth, 3)
        return replace(found, bounds=box, growth=growth, side_growth=side_growth)

    def _of_many(
        self,
        body: StatementList,
        rule: Operator,
        children: Sequence[tuple[Node, Sequence[Expr]]],
        own: Mapping[str, Expr],
        *,
        flat: bool,
    ) -> ShapeBounds:
        """Return the bounds of an operator on many children: a function for each group of them.

        Each value of the per-frame part repeats what it is computed from, except functions.
        """
        groups = -(-len(children) // AT_ONCE)
        groups = min(groups, AT_ONCE)
        ends = [len(children) * g // groups for g in range(groups + 1)]
        inner = [
            self._of_group(body, rule, children[start:stop], own, flat=flat)
            for start, stop in pairwise(ends)
        ]
        return self.of_operator(body, rule, inner, own)

    def _of_group(
        self,
        body: StatementList,
        rule: Operator,
        children: Sequence[tuple[Node, Sequence[Expr]]],
        own: Mapping[str, Expr],
        *,
        flat: bool,
    ) -> ShapeBounds:
        inside = StatementList()
        if len(children) > AT_ONCE:
            found = self._of_many(inside, rule, children, own, flat=flat)
        else:
            inner = [self.of(inside, child, share) for child, share in children]
            found = self.of_operator(inside, rule, inner, own)
        box = inside.let("bounds", found.bounds)
        numbers = {n: getattr(found, n) for n in NUMBERS}
        varying = {n: e for n, e in numbers.items() if not isinstance(e, Const)}
        if found.exists is not None:
            varying["exists"] = found.exists
        parts = (field(box, "low"), field(box, "high"), *varying.values())
        packed = tuple_type(tuple(part.type for part in parts))
        inside.statements.append(Return(Construct(parts, packed)))
        assembly = self._values.assembly
        name = assembly.define(f"{plain_name(rule.name)}_bounds", (), packed, inside.statements)
        group = body.let("group", Call(name, (), packed))
        low, high, *rest = (field(group, f"item{i}") for i in range(len(parts)))
        numbers |= dict(zip(varying, rest, strict=True))
        corners = Construct((low, high), assembly.struct(Bounds2 if flat else Bounds))
        return ShapeBounds(bounds=corners, **numbers)

    def _of_table(self, table: PartTable) -> ShapeBounds:
        corners = (
            self._values.fixed("parts_low", VEC3, table.low),
            self._values.fixed("parts_high", VEC3, table.high),
        )
        slope = constant_number(table.slope)
        divisor = constant_number(table.divisor) if table.needs_factors else ONE
        box = Construct(corners, self._values.assembly.struct(Bounds))
        bricks = table.programs.bricks if table.programs is not None else None
        growth = UNKNOWN if bricks is None else constant_number(bricks.growth)
        corner = growth if bricks is None else _corner_growth(StatementList(), growth, 3)
        return ShapeBounds(slope, divisor, box, corner, growth)

    def of_operator(
        self,
        body: StatementList,
        rule: Operator,
        inner: Sequence[ShapeBounds],
        own: Mapping[str, Expr],
    ) -> ShapeBounds:
        """Return the bounds of an operator on children with these bounds.

        Args:
            body: The statements to add to.
            rule: The operator.
            inner: The bounds of the children.
            own: The operator's numbers, by name.
        """
        if len(inner) == 1:
            return self._one(body, rule, inner[0], own)
        if rule is SELECT:
            first, second = inner
            return self.either(body, first, second, own["second"])
        if not _folds(rule):
            return self._halved(body, rule, inner, own)
        result = inner[0]
        for other in inner[1:]:
            result = self._two(body, rule, result, other, own)
        return result

    def _halved(
        self,
        body: StatementList,
        rule: Operator,
        inner: Sequence[ShapeBounds],
        own: Mapping[str, Expr],
    ) -> ShapeBounds:
        """Combine many children as a balanced tree, because a chain would be too deep."""
        if len(inner) == 1:
            return inner[0]
        middle = len(inner) // 2
        a = self._halved(body, rule, inner[:middle], own)
        return self._two(body, rule, a, self._halved(body, rule, inner[middle:], own), own)

    def given(
        self, body: StatementList, node: Node, shares: Sequence[Sequence[Expr]]
    ) -> dict[str, Expr]:
        """Return the children's bounds, by the parameter names of an operator's functions.

        ``exists`` is among them if there may be nothing below an operator on one shape.

        Args:
            body: The statements to add to.
            node: The operator's node.
            shares: The numbers of each child.
        """
        inner = [
            self.of(body, child, share) for child, share in zip(node.children, shares, strict=True)
        ]
        if len(inner) > 1:
            return self._joined_to(body, inner[0], inner[1])
        found = _named(inner[0], None)
        if inner[0].exists is not None and node.rule is not COMPLEMENT:
            found["exists"] = inner[0].exists
        return found

    def steps(
        self,
        body: StatementList,
        node: Node,
        shares: Sequence[Sequence[Expr]],
        own: Mapping[str, Expr],
    ) -> list[dict[str, Expr]]:
        """Return what ``given`` returns for each child but the first; ``a`` is all before it.

        Args:
            body: The statements to add to.
            node: The node of an operator on several shapes.
            shares: The numbers of each child.
            own: The operator's numbers, by name.
        """
        assert isinstance(node.rule, Operator)
        found: list[dict[str, Expr]] = []
        before: ShapeBounds | None = None
        for child, share in zip(node.children, shares, strict=True):
            other = self.of(body, child, share)
            if before is not None:
                found.append(self._joined_to(body, before, other))
            before = other if before is None else self._two(body, node.rule, before, other, own)
        return found

    def _joined_to(self, body: StatementList, a: ShapeBounds, b: ShapeBounds) -> dict[str, Expr]:
        return _named(self._filled(body, a, b), self._filled(body, b, a))

    def of_primitive(
        self, body: StatementList, rule: Primitive, own: Mapping[str, Expr], *, flat: bool
    ) -> ShapeBounds:
        """Return the bounds of a primitive with these numbers.

        Args:
            body: The statements to add to.
            rule: The primitive.
            own: The primitive's numbers, by name.
            flat: Whether the shape lies in the plane.
        """
        slope = self._number(body, "slope", rule.slope, own)
        exists = NEVER if rule in NOTHINGS else None
        whole = everywhere2 if flat else everywhere
        bounds = body.let("bounds", self._call(rule.bounds or whole, own))
        lower = Guarantee.LOWER_BOUND in rule.claims
        growth, side_growth = self._growth_of_leaf(body, rule, own)
        return ShapeBounds(slope, ONE if lower else slope, bounds, growth, side_growth, exists)

    def _growth_of_leaf(
        self, body: StatementList, rule: Primitive, own: Mapping[str, Expr]
    ) -> tuple[Expr, Expr]:
        if rule.growth is None:
            known = Guarantee.EXACT_OUTSIDE in rule.claims or rule.bounds is None
            return (ONE, ONE) if known else (UNKNOWN, UNKNOWN)
        growth = self._number(body, "growth", rule.growth, own)
        if rule.side_growth is None:
            return growth, growth
        return growth, self._number(body, "side_growth", rule.side_growth, own)

    def _number(
        self, body: StatementList, name: str, rule: Rule, given: Mapping[str, Expr]
    ) -> Expr:
        if isinstance(rule, Func):
            return body.let(name, self._call(rule, given))
        return constant_number(rule)

    def _one(
        self, body: StatementList, rule: Operator, child: ShapeBounds, own: Mapping[str, Expr]
    ) -> ShapeBounds:
        if rule is IN_CELLS:
            # The box of one cell is not that of all: the operator's numbers are.
            box = Construct((own["low"], own["high"]), child.bounds.type)
            numbers = {name: own[name] for name in NUMBERS}
            return ShapeBounds(bounds=box, exists=child.exists, **numbers)
        given = {**own, **_named(child, None)}
        slope = self._slope(body, rule, child.slope, given)
        bounds = child.bounds
        if rule.bounds is not None:
            bounds = body.let("bounds", self._call(rule.bounds, given))
        kept = Guarantee.LOWER_BOUND in rule.keeps
        growth, side_growth = self._growth(body, rule, (child,), bounds, given)
        divisor = child.divisor if kept else slope
        exists = None if rule is COMPLEMENT else child.exists
        return ShapeBounds(slope, divisor, bounds, growth, side_growth, exists)

    def _two(
        self,
        body: StatementList,
        rule: Operator,
        a: ShapeBounds,
        b: ShapeBounds,
        own: Mapping[str, Expr],
    ) -> ShapeBounds:
        exists = exists_after(rule, a.exists, b.exists)
        # Where there is no first shape, the second counts twice, and likewise.
        a, b = self._filled(body, a, b), self._filled(body, b, a)
        larger = _larger(body, "slope", a.slope, b.slope)
        side_growth = _larger(body, "side_growth", a.side_growth, b.side_growth)
        given = {**own, **_named(a, b), "side_growth": side_growth}
        given["growth"] = _larger(body, "growth", a.growth, b.growth)
        slope = self._slope(body, rule, larger, given)
        flat = a.bounds.type is self._values.assembly.struct(Bounds2)
        around = rule.bounds or (hull2 if flat else hull)
        bounds = body.let("bounds", self._call(around, given))
        divisor = slope
        if Guarantee.LOWER_BOUND in rule.keeps:
            divisor = _larger(body, "divisor", a.divisor, b.divisor)
        growth, side_growth = self._growth(body, rule, (a, b), bounds, given)
        return ShapeBounds(slope, divisor, bounds, growth, side_growth, exists)

    def _filled(self, body: StatementList, a: ShapeBounds, b: ShapeBounds) -> ShapeBounds:
        """Return the bounds of a shape; where it does not exist, those of another."""
        if a.exists is None:
            return a
        return self.either(body, b, replace(a, exists=None), a.exists)

    def either(
        self, body: StatementList, a: ShapeBounds, b: ShapeBounds, second: Expr
    ) -> ShapeBounds:
        """Return the bounds of one of two shapes.

        Args:
            body: The statements to add to.
            a: The bounds of the first.
            b: The bounds of the second.
            second: Whether it is the second.
        """
        exists = exists_of_either(a.exists, b.exists, second)
        if b.exists is NEVER:
            return replace(a, exists=exists)
        if a.exists is NEVER:
            return replace(b, exists=exists)
        parts = {
            name: one if one is other else body.let(name, select(second, other, one))
            for name in PARTS_OF_BOUNDS
            for one, other in ((getattr(a, name), getattr(b, name)),)
        }
        return ShapeBounds(**parts, exists=exists)

    def _growth(
        self,
        body: StatementList,
        rule: Operator,
        inner: Sequence[ShapeBounds],
        bounds: Expr,
        given: Mapping[str, Expr],
    ) -> tuple[Expr, Expr]:
        """Return the growth of an operator's result, and that of its sides."""
        growth, side_growth = given["growth"], given["side_growth"]
        match rule.growth:
            case Growth.KEPT:
                return growth, side_growth
            case Growth.FIRST:
                return inner[0].growth, inner[0].side_growth
            case Growth.TURNED:
                return growth, growth
            case Growth.CORNERED:
                flat = bounds.type is self._values.assembly.struct(Bounds2)
                return _corner_growth(body, side_growth, 2 if flat else 3), side_growth
            case Growth.HELD:
                return ONE, ONE
            case Growth.UNKNOWN:
                return UNKNOWN, UNKNOWN
            case Func():
                found = self._number(body, "growth", rule.growth, given)
                return found, found
            case _:
                assert_never(rule.growth)

    def _slope(
        self, body: StatementList, rule: Operator, child: Expr, given: Mapping[str, Expr]
    ) -> Expr:
        if rule.slope is None:
            return child
        if isinstance(rule.slope, Func):
            return body.let("slope", self._call(rule.slope, given))
        return body.let("slope", multiply(child, constant_number(rule.slope)))


class RememberedBounds(BoundsComposer):
    """Bounds composed within one function, once for each node."""

    def __init__(self, values: Values) -> None:
        super().__init__(values)
        self.found: dict[int, ShapeBounds] = {}

    def of(
        self,
        body: StatementList,
        node: Node,
        values: Sequence[Expr],
        axes: BoxAxes | None = None,
    ) -> ShapeBounds:
        """Return the bounds of a subtree, composed once."""
        if axes is not None:
            return super().of(body, node, values, axes)
        known = self.found.get(id(node))
        if known is None:
            known = self.found[id(node)] = super().of(body, node, values)
        return known

    def _of_many(
        self,
        body: StatementList,
        rule: Operator,
        children: Sequence[tuple[Node, Sequence[Expr]]],
        own: Mapping[str, Expr],
        *,
        flat: bool,
    ) -> ShapeBounds:
        """Return bounds without functions for groups: what is remembered is read in this one."""
        return self.of_operator(body, rule, [self.of(body, *child) for child in children], own)


def _named(a: ShapeBounds, b: ShapeBounds | None) -> dict[str, Expr]:
    """Return bounds by the parameter names of an operator's functions."""
    of = {"": a} if b is None else {"_a": a, "_b": b}
    return {f"{n}{end}": getattr(of[end], n) for n in BOUNDS_OF_CHILD for end in of}


def _larger(body: StatementList, name: str, a: Expr, b: Expr) -> Expr:
    """Return the larger of two; folded if both are constants, as for exact shapes."""
    if a is b:
        return a
    if isinstance(a, Const) and isinstance(b, Const):
        return a if a.value >= b.value else b
    return body.let(name, builtin("max", a, b))


def _corner_growth(body: StatementList, side_growth: Expr, dimensions: int) -> Expr:
    """Return the growth of a corner: all sides passed by ``side_growth``; infinity stays."""
    root = constant_number(math.sqrt(dimensions))
    if isinstance(side_growth, Const):
        return constant_number(min(side_growth.value * math.sqrt(dimensions), UNBOUNDED))
    return body.let("growth", builtin("min", multiply(side_growth, root), UNKNOWN))
