"""Operators and built-ins between values that Python code holds: ``slider("Size", 1) * 2``.

Input: the name of an operation and its operands, expressions among them. Output:
the expression, by the rules that scene code has; a mistake is a ``TypeError`` in the same words.
There is no function around it: no statement, no local, no place in a source.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any, Final
from weakref import WeakKeyDictionary

from distal.frontend.function_body import FunctionBody
from distal.frontend.lowering.builtin_calls import call_builtin
from distal.frontend.problems import SceneError
from distal.frontend.types.coercion import vector_type, with_default_type
from distal.frontend.types.constructors import construct
from distal.frontend.types.operators import binary, unary
from distal.frontend.types.python_objects import RefusedError, coerce_constant, value_of
from distal.frontend.values import SequenceValue, Static, Value
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Expr, Uniform
from distal.ir.types import Type
from distal.ir.walk import children
from distal.lang.expressions import Expression, Symbolic
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureValue
from distal.lang.values import VALUE_CLASSES, MatrixValue, VectorValue

_BINARY: Final[dict[str, ast.operator]] = {
    "+": ast.Add(),
    "-": ast.Sub(),
    "*": ast.Mult(),
    "/": ast.Div(),
    "//": ast.FloorDiv(),
    "%": ast.Mod(),
    "**": ast.Pow(),
    "@": ast.MatMult(),
}
_UNARY: Final[dict[str, ast.unaryop]] = {"-x": ast.USub(), "+x": ast.UAdd()}
_TYPES: Final[dict[str, Type]] = {str(type): type for type in VALUE_CLASSES}

# What a message of scene code advises, said for Python, where float(...) must give a number.
_HINTS: Final = {"write float(...) around the int": "an int divided by 1 is a float: (n / 1) * 0.5"}

# In a function the front end cuts a deeper expression into locals. Here there are no locals, and
# the passes recurse through the whole expression and what surrounds it. Half of the measured limit.
DEEPEST: Final = 100
_depths: Final[WeakKeyDictionary[Expr, int]] = WeakKeyDictionary()

# The rules take the author's syntax for their messages: here there is none.
_NOWHERE: Final = ast.Call(ast.Name("expression"), [], [])


def combine(operation: str, operands: Sequence[Any]) -> Expression | None:
    """The value of an operator, a built-in or a vector's or matrix's type, by name.

    None where an operand is no value of scene code.

    Raises:
        TypeError: The operation does not take such operands, or the expression grows too deep.
        ValueError: A number is NaN, infinite or too large.
    """
    if not all(map(_may_be_value, operands)):
        return None
    parameters = _Parameters()
    try:
        values = [_value(o, parameters) for o in operands]
        node = with_default_type(_OUTSIDE, _rule(operation)(values), _NOWHERE)
    except RefusedError as refused:
        raise ValueError(_with_hint(refused.message, refused.hint)) from None
    except SceneError as error:
        found = error.diagnostic
        hint = _HINTS.get(found.hint or "", found.hint)
        raise TypeError(_with_hint(found.message, hint)) from None
    if _depth(node) > DEEPEST:
        raise TypeError(
            f"this expression has more than {DEEPEST} operations inside one another; "
            "compute it in a @func, with a loop"
        )
    return Expression(node, tuple(parameters.found))


def _depth(node: Expr) -> int:
    """How many operations are nested; an operand's number is known since it was built."""
    known = _depths.get(node)
    if known is None:
        known = _depths[node] = 1 + max(map(_depth, children(node)), default=0)
    return known


class _Outside(FunctionBody):
    """Where an expression is built that belongs to no function."""

    def __init__(self) -> None:
        self.whole_starts = {}

    def span(self, node: Any) -> Any:
        """No place."""
        return None

    def bind(self, name: str, value: Expr) -> Expr:
        """The value itself: equal nodes are one object, and the compiler shares it."""
        return value

    def shallow(self, value: Expr) -> Expr:
        """The value as it is: there is no statement to split it into."""
        return value


_OUTSIDE: Final = _Outside()


class _Parameters:
    """The parameters that the operands read, by first use."""

    def __init__(self) -> None:
        self.found: dict[Parameter, None] = {}

    def uniform(self, parameter: Parameter) -> Expr:
        self.found.setdefault(parameter)
        return Uniform(parameter.name, parameter.type)

    def computed(self, expression: Expression) -> Expr:
        for parameter in expression.parameters:
            self.found.setdefault(parameter)
        return expression.node

    def resource(self, resource: TextureValue | Buffer, name: str, type: Type) -> Expr:
        raise RefusedError(f"a {type} is read in scene code only", "read it in a @func")


def _rule(operation: str) -> Callable[[Sequence[Value]], Value]:
    if operation in _BINARY:
        return lambda v: binary(_OUTSIDE, _BINARY[operation], v[0], v[1], _NOWHERE)
    if operation in _UNARY:
        return lambda v: unary(_OUTSIDE, _UNARY[operation], v[0], _NOWHERE)
    if operation in _TYPES:
        return lambda v: construct(_OUTSIDE, _TYPES[operation], v, _NOWHERE)
    return lambda v: call_builtin(_OUTSIDE, INTRINSICS[operation], v, _NOWHERE)


def _may_be_value(operand: Any) -> bool:
    known = (int, float, Symbolic, VectorValue, MatrixValue)
    if isinstance(operand, tuple | list):
        return all(map(_may_be_value, operand))
    return isinstance(operand, known) or hasattr(operand, "dtype")


def _value(operand: Any, parameters: _Parameters) -> Value:
    if getattr(getattr(operand, "dtype", None), "kind", "") == "O":
        operand = operand.tolist()  # NumPy's array of numbers and expressions
    text = repr(operand) if isinstance(operand, int | float) else "the operand"
    value = value_of(operand, text, parameters)
    if isinstance(value, SequenceValue):
        # Outside scene code a short tuple, list or array of numbers is a vector, never an array.
        type = vector_type(value)
        coerced = None if type is None else coerce_constant(value, type)
        return value if coerced is None else coerced
    assert not isinstance(value, Static), f"{operand!r} passed as a value"
    return value


def _with_hint(message: str, hint: str | None) -> str:
    return f"{message}; {hint}" if hint else message
