"""What programs that measure lines have in common: the places of statements, and a writer.

Input: which files are the author's. Output: numbers of places, a writer that knows its instrument.
``glsl.counting``, ``glsl.work`` and ``glsl.timing`` are the three.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from distal.backends.clike.code import Code, Line
from distal.backends.clike.expense import Expense
from distal.backends.clike.module_names import ModuleNames
from distal.backends.glsl.writer import GlslWriter
from distal.diagnostics import Span
from distal.ir.nodes import Expr, Function, If

if TYPE_CHECKING:
    from distal.backends.glsl.stages import GlslProgram


@dataclass(slots=True)
class Instrument:
    """What is measured, and under which names.

    Attributes:
        is_counted: Whether the statements of a file are measured.
        cost: The operations of an expression, without those of the functions that it calls.
        places: File and line by the number of the place.
        names: The names that the text has for it, by the names they would like to have.
    """

    is_counted: Callable[[str], bool]
    cost: Callable[[Expr], int]
    places: list[tuple[str, int]] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)

    def number(self, span: Span | None) -> int | None:
        """Return the number of a place; None where it is not measured."""
        if span is None or not self.is_counted(span.file):
            return None
        place = (span.file, span.line)
        if place not in self.places:
            self.places.append(place)
        return self.places.index(place)

    def is_placed(self, span: Span | None) -> bool:
        """Return whether a statement at a place is measured."""
        return span is not None and self.is_counted(span.file)

    @abstractmethod
    def writer(self, program: GlslProgram) -> GlslWriter:
        """Return a new writer for the stage of the pixels."""

    @abstractmethod
    def declaration_lines(self) -> list[Line]:
        """Return the declarations of what measures."""


class InstrumentWriter(GlslWriter):
    """Writes the functions of a program that measures; its locals leave the instrument's names."""

    def __init__(
        self,
        instrument: Instrument,
        names: ModuleNames,
        expense: Expense,
        uniform_texts: Mapping[str, str],
    ) -> None:
        """Create a writer.

        Args:
            instrument: What is measured.
            names: The names in the text.
            expense: The costs of functions.
            uniform_texts: The texts of the uniforms that are not declared by name.
        """
        super().__init__(names, expense, uniform_texts)
        self.instrument = instrument

    def mentioned(self, fn: Function) -> frozenset[str]:
        """Return the module-scope names that the function's text may contain."""
        return super().mentioned(fn) | frozenset(self.instrument.names.values())

    def _if(self, stmt: If, condition: Code, tail: bool) -> None:
        # An elif is a statement of its own: it counts when it is reached.
        self.line(f"if ({condition.text}) {{")
        self.inner(stmt.then, tail=tail)
        if stmt.otherwise:
            self.line("} else {")
            self.inner(stmt.otherwise, tail=tail)
        self.line("}")
