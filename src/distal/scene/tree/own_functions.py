"""Checks of an author's function that stands where the library has functions of its own.

Input: the author's value, and what such a function takes and returns. Output: the ``@func``, or an
error at the author's line. Does not depend on what the function computes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.diagnostics import Span
from distal.frontend.signatures.annotations import to_type
from distal.frontend.signatures.signatures import MISSING
from distal.ir.nodes import Expr
from distal.ir.types import FLOAT, INT, VEC3, FunctionType, Type
from distal.lang.functions import Func
from distal.render.material import Surface
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.calls import result_of
from distal.scene.tree.conversion import type_name
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.varying import Composer


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
        names = [slot.name for slot in slots[: len(self.takes)]]
        expected = [name for name, _ in self.takes]
        if names != expected and sorted(names) == sorted(expected):
            order = f"{', '.join(expected)}; '{value.name}' has {', '.join(names)}"
            refuse_kind(f"{self.noun} takes {order}", self._hint(value.name), place)
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
_SEEN: Final = (("surface", to_type(Surface)), ("n", VEC3), ("view", VEC3))
EVALUATE: Final = OwnFunction("a scattering function", (*_SEEN, ("light", VEC3)), VEC3)
SAMPLE: Final = OwnFunction("a function of directions", (*_SEEN, ("u", VEC3)), VEC3)
DENSITY: Final = OwnFunction("a density of directions", (*_SEEN, ("light", VEC3)), FLOAT)


@dataclass(frozen=True, slots=True)
class OwnBsdf:
    """An author's scattering function as a value of a material; a program knows it by number.

    Attributes:
        evaluate: The function of the surface, the normal, the view and the light.
        sample: A random direction of light.
        density: The density of these directions by solid angle.
    """

    evaluate: Func
    sample: Func
    density: Func

    @staticmethod
    def known(composer: Composer) -> dict[OwnBsdf, BsdfInProgram]:
        """Return the functions of a program so far."""
        found: dict[OwnBsdf, BsdfInProgram] = composer.assembly.made.setdefault(OwnBsdf, {})
        return found

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """Return the number of the function in a program; 0 in one that does not call it.

        Such programs read its parameters and have its mistakes, too.
        """
        known = self.known(composer)
        if self in known:
            return known[self].number
        self._in_program(composer, 0)
        return composer.assembly.constant(0, INT)

    def number(self, composer: Composer) -> None:
        """Give the function a number in a program that calls it."""
        known = self.known(composer)
        if self not in known:
            known[self] = self._in_program(composer, len(known) + 1)

    def _in_program(self, composer: Composer, number: int) -> BsdfInProgram:
        reference = composer.assembly.reference
        return BsdfInProgram(
            composer.assembly.constant(number, INT),
            reference(self.evaluate, EVALUATE.type),
            reference(self.sample, SAMPLE.type),
            reference(self.density, DENSITY.type),
        )

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions."""
        yield from (self.evaluate, self.sample, self.density)


@dataclass(frozen=True, slots=True)
class BsdfInProgram:
    """An author's scattering function in a program: its number, from 1, and function values."""

    number: Expr
    evaluate: Expr
    sample: Expr
    density: Expr
