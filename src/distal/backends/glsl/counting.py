"""Write a GLSL program whose pixels are counts: how often a line of the author runs.

Input: a module without the passes that move or merge statements. Output: the program, whose uniform
``COUNTED`` picks the line, and the places of all lines by their numbers. Of several statements of
one line in a block the first is counted: a line that runs once counts once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final

from distal.backends.base import Artifact
from distal.backends.clike.code import Line
from distal.backends.clike.expense import Expense
from distal.backends.glsl.instruments import Instrument, InstrumentWriter
from distal.ir.nodes import Origin, Stmt

if TYPE_CHECKING:
    from distal.backends.glsl.stages import GlslProgram

COUNTED: Final = "Counted_place"
MOST: Final = 2**24 - 1  # the largest count that a pixel holds
_MAIN: Final = """
void main() {{
    {drawn_picture}();
    int shown = min({count}, {most});
    ivec3 digits = ivec3(shown, shown / 256, shown / 65536) % 256;
    fragment_color = vec4(vec3(digits) / 255.0, 1.0);
}}
"""


class Counts(Instrument):
    """Counts runs.

    Attributes:
        wanted: The names that the declarations have, if the author has none of them.
        declarations: The declarations of what counts; ``count`` is what a pixel shows.
        splits: Whether statements compute their values in locals of their own.
    """

    wanted: ClassVar[tuple[str, ...]] = (COUNTED, "count", "run", "drawn_picture")
    declarations: ClassVar[str] = """
uniform int {Counted_place};
int {count} = 0;
void {run}(int place) {{
    if (place == {Counted_place}) {{
        {count} += 1;
    }}
}}"""
    splits: ClassVar[bool] = False

    def writer(self, program: GlslProgram) -> InstrumentWriter:
        """Return a new writer for the stage of the pixels."""
        return CountingWriter(self, program.names, Expense(program.module), program.fixed)

    def declaration_lines(self) -> list[Line]:
        """Return the declarations of what counts."""
        return [Line(text) for text in self.declarations.format(**self.names).split("\n")]


class CountingWriter(InstrumentWriter):
    """Writes a call before each statement."""

    _lines: frozenset[int] = frozenset()

    def block(self, body: tuple[Stmt, ...], *, tail: bool = False) -> None:
        """Append statements."""
        before, self._lines = self._lines, frozenset()
        super().block(body, tail=tail)
        self._lines = before

    def statement(self, stmt: Stmt, *, tail: bool) -> None:
        """Append a statement after the call that counts it."""
        number = self.instrument.number(stmt.span)
        if number is not None and number not in self._lines:
            self._lines |= {number}
            self.line(f"{self.instrument.names['run']}({number});")
        super().statement(stmt, tail=tail)


def prepared(program: GlslProgram, counts: Counts) -> GlslProgram:
    """Return a program that counts: its picture is a function of its own."""
    counts.names = {name: program.names.namer.name(name) for name in counts.wanted}
    target = replace(program.target, main=f"void {counts.names['drawn_picture']}()")
    return replace(program, target=target, instrument=counts)


def counting(artifact: Artifact, counts: Counts) -> Artifact:
    """Return the program with the entry that draws the count: red + 256 green + 65536 blue."""
    text = _MAIN.format(**counts.names, most=MOST)
    uniform = {"name": COUNTED, "uniform": counts.names[COUNTED], "type": "int", "default": 0}
    uniforms = [*artifact.interface["uniforms"], uniform | {"origin": Origin.NUMBER.value}]
    return replace(
        artifact,
        text=artifact.text + text,
        interface={**artifact.interface, "uniforms": uniforms},
        lines=(*artifact.lines, *(None for _ in text.splitlines())),
    )
