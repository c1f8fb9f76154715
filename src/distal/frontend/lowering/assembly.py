"""Functions of the IR made by objects instead of by a ``def``: shapes and scenes.

Input: library functions as they were recorded, arguments as expressions, by name. Output: calls,
and functions added to the program. Knows nothing of what the objects are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from distal.diagnostics import CompileError, Span
from distal.frontend.lowering.exact_overloads import exact_instance
from distal.frontend.lowering.instances import Instance
from distal.frontend.problems import FollowupError
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, SignatureParameter
from distal.frontend.types.python_objects import RefusedError, coerce_constant, value_of
from distal.ir.nodes import Call, Expr, Function, Param, Return, Stmt
from distal.ir.types import Buffer, Type
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer as LangBuffer
from distal.lang.resources import TextureValue

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation


class Assembly:
    """What an object uses to add its functions to a program."""

    def __init__(self, compilation: Compilation) -> None:
        self._compilation = compilation
        # For the objects: what they made already in this program, by their own keys.
        self.made: dict[Any, Any] = {}

    def call(self, func: Func, arguments: Mapping[str, Expr]) -> Expr:
        """A call of a scene function with those of the arguments that its parameters name.

        A parameter without argument takes its default. Of overloads, the first is called whose
        parameters all have an argument or a default.
        """
        parameters = self._parameters_of(func, arguments)
        args = tuple(self._argument(func, parameter, arguments) for parameter in parameters)
        instance = exact_instance(self._compilation, func, tuple(a.type for a in args))
        if instance.result is None:
            raise FollowupError
        return Call(instance.name, args, instance.result)

    def parameter_names(self, func: Func) -> tuple[str, ...]:
        """The names of a function's parameters (of its first overload)."""
        return tuple(p.name for p in self._compilation.signature(func.overloads[0]).parameters)

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
        # A kernel that writes a vector into memory for a float would write beyond it.
        if body and isinstance(body[-1], Return):
            given = body[-1].value.type
            if given != result:
                raise CompileError.at(f"'{name}' gives a {given}; a {result} is wanted", span)
        unique = self._compilation.unique_name(name)
        self._compilation.functions.append(
            Function(unique, tuple(params), result, tuple(body), name, span=span)
        )
        return unique

    def function(self, name: str) -> Function:
        """A function that the program has already."""
        return next(f for f in self._compilation.functions if f.name == name)

    def composed(self, obj: Composed) -> Instance:
        """The function of another object."""
        return self._compilation.composed(obj)

    def adopt(self, type: Type) -> Type:
        """The type as this program spells it."""
        return self._compilation.adopt(type)

    def struct(self, cls: type) -> Type:
        """The type of a ``@struct`` class."""
        return self._compilation.adopt(to_type(cls))

    def constant(self, value: Any, type: Type) -> Expr:
        """A Python value as a constant of a type."""
        found = coerce_constant(value_of(value, "value", self._compilation), type)
        assert found is not None, f"{value!r} is no {type}"
        return found

    def uniform(self, parameter: Parameter) -> Expr:
        """The value of a parameter."""
        return self._compilation.uniform(parameter)

    def expression(self, expression: Expression) -> Expr:
        """The value of an expression of parameters and time."""
        return self._compilation.computed(expression)

    def number(self, preferred_name: str, type: Type, value: Any) -> Expr:
        """A number of the scene: a uniform with this value and, if it is free, this name."""
        return self._compilation.number(preferred_name, type, value)

    def resource(self, resource: TextureValue | LangBuffer, preferred_name: str) -> Expr:
        """A texture or buffer."""
        if isinstance(resource, TextureValue):
            return self._compilation.resource(resource, preferred_name, resource.__distal_type__)
        return self._compilation.resource(resource, preferred_name, Buffer(resource.element))

    def _parameters_of(
        self, func: Func, arguments: Mapping[str, Expr]
    ) -> tuple[SignatureParameter, ...]:
        signatures = [self._compilation.signature(o) for o in func.overloads]
        for signature in signatures:
            if signature.problems:
                raise FollowupError
            given = [p for p in signature.parameters if p.name in arguments]
            enough = all(
                p.name in arguments or p.default is not MISSING for p in signature.parameters
            )
            matching = all(self._accepts(p, arguments[p.name].type) for p in given)
            if enough and (matching or len(signatures) == 1):
                return signature.parameters
        wanted = {p.name for p in signatures[0].parameters if p.default is MISSING} - set(arguments)
        message = f"nothing gives '{func.name}' its {', '.join(sorted(wanted)) or 'arguments'}"
        hint = f"it may ask for {', '.join(arguments)}"
        raise CompileError.at(message, signatures[0].span, hint)

    def _accepts(self, parameter: SignatureParameter, type: Type) -> bool:
        try:
            return self._compilation.adopt(to_type(parameter.annotation)) is type
        except AnnotationError:
            return False
        except UnboundVariableError:
            return True

    def _argument(
        self, func: Func, parameter: SignatureParameter, arguments: Mapping[str, Expr]
    ) -> Expr:
        if parameter.name in arguments:
            return arguments[parameter.name]
        try:
            type = self._compilation.adopt(to_type(parameter.annotation))
            value = coerce_constant(
                value_of(parameter.default, parameter.name, self._compilation), type
            )
        except (AnnotationError, RefusedError) as error:
            raise CompileError.at(error.message, parameter.span, error.hint) from None
        if value is None:
            message = f"the default of '{parameter.name}' of '{func.name}' is no {type}"
            raise CompileError.at(message, parameter.span)
        return value
