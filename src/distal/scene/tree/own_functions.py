"""Checks of an author's function that stands where the library has functions of its own.

Input: the author's value, and what such a function takes and returns. Output: the ``@func``, or an
error at the author's line. Does not depend on what the function computes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.diagnostics import Span
from distal.frontend.signatures.signatures import MISSING
from distal.ir.types import FLOAT, VEC3, FunctionType, Type
from distal.lang.functions import Func
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.calls import result_of
from distal.scene.tree.conversion import type_name
from distal.scene.tree.errors import refuse_kind


@dataclass(frozen=True, slots=True)
class OwnFunction:
    """What an author's function is for.

    Attributes:
        noun: What it is called in messages: "a tone map".
        takes: The names of its parameters for hints, and their types.
        gives: The type of its result.
    """

    noun: str
    takes: Sequence[tuple[str, Type]]
    gives: Type

    @property
    def type(self) -> FunctionType:
        """The type of the function."""
        return FunctionType(tuple(type for _, type in self.takes), self.gives)

    def checked(self, value: Any, place: Span | None) -> Func:
        """Return the author's function.

        Args:
            value: The author's value.
            place: The author's line.

        Raises:
            SceneTypeError: It is no ``@func``, or takes or returns something else.
            CompileError: Its signature is not valid scene code.
        """
        noun = self.noun.partition(" ")[2]
        if not isinstance(value, Func):
            kind = f"{type_name(value)} {value!r:.40}"
            hint = f"@func above {self._hint(noun.replace(' ', '_'))}"
            refuse_kind(f"{self.noun} is a @func, not {kind}", hint, place)
        slots = slots_of(value)
        needed = [slot.type for slot in slots if slot.default is MISSING]
        first = [slot.type for slot in slots[: len(self.takes)]]
        wanted = [type for _, type in self.takes]
        if first != wanted or len(needed) > len(wanted) or result_of(value) is not self.gives:
            took = ", ".join(str(slot.type) for slot in slots) or "nothing"
            gave = result_of(value) or "no declared type"
            message = f"'{value.name}' is no {noun}: it takes {took} and returns {gave}"
            refuse_kind(message, self._hint(value.name), place)
        return value

    def _hint(self, name: str) -> str:
        taken = ", ".join(f"{of}: {type}" for of, type in self.takes)
        return f"def {name}({taken}) -> {self.gives}"


TONE_MAP: Final = OwnFunction("a tone map", (("light", VEC3),), VEC3)
FALLOFF: Final = OwnFunction("a falloff", (("distance", FLOAT),), FLOAT)
