"""A scene function together with its arguments: patterns, materials, lights, cameras.

Input: a function and checked values, which may be such calls themselves (a material whose
colour is a pattern). Output: on request, the call as an expression of the IR. Knows nothing
of what the function means.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from distal.diagnostics import Span
from distal.frontend import Assembly
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, read_signature
from distal.ir.nodes import Expr
from distal.ir.types import BOOL, INT, Type
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.immutable import Immutable
from distal.lang.resources import Buffer, TextureValue
from distal.render.declarations import PLACE_NAMES
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.conversion import Number


class Composer(Protocol):
    """What emits values into a program: anything that has the program's assembly."""

    @property
    def assembly(self) -> Assembly:
        """Where functions, numbers and resources are added."""
        ...


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class FunctionCall(Immutable):
    """A scene function and its values.

    Attributes:
        what: What messages call it, and the stem of its numbers' names in emitted text.
        func: The function. Its other parameters come from the place where it is evaluated.
        values: By parameter: numbers, choices, textures, buffers, or something that emits.
        place: Where the author made it.
    """

    what: str
    func: Func
    values: Mapping[str, Any] = field(default_factory=dict)
    place: Span | None = None

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """The call, where ``site`` has what the function may ask for besides its values."""
        given = dict(site)
        for name, value in self.values.items():
            given[name] = self._emitted(composer, site, name, value)
        return composer.assembly.call(self.func, given)

    def value(self, composer: Composer, name: str) -> Expr:
        """One of its values, as the call gets it."""
        return self._emitted(composer, {}, name, self.values[name])

    def _emitted(self, composer: Composer, site: Mapping[str, Expr], name: str, value: Any) -> Expr:
        if isinstance(value, bool | int):
            return composer.assembly.constant(value, BOOL if isinstance(value, bool) else INT)
        if not isinstance(value, Number | TextureValue | Buffer):
            nested: Expr = value.emit(composer, site)
            return nested
        # What is read at several places, or by several functions, is one number of the program.
        made = composer.assembly.made
        key = (FunctionCall, id(value))
        if key not in made:
            stem = f"{_identifier(self.what)}_{name}"
            made[key] = (
                value,
                expression_of(composer.assembly, value, stem),
            )  # alive, so the id stays
        found: Expr = made[key][1]
        return found

    @property
    def uses(self) -> frozenset[str]:
        """Which of "p", "n", "cell" it needs, itself or for its values."""
        own = {slot.name for slot in slots_of(self.func)} - set(self.values)
        nested = (value.uses for value in self.values.values() if hasattr(value, "uses"))
        return PLACE_NAMES & own.union(*nested)

    @property
    def result(self) -> Type | None:
        """What the function says it gives; None where only a call decides."""
        return result_of(self.func)

    def functions(self) -> Iterator[Func]:
        """The functions that it and its values call."""
        yield self.func
        for value in self.values.values():
            if hasattr(value, "functions"):
                yield from value.functions()


def result_of(func: Func) -> Type | None:
    """The type that a function's first line says it gives, or None."""
    result = read_signature(func.overloads[0]).result
    if result is MISSING:
        return None
    try:
        return to_type(result)
    except (AnnotationError, UnboundVariableError):
        return None


def expression_of(assembly: Assembly, value: Number | TextureValue | Buffer, stem: str) -> Expr:
    """A value in a program: a uniform of its own, the author's expression, a resource."""
    if not isinstance(value, Number):
        return assembly.resource(value, stem)
    if isinstance(value.value, Expression):
        return assembly.expression(value.value)
    return assembly.number(stem, value.type, value.value)


def _identifier(what: str) -> str:
    return "".join(c if c.isascii() and c.isalnum() else "_" for c in what)


class Pattern(FunctionCall):
    """A colour (vec3) or an amount (float) that differs from place to place on a surface.

    It stands wherever a material takes a colour or a number.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        return f"<pattern {self.what}>"
