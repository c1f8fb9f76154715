"""Values that are known only when a picture is rendered, written with Python's operators.

Input: parameters, the time, numbers, vectors, and operators or built-ins between them
(``0.5 + 0.1 * np.cos(time)``). Output: an ``Expression`` that holds a node of the IR. Operators
have the same meaning as in scene code; the front end implements their rules and is called through
``runtime_access``. NumPy itself calls ``__array_ufunc__``, so NumPy is not imported here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NoReturn

from distal.ir.build import swizzle
from distal.ir.intrinsics import python_functions
from distal.ir.nodes import FRAME_TIME, Expr, Uniform
from distal.ir.printer import print_expression
from distal.ir.types import FLOAT, Type, Vector
from distal.ir.walk import nodes_in
from distal.lang.immutable import Immutable
from distal.lang.lazy_module import LazyModule
from distal.lang.runtime_access import executor, python_expressions

if TYPE_CHECKING:
    from distal.lang import expression_text
    from distal.lang.parameters import Parameter
else:
    expression_text = LazyModule("distal.lang.expression_text")

_RANGE: Final = "range takes a plain int; a live count: shape.shown(i < n) for i in range(8)"
_LANES: Final = {"r": "x", "g": "y", "b": "z", "a": "w", **{c: c for c in "xyzw"}}

# NumPy's functions and their equivalent in scene code: an operator or an intrinsic.
UFUNCS: Final[Mapping[str, str]] = {
    **{"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "true_divide": "/"},
    **{"floor_divide": "//", "remainder": "%", "power": "**", "float_power": "**"},
    **{"less": "<", "less_equal": "<=", "greater": ">", "greater_equal": ">="},
    **{"matmul": "@", "negative": "-x", "positive": "+x"},
    **python_functions("numpy"),
}
_COMPARING: Final = frozenset(("equal", "not_equal"))


class Symbolic(Immutable):
    """Base class of expressions and parameters: has the operators of scene code."""

    __slots__ = ()

    def as_expression(self) -> Expression:
        """Return the value as an expression."""
        raise NotImplementedError

    def __getattr__(self, name: str) -> Expression:
        """Return components of a vector: ``.x``, ``.xz``, ``.rgb``."""
        lanes = "".join(_LANES.get(c, "?") for c in name)
        if 1 <= len(lanes) <= 4 and "?" not in lanes:
            held = self.as_expression()
            type = held.node.type
            if isinstance(type, Vector) and all("xyzw".index(c) < type.size for c in lanes):
                return Expression(swizzle(held.node, lanes), held.parameters)
            raise AttributeError(f"a {type} has no component '{name}'")
        raise AttributeError(f"'{self.__class__.__name__}' has no attribute '{name}'")

    def __iter__(self) -> Iterator[Expression]:
        """Iterate over the components of a vector, so that it can be unpacked."""
        type = self.as_expression().node.type
        if not isinstance(type, Vector):
            raise TypeError(f"a {type} has no components to go through")
        return (getattr(self, lane) for lane in "xyzw"[: type.size])

    # The value is known only at render time, so it has no truth value and cannot become a number.

    def __bool__(self) -> bool:
        _unknown("whether it is true", "select(condition, a, b) of distal.lang, or if in a @func")

    def __float__(self) -> float:
        _unknown("its number", "np.sin(time), or sin of distal.lang, instead of math.sin and float")

    def __int__(self) -> int:
        _unknown("its number", "a count or a choice of a shape is a plain int")

    def __index__(self) -> int:
        _unknown("its number", _RANGE)

    # Comparisons are conditions: for ``select``, ``shown`` and the switches of shapes

    def __lt__(self, other: Any) -> Any:
        return _operated("<", self, other)

    def __le__(self, other: Any) -> Any:
        return _operated("<=", self, other)

    def __gt__(self, other: Any) -> Any:
        return _operated(">", self, other)

    def __ge__(self, other: Any) -> Any:
        return _operated(">=", self, other)

    def __and__(self, other: Any) -> Any:
        return _operated("&", self, other)

    def __rand__(self, other: Any) -> Any:
        return _operated("&", other, self)

    def __or__(self, other: Any) -> Any:
        return _operated("|", self, other)

    def __ror__(self, other: Any) -> Any:
        return _operated("|", other, self)

    def __xor__(self, other: Any) -> Any:
        return _operated("^", self, other)

    def __rxor__(self, other: Any) -> Any:
        return _operated("^", other, self)

    def __invert__(self) -> Any:
        return _operated("~x", self)

    # Arithmetic

    def __add__(self, other: Any) -> Any:
        return _operated("+", self, other)

    def __radd__(self, other: Any) -> Any:
        return _operated("+", other, self)

    def __sub__(self, other: Any) -> Any:
        return _operated("-", self, other)

    def __rsub__(self, other: Any) -> Any:
        return _operated("-", other, self)

    def __mul__(self, other: Any) -> Any:
        return _operated("*", self, other)

    def __rmul__(self, other: Any) -> Any:
        return _operated("*", other, self)

    def __truediv__(self, other: Any) -> Any:
        return _operated("/", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return _operated("/", other, self)

    def __floordiv__(self, other: Any) -> Any:
        return _operated("//", self, other)

    def __rfloordiv__(self, other: Any) -> Any:
        return _operated("//", other, self)

    def __mod__(self, other: Any) -> Any:
        return _operated("%", self, other)

    def __rmod__(self, other: Any) -> Any:
        return _operated("%", other, self)

    def __pow__(self, other: Any) -> Any:
        return _operated("**", self, other)

    def __rpow__(self, other: Any) -> Any:
        return _operated("**", other, self)

    def __matmul__(self, other: Any) -> Any:
        return _operated("@", self, other)

    def __rmatmul__(self, other: Any) -> Any:
        return _operated("@", other, self)

    def __neg__(self) -> Any:
        return _operated("-x", self)

    def __pos__(self) -> Any:
        return _operated("+x", self)

    def __abs__(self) -> Any:
        return _operated("abs", self)

    def __round__(self, digits: int | None = None) -> Any:
        if digits is not None:
            raise TypeError("an expression is rounded to whole numbers only")
        return _operated("round", self)

    def __floor__(self) -> Any:
        return _operated("floor", self)

    def __ceil__(self) -> Any:
        return _operated("ceil", self)

    def __trunc__(self) -> Any:
        return _operated("trunc", self)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        """Apply a NumPy function: ``np.cos(time)``, ``np.float64(2) * time``."""
        name: str = ufunc.__name__
        if name in _COMPARING:
            refuse_comparison(name)
        operation = UFUNCS.get(name)
        if operation is None or method != "__call__" or options:
            called = f"np.{name}" if method == "__call__" else f"np.{name}.{method}"
            plain = f"{called} with {', '.join(options)}" if options and operation else called
            raise TypeError(
                f"{plain} has no counterpart in scene code; "
                "use a built-in of distal.lang, or write it in a @func"
            )
        result = python_expressions.combine(operation, inputs)
        if result is None:
            given = " and ".join(type(i).__name__ for i in inputs)
            raise TypeError(f"np.{name} of a parameter or of time does not take {given}")
        return result


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Expression(Symbolic):
    """A value that depends on parameters and on time. It is immutable.

    Attributes:
        node: Its node in the IR, in which the parameters and the time are uniforms.
        parameters: The parameters that it reads, in order of first use.
    """

    node: Expr
    parameters: tuple[Parameter, ...] = ()

    @property
    def type(self) -> Type:
        """Its type in scene code."""
        return self.node.type

    def as_expression(self) -> Expression:
        """Return itself."""
        return self

    def value(self, params: Mapping[str, Any] | None = None, time: float = 0.0) -> Any:
        """Return its value for given parameters and time: a number, a vector or a matrix.

        Args:
            params: Values of parameters by name or label; the others have their defaults.
            time: Seconds.

        Raises:
            ValueError: There is no such parameter, or a value is out of its range.
            TypeError: A value has the wrong type.
        """
        return executor().value(self, params or {}, time)

    def __eq__(self, other: object) -> Any:
        """Return whether it is the same expression; comparing with a number is an error."""
        if isinstance(other, Symbolic):
            held = other.as_expression()
            return self.node is held.node and self.parameters == held.parameters
        if isinstance(other, int | float):
            refuse_comparison("==")
        return NotImplemented

    def __hash__(self) -> int:
        return hash(self.node)

    def __copy__(self) -> Expression:
        return self

    def __deepcopy__(self, memo: Any) -> Expression:
        return self

    def _pickled(self) -> Any:
        return Expression, (self.node, self.parameters)

    def __repr__(self) -> str:
        """Return the code that makes it; what it computes, in brackets, if there is none."""
        text = expression_text.expression_text(self.node, self.parameters)
        return text or f"<expression {self.type}: {print_expression(self.node)}>"


def uniform_of(parameter: Parameter) -> Expression:
    """Return the value of a parameter as an expression; the compiler declares the uniform."""
    return Expression(Uniform(parameter.name, parameter.type), (parameter,))


def depends_on_time(expression: Expression) -> bool:
    """Return whether the value of an expression differs from time to time."""
    nodes = nodes_in(expression.node)
    return any(isinstance(node, Uniform) and node.name == FRAME_TIME for node in nodes)


def is_symbolic(value: object) -> bool:
    """Return whether a value, or an item of a tuple or list, is an expression or a parameter."""
    if isinstance(value, tuple | list):
        return any(map(is_symbolic, value))
    return isinstance(value, Symbolic)


def composed_value(operation: str, operands: tuple[Any, ...]) -> Expression:
    """Apply a built-in or a type's constructor to operands, at least one of them symbolic.

    Raises:
        TypeError: The operation does not accept these operands.
    """
    result = python_expressions.combine(operation, operands)
    if result is None:
        given = ", ".join(type(o).__name__ for o in operands)
        raise TypeError(f"{operation}() of a parameter or of time does not take ({given})")
    return result


def _operated(operation: str, *operands: Any) -> Any:
    result = python_expressions.combine(operation, operands)
    return NotImplemented if result is None else result


def refuse_comparison(symbol: str) -> NoReturn:
    """Raise the error for a comparison of a value that is not known here."""
    _unknown(f"what '{symbol}' gives", "choose(which, shapes), or compare by <= and >=")


class UnknownValue(TypeError):  # noqa: N818 (it names what is wrong)
    """A value is needed that is known only when a picture is rendered.

    Attributes:
        hint: What to write instead.
    """

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message, hint)  # all arguments, for pickles
        self.hint = hint

    def __str__(self) -> str:
        return f"{self.args[0]}; {self.hint}"


def _unknown(what: str, hint: str) -> NoReturn:
    raise UnknownValue(
        f"a parameter or the time has no value yet, so {what} is not known here", hint
    )


time: Final = Expression(Uniform(FRAME_TIME, FLOAT))

__all__ = ["Expression", "Symbolic", "composed_value", "is_symbolic", "time", "uniform_of"]
