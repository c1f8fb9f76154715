"""Build expressions from operators and built-ins in Python code: ``slider("Size", 1) * 2``.

Input: the name of an operation and its operands; at least one is an expression. Output: the
expression, by the rules of scene code. Errors are ``TypeError`` with the messages of scene code.
There is no enclosing function: no statements, no locals, no source spans.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any, Final
from weakref import WeakKeyDictionary

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.lowering.builtin_calls import call_builtin
from distal.frontend.problems import SceneError, must_be
from distal.frontend.types.coercion import vector_type, with_default_type
from distal.frontend.types.constructors import construct
from distal.frontend.types.operators import binary, compare, unary
from distal.frontend.types.python_objects import RefusedError, coerce_constant, value_of
from distal.frontend.types.unification import unify_operands
from distal.frontend.values import SequenceValue, Static, Value
from distal.ir.build import negation
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Binary, BinaryOp, Const, Expr, Select, Uniform
from distal.ir.types import BOOL, FLOAT, INT, Type
from distal.ir.walk import children
from distal.lang.expressions import Expression, Symbolic
from distal.lang.parameter_values import LARGEST_FLOAT
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureValue
from distal.lang.values import VALUE_CLASSES, MatrixValue, VectorValue
from distal.session import SESSION

_BINARY: Final[dict[str, ast.operator]] = {
    "+": ast.Add(),
    "-": ast.Sub(),
    "*": ast.Mult(),
    "/": ast.Div(),
    "//": ast.FloorDiv(),
    "%": ast.Mod(),
    "**": ast.Pow(),
    "@": ast.MatMult(),
    "&": ast.BitAnd(),
    "|": ast.BitOr(),
    "^": ast.BitXor(),
}
_COMPARISONS: Final[dict[str, ast.cmpop]] = {
    "<": ast.Lt(),
    "<=": ast.LtE(),
    ">": ast.Gt(),
    ">=": ast.GtE(),
}
_QUICK: Final = {"+": BinaryOp.ADD, "-": BinaryOp.SUB, "*": BinaryOp.MUL}
_UNARY: Final[dict[str, ast.unaryop]] = {
    "-x": ast.USub(),
    "+x": ast.UAdd(),
    "~x": ast.Invert(),
}
_TYPES: Final[dict[str, Type]] = {str(type): type for type in VALUE_CLASSES}

# Hints of scene code and their replacements for Python, where float(...) must return a number.
_HINTS: Final = {"write float(...) around the int": "an int divided by 1 is a float: (n / 1) * 0.5"}

# In a function the front end splits deeper expressions into locals. Here there are no locals, and
# the passes recurse through the expression and its surroundings. This is half the measured limit.
DEEPEST: Final = 100
_depths: Final[WeakKeyDictionary[Expr, int]] = SESSION.keep("depths", WeakKeyDictionary())

# The rules need a syntax node for their messages; here there is none.
_NOWHERE: Final = ast.Call(ast.Name("expression"), [], [])


def combine(operation: str, operands: Sequence[Any]) -> Expression | None:
    """Apply an operation to operands: an operator, a built-in, or a vector or matrix constructor.

    Args:
        operation: The operator's symbol, the built-in's name or the type's name.
        operands: The operands.

    Returns:
        The expression; None if an operand is not a value of scene code.

    Raises:
        TypeError: The operation does not accept the operands, or the expression is too deep.
        ValueError: A number is NaN, infinite or too large.
    """
    quick = _of_floats(operation, operands)
    if quick is not None:
        return _checked(quick)
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
    return _checked(Expression(node, tuple(parameters.found)))


def _checked(found: Expression) -> Expression:
    if _depth(found.node) > DEEPEST:
        raise TypeError(
            f"this expression has more than {DEEPEST} operations inside one another; "
            "compute it in a @func, with a loop"
        )
    return found


def _of_floats(operation: str, operands: Sequence[Any]) -> Expression | None:
    """Return what ``combine`` returns for two floats, in a third of the time; None for all else.

    A scene has thousands of parts that move by expressions of their own.
    """
    op = _QUICK.get(operation)
    if op is None:
        return None
    nodes: list[Expr] = []
    parameters: dict[Parameter, None] = {}
    for operand in operands:
        if type(operand) is Expression and operand.node.type is FLOAT:
            nodes.append(operand.node)
            parameters.update(dict.fromkeys(operand.parameters))
        elif isinstance(operand, float) and abs(operand) <= LARGEST_FLOAT:
            nodes.append(Const(float(operand), FLOAT))
        else:
            return None
    lhs, rhs = nodes
    return Expression(Binary(op, lhs, rhs, FLOAT), tuple(parameters))


def _depth(node: Expr) -> int:
    """Return how many operations are nested; the depths of operands are cached."""
    known = _depths.get(node)
    if known is None:
        known = _depths[node] = 1 + max(map(_depth, children(node)), default=0)
    return known


class _Outside(FunctionBody):
    """A stand-in for ``FunctionBody``, for expressions outside any function."""

    def __init__(self) -> None:
        self.whole_starts = {}

    def span(self, node: Any) -> Any:
        """Return None: there is no source."""
        return None

    def bind(self, name: str, value: Expr) -> Expr:
        """Return the value itself: equal nodes are one object and are computed once."""
        return value

    def shallow(self, value: Expr) -> Expr:
        """Return the value itself: there are no statements to split it into."""
        return value


_OUTSIDE: Final = _Outside()


class _Parameters:
    """The parameters that the operands read, in order of first use."""

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
    if operation == "~x":
        return _inverted
    if operation in _UNARY:
        return lambda v: unary(_OUTSIDE, _UNARY[operation], v[0], _NOWHERE)
    if operation in _COMPARISONS:
        return lambda v: compare(_OUTSIDE, _COMPARISONS[operation], v[0], v[1], _NOWHERE)
    if operation == "select":
        return _selected
    if operation in _TYPES:
        return lambda v: construct(_OUTSIDE, _TYPES[operation], v, _NOWHERE)
    return lambda v: call_builtin(_OUTSIDE, INTRINSICS[operation], v, _NOWHERE)


def _selected(operands: Sequence[Value]) -> Value:
    test = with_default_type(_OUTSIDE, operands[0], _NOWHERE)
    if test.type is not BOOL:
        hint = "compare it: select(x > 0.0, ...)" if test.type in (INT, FLOAT) else None
        message = must_be("the condition of 'select'", BOOL, test.type)
        raise _OUTSIDE.problem(ErrorCode.TYPE, message, _NOWHERE, hint)
    yes, no = unify_operands(_OUTSIDE, operands[1], operands[2], _NOWHERE, "select")
    return Select(test, yes, no, yes.type)


def _inverted(operands: Sequence[Value]) -> Value:
    """Return ``~x``; of a condition its negation, because Python's ``not`` cannot be."""
    value = with_default_type(_OUTSIDE, operands[0], _NOWHERE)
    if value.type is BOOL:
        return negation(value)
    return unary(_OUTSIDE, _UNARY["~x"], operands[0], _NOWHERE)


def _may_be_value(operand: Any) -> bool:
    known = (int, float, Symbolic, VectorValue, MatrixValue)
    if isinstance(operand, tuple | list):
        return all(map(_may_be_value, operand))
    return isinstance(operand, known) or hasattr(operand, "dtype")


def _value(operand: Any, parameters: _Parameters) -> Value:
    if getattr(getattr(operand, "dtype", None), "kind", "") == "O":
        operand = operand.tolist()  # a NumPy array of numbers and expressions
    text = repr(operand) if isinstance(operand, int | float) else "the operand"
    value = value_of(operand, text, parameters)
    if isinstance(value, SequenceValue):
        # Outside scene code, a tuple, list or array of 2 to 4 numbers is a vector, not an array.
        type = vector_type(value)
        coerced = None if type is None else coerce_constant(value, type)
        return value if coerced is None else coerced
    assert not isinstance(value, Static), f"{operand!r} passed as a value"
    return value


def _with_hint(message: str, hint: str | None) -> str:
    return f"{message}; {hint}" if hint else message
