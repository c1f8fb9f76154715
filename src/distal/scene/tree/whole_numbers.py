"""The limits of whole numbers that are computed from parameters.

Input: an expression of type int. Output: its smallest and its largest value for all values of its
parameters, or None if they are not known. Bounds are those of each operation alone, so they may be
wider than the values.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TypeAlias

from distal.ir.nodes import Binary, BinaryOp, Builtin, Const, Expr, Select, Unary, UnaryOp, Uniform
from distal.ir.types import INT
from distal.lang.expressions import Expression
from distal.lang.parameters import Parameter

Ends: TypeAlias = "tuple[int, int]"


def whole_ends(expression: Expression) -> Ends | None:
    """Return the smallest and the largest value of a whole number; None if they are not known."""
    return _ends(expression.node, {p.name: p for p in expression.parameters})


def _ends(e: Expr, parameters: Mapping[str, Parameter]) -> Ends | None:
    if e.type is not INT:
        return None
    match e:
        case Const(value=value):
            return int(value), int(value)
        case Uniform(name=name) if name in parameters:
            return _of_parameter(parameters[name])
        case Unary(op=UnaryOp.NEGATE, operand=operand):
            own = _ends(operand, parameters)
            return None if own is None else (-own[1], -own[0])
        case Binary(op=op, lhs=lhs, rhs=rhs):
            a, b = _ends(lhs, parameters), _ends(rhs, parameters)
            return None if a is None or b is None else _of_operation(op, a, b)
        case Select(yes=yes, no=no):
            a, b = _ends(yes, parameters), _ends(no, parameters)
            return None if a is None or b is None else (min(a[0], b[0]), max(a[1], b[1]))
        case Builtin(name=name, args=args):
            return _of_builtin(name, [_ends(arg, parameters) for arg in args])
        case _:
            return None


def _of_parameter(parameter: Parameter) -> Ends | None:
    if parameter.options:
        return 0, len(parameter.options) - 1
    if parameter.low is None or parameter.high is None:
        return None
    return int(parameter.low), int(parameter.high)


def _of_operation(op: BinaryOp, a: Ends, b: Ends) -> Ends | None:
    match op:
        case BinaryOp.ADD:
            return a[0] + b[0], a[1] + b[1]
        case BinaryOp.SUB:
            return a[0] - b[1], a[1] - b[0]
        case BinaryOp.MUL:
            corners = [x * y for x, y in product(a, b)]
            return min(corners), max(corners)
        case BinaryOp.FLOOR_DIV if b[0] > 0:
            corners = [x // y for x, y in product(a, b)]
            return min(corners), max(corners)
        case BinaryOp.MOD if b[0] > 0:
            return 0, b[1] - 1
        case _:
            return None


def _of_builtin(name: str, args: list[Ends | None]) -> Ends | None:
    known = [arg for arg in args if arg is not None]
    if name == "clamp" and args[1] is not None and args[2] is not None:
        return args[1][0], args[2][1]
    if len(known) < len(args):
        return None
    if name in ("min", "max"):
        ends = zip(*known, strict=True)
        low, high = (min(end) if name == "min" else max(end) for end in ends)
        return low, high
    if name == "abs":
        low, high = known[0]
        return max(0, low, -high), max(abs(low), abs(high))
    return None
