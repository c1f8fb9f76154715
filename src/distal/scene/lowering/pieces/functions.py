"""Functions of the parts of a table of pieces: values, distances, attributes.

Input: a table whose parts are leaves and pieces. Output: functions of the IR. Those of a leaf are
those of ``PartFunctions``; the way through a program is scene code (``render.pieces``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from distal.ir.build import boolean, compare, integer, multiply, number, select
from distal.ir.nodes import Call, CompareOp, Construct, Expr, FunctionRef, If, Param, Read, Return
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, FunctionType, Type
from distal.render import bricks as brick_code
from distal.render import pieces as scene_code
from distal.scene.lowering.part_functions import PartFunctions
from distal.scene.lowering.parts.table import PartTable
from distal.scene.lowering.pieces.joins import JoinCode, ValueJoin
from distal.scene.tree.values import StatementList
from distal.scene.tree.varying import expression_of

if TYPE_CHECKING:
    from distal.scene.lowering.shapes import ShapeComposer

HOW: Final = Read("how", INT)
BEFORE: Final = Read("before", FLOAT)
LAST: Final = Read("last", FLOAT)
_PAIR: Final = (("how", INT), ("before", FLOAT), ("last", FLOAT))
_COUNTS: Final = ("bricks_across", "bricks_up", "bricks_deep")
_AT: Final = (("p", VEC3),)
_AT_PART: Final = (("p", VEC3), ("part", INT))


class ProgramFunctions(PartFunctions):
    """Makes the functions of the programs of one table."""

    def __init__(self, composer: ShapeComposer, table: PartTable) -> None:
        super().__init__(composer, table)
        data, fixed = table.programs, composer.values.fixed
        assert data is not None
        self._joins = data.joins
        self._share: FunctionRef | None = None
        self._own: dict[str, Expr | FunctionRef] = {
            "pieces": composer.assembly.resource(data.numbers, "pieces"),
            "leaf": self.distance_of,
            "joined": self._of_join("values_joined", self._joined),
            "first_piece": fixed("first_piece", INT, data.first_program),
            "some_others": boolean(data.some_others),
        }
        self.value_of = self.made("part_value", scene_code.value_of_part, self._own, _AT_PART)
        self._field_of = self.value_of
        self._whole = fixed("whole_piece", INT, data.whole)

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
        numbers = self._numbers_of(join)
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
        given = {**self._numbers_of(join), "a": BEFORE, "b": LAST}
        return self._composer.call(join.mix, given)

    def _numbers_of(self, join: ValueJoin) -> dict[str, Expr]:
        """Return the numbers of a join: constants, but for one that changes."""
        found: dict[str, Expr] = {
            name: integer(value) if isinstance(value, int) else number(value)
            for name, value in join.numbers
        }
        if join.moving is not None:
            name, value, factor = join.moving
            size = expression_of(self._composer.assembly, value, name)
            found[name] = multiply(number(factor), size) if factor != 1.0 else size
        return found

    def attribute(self, result: Type, given: Mapping[str, Expr], of_leaf: FunctionRef) -> Expr:
        """Return an attribute of a part at a point; see ``PartFunctions.attribute``."""
        if self._share is None:
            self._share = self._of_join("share_joined", self._share_of)
        rest = tuple(value for name, value in given.items() if name not in ("p", "part"))
        shown = FunctionRef(of_leaf.name, rest, FunctionType((VEC3, INT), result))
        function = scene_code.number_of_part if result is FLOAT else scene_code.surface_of_part
        values = {**self._own, **given, "share": self._share, "shown": shown}
        return self._composer.call(function, values)


class PieceFunctions(ProgramFunctions):
    """Makes the functions of the parts of one table of pieces."""

    def __init__(self, composer: ShapeComposer, table: PartTable) -> None:
        super().__init__(composer, table)
        bound: dict[str, Any] = {
            **self._own,
            "boxes": self.given["boxes"],
            "value": self.value_of,
            "factor": composer.values.fixed("piece_factor", FLOAT, 1.0 / max(table.divisor, 1.0)),
            "whole": self._whole,
        }
        self.given["within"] = self.made("within_box", scene_code.within_box, bound, _AT_PART)
        self.distance_of = self.made("piece_distance", scene_code.distance_to_part, bound, _AT_PART)
        self._of_whole = self.made("whole_value", scene_code.value_of_whole, bound, _AT)
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
        return Call(self._of_whole.name, (p,), FLOAT)


class BrickFunctions(ProgramFunctions):
    """Makes the functions of a tree by the programs of bricks."""

    def __init__(self, composer: ShapeComposer, table: PartTable) -> None:
        super().__init__(composer, table)
        assert table.programs is not None
        bricks, fixed = table.programs.bricks, composer.values.fixed
        assert bricks is not None
        self._bricks: dict[str, Any] = {
            "bricks": composer.assembly.resource(bricks.programs, "bricks"),
            "value": self.value_of,
            "grid": Construct(
                (
                    fixed("bricks_low", VEC3, bricks.low),
                    fixed("bricks_high", VEC3, bricks.high),
                    fixed("bricks_per_unit", VEC3, bricks.per_unit),
                    *(
                        fixed(name, INT, count)
                        for name, count in zip(_COUNTS, bricks.counts, strict=True)
                    ),
                    self._whole,
                ),
                composer.assembly.struct(brick_code.BrickGrid),
            ),
            "steepest": number(table.slope),
            "exact": boolean(bricks.exact),
        }

    def distance(self, p: Expr) -> Expr:
        """Return the value of the tree at a point."""
        return self._composer.call(brick_code.value_by_bricks, {**self._bricks, "p": p})

    def nearest(self, body: StatementList, p: Expr) -> Expr:
        """Return the program that has the surface at a point."""
        return body.let(
            "part", self._composer.call(brick_code.program_at, {**self._bricks, "p": p})
        )


def functions_of(composer: ShapeComposer, table: PartTable) -> PartFunctions:
    """Return the functions of a table."""
    if table.programs is None:
        return PartFunctions(composer, table)
    kind = PieceFunctions if table.programs.bricks is None else BrickFunctions
    return kind(composer, table)
