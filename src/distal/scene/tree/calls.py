"""Calls of scene functions with their arguments: patterns, materials, lights, cameras.

Input: a function and checked values, which may be such calls themselves (a material whose color is
a pattern). Output: on request, the call as an expression of the IR. Does not depend on what the
function computes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

from distal.diagnostics import Span
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, read_signature
from distal.ir.nodes import Expr
from distal.ir.types import BOOL, FLOAT, INT, FunctionType, Type
from distal.lang.functions import Func
from distal.lang.immutable import Immutable
from distal.lang.resources import Buffer, TextureValue
from distal.render.declarations import PLACE_NAMES
from distal.render.footprint import footprint_length
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.conversion import NO_VALUES, Number
from distal.scene.tree.value import CalledValue
from distal.scene.tree.varying import Composer, expression_of

FOOTPRINT: Final = "footprint"
FACING: Final = "facing"


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True, init=False)
class FunctionCall(Immutable):
    """A scene function and its arguments.

    Attributes:
        what: The name in messages, and the stem of the numbers' names in emitted text.
        func: The function. Its other parameters come from the place where it is evaluated.
        values: The values by parameter: numbers, choices, textures, buffers, or objects that emit.
        place: The author's line.
    """

    what: str
    func: Func
    values: Mapping[str, Any]
    place: Span | None

    def __init__(
        self,
        what: str,
        func: Func,
        values: Mapping[str, Any] = NO_VALUES,
        place: Span | None = None,
    ) -> None:
        """Keep the call's parts; the arguments are the attributes.

        Args:
            what: The name in messages.
            func: The function.
            values: The values by parameter.
            place: The author's line.
        """
        # Each part of a scene may have a material, so it is made without object.__setattr__.
        _set_what(self, what)
        _set_func(self, func)
        _set_values(self, values)
        _set_place(self, place)

    def _pickled(self) -> Any:
        return FunctionCall, (self.what, self.func, dict(self.values), self.place)

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """Emit the call. ``site`` provides the function's other arguments (point, normal, cell)."""
        given = dict(site)
        if FOOTPRINT in site and self._takes_length():
            given[FOOTPRINT] = composer.assembly.call(footprint_length, site)
        for name, value in self.values.items():
            given[name] = self._emitted(composer, site, name, value)
        return composer.assembly.call(self.func, given)

    def _takes_length(self) -> bool:
        """Return whether the function takes the length of the footprint, not both sides."""
        return any(s.name == FOOTPRINT and s.type is FLOAT for s in slots_of(self.func))

    def value(self, composer: Composer, name: str) -> Expr:
        """Emit one of the call's values."""
        return self._emitted(composer, {}, name, self.values[name])

    def _emitted(self, composer: Composer, site: Mapping[str, Expr], name: str, value: Any) -> Expr:
        if isinstance(value, Func):
            type = next(s.type for s in slots_of(self.func) if s.name == name)
            assert isinstance(type, FunctionType)
            return composer.assembly.reference(value, type)
        if isinstance(value, bool | int):
            return composer.assembly.constant(value, BOOL if isinstance(value, bool) else INT)
        if not isinstance(value, Number | TextureValue | Buffer):
            nested: Expr = value.emit(composer, site)
            return nested
        # A value that several places or functions read is one number of the program.
        made = composer.assembly.made
        key = (FunctionCall, id(value))
        if key not in made:
            stem = f"{_identifier(self.what)}_{name}"
            made[key] = (
                value,
                expression_of(composer.assembly, value, stem),
            )  # kept alive, so that its id is not reused
        found: Expr = made[key][1]
        return found

    @property
    def uses(self) -> frozenset[str]:
        """Which of ``PLACE_NAMES`` the call or its values depend on."""
        found = _own_uses(self.func, tuple(self.values))
        for value in self.values.values():
            if type(value) is not Number and hasattr(value, "uses"):
                found |= value.uses
        return found

    @property
    def result(self) -> Type | None:
        """The type that the function's signature declares; None if each call decides it."""
        return result_of(self.func)

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions that the call and its values need."""
        yield self.func
        for value in self.values.values():
            if isinstance(value, Func):
                yield value
            elif hasattr(value, "functions"):
                yield from value.functions()


_set_what, _set_func, _set_values, _set_place = (
    vars(FunctionCall)[name].__set__ for name in ("what", "func", "values", "place")
)


@lru_cache(maxsize=1024)
def _own_uses(func: Func, given: tuple[str, ...]) -> frozenset[str]:
    """Return which of ``PLACE_NAMES`` a function takes besides the given values."""
    return PLACE_NAMES & ({slot.name for slot in slots_of(func)} - set(given))


def result_of(func: Func) -> Type | None:
    """Return the result type that a function's signature declares, or None."""
    result = read_signature(func.overloads[0]).result
    if result is MISSING:
        return None
    try:
        return to_type(result)
    except (AnnotationError, UnboundVariableError):
        return None


def _identifier(what: str) -> str:
    return "".join(c if c.isascii() and c.isalnum() else "_" for c in what)


class Pattern(CalledValue, FunctionCall):
    """A color (vec3) or an amount (float) that varies over a surface.

    A material accepts it instead of a color or a number.
    """

    __slots__ = ("_kept_digest", "_origin")

    noun = "pattern"

    def _checked(self) -> Iterator[Mapping[str, Any]]:
        yield self.values

    def _compared(self) -> tuple[Any, ...]:
        return self.noun, self.func, self.values
