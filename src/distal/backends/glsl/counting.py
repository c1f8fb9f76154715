"""Write a GLSL program whose pixels are counts: how often a statement of the author runs.

Input: a module without the passes that move or merge statements. Output: the program, whose uniform
``COUNTED`` picks the statement, and the places of all statements by their numbers. Of several
statements of one line in a block the first is counted: a line that runs once counts once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from distal.backends.base import Artifact
from distal.backends.clike.code import Code, Line
from distal.backends.glsl.writer import GlslWriter
from distal.ir.nodes import If, Origin, Stmt

if TYPE_CHECKING:
    from distal.backends.glsl.stages import GlslProgram

COUNTED: Final = "Counted_place"


@dataclass(slots=True)
class Counts:
    """What is counted, and under which names.

    Attributes:
        is_counted: Whether the statements of a file are counted.
        names: The names of the uniform, the count, the function that counts, and the picture.
        places: File and line by the number of the place.
    """

    is_counted: Callable[[str], bool]
    names: tuple[str, str, str, str] = ("", "", "", "")
    places: list[tuple[str, int]] = field(default_factory=list)

    def number(self, file: str, line: int) -> int:
        """Return the number of a place."""
        if (file, line) not in self.places:
            self.places.append((file, line))
        return self.places.index((file, line))


class CountingWriter(GlslWriter):
    """Writes a call before each statement.

    Attributes:
        counts: What is counted; None until it is set.
    """

    counts: Counts | None = None
    _lines: frozenset[tuple[str, int]] = frozenset()

    def block(self, body: tuple[Stmt, ...], *, tail: bool = False) -> None:
        """Append statements."""
        before, self._lines = self._lines, frozenset()
        super().block(body, tail=tail)
        self._lines = before

    def statement(self, stmt: Stmt, *, tail: bool) -> None:
        """Append a statement after the call that counts it."""
        span = stmt.span
        if self.counts is not None and span is not None and self.counts.is_counted(span.file):
            place = (span.file, span.line)
            if place not in self._lines:
                self._lines |= {place}
                self.line(f"{self.counts.names[2]}({self.counts.number(*place)});")
        super().statement(stmt, tail=tail)

    def _if(self, stmt: If, condition: Code, tail: bool) -> None:
        # An elif is a statement of its own: it counts when it is reached.
        self.line(f"if ({condition.text}) {{")
        self.inner(stmt.then, tail=tail)
        if stmt.otherwise:
            self.line("} else {")
            self.inner(stmt.otherwise, tail=tail)
        self.line("}")


def prepared(program: GlslProgram, counts: Counts) -> GlslProgram:
    """Return a program that counts: its picture is a function of its own."""
    name = program.names.namer.name
    counts.names = (name(COUNTED), name("runs"), name("run"), name("drawn_picture"))
    target = replace(program.target, main=f"void {counts.names[3]}()")
    return replace(program, target=target, counts=counts)


def declaration_lines(counts: Counts) -> list[Line]:
    """Return the declarations of what counts."""
    place, runs, run, _ = counts.names
    texts = (
        f"uniform int {place};",
        f"int {runs} = 0;",
        f"void {run}(int place) {{",
        f"    if (place == {place}) {{",
        f"        {runs} += 1;",
        "    }",
        "}",
    )
    return [Line(""), *map(Line, texts)]


def counting(artifact: Artifact, counts: Counts) -> Artifact:
    """Return the program with the entry that draws the count: red + 256 green + 65536 blue."""
    place, runs, _, picture = counts.names
    text = f"""
void main() {{
    {picture}();
    ivec3 digits = ivec3({runs}, {runs} / 256, {runs} / 65536) % 256;
    fragment_color = vec4(vec3(digits) / 255.0, 1.0);
}}
"""
    uniform = {"name": COUNTED, "uniform": place, "type": "int", "default": 0}
    uniforms = [*artifact.interface["uniforms"], uniform | {"origin": Origin.NUMBER.value}]
    return replace(
        artifact,
        text=artifact.text + text,
        interface={**artifact.interface, "uniforms": uniforms},
        lines=(*artifact.lines, *(None for _ in text.splitlines())),
    )
