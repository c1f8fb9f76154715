"""Put definitions together to the text of one LLVM module, or of several of about equal length.

Input: functions and constant tables. Output: texts. Several modules are compiled at the same time;
each declares the functions of the others. LLVM's passes here do not cross functions, so the
instructions are the same in one module and in several.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LlvmFunction:
    """The definition of a function.

    Attributes:
        result: The type of the result.
        symbol: The name, with ``@``.
        params: The parameters: types with attributes, and names.
        body: The lines between the braces.
        exported: Whether the program calls it from outside.
        comment: The author's name of it, or "".
    """

    result: str
    symbol: str
    params: Sequence[tuple[str, str]]
    body: str
    exported: bool = False
    comment: str = ""

    def definition(self, linkage: str) -> str:
        """Return the text of the definition; an exported function has no linkage of its own."""
        params = ", ".join(f"{type} {name}" for type, name in self.params)
        head = f"{'' if self.exported else linkage}{self.result} {self.symbol}({params})"
        comment = f"; {self.comment}\n" if self.comment else ""
        return f"{comment}define {head} #0 {{\n{self.body}\n}}"

    def declaration(self) -> str:
        """Return the text that another module needs to call the function."""
        types = ", ".join(type for type, _ in self.params)
        return f"declare hidden {self.result} {self.symbol}({types}) #0"


@dataclass(frozen=True, slots=True)
class LlvmProgram:
    """The definitions of a program.

    Attributes:
        name: The name of the source.
        definitions: Functions, and texts, in an order of the writer's choice. In a program of
            several modules, each has all texts: constant tables.
        declarations: Declarations of LLVM's intrinsics.
        attributes: The attributes of all functions.
    """

    name: str
    definitions: Sequence[LlvmFunction | str]
    declarations: Sequence[str]
    attributes: str

    def text(self) -> str:
        """Return the whole program as one module."""
        return self._module(
            d if isinstance(d, str) else d.definition("internal ") for d in self.definitions
        )

    def texts(self, most: int, least_length: int) -> list[str]:
        """Return the program as several modules.

        Args:
            most: The largest number of modules.
            least_length: The least mean length of a module, in characters.
        """
        functions = [d for d in self.definitions if not isinstance(d, str)]
        length = sum(len(f.body) for f in functions)
        count = min(most, length // least_length)
        if count < 2:
            return [self.text()]
        # The longest first, each to the shortest module.
        groups: list[list[LlvmFunction]] = [[] for _ in range(count)]
        lengths = [0] * count
        for function in sorted(functions, key=lambda f: -len(f.body)):
            shortest = lengths.index(min(lengths))
            groups[shortest].append(function)
            lengths[shortest] += len(function.body)
        return [self._part(group, functions) for group in groups]

    def _part(self, own: Sequence[LlvmFunction], functions: Sequence[LlvmFunction]) -> str:
        inside = {f.symbol for f in own}
        tables = [d for d in self.definitions if isinstance(d, str)]
        bodies = [f.definition("hidden ") for f in own]
        others = [f.declaration() for f in functions if f.symbol not in inside]
        return self._module((*tables, *bodies, *others))

    def _module(self, definitions: Iterable[str]) -> str:
        parts = (
            f'source_filename = "{self.name}"',
            *definitions,
            *self.declarations,
            self.attributes,
            "!0 = !{}",
        )
        return "\n\n".join(parts) + "\n"
