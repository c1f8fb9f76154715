"""Write a GLSL program that does one line as often as a uniform says, to measure its time.

Input: a module without the passes that move or merge statements. Output: the program. Its line
``#define MEASURED_PLACE -1`` picks the place: a macro and no uniform, so that all other lines stay
as they are, and the driver compiles them as usual. -2 - n is the loop of place n alone, without
what it computes: a line's time is the difference of the two.

A repeated computation must neither be moved out of the loop nor be left out, nor change its result.
It reads copies of its locals, which a round with the number ``NEVER`` would replace. No round has
this number, but only the host knows that. A short line is evaluated ``SHORT`` times in a round, or
the loop would take longer than the line.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from distal.backends.base import Artifact
from distal.backends.clike.code import Code, Line
from distal.backends.clike.constants import is_table
from distal.backends.clike.expense import Expense
from distal.backends.glsl.instruments import Instrument, InstrumentWriter
from distal.ir.contents import contents
from distal.ir.nodes import Construct, Let, Origin, Read, Stmt, Var
from distal.ir.types import Array, Kind, Matrix, Scalar, Vector, kind_of
from distal.ir.walk import nodes_in, statements_in

if TYPE_CHECKING:
    from distal.backends.glsl.stages import GlslProgram

MEASURED: Final = "MEASURED_PLACE"  # reserved in all texts that are measured
CHOICE: Final = f"#define {MEASURED} -1"
REPEATS: Final = "Repeats"
NEVER: Final = "Round_that_never_is"
SHORT: Final = 8


@dataclass(slots=True)
class Repetitions(Instrument):
    """Repeats what a line computes.

    Attributes:
        long: The places that are evaluated once in a repetition: those that call functions.
    """

    long: set[tuple[str, int]] = field(default_factory=set)

    def evaluations(self, number: int) -> int:
        """Return how often a repetition evaluates a place: short ones often, for a small loop."""
        return 1 if self.places[number] in self.long else SHORT

    def writer(self, program: GlslProgram) -> InstrumentWriter:
        """Return a new writer for the stage of the pixels."""
        return TimingWriter(self, program.names, Expense(program.module), program.fixed)

    def declaration_lines(self) -> list[Line]:
        """Return the declarations of what repeats."""
        names = self.names
        return [
            Line(""),
            Line(CHOICE),
            *(Line(f"uniform int {names[name]};") for name in (REPEATS, NEVER)),
            Line(f"int {names['inside']} = 0;"),
        ]


class TimingWriter(InstrumentWriter):
    """Writes each declaration twice: as it is, and repeated."""

    instrument: Repetitions

    def statement(self, stmt: Stmt, *, tail: bool) -> None:
        """Append a statement."""
        is_repeatable = isinstance(stmt, Let | Var) and self._is_repeatable(stmt)
        number = self.instrument.number(stmt.span) if is_repeatable else None
        if number is None or not isinstance(stmt, Let | Var):
            super().statement(stmt, tail=tail)
            return
        self.line(f"#if {MEASURED} == {number} || {MEASURED} == {-2 - number}")
        self._repeated(stmt, number)
        self.line("#else")
        super().statement(stmt, tail=tail)
        self.line("#endif")

    def _repeated(self, stmt: Let | Var, number: int) -> None:
        names = self.instrument.names
        inside, never, repeats = names["inside"], names[NEVER], names[REPEATS]
        result, type = self.locals[stmt.name], stmt.value.type
        is_summed = self.instrument.evaluations(number) > 1
        kept, rounds, round_ = map(self.local_namer.name, ("kept", "rounds", "round"))
        start = f"{self.type_name(type)}({never})" if is_summed else self.zero(type)
        self.line(self.declaration(kept, Code(start), type, mutable=True))
        self.line(self.declaration(result, Code(self.zero(type)), type, mutable=True))
        reads = _reads(stmt)
        copies = {
            r.name: self.temporary(r.name, Code(self.locals[r.name]), r.type, mutable=True).text
            for r in reads
        }
        # A line that a line of the same number calls is not repeated in each repetition.
        self.line(f"int {rounds} = {inside} == 0 ? {repeats} : 1;")
        self.line(f"{inside} += 1;")
        self.line(f"for (int {round_} = 0; {round_} < {rounds}; {round_}++) {{")
        self.depth += 1
        for turn in range(self.instrument.evaluations(number)):
            self._evaluation(stmt, number, kept, copies)
            zeros = [f"{copies[r.name]} = {self.zero(r.type)};" for r in reads]
            taken = [] if is_summed else [f"{kept} = {result};"]
            self._where(f"{round_} + {turn} == {never}", [*taken, *zeros])
        self.depth -= 1
        self.line("}")
        self.line(f"{inside} -= 1;")
        # Without its computation the loop still has to keep the copies.
        back = [f"{self.locals[name]} = {copy};" for name, copy in copies.items()]
        self._where(f"{rounds} == {never}", [f"{result} = {kept};", *back])
        self.line(f"#if {MEASURED} != {number}")
        self.line(f"{result} = {self.expression(stmt.value).text};")
        self.line("#endif")

    def _evaluation(self, stmt: Let | Var, number: int, kept: str, copies: dict[str, str]) -> None:
        """Append one evaluation; of several each is used, so that none is left out."""
        result = self.locals[stmt.name]
        before, self.locals = self.locals, self.locals | copies
        self.line(f"#if {MEASURED} == {number}")
        self.line(f"{result} = {self.expression(stmt.value).text};")
        self.locals = before
        if self.instrument.evaluations(number) > 1:
            is_truth = kind_of(stmt.value.type) is Kind.BOOL
            self.line(f"{kept} = {kept} != {result};" if is_truth else f"{kept} += {result};")
            self.line("#else")
            self.line(f"{kept} = !{kept};" if is_truth else f"{kept} += {kept};")
        self.line("#endif")

    def _is_repeatable(self, stmt: Let | Var) -> bool:
        """Return whether a declaration computes anything."""
        is_stored = isinstance(stmt.value, Construct) and is_table(stmt.value)
        return self.instrument.cost(stmt.value) > 0 and not is_stored

    def _where(self, condition: str, lines: list[str]) -> None:
        self.line(f"if ({condition}) {{")
        self.depth += 1
        for line in lines:
            self.line(line)
        self.depth -= 1
        self.line("}")


def _is_short(stmt: Let | Var) -> bool:
    """Return whether a declaration calls nothing, and its values can be added up."""
    value = stmt.value
    is_vector_of_truth = kind_of(value.type) is Kind.BOOL and not isinstance(value.type, Scalar)
    is_summed = isinstance(value.type, Scalar | Vector | Matrix) and not is_vector_of_truth
    return is_summed and not contents(value).callees


def _reads(stmt: Let | Var) -> list[Read]:
    """Return the locals that a declaration reads, each once; to copy arrays would take longer."""
    reads = {n.name: n for n in nodes_in(stmt.value) if isinstance(n, Read)}
    return [read for read in reads.values() if not isinstance(read.type, Array)]


def prepared(program: GlslProgram, timing: Repetitions) -> GlslProgram:
    """Return a program that repeats a line."""
    placed = [
        stmt
        for fn in program.module.functions
        for stmt in statements_in(fn.body)
        if isinstance(stmt, Let | Var) and timing.is_placed(stmt.span)
    ]
    timing.long = {
        (stmt.span.file, stmt.span.line)
        for stmt in placed
        if stmt.span is not None and not _is_short(stmt)
    }
    timing.names = {name: program.names.namer.name(name) for name in (REPEATS, NEVER, "inside")}
    return replace(program, instrument=timing)


def timed(artifact: Artifact, timing: Repetitions) -> Artifact:
    """Return the program with its uniforms: one round, and the number of none."""
    defaults = {REPEATS: 1, NEVER: -1}
    added = [
        {"name": n, "uniform": timing.names[n], "type": "int", "default": default}
        | {"origin": Origin.NUMBER.value}
        for n, default in defaults.items()
    ]
    uniforms = [*artifact.interface["uniforms"], *added]
    return replace(artifact, interface={**artifact.interface, "uniforms": uniforms})
