"""Numbers of scene objects as expressions of a program, also those that differ by place.

Input: checked numbers. Output: uniforms, reads of a table's columns, or expressions of parameters
and time. A number that depends on the cell of a repetition or on the place is a ``VaryingNumber``:
no number of the scene, but a part of its structure, which is emitted where the cell is known.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

from distal.fields.guarantees import Limit, Operator
from distal.fields.place.within import WITHIN, WITHIN_FLAT
from distal.frontend import Assembly
from distal.ir.build import integer
from distal.ir.build import number as constant_number
from distal.ir.nodes import Binary, Builtin, Compose, Const, Expr
from distal.ir.types import FLOAT, VEC2, VEC3
from distal.ir.walk import children, rebuild, rewrite
from distal.lang.expressions import Expression, depends_on_time
from distal.lang.places import CELL, POINT, at_place, places_in
from distal.lang.resources import Buffer, TextureValue
from distal.render.patterns import cell_number
from distal.scene.tree.conversion import HostNumber, Number
from distal.scene.tree.node import Node, Rule

# With the id of a number: the key in ``Assembly.made`` of the expression that reads its column.
COLUMN: Final = "column"
# The cell outside of any repetition.
ZERO_CELL: Final = constant_number(0.0, VEC3)
# Another one than those of the colors of ``by_cell``.
_SALT: Final = 2


class Composer(Protocol):
    """An object that adds values to a program: any object with the program's assembly."""

    @property
    def assembly(self) -> Assembly:
        """The assembly to which functions, numbers and resources are added."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class VaryingNumber:
    """A number that depends on the cell of the repetition around a shape, or on the place.

    Attributes:
        number: The number; its value is an expression.
        name: The name of the parameter that it is for.
        uses: What it depends on: "cell", "p".
    """

    number: Number
    name: str
    uses: frozenset[str]

    @property
    def expression(self) -> Expression:
        """The expression."""
        assert isinstance(self.number.value, Expression)
        return self.number.value

    @property
    def moves(self) -> bool:
        """Whether it depends on parameters or time, too."""
        return bool(self.expression.parameters) or depends_on_time(self.expression)

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """Emit the number at a place; ``site`` gives the cell and the point."""
        assembly = composer.assembly
        found = expression_of(assembly, self.number, self.name)
        known = {CELL: ZERO_CELL, POINT: ZERO_CELL, **site}
        p = known[POINT]
        known[POINT] = Compose((p, constant_number(0.0)), VEC3) if p.type is VEC2 else p

        def random(cell: Expr, seed: int) -> Expr:
            given = {"cell": cell, "seed": constant_number(float(seed)), "salt": integer(_SALT)}
            return assembly.call(cell_number, given)

        return at_place(found, known, random)


def varying_or_same(number: Number, name: str) -> Number | VaryingNumber:
    """Return a number that depends on the cell or the place as a ``VaryingNumber``."""
    assert isinstance(number.value, Expression)
    uses = places_in(number.value)
    return VaryingNumber(number, name, uses) if uses else number


def expression_of(assembly: Assembly, value: Number | TextureValue | Buffer, stem: str) -> Expr:
    """Return a value as an expression of a program.

    A constant number becomes a uniform, a column of a table (``scene.lowering.parts``) a read of
    the row, an expression of the author stays one, but for its numbers, and a texture or buffer
    becomes a resource.

    Args:
        assembly: The program.
        value: The value.
        stem: The stem of the name of the uniform or resource.
    """
    if not isinstance(value, Number):
        return assembly.resource(value, stem)
    column: Expr | None = assembly.made.get((COLUMN, id(value)))
    if column is not None:
        return column
    if isinstance(value.value, Expression):
        return _with_numbers(assembly, value.value, stem)
    if isinstance(value, HostNumber):
        return host_number(assembly, value)
    return assembly.number(stem, value.type, value.value)


def host_number(assembly: Assembly, number: HostNumber) -> Expr:
    """Return the uniform of a number that whoever shows the scene sets, declared once."""
    made, key = assembly.made, (HostNumber, number.name)
    if key not in made:
        made[key] = assembly.number(number.name, number.type, number.value)
    found: Expr = made[key]
    return found


def _with_numbers(assembly: Assembly, expression: Expression, stem: str) -> Expr:
    """Return an expression whose constants are numbers of the scene: a new value needs no new text.

    An exponent stays, because a power of a known one is another formula.
    """
    made, key = assembly.made, (Expression, id(expression))
    if key not in made:

        def changed(e: Expr) -> Expr:
            if not isinstance(e, Binary | Compose | Builtin) or _is_power(e):
                return e
            return rebuild(e, tuple(numbered(c) for c in children(e)))

        def numbered(e: Expr) -> Expr:
            if isinstance(e, Const) and e.type is FLOAT:
                return assembly.number(stem, FLOAT, e.value)
            return e

        # The expression is kept, so that no other gets its identity.
        made[key] = rewrite(assembly.expression(expression), changed, {}), expression
    found: Expr = made[key][0]
    return found


def _is_power(e: Expr) -> bool:
    return isinstance(e, Builtin) and e.name == "pow"


@dataclass(frozen=True, slots=True)
class VariedNumber:
    """A number of a shape that differs from cell to cell.

    Attributes:
        node: The shape.
        number: The number.
    """

    node: Node
    number: VaryingNumber

    @property
    def label(self) -> str:
        """The number in messages."""
        return f"{self.number.name} of {self.node.rule.name}"

    @property
    def limit(self) -> Limit:
        """Its limit."""
        return self.node.rule.limits.get(self.number.name, Limit.ANY)


def holds(rule: Rule) -> bool:
    """Return whether an operator holds the bounds of a shape whose numbers differ by place."""
    return rule in (WITHIN, WITHIN_FLAT)


def varied_in(root: Node) -> list[VariedNumber]:
    """Return the numbers of a tree that differ in the cells of a repetition around it.

    Below an operator that holds the bounds of all places (``varied_places``) they are its matter.
    """
    return root.derived("numbers of cells", lambda: list(_varied_in(root)))


def _varied_in(root: Node) -> Iterator[VariedNumber]:
    seen: set[int] = set()
    stack = [root]
    while stack:
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        for value in node.constants.values():
            if isinstance(value, VaryingNumber):
                yield VariedNumber(node, value)
        # What is below a repetition has the cells of that one.
        if not (isinstance(node.rule, Operator) and (node.rule.repeats or holds(node.rule))):
            stack.extend(node.children)
