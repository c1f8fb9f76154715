"""Build IR functions for objects (shapes and scenes) that have no ``def``.

Input: recorded library functions, and their arguments as expressions, by name. Output: calls, and
functions added to the program. Does not depend on the kinds of objects.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.frontend.lowering.exact_overloads import exact_instance
from distal.frontend.lowering.instances import Instance
from distal.frontend.problems import FollowupError, must_be
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, SignatureParameter
from distal.frontend.types.python_objects import RefusedError, coerce_constant, value_of
from distal.frontend.values import describe
from distal.ir.nodes import Call, Expr, Function, FunctionRef, Param, Read, Return, Stmt
from distal.ir.types import Buffer, FunctionType, Type
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer as LangBuffer
from distal.lang.resources import TextureValue

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation


# The least number of parts of which an object makes a table, unless a caller says otherwise.
TABLE_FROM: Final = 16


class Assembly:
    """The interface through which an object adds its functions to a program.

    Attributes:
        made: What the objects have already added to this program, by keys that they choose.
    """

    def __init__(self, compilation: Compilation) -> None:
        self._compilation = compilation
        self.made: dict[Any, Any] = {}
        self._called: dict[Any, tuple[tuple[SignatureParameter, ...], Instance]] = {}
        self._defined: dict[tuple[str, tuple[Param, ...], Type, tuple[Stmt, ...]], str] = {}

    @property
    def table_from(self) -> int | None:
        """The least number of parts whose numbers may be put into buffers; None for no buffers."""
        return self._compilation.table_from

    def call(self, func: Func, arguments: Mapping[str, Expr]) -> Expr:
        """Return a call of a scene function, with arguments bound by parameter name.

        Arguments that the function has no parameter for are ignored. A parameter without an
        argument takes its default. The first overload whose parameters all have an argument or a
        default, and accept the arguments' types, is called.

        Raises:
            CompileError: A parameter has neither an argument nor a default.
            FollowupError: The function has errors, which are reported already.
            SceneError: The types of the arguments do not match.
        """
        key = (func, *((name, e.type) for name, e in arguments.items()))
        known = self._called.get(key)
        parameters = self._parameters_of(func, arguments) if known is None else known[0]
        args = tuple(self._argument(func, parameter, arguments) for parameter in parameters)
        if known is None:
            instance = exact_instance(self._compilation, func, tuple(a.type for a in args))
            if instance.result is None:
                raise FollowupError
            known = self._called[key] = (parameters, instance)
        instance = known[1]
        assert instance.result is not None
        return Call(instance.name, args, instance.result)

    def reference(self, func: Func, type: FunctionType) -> Expr:
        """Return a scene function as an argument of others.

        Args:
            func: The function; parameters beyond those of the type have defaults.
            type: What it takes and returns.

        Raises:
            FollowupError: The function has errors, which are reported already.
            SceneError: The types do not match.
        """
        adopted = FunctionType(tuple(map(self.adopt, type.params)), self.adopt(type.result))
        names = self.parameter_names(func)[: len(adopted.params)]
        params = [Param(name, taken) for name, taken in zip(names, adopted.params, strict=True)]
        value = self.call(func, {param.name: Read(param.name, param.type) for param in params})
        name = self.define(func.name, params, adopted.result, (Return(value),))
        return FunctionRef(name, (), adopted)

    def parameter_names(self, func: Func) -> tuple[str, ...]:
        """Return the names of the parameters of a function's first overload."""
        return tuple(p.name for p in self._compilation.signature(func.overloads[0]).parameters)

    def result(self, func: Func, arguments: Mapping[str, Expr]) -> Type:
        """Return the result type of ``call`` with the same arguments."""
        return self.call(func, arguments).type

    def define(
        self,
        name: str,
        params: Sequence[Param],
        result: Type,
        body: Sequence[Stmt],
        span: Span | None = None,
    ) -> str:
        """Add a function and return its unique name in the program.

        If an equal function with the same preferred name was added before, its name is returned: a
        scene makes the distance of its parts for each march.

        Args:
            name: The preferred name.
            params: Its parameters.
            result: Its result type.
            body: Its statements.
            span: Where the author wrote the object.

        Raises:
            CompileError: The type of the returned value is not ``result``. This happens if an
                author's function has a wrong result type.
        """
        # A kernel that wrote a vector where the memory holds a float would write out of bounds.
        if body and isinstance(body[-1], Return):
            given = body[-1].value.type
            if given != result:
                raise CompileError.at(
                    ErrorCode.TYPE, must_be(f"the value of '{name}'", result, given), span
                )
        key = (name, tuple(params), result, tuple(body))
        unique = self._defined.get(key)
        if unique is None:
            unique = self._defined[key] = self._compilation.unique_name(name)
            self._compilation.add(
                Function(unique, tuple(params), result, tuple(body), name, span=span)
            )
        return unique

    def function(self, name: str) -> Function:
        """Return a function that is already in the program."""
        return next(f for f in self._compilation.functions if f.name == name)

    def composed(self, obj: Composed) -> Instance:
        """Return the function of another object."""
        return self._compilation.composed(obj)

    def adopt(self, type: Type) -> Type:
        """Return the type with its structs renamed as in this program."""
        return self._compilation.adopt(type)

    def struct(self, cls: type) -> Type:
        """Return the type of a ``@struct`` class."""
        return self._compilation.adopt(to_type(cls))

    def constant(self, value: Any, type: Type) -> Expr:
        """Return a Python value as a constant of a type."""
        found = coerce_constant(value_of(value, "value", self._compilation), type)
        assert found is not None, f"{value!r} is no {type}"
        return found

    def uniform(self, parameter: Parameter) -> Expr:
        """Return a read of a parameter's uniform."""
        return self._compilation.uniform(parameter)

    def expression(self, expression: Expression) -> Expr:
        """Return the IR of an expression of parameters and time."""
        return self._compilation.computed(expression)

    def number(self, preferred_name: str, type: Type, value: Any) -> Expr:
        """Return a number of the scene: a uniform with this value.

        Args:
            preferred_name: The name of the uniform, if no other number has it.
            type: The type of the uniform.
            value: The value.
        """
        return self._compilation.number(preferred_name, type, value)

    def resource(self, resource: TextureValue | LangBuffer, preferred_name: str) -> Expr:
        """Return a texture or buffer as an expression."""
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
        raise CompileError.at(ErrorCode.CALL, message, signatures[0].span, hint)

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
            captured = value_of(parameter.default, parameter.name, self._compilation)
            value = coerce_constant(captured, type)
        except (AnnotationError, RefusedError) as error:
            raise CompileError.at(
                ErrorCode.ANNOTATION, error.message, parameter.span, error.hint
            ) from None
        if value is None:
            what = f"the default of '{parameter.name}' of '{func.name}'"
            message = must_be(what, type, describe(captured))
            raise CompileError.at(ErrorCode.TYPE, message, parameter.span)
        return value
