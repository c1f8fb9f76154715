"""Write a GLSL program whose pixels are estimates: the operations of a line of the author.

Input: a module without the passes that move or merge statements. Output: the program, as
``glsl.counting`` has it. The work of a line is what ``passes/cost.py`` estimates for the values
that it computes, each time that it runs, and the same of all functions that it calls, as they run.
The lines of the blocks below it have their own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Final

from distal.backends.clike.code import Code
from distal.backends.clike.expense import Expense
from distal.backends.glsl.counting import COUNTED, Counts
from distal.backends.glsl.instruments import InstrumentWriter
from distal.ir.contents import contents
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Function, Let, Stmt, Var
from distal.ir.types import Matrix, Scalar, Vector, component_count

if TYPE_CHECKING:
    from distal.backends.glsl.stages import GlslProgram

_VARIABLES: Final = ("count", "work", "started", "inside")
_FUNCTIONS: Final = ("spend", "enter", "leave", "drawn_picture")


class WorkCounts(Counts):
    """Adds up operations: ``work`` has those of all lines, ``count`` those of the counted line."""

    wanted: ClassVar[tuple[str, ...]] = (COUNTED, *_VARIABLES, *_FUNCTIONS)
    declarations: ClassVar[str] = """
uniform int {Counted_place};
int {count} = 0;
int {work} = 0;
int {started} = 0;
int {inside} = 0;
void {spend}(int place, int operations) {{
    {work} += operations;
    if (place == {Counted_place} && {inside} == 0) {{
        {count} += operations;
    }}
}}
void {enter}(int place) {{
    if (place == {Counted_place}) {{
        if ({inside} == 0) {{
            {started} = {work};
        }}
        {inside} += 1;
    }}
}}
void {leave}(int place, int operations) {{
    {work} += operations;
    if (place == {Counted_place}) {{
        {inside} -= 1;
        if ({inside} == 0) {{
            {count} += {work} - {started};
        }}
    }}
}}"""
    splits: ClassVar[bool] = True

    def writer(self, program: GlslProgram) -> InstrumentWriter:
        """Return a new writer for the stage of the pixels."""
        return WorkWriter(self, program.names, Expense(program.module), program.fixed)


class WorkWriter(InstrumentWriter):
    """Adds the operations of each value beside its declaration."""

    def statement(self, stmt: Stmt, *, tail: bool) -> None:
        """Append a statement and the operations of its value."""
        names = self.instrument.names
        number = self.instrument.number(stmt.span)
        cost = self.instrument.cost(stmt.value) if isinstance(stmt, Let | Var) else 0
        is_calling = isinstance(stmt, Let | Var) and bool(contents(stmt.value).callees)
        if is_calling and number is not None:
            self.line(f"{names['enter']}({number});")
        elif number is not None and cost:
            self.line(f"{names['spend']}({number}, {cost});")
        elif cost:
            self.line(f"{names['work']} += {cost};")
        super().statement(stmt, tail=tail)
        if is_calling and number is not None:
            self.line(f"{names['leave']}({number}, {cost});")

    def native_body(self, fn: Function, native: Code) -> str:
        """Return the body of a careful function where the driver's own is used."""
        assert fn.native is not None
        first = fn.params[0].type
        assert isinstance(first, Scalar | Vector | Matrix)
        cost = INTRINSICS[fn.native].cost * component_count(first)
        return f"{self.instrument.names['work']} += {cost}; {super().native_body(fn, native)}"
