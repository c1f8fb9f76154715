"""Lowering of a shape's tree to functions of the IR.

Input: nodes. Output: calls of the field library's functions, bound by parameter name. Floats become
uniforms. A subtree that occurs several times, even with other numbers, becomes one function that
takes its numbers as parameters. Materials are lowered by ``attributes``.

There are two functions of a tree. The *field* is the author's: its values are shown, probed and
compared. The *safe field* has the same zero set, and its values are never more than the distance to
it: each part of a hard union is divided by the part's own divisor, so that a steep part does not
shorten the steps near the others. Rays are marched through the safe field. Both are the same
function if no part needs a divisor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final

from distal.fields.combine.alternatives import NOWHERE, SELECT
from distal.fields.guarantees import BOUNDS_OF_CHILDREN, Operator, Primitive
from distal.frontend import Assembly
from distal.frontend.problems import must_be
from distal.ir.build import builtin, divide, multiply, select
from distal.ir.build import field as field_of
from distal.ir.build import number as constant_number
from distal.ir.nodes import Call, Expr, FunctionRef, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, FunctionType, Struct
from distal.lang.functions import Func
from distal.lang.places import CELL
from distal.lang.resources import Buffer, TextureValue
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.part_functions import PartFunctions
from distal.scene.lowering.parts.table import RowsNode
from distal.scene.lowering.pieces.functions import functions_of
from distal.scene.lowering.safe_parts import SafeParts
from distal.scene.lowering.selection import selected
from distal.scene.lowering.sheets import Sheets
from distal.scene.lowering.turned_boxes import TurnedBoxes
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values, plain_name
from distal.scene.tree.varying import ZERO_CELL as ZERO_CELL
from distal.scene.tree.varying import VaryingNumber

ONE: Final = constant_number(1.0)


class ShapeComposer:
    """Makes the functions of one program's shapes."""

    def __init__(self, assembly: Assembly, root_nodes: Sequence[Node]) -> None:
        self.assembly = assembly
        self.call = assembly.call
        self.values = Values(assembly)
        self.bounds = BoundsComposer(self.values)
        self._turned_boxes = TurnedBoxes(self.values, self.bounds)
        self.parts = SafeParts()
        self._keys: dict[int, int] = {}
        self._known_keys: dict[Any, int] = {}
        self._functions: dict[tuple[int, str, int | None, bool], str] = {}
        self._uses_cell: dict[int, bool] = {}
        self._in_cells: dict[str, str] = {}
        self._count: dict[int, int] = {}
        self._kinds: dict[int, set[int]] = {}
        self._count_kinds(root_nodes)
        self._tables: dict[int, PartFunctions] = {}
        self.sheets = Sheets(self)

    # Equality of subtrees

    def key(self, node: Node) -> int:
        """Return a key that is equal for subtrees that differ only in values of numbers."""
        found = self._keys.get(id(node))
        if found is None:
            constants = tuple((n, _identity(v)) for n, v in node.constants.items())
            numbers = tuple((n, number.type) for n, number in node.numbers.items())
            table = id(node) if node.has_rows else None
            inner = (self.key(c) for c in node.children)
            whole = (id(node.rule), table, constants, numbers, *inner)
            found = self._known_keys.setdefault(whole, len(self._known_keys))
            self._keys[id(node)] = found
        return found

    def _count_kinds(self, roots: Sequence[Node]) -> None:
        """Count the occurrences of each kind of subtree; inside a repeated one only once."""
        stack = list(roots)
        while stack:
            node = stack.pop()
            key = self.key(node)
            self._count[key] = self._count.get(key, 0) + 1
            self._kinds.setdefault(key, set()).add(id(node))
            if self._count[key] == 1:
                stack.extend(node.children)

    def uses_cell(self, node: Node) -> bool:
        """Return whether the subtree's distance depends on the cell of a repetition."""
        found = self._uses_cell.get(id(node))
        if found is None:
            names = {n for f in rule_functions(node) for n in self.assembly.parameter_names(f)}
            numbers = (v for v in node.constants.values() if isinstance(v, VaryingNumber))
            varies = any(CELL in number.uses for number in numbers)
            found = varies or "cell" in names or any(map(self.uses_cell, node.children))
            self._uses_cell[id(node)] = found
        return found

    def table(self, node: RowsNode) -> PartFunctions:
        """Return the functions of a table's parts."""
        found = self._tables.get(id(node))
        if found is None:
            found = self._tables[id(node)] = functions_of(self, node.table)
        return found

    def field(self, node: Node, values: Sequence[Expr], cell: Expr) -> FunctionRef:
        """Return a subtree's distance as a function of the point alone.

        Args:
            node: The root of the subtree.
            values: The numbers of the subtree.
            cell: The index of the repetition.
        """
        name, captures = self._function(node, values, cell)
        point = VEC2 if node.flat else VEC3
        return FunctionRef(name, captures, FunctionType((point,), FLOAT))

    def field_around(
        self, node: Node, child: Node, values: Sequence[Expr], cell: Expr
    ) -> FunctionRef:
        """Return the child's distance as the functions around it take it.

        Of a repetition it is a function of the point and the cell: in each cell, the child may be
        another.

        Args:
            node: The node, whose rule evaluates the child at several points.
            child: The child.
            values: The numbers of the child.
            cell: The index of the repetition around the node.
        """
        of_point = self.field(child, values, cell)
        rule = node.rule
        assert isinstance(rule, Operator)
        if not rule.repeats:
            return of_point
        captures = of_point.captures[:-1] if self.uses_cell(child) else of_point.captures
        point = Param("p", VEC2 if child.flat else VEC3)
        passed = [Param(f"value_{i}", value.type) for i, value in enumerate(captures)]
        own = [Read(param.name, param.type) for param in (point, *passed)]
        if self.uses_cell(child):
            own.append(Read("cell", VEC3))
        made = of_point.name
        if made not in self._in_cells:
            params = (point, Param("cell", VEC3), *passed)
            result = Return(Call(of_point.name, tuple(own), FLOAT))
            self._in_cells[made] = self.assembly.define(
                f"{of_point.name}_in_cell", params, FLOAT, (result,), node.place
            )
        type = FunctionType((point.type, VEC3), FLOAT)
        return FunctionRef(self._in_cells[made], captures, type)

    def safe_field(self, node: Node, values: Sequence[Expr], cell: Expr) -> FunctionRef:
        """Return a subtree's safe field, as a function of the point alone.

        Args:
            node: The root of the subtree, which is closed: its numbers are uniforms.
            values: The numbers of the subtree.
            cell: The index of the repetition.
        """
        if self.sheets.among(node):
            return self.sheets.field(node)
        if self.parts.has_safe_values(node):
            return self.field(node, values, cell)
        name, captures = self._function(node, values, cell, safe=True)
        point = VEC2 if node.flat else VEC3
        return FunctionRef(name, captures, FunctionType((point,), FLOAT))

    def _factors(self, body: StatementList, node: Node, values: Sequence[Expr]) -> tuple[Expr, ...]:
        """Return the factors of a subtree's safe field: one for each part with its own divisor."""
        if self.parts.has_safe_values(node):
            return ()
        if not self.parts.splits(node):
            divisor = self.bounds.of(body, node, values).divisor
            safe = body.let("divisor", builtin("max", divisor, ONE))
            return (body.let("factor", divide(ONE, safe)),)
        _, shares = self.values.split(node, values)
        pairs = zip(node.children, shares, strict=True)
        return tuple(f for child, share in pairs for f in self._factors(body, child, share))

    def _function(
        self,
        node: Node,
        values: Sequence[Expr],
        cell: Expr,
        *,
        safe: bool = False,
        factors: Sequence[Expr] = (),
    ) -> tuple[str, tuple[Expr, ...]]:
        """Return the function of a subtree: its name, and the arguments to pass besides the point.

        If no other subtree is of the same kind, the function reads its numbers itself.
        """
        key = self.key(node)
        alone = len(self._kinds.get(key, ())) <= 1 and not self.values.has_columns(node)
        closed = alone and tuple(values) == self.values.all(node)
        passed = () if closed else tuple(values)
        if safe and not closed and not factors:
            closed = True  # the root of a safe field computes its factors itself
            passed = ()
        uses_cell = self.uses_cell(node)
        whole = (key, node.label, id(node) if closed else None, safe)
        if whole not in self._functions:
            self._functions[whole] = self._define(node, passed, uses_cell, safe=safe)
        passed = (*passed, *factors) if passed else ()
        return self._functions[whole], ((*passed, cell) if uses_cell else passed)

    def _define(self, node: Node, passed: tuple[Expr, ...], uses_cell: bool, *, safe: bool) -> str:
        point = VEC2 if node.flat else VEC3
        names = fresh_names(node) if passed else []
        params = [Param(n, v.type) for n, v in zip(names, passed, strict=True)]
        values = [Read(p.name, p.type) for p in params] if passed else self.values.all(node)
        extra = self.parts.factor_names(node, names) if safe and passed else []
        params += [Param(n, FLOAT) for n in extra]
        place = None if passed else node.place
        body = StatementList({"p", "cell", *names, *extra}, place, is_shared=bool(passed))
        cell = Read("cell", VEC3) if uses_cell else ZERO_CELL
        factors: Sequence[Expr] | None = None
        if safe:
            given = tuple(Read(n, FLOAT) for n in extra)
            factors = given if passed else self._factors(body, node, values)
        result = self._emit(body, node, Read("p", point), cell, values, factors)
        body.statements.append(Return(result, span=place))
        params = [Param("p", point), *params, *([Param("cell", VEC3)] if uses_cell else [])]
        stem = f"{plain_name(node.name)}_{'safe_distance' if safe else 'distance'}"
        return self.assembly.define(stem, params, FLOAT, body.statements, node.place)

    def distance(
        self,
        body: StatementList,
        node: Node,
        p: Expr,
        cell: Expr,
        values: Sequence[Expr],
        factors: Sequence[Expr] | None = None,
    ) -> Expr:
        """Return a subtree's distance at a point.

        Args:
            body: The statements to add to.
            node: The root of the subtree.
            p: The point.
            cell: The index of the repetition.
            values: The numbers of the subtree.
            factors: The factors of its safe field; None or empty for the field itself.
        """
        shared = self._count.get(self.key(node), 0) > 1 and len(node.children) > 0
        if not shared and not node.label:
            return self._emit(body, node, p, cell, values, factors)
        if factors and not self.parts.splits(node):
            return self._scaled(body, node, p, cell, values, factors)
        name, passed = self._function(node, values, cell, safe=bool(factors), factors=factors or ())
        # Where several shapes share a function, its call is at the shape's place.
        with body.at(node.place if passed else None):
            return body.let("d", Call(name, (p, *passed), FLOAT))

    def _scaled(
        self,
        body: StatementList,
        node: Node,
        p: Expr,
        cell: Expr,
        values: Sequence[Expr],
        factors: Sequence[Expr],
    ) -> Expr:
        """Return the distance of a part with its own divisor, times its factor."""
        (factor,) = factors
        d = self.distance(body, node, p, cell, values)
        return body.let("d", multiply(d, factor))

    def _emit(
        self,
        body: StatementList,
        node: Node,
        p: Expr,
        cell: Expr,
        values: Sequence[Expr],
        factors: Sequence[Expr] | None = None,
    ) -> Expr:
        with body.at(node.place):
            return self._emit_here(body, node, p, cell, values, factors)

    def _emit_here(
        self,
        body: StatementList,
        node: Node,
        p: Expr,
        cell: Expr,
        values: Sequence[Expr],
        factors: Sequence[Expr] | None,
    ) -> Expr:
        if factors and not self.parts.splits(node):
            return self._scaled(body, node, p, cell, values, factors)
        if isinstance(node, RowsNode):
            return body.let("d", self.table(node).distance(p))
        given, shares = self.given(body, node, p, cell, values)
        rule = node.rule
        if isinstance(rule, Primitive):
            if rule.normalize is not None:
                given["field"] = self._unchanged(node, rule, given)
            value = self.call(rule.normalize or rule.distance, given)
            if value.type is not FLOAT:
                message = must_be(f"the distance of '{rule.name}'", FLOAT, value.type)
                refuse(message, None, node.place)
            return body.let("d", value)
        if rule.around is not None:
            given["field"] = self.field_around(node, node.children[0], shares[0], cell)
            return existing(body, given, body.let("d", self.call(rule.around, given)))
        of_children = self.parts.shared_out(node, factors)
        if rule is SELECT:
            first, second = (
                partial(self.distance, node=child, p=p, cell=cell, values=share, factors=own)
                for child, share, own in zip(node.children, shares, of_children, strict=True)
            )
            return selected(body, given["second"], first, second)
        inner_p, inner_cell = self.moved(body, rule, given)
        parts = (
            self.distance(body, child, inner_p, inner_cell, share, own)
            for child, share, own in zip(node.children, shares, of_children, strict=True)
        )
        result = next(parts)
        if rule.combine is not None:
            # Each part is combined at once: few values are alive at a time.
            for step, other in zip(self.steps(body, node, given, shares), parts, strict=True):
                result = self.joined(body, rule, {**step, "a": result, "b": other})
        if rule.finish is not None:
            result = body.let("d", self.call(rule.finish, {**given, "d": result}))
        return existing(body, given, result)

    def _unchanged(self, node: Node, rule: Primitive, given: Mapping[str, Expr]) -> FunctionRef:
        """Return an author's function as a function of the point alone, before it is normalized.

        Args:
            node: The author's function.
            rule: Its primitive.
            given: The values of its parameters, by name.
        """
        names = self.assembly.parameter_names(rule.distance)
        passed = {n: given[n] for n in names if n in node.numbers or n == "cell"}
        point = Param("p", VEC2 if node.flat else VEC3)
        params = (point, *(Param(n, v.type) for n, v in passed.items()))
        value = self.call(
            rule.distance, {**given, **{p.name: Read(p.name, p.type) for p in params}}
        )
        if value.type is not FLOAT:
            message = must_be(f"the distance of '{rule.name}'", FLOAT, value.type)
            refuse(message, None, node.place)
        stem = f"{plain_name(node.name)}_unchanged"
        name = self.assembly.define(stem, params, FLOAT, (Return(value),), node.place)
        return FunctionRef(name, tuple(passed.values()), FunctionType((point.type,), FLOAT))

    def given(
        self, body: StatementList, node: Node, p: Expr, cell: Expr, values: Sequence[Expr]
    ) -> tuple[dict[str, Expr], list[Sequence[Expr]]]:
        """Return the values for a node's functions by name, and the numbers of each child.

        Arguments as for ``distance``.
        """
        with self.values.at(cell, p):
            own, shares = self.values.split(node, values)
            given = {**own, "p": p, "cell": cell}
            taken = {n for f in rule_functions(node) for n in self.assembly.parameter_names(f)}
            if node.children and taken & BOUNDS_OF_CHILDREN:
                given |= self.bounds.given(body, node, shares)
        return given, shares

    def steps(
        self,
        body: StatementList,
        node: Node,
        given: Mapping[str, Expr],
        shares: Sequence[Sequence[Expr]],
    ) -> list[Mapping[str, Expr]]:
        """Return the values for an operator's functions when each child but the first is joined.

        They differ in the bounds: of three children, two were joined before the third. ``axes`` is
        among them where the box along axes of the shapes' own cuts the result.

        Args:
            body: The statements to add to.
            node: The operator's node.
            given: The values when the second child is joined to the first.
            shares: The numbers of each child.
        """
        rule = node.rule
        assert isinstance(rule, Operator)
        steps = [given] * (len(node.children) - 1)
        with self.values.at(given["cell"], given["p"]):
            if len(steps) > 1 and "bounds_a" in given:
                bounds = self.bounds.steps(body, node, shares, given)
                steps = [{**given, **own} for own in bounds]
            if rule.within is not None:
                for i, axes in enumerate(self._turned_boxes.joined(body, node, shares)):
                    steps[i] = {**steps[i], "axes": axes}
        return steps

    def joined(self, body: StatementList, rule: Operator, given: Mapping[str, Expr]) -> Expr:
        """Return the distance of two shapes of an operator.

        Args:
            body: The statements to add to.
            rule: The operator.
            given: The values of this step, with the distances ``a`` and ``b``.
        """
        assert rule.combine is not None
        d = body.let("d", self.call(rule.combine, given))
        if "axes" not in given:
            return d
        assert rule.within is not None
        return body.let("d", self.call(rule.within, {**given, "d": d}))

    def moved(
        self, body: StatementList, rule: Operator, given: Mapping[str, Expr]
    ) -> tuple[Expr, Expr]:
        """Return the point and the cell at which an operator's children are evaluated.

        Args:
            body: The statements to add to.
            rule: The operator.
            given: The values for the operator's functions, by name.
        """
        if rule.point is None:
            return given["p"], given["cell"]
        return self.site(body, self.call(rule.point, given), given["cell"])

    def site(self, body: StatementList, place: Expr, cell: Expr) -> tuple[Expr, Expr]:
        """Return the point and the cell of a place that an operator returned.

        Args:
            body: The statements to add to.
            place: The returned value: a point or a ``Site``.
            cell: The index of the repetition around the operator.
        """
        if isinstance(place.type, Struct):
            site = body.let("site", place)
            return field_of(site, "p"), field_of(site, "cell")
        return body.let("q", place), cell


