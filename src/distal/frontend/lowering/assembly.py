"""Functions of the IR made by objects instead of by a ``def``: shapes and scenes.

Input: library functions as they were recorded, arguments as expressions, by name. What
flows out: calls, and functions added to the program. Knows nothing of what the objects are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from distal.diagnostics import CompileError, Span
from distal.frontend.objects import RefusedError, fit_constant, value_of
from distal.frontend.problems import FollowupError
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.exact import exact_instance
from distal.frontend.signatures.instances import Instance
from distal.frontend.signatures.signatures import MISSING, Slot
from distal.ir.nodes import Call, Expr, Function, Param, Return, Stmt
from distal.ir.types import Buffer, Type
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer as LangBuffer
from distal.lang.resources import TextureValue

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Program


class Assembly:
    """What an object is handed to add its functions to a program."""

    def __init__(self, program: Program) -> None:
        self._program = program
        # For whoever composes: what was made already in this program, by keys of their own.
        self.made: dict[Any, Any] = {}

    def call(self, func: Func, arguments: Mapping[str, Expr]) -> Expr:
        """A call of a scene function with those of the arguments that its parameters name.

        A parameter without argument takes its default. Of overloads, the first whose parameters
        all find something is meant.
        """
        slots = self._slots(func, arguments)
        args = tuple(self._argument(func, slot, arguments) for slot in slots)
        instance = exact_instance(self._program, func, tuple(a.type for a in args))
        if instance.result is None:
            raise FollowupError
        return Call(instance.name, args, instance.result)

    def parameter_names(self, func: Func) -> tuple[str, ...]:
        """The names of a function's parameters (of its first overload)."""
        return tuple(s.name for s in self._program.header(func.overloads[0]).slots)

    def result(self, func: Func, arguments: Mapping[str, Expr]) -> Type:
        """What ``call`` would give."""
        return self.call(func, arguments).type

    def define(
        self,
        name: str,
        params: Sequence[Param],
        result: Type,
        body: Sequence[Stmt],
        span: Span | None = None,
    ) -> str:
        """Add a function; its name in the program.

        Raises:
            CompileError: The body gives something else than the result: an author's function does.
        """
        # A kernel that writes a vector where room is for a float would write beyond it.
        if body and isinstance(body[-1], Return):
            given = body[-1].value.type
            if given != result:
                raise CompileError.at(f"'{name}' gives a {given}; a {result} is wanted", span)
        unique = self._program.unique_name(name)
        self._program.functions.append(
            Function(unique, tuple(params), result, tuple(body), name, span=span)
        )
        return unique

    def function(self, name: str) -> Function:
        """A function that the program has already."""
        return next(f for f in self._program.functions if f.name == name)

    def composed(self, obj: Composed) -> Instance:
        """The function of another object."""
        return self._program.composed(obj)

    def adopt(self, type: Type) -> Type:
        """The type as this program spells it."""
        return self._program.adopt(type)

    def struct(self, cls: type) -> Type:
        """The type of a ``@struct`` class."""
        return self._program.adopt(to_type(cls))

    def constant(self, value: Any, type: Type) -> Expr:
        """A Python value as a constant of a type."""
        found = fit_constant(value_of(value, "value", self._program), type)
        assert found is not None, f"{value!r} is no {type}"
        return found

    def uniform(self, parameter: Parameter) -> Expr:
        """The value of a parameter."""
        return self._program.uniform(parameter)

    def expression(self, expression: Expression) -> Expr:
        """The value of an expression of parameters and time."""
        return self._program.computed(expression)

    def number(self, wish: str, type: Type, value: Any) -> Expr:
        """A number of the scene: a uniform with this value, named as wished where that is free."""
        return self._program.number(wish, type, value)

    def resource(self, resource: TextureValue | LangBuffer, wish: str) -> Expr:
        """A texture or buffer."""
        if isinstance(resource, TextureValue):
            return self._program.resource(resource, wish, resource.__distal_type__)
        return self._program.resource(resource, wish, Buffer(resource.element))

    def _slots(self, func: Func, arguments: Mapping[str, Expr]) -> tuple[Slot, ...]:
        headers = [self._program.header(o) for o in func.overloads]
        for header in headers:
            if header.problems:
                raise FollowupError
            given = [s for s in header.slots if s.name in arguments]
            enough = all(s.name in arguments or s.default is not MISSING for s in header.slots)
            fitting = all(self._fits(s, arguments[s.name].type) for s in given)
            if enough and (fitting or len(headers) == 1):
                return header.slots
        wanted = {s.name for s in headers[0].slots if s.default is MISSING} - set(arguments)
        message = f"nothing gives '{func.name}' its {', '.join(sorted(wanted)) or 'arguments'}"
        hint = f"it may ask for {', '.join(arguments)}"
        raise CompileError.at(message, headers[0].span, hint)

    def _fits(self, slot: Slot, type: Type) -> bool:
        try:
            return self._program.adopt(to_type(slot.annotation)) is type
        except AnnotationError:
            return False
        except UnboundVariableError:
            return True

    def _argument(self, func: Func, slot: Slot, arguments: Mapping[str, Expr]) -> Expr:
        if slot.name in arguments:
            return arguments[slot.name]
        try:
            type = self._program.adopt(to_type(slot.annotation))
            value = fit_constant(value_of(slot.default, slot.name, self._program), type)
        except (AnnotationError, RefusedError) as error:
            raise CompileError.at(error.message, slot.span, error.hint) from None
        if value is None:
            message = f"the default of '{slot.name}' of '{func.name}' is no {type}"
            raise CompileError.at(message, slot.span)
        return value
