"""Functions of the parts of a table of pieces: values, distances, attributes.

Input: a table whose parts are leaves and pieces. Output: functions of the IR. Those of a leaf are
those of ``PartFunctions``; the way through a program is scene code (``render.pieces``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from distal.ir.build import boolean, compare, integer, number, select
from distal.ir.nodes import Call, CompareOp, Expr, FunctionRef, If, Param, Read, Return
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, FunctionType, Type
from distal.render import pieces as scene_code
from distal.scene.lowering.part_functions import PartFunctions
from distal.scene.lowering.parts.table import PartTable
from distal.scene.lowering.pieces.joins import JoinCode, ValueJoin
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.lowering.shapes import ShapeComposer

HOW: Final = Read("how", INT)
BEFORE: Final = Read("before", FLOAT)
LAST: Final = Read("last", FLOAT)
_PAIR: Final = (("how", INT), ("before", FLOAT), ("last", FLOAT))
_AT: Final = (("p", VEC3),)
_AT_PART: Final = (("p", VEC3), ("part", INT))


class PieceFunctions(PartFunctions):
    """Makes the functions of the parts of one table of pieces."""

    def __init__(self, composer: ShapeComposer, table: PartTable) -> None:
        super().__init__(composer, table)
        data, fixed = table.pieces, composer.values.fixed
        assert data is not None
        self._joins = data.joins
        self._leaf = self.distance_of
        self._share: FunctionRef | None = None
        self._own: dict[str, Expr | FunctionRef] = {
            "pieces": composer.assembly.resource(data.numbers, "pieces"),
            "leaf": self._leaf,
            "joined": self._of_join("values_joined", self._joined),
            "first_piece": fixed("first_piece", INT, data.first_piece),
        }
        self.value_of = self.made("part_value", scene_code.value_of_part, self._own, _AT_PART)
        self._field_of = self.value_of
        bound: dict[str, Any] = {
            **self._own,
            "boxes": self.given["boxes"],
            "value": self.value_of,
            "factor": fixed("piece_factor", FLOAT, 1.0 / max(table.divisor, 1.0)),
            "whole": fixed("whole_piece", INT, data.whole),
        }
        self.given["within"] = self.made("within_box", scene_code.within_box, bound, _AT_PART)
        self.distance_of = self.made("piece_distance", scene_code.distance_to_part, bound, _AT_PART)
        self._whole = self.made("whole_value", scene_code.value_of_whole, bound, _AT)
        self.given["all_parts"] = self.made(
            "whole_distance", scene_code.distance_to_whole, bound, _AT
        )
        self.given["distance"] = self.distance_of
        self.given["many_boxes"] = boolean(True)
        line = (("p", VEC3), ("direction", VEC3), ("part", INT))
        chords: dict[str, Any] = {**self._own, **self.given}
        self.given |= {
            "chord": self.made("chord_of_part", scene_code.chord_of_part, chords, line, VEC2),
            "has_chord": self.made(
                "part_has_chord", scene_code.has_part_chord, chords, line[2:], BOOL
            ),
        }

    def distance(self, p: Expr) -> Expr:
        """Return the value of the author's field at a point."""
        return Call(self._whole.name, (p,), FLOAT)

    def _of_join(self, name: str, make: Callable[[StatementList, ValueJoin], Expr]) -> FunctionRef:
        """Return a function of two values and the number of their join."""
        taken = {n for n, _ in _PAIR}
        body = StatementList(taken=set(taken))
        for i, join in enumerate(self._joins):
            inner = StatementList(taken=set(taken))
            inner.statements.append(Return(make(inner, join)))
            if i == len(self._joins) - 1:
                body.statements.extend(inner.statements)
            else:
                is_join = compare(CompareOp.EQ, HOW, integer(i))
                body.statements.append(If(is_join, tuple(inner.statements), ()))
        declared = tuple(Param(n, t) for n, t in _PAIR)
        defined = self._composer.assembly.define(name, declared, FLOAT, body.statements)
        return FunctionRef(defined, (), FunctionType(tuple(t for _, t in _PAIR), FLOAT))

    def _joined(self, body: StatementList, join: ValueJoin) -> Expr:
        """Return two values joined, or one changed."""
        numbers = _numbers_of(join)
        rule = join.rule
        if join.code.is_binary:
            assert rule.combine is not None
            return self._composer.call(rule.combine, {**numbers, "a": BEFORE, "b": LAST})
        assert rule.finish is not None
        return self._composer.call(rule.finish, {**numbers, "d": LAST})

    def _share_of(self, body: StatementList, join: ValueJoin) -> Expr:
        """Return the share of the second of two values in the material."""
        if not join.code.is_binary:
            return number(1.0)
        if join.code is JoinCode.DIFFERENCE and not join.shows_cutter:
            return number(0.0)
        if join.mix is None:
            return select(compare(CompareOp.LT, LAST, BEFORE), number(1.0), number(0.0))
        given = {**_numbers_of(join), "a": BEFORE, "b": LAST}
        return self._composer.call(join.mix, given)

    def attribute(self, result: Type, given: Mapping[str, Expr], of_leaf: FunctionRef) -> Expr:
        """Return an attribute of a part at a point; see ``PartFunctions.attribute``."""
        if self._share is None:
            self._share = self._of_join("share_joined", self._share_of)
        rest = tuple(value for name, value in given.items() if name not in ("p", "part"))
        shown = FunctionRef(of_leaf.name, rest, FunctionType((VEC3, INT), result))
        function = scene_code.number_of_part if result is FLOAT else scene_code.surface_of_part
        values = {**self._own, **given, "share": self._share, "shown": shown}
        return self._composer.call(function, values)


def _numbers_of(join: ValueJoin) -> dict[str, Expr]:
    """Return the numbers of a join as constants."""
    return {
        name: integer(value) if isinstance(value, int) else number(value)
        for name, value in join.numbers
    }