def existing(body: StatementList, given: Mapping[str, Expr], d: Expr) -> Expr:
    """Return the distance of an operator; where there is nothing below it, that to nothing.

    An operator that knows the box of its child never returns more than the distance to some box.

    Args:
        body: The statements to add to.
        given: The values for the operator's functions, by name.
        d: The distance.
    """
    if "exists" not in given:
        return d
    return body.let("d", select(given["exists"], d, constant_number(NOWHERE)))


def rule_functions(node: Node) -> tuple[Func, ...]:
    """Return the functions of a node's rule that are called for each point."""
    rule = node.rule
    if isinstance(rule, Primitive):
        return (rule.distance,)
    return rule.point_functions


def _identity(value: Any) -> Any:
    if isinstance(value, bool | int):
        return (type(value), value)
    if isinstance(value, TextureValue | Buffer | VaryingNumber):
        return id(value)
    return (value.type, value.value)


def fresh_names(node: Node) -> list[str]:
    """Return parameter names for all numbers of a subtree, made unique by a number."""
    names: list[str] = []
    taken = {"p", "cell"}

    def visit(inner: Node) -> None:
        for stem in inner.numbers:
            name, n = stem, 2
            while name in taken:
                name, n = f"{stem}_{n}", n + 1
            taken.add(name)
            names.append(name)
        for child in inner.children:
            visit(child)

    visit(node)
    return names
