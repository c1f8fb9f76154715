"""Fields in which shapes without an inside have a thickness (``render.sheets``).

Input: a tree, and where a program's picture is seen from. Output: its safe field. Thick are the
members of the unions at the root that have no inside or are estimates (``Node.solid``), whole: a
sheet that is cut, moved or blended is one. Values that are shown, probed and meshed know no
thickness.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from distal.ir.build import builtin, number
from distal.ir.nodes import Call, Expr, FunctionRef, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, FunctionType
from distal.render import sheets
from distal.scene.lowering.union_parts import parts_of, united
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList
from distal.scene.tree.varying import ZERO_CELL

if TYPE_CHECKING:
    from distal.scene.lowering.shapes import ShapeComposer

# What a field with thickness captures, by the names of ``render.sheets``.
_CAPTURED = (("eye", VEC3), ("threshold", FLOAT))


class Sheets:
    """Makes the fields of one program.

    Attributes:
        seen: Where the picture is seen from, and how wide a pixel is, by the names of
            ``render.sheets``; None where nothing is thick.
    """

    def __init__(self, composer: ShapeComposer) -> None:
        self._composer = composer
        self._made: dict[int, tuple[str, Node]] = {}
        self.seen: Mapping[str, Expr] | None = None

    def among(self, root: Node) -> list[Node]:
        """Return the members of the unions at the root that are no solids."""
        if self.seen is None or root.flat:
            return []
        found: list[Node] = root.derived(
            "sheets", lambda: [part for part in parts_of(root) if not part.solid]
        )
        return found

    def grown(self, root: Node, bounds: Expr) -> Expr:
        """Return the box of a tree, grown by the thickness of its sheets."""
        if not self.among(root):
            return bounds
        assert self.seen is not None
        return self._composer.call(sheets.grown_by_thickness, {**self.seen, "bounds": bounds})

    def field(self, root: Node) -> FunctionRef:
        """Return the safe field of a tree that has sheets, as a function of the point."""
        assert self.seen is not None
        if id(root) not in self._made:
            self._made[id(root)] = self._define(root), root
        captures = tuple(self.seen[name] for name, _ in _CAPTURED)
        return FunctionRef(self._made[id(root)][0], captures, FunctionType((VEC3,), FLOAT))

    def _define(self, root: Node) -> str:
        composer, thin = self._composer, self.among(root)
        params = (Param("p", VEC3), *(Param(name, type) for name, type in _CAPTURED))
        body = StatementList(taken={param.name for param in params})
        given: dict[str, Expr] = {param.name: Read(param.name, param.type) for param in params}
        least: Expr | None = None
        solids = [part for part in parts_of(root) if part.solid]
        if solids:
            node = united(root, solids)
            field = composer.safe_field(node, composer.values.all(node), ZERO_CELL)
            least = body.let("solids", Call(field.name, (given["p"], *field.captures), FLOAT))
        for node in thin:
            values = composer.values.all(node)
            field = composer.field(node, values, ZERO_CELL)
            divisor: Expr = number(1.0)
            if not composer.parts.has_safe_values(node):
                divisor = composer.bounds.of(body, node, values).divisor
            d = Call(field.name, (given["p"], *field.captures), FLOAT)
            asked = {**given, "d": d, "divisor": divisor}
            sheet = body.let("sheet", composer.call(sheets.with_thickness, asked))
            least = sheet if least is None else body.let("least", builtin("min", least, sheet))
        assert least is not None
        body.statements.append(Return(least))
        return composer.assembly.define("field_with_sheets", params, FLOAT, body.statements)
