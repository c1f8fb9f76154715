"""Functions of the parts of a table: distances, hits, shadows, materials.

Input: a table. Output: functions of the IR. A function of a part takes the number of the part's row
and calls the function of its kind; the walks through the tree of boxes are scene code
(``render.part_tree``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from distal.fields.chords import missed
from distal.ir.build import add, boolean, cast, compare, index, integer, multiply, swizzle
from distal.ir.build import number as constant_number
from distal.ir.nodes import Call, CompareOp, Expr, FunctionRef, If, Param, Read, Return
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, FunctionType, Kind, Type
from distal.lang.functions import Func
from distal.render import part_tree
from distal.scene.lowering.chords import chord_of, has_chord
from distal.scene.lowering.parts.kinds import Column, PartKind
from distal.scene.lowering.parts.table import PartTable
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.lowering.shapes import ShapeComposer

ZERO_CELL: Final = constant_number(0.0, VEC3)  # parts are outside of any repetition
# The parameters of functions of a part: the number of the first vec4 of its row, the point.
PART: Final = Read("part", INT)
POINT: Final = Read("p", VEC3)

# Adds the statements of one kind, and returns its value.
OfKind: TypeAlias = "Callable[[StatementList, PartKind], Expr]"


def _has_chord(body: StatementList, kind: PartKind) -> Expr:
    return boolean(has_chord(kind.node))


class PartFunctions:
    """Makes the functions of the parts of one table."""

    def __init__(self, composer: ShapeComposer, table: PartTable) -> None:
        self._composer = composer
        self._table = table
        assembly = composer.assembly
        self._rows = assembly.resource(table.rows, "part_rows")
        self.given: dict[str, Expr] = {}
        if table.boxes is not None:
            self.given["boxes"] = assembly.resource(table.boxes, "part_boxes")
        for kind in table.kinds:
            kind.read(assembly, [self._read(column) for column in kind.columns])
        params = (("p", VEC3), ("part", INT))
        self.distance_of = self.of_part("part_distance", params, FLOAT, self._distance)
        self.given["distance"] = self.distance_of
        self._field_of = self.distance_of
        if table.needs_factors:
            self._field_of = self.of_part("part_field", params, FLOAT, self._field)
        self.value_of = self.distance_of
        if table.boxes is not None:
            self._add_chords()
            self.given |= {"within": self.distance_of, "many_boxes": boolean(False)}
            self.given["all_parts"] = self.made(
                "distance_to_all", part_tree.distance_to_all, self.given, (("p", VEC3),)
            )

    def made(
        self,
        name: str,
        function: Func,
        given: Mapping[str, Any],
        params: Sequence[tuple[str, Type]],
        result: Type = FLOAT,
    ) -> FunctionRef:
        """Return a function of its own that calls scene code.

        Args:
            name: The preferred name.
            function: The scene code.
            given: What it takes besides the parameters, by name.
            params: Name and type of each parameter.
            result: The type of the result.
        """
        body = StatementList(taken={n for n, _ in params})
        values = {**given, **{n: Read(n, t) for n, t in params}}
        body.statements.append(Return(self._composer.call(function, values)))
        declared = tuple(Param(n, t) for n, t in params)
        defined = self._composer.assembly.define(name, declared, result, body.statements)
        return FunctionRef(defined, (), FunctionType(tuple(t for _, t in params), result))

    def _add_chords(self) -> None:
        """Add the chords of the kinds that have some, for the scene code of ``render``."""
        self.given["some_chords"] = boolean(any(has_chord(k.node) for k in self._table.kinds))
        line = (("p", VEC3), ("direction", VEC3), ("part", INT))
        self.given["chord"] = self.of_part("part_chord", line, VEC2, self._chord)
        self.given["has_chord"] = self.of_part("has_chord", line[2:], BOOL, _has_chord)

    def _read(self, column: Column) -> Expr:
        """Return the numbers of a column, in the row of ``PART``."""
        first = column.first
        row = add(PART, integer(first // 4)) if first >= 4 else PART
        return swizzle(index(self._rows, row), "xyzw"[first % 4 : first % 4 + column.floats])

    def _head(self, lane: str) -> Expr:
        return swizzle(index(self._rows, PART), lane)

    @property
    def ordinal(self) -> Expr:
        """The number of ``PART`` among the parts of its kind, as a float."""
        return self._head("y")

    def _field(self, body: StatementList, kind: PartKind) -> Expr:
        """Return the value of the author's field."""
        composer = self._composer
        return composer.distance(body, kind.node, POINT, ZERO_CELL, composer.values.all(kind.node))

    def _distance(self, body: StatementList, kind: PartKind) -> Expr:
        """Return a value that is never more than the distance."""
        value = self._field(body, kind)
        if kind.factor is None:
            return value
        return body.let("d", multiply(value, self._read(Column(kind.factor, FLOAT))))

    def _chord(self, body: StatementList, kind: PartKind) -> Expr:
        """Return where a line enters and leaves the part; nowhere if that is not known."""
        if not has_chord(kind.node):
            return self._composer.call(missed, {})
        values = self._composer.values.all(kind.node)
        line = (POINT, Read("direction", VEC3))
        return chord_of(self._composer, body, kind.node, line, ZERO_CELL, values)

    def distance(self, p: Expr) -> Expr:
        """Return the value of the author's field of the part nearest to a point."""
        given = {**self.given, "p": p, "field": self._field_of}
        return self._composer.call(part_tree.distance_to_parts, given)

    def nearest(self, body: StatementList, p: Expr) -> Expr:
        """Return the part nearest to a point."""
        return body.let("part", self._composer.call(part_tree.part_at, {**self.given, "p": p}))

    def of_part(
        self, name: str, params: Sequence[tuple[str, Type]], result: Type, make: OfKind
    ) -> FunctionRef:
        """Return a function of a part, which calls that of the part's kind.

        Args:
            name: The preferred name.
            params: Name and type of each parameter; one is ``PART``.
            result: The type of the result.
            make: Adds the statements of one kind.
        """
        assembly = self._composer.assembly
        declared = tuple(Param(n, t) for n, t in params)
        arguments = tuple(Read(n, t) for n, t in params)
        body = StatementList(taken={n for n, _ in params})
        kinds = self._table.kinds
        known = cast(self._head("x"), Kind.INT)
        known = known if len(kinds) == 1 else body.let("kind", known)
        for k, kind in enumerate(kinds):
            inner = StatementList(taken={n for n, _ in params})
            inner.statements.append(Return(make(inner, kind)))
            stem = f"{name}_{k}"
            own = assembly.define(stem, declared, result, inner.statements, kind.node.place)
            call = Return(Call(own, arguments, result))
            if k == len(kinds) - 1:
                body.statements.append(call)
            else:
                is_kind = compare(CompareOp.EQ, known, integer(k))
                body.statements.append(If(is_kind, (call,), ()))
        defined = assembly.define(name, declared, result, body.statements)
        return FunctionRef(defined, (), FunctionType(tuple(t for _, t in params), result))

    def attribute(self, result: Type, given: Mapping[str, Expr], of_leaf: FunctionRef) -> Expr:
        """Return an attribute of a part at a point.

        Args:
            result: Its type: a ``Surface`` or a number.
            given: The point ``p``, the ``part`` and what else ``of_leaf`` takes, in its order.
            of_leaf: The attribute of a leaf, by its row.
        """
        return Call(of_leaf.name, tuple(given.values()), result)
