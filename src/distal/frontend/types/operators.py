"""The typing rules of operators: operand types and result types.

Operations on two literals are computed here, with Python's arithmetic; others become IR nodes.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import SceneError, must_be
from distal.frontend.source import Node
from distal.frontend.types.coercion import with_default_type
from distal.frontend.types.powers import power
from distal.frontend.types.python_objects import RefusedError, float_constant
from distal.frontend.types.unification import concrete, do_not_mix, unify_operands
from distal.frontend.values import Value, Whole
from distal.ir.build import cast, splat
from distal.ir.constant_arithmetic import wrap
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Cast,
    Compare,
    CompareOp,
    Const,
    Expr,
    MatMul,
    Splat,
    Unary,
    UnaryOp,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    UINT,
    Kind,
    Matrix,
    Scalar,
    Type,
    Vector,
    kind_of,
    with_kind,
)

_OPS: Final[dict[type[ast.operator], BinaryOp]] = {
    ast.Add: BinaryOp.ADD,
    ast.Sub: BinaryOp.SUB,
    ast.Mult: BinaryOp.MUL,
    ast.Div: BinaryOp.DIV,
    ast.FloorDiv: BinaryOp.FLOOR_DIV,
    ast.Mod: BinaryOp.MOD,
    ast.BitAnd: BinaryOp.AND,
    ast.BitOr: BinaryOp.OR,
    ast.BitXor: BinaryOp.XOR,
    ast.LShift: BinaryOp.SHL,
    ast.RShift: BinaryOp.SHR,
}
COMPARISONS: Final[dict[type[ast.cmpop], CompareOp]] = {
    ast.Eq: CompareOp.EQ,
    ast.NotEq: CompareOp.NE,
    ast.Lt: CompareOp.LT,
    ast.LtE: CompareOp.LE,
    ast.Gt: CompareOp.GT,
    ast.GtE: CompareOp.GE,
}
_LITERAL: Final[dict[BinaryOp, Callable[[int, int], int]]] = {
    BinaryOp.ADD: operator.add,
    BinaryOp.SUB: operator.sub,
    BinaryOp.MUL: operator.mul,
    BinaryOp.FLOOR_DIV: operator.floordiv,
    BinaryOp.MOD: operator.mod,
    BinaryOp.AND: operator.and_,
    BinaryOp.OR: operator.or_,
    BinaryOp.XOR: operator.xor,
}
_BITWISE = {BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR}
_DIVISIONS = {BinaryOp.DIV, BinaryOp.FLOOR_DIV, BinaryOp.MOD}
_SHIFTS = {BinaryOp.SHL, BinaryOp.SHR}
# Of these the lowest 32 bits of the result depend on higher bits of the operands.
_NARROWING = {BinaryOp.FLOOR_DIV, BinaryOp.MOD, BinaryOp.SHR}
_LARGEST_LITERAL = 1 << 1024


def binary(body: FunctionBody, op: ast.operator, lhs: Value, rhs: Value, node: Node) -> Value:
    """Lower ``lhs op rhs``.

    Args:
        body: The function being lowered.
        op: The operator.
        lhs: The left operand.
        rhs: The right operand.
        node: The node, for errors.

    Raises:
        SceneError: The operator does not accept these operands.
    """
    if isinstance(op, ast.Pow):
        return power(body, lhs, rhs, node)
    if isinstance(op, ast.MatMult):
        return _matmul(body, lhs, rhs, node)
    kind = _OPS[type(op)]
    if isinstance(lhs, Whole) and isinstance(rhs, Whole):
        folded = _fold(body, kind, lhs, rhs, node)
        if folded is not None:
            return folded
    if kind in _SHIFTS:
        return _shift(body, kind, lhs, rhs, node)
    left, right = unify_operands(body, lhs, rhs, node, kind.value)
    return _arithmetic(body, kind, left, right, node)


def _held(operand: Whole, op: BinaryOp) -> int:
    """Return an operand as the int that it is, where more bits would give another result."""
    exact = op not in _NARROWING or not operand.computed
    return operand.value if exact else wrap(operand.value, Kind.INT)


def _fold(body: FunctionBody, op: BinaryOp, lhs: Whole, rhs: Whole, node: Node) -> Value | None:
    if op in _DIVISIONS and _held(rhs, op) == 0:
        raise body.problem(ErrorCode.NUMBER, "division by zero", node)
    if op is BinaryOp.DIV:
        try:
            return float_constant(lhs.value / rhs.value, "the quotient")
        except (RefusedError, OverflowError):
            raise body.problem(
                ErrorCode.NUMBER, "the quotient is out of the range of float", node
            ) from None
    compute = _LITERAL.get(op)
    if compute is None:
        return None
    value = compute(_held(lhs, op), _held(rhs, op))
    if abs(value) >= _LARGEST_LITERAL:
        raise body.problem(
            ErrorCode.NUMBER, "this number is too large", node, "write it as a float"
        )
    return Whole(value, computed=True)


def _arithmetic(body: FunctionBody, op: BinaryOp, lhs: Expr, rhs: Expr, node: Node) -> Expr:
    type, span = lhs.type, body.span(node)
    kind = kind_of(type)
    operand = f"an operand of '{op.value}'"
    if kind is None:
        raise body.problem(
            ErrorCode.TYPE, must_be(operand, "a number, a vector or a matrix", type), node
        )
    if isinstance(type, Matrix):
        _check_matrix(body, op, lhs, rhs, node)
    elif op in _BITWISE:
        if kind is Kind.FLOAT:
            hint = "use ** for powers" if op is BinaryOp.XOR else "use and, or for conditions"
            raise body.problem(
                ErrorCode.TYPE, must_be(operand, "of int, uint or bool", type), node, hint
            )
    elif kind is Kind.BOOL:
        hint = "convert the bool: int(b) or float(b)"
        raise body.problem(
            ErrorCode.TYPE, must_be(operand, "of int, uint or float", type), node, hint
        )
    elif op is BinaryOp.DIV and kind is not Kind.FLOAT:
        lhs, rhs = cast(lhs, Kind.FLOAT), cast(rhs, Kind.FLOAT)
        type = lhs.type
    if op in _DIVISIONS and _is_zero(rhs):
        raise body.problem(ErrorCode.NUMBER, "division by zero", node)
    return Binary(op, lhs, rhs, type, span=span)


def _is_zero(value: Expr) -> bool:
    if isinstance(value, Splat | Cast):
        value = value.value
    return isinstance(value, Const) and value.value == 0


def _check_matrix(body: FunctionBody, op: BinaryOp, lhs: Expr, rhs: Expr, node: Node) -> None:
    scaled = isinstance(rhs, Splat) or (isinstance(lhs, Splat) and op is BinaryOp.MUL)
    if op in (BinaryOp.ADD, BinaryOp.SUB) and not (scaled or isinstance(lhs, Splat)):
        return
    if op in (BinaryOp.MUL, BinaryOp.DIV) and scaled:
        return
    types = [e.value.type if isinstance(e, Splat) else e.type for e in (lhs, rhs)]
    wanted = {
        BinaryOp.MUL: "a matrix and a number",
        BinaryOp.DIV: "a matrix and a number, in this order",
    }.get(op, "numbers or vectors")
    hint = "the product of matrices is written @" if op is BinaryOp.MUL else None
    raise body.problem(
        ErrorCode.TYPE, must_be(f"the operands of '{op.value}'", wanted, *types), node, hint
    )


def _shift(body: FunctionBody, op: BinaryOp, lhs: Value, rhs: Value, node: Node) -> Value:
    if isinstance(rhs, Whole) and not 0 <= rhs.value < 32:
        raise body.problem(ErrorCode.NUMBER, "a shift goes by 0 to 31 bits", node)
    if isinstance(lhs, Whole) and isinstance(rhs, Whole):
        number, by = _held(lhs, op), rhs.value
        return Whole(number << by if op is BinaryOp.SHL else number >> by, computed=True)
    value = with_default_type(body, lhs, node)
    kind = kind_of(value.type)
    if isinstance(rhs, Whole) and kind is Kind.UINT:
        count: Expr = Const(rhs.value, UINT)
    else:
        count = with_default_type(body, rhs, node)
    if kind not in (Kind.INT, Kind.UINT) or isinstance(value.type, Matrix):
        message = must_be(f"the left operand of '{op.value}'", "of int or uint", value.type)
        raise body.problem(ErrorCode.TYPE, message, node)
    if kind_of(count.type) not in (Kind.INT, Kind.UINT):
        message = must_be(f"the right operand of '{op.value}'", "of int or uint", count.type)
        raise body.problem(ErrorCode.TYPE, message, node)
    # int and uint counts keep their bits, and only the lowest five bits are used.
    count = cast(count, kind)
    if isinstance(value.type, Scalar):
        value = splat(value, count.type)
    elif isinstance(count.type, Scalar):
        count = splat(count, value.type)
    if value.type is not count.type:
        raise do_not_mix(body, value, count, node, op.value)
    return Binary(op, value, count, value.type, span=body.span(node))


def _matmul(body: FunctionBody, lhs: Value, rhs: Value, node: Node) -> Expr:
    left, right = concrete(body, lhs, rhs, node), concrete(body, rhs, lhs, node)
    match left.type, right.type:
        case (Matrix(n), Matrix(m)) if n == m:
            type: Type = left.type
        case (Matrix(n), Vector(Kind.FLOAT, m)) if n == m:
            type = right.type
        case (Vector(Kind.FLOAT, n), Matrix(m)) if n == m:
            type = left.type
        case _:
            scalar = isinstance(left.type, Scalar) or isinstance(right.type, Scalar)
            hint = "a number times a matrix is written *" if scalar else None
            wanted = "two matrices, or a matrix and a vector, of one size"
            message = must_be("the operands of '@'", wanted, left.type, right.type)
            raise body.problem(ErrorCode.TYPE, message, node, hint)
    return MatMul(left, right, type, span=body.span(node))


def unary(body: FunctionBody, op: ast.unaryop, operand: Value, node: ast.expr) -> Value:
    """Lower ``-x``, ``+x`` or ``~x``; ``not`` is lowered with the conditions.

    Args:
        body: The function being lowered.
        op: The operator.
        operand: The operand.
        node: The node, for errors.

    Raises:
        SceneError: The operator does not accept this operand.
    """
    if isinstance(operand, Whole):
        match op:
            case ast.USub():
                return Whole(-operand.value, operand.computed or operand.value < 0)
            case ast.UAdd():
                return operand
            case _:
                return Whole(~operand.value, operand.computed)
    value = with_default_type(body, operand, node)
    kind, span = kind_of(value.type), body.span(node)
    match op:
        case ast.USub() | ast.UAdd() if kind in (Kind.FLOAT, Kind.INT, Kind.UINT):
            if isinstance(op, ast.UAdd):
                return value
            if isinstance(value, Const) and kind is Kind.FLOAT:
                return Const(-value.value, FLOAT, span=span)
            return Unary(UnaryOp.NEGATE, value, value.type, span=span)
        case ast.Invert() if kind in (Kind.INT, Kind.UINT):
            return Unary(UnaryOp.INVERT, value, value.type, span=span)
        case ast.Invert() if kind is Kind.BOOL and isinstance(value.type, Vector):
            return Unary(UnaryOp.NOT, value, value.type, span=span)
        case _:
            symbol = {ast.USub: "-", ast.UAdd: "+", ast.Invert: "~"}[type(op)]
            hint = "write not" if isinstance(op, ast.Invert) and kind is Kind.BOOL else None
            wanted = (
                "of int or uint, or a vector of bool" if symbol == "~" else "a number or a vector"
            )
            message = must_be(f"the operand of '{symbol}'", wanted, value.type)
            raise body.problem(ErrorCode.TYPE, message, node, hint)


def compare(body: FunctionBody, op: ast.cmpop, lhs: Value, rhs: Value, node: ast.expr) -> Expr:
    """Lower one comparison of a chain.

    Args:
        body: The function being lowered.
        op: The comparison.
        lhs: The left operand.
        rhs: The right operand.
        node: The node, for errors.

    Raises:
        SceneError: The operands cannot be compared.
    """
    found = COMPARISONS.get(type(op))
    if found is None:
        raise _no_comparison(body, op, node)
    if isinstance(lhs, Whole) and isinstance(rhs, Whole):
        meaning: Any = getattr(operator, found.name.lower())
        held = (wrap(v.value, Kind.INT) if v.computed else v.value for v in (lhs, rhs))
        return Const(bool(meaning(*held)), BOOL)
    left, right = unify_operands(body, lhs, rhs, node, found.value)
    kind = kind_of(left.type)
    is_order = found not in (CompareOp.EQ, CompareOp.NE)
    if kind is None or isinstance(left.type, Matrix) or (kind is Kind.BOOL and is_order):
        wanted = "a number or a vector of numbers" if is_order else "a number, a bool or a vector"
        raise body.problem(
            ErrorCode.TYPE, must_be(f"an operand of '{found.value}'", wanted, left.type), node
        )
    return Compare(found, left, right, with_kind(left.type, Kind.BOOL), span=body.span(node))


def _no_comparison(body: FunctionBody, op: ast.cmpop, node: ast.expr) -> SceneError:
    match op:
        case ast.Is() | ast.IsNot():
            symbol = "is" if isinstance(op, ast.Is) else "is not"
            other = "==" if isinstance(op, ast.Is) else "!="
            return body.problem(
                ErrorCode.LANGUAGE, f"'{symbol}' is not part of scene code", node, f"write {other}"
            )
        case _:
            hint = "compare with each: x == a or x == b"
            return body.problem(ErrorCode.LANGUAGE, "'in' is not part of scene code", node, hint)


def condition(body: FunctionBody, value: Value, node: ast.expr, what: str) -> Expr:
    """Return a condition as an expression. It must be a bool; numbers are not converted.

    Args:
        body: The function being lowered.
        value: The condition.
        node: The node, for errors.
        what: The subject of the message "``what`` must be bool, but this is …".

    Raises:
        SceneError: The value is not a bool.
    """
    if isinstance(value, Whole):
        raise body.problem(ErrorCode.TYPE, must_be(what, BOOL, INT), node, "compare it: x != 0")
    expr = with_default_type(body, value, node)
    if expr.type is BOOL:
        return expr
    hint = None
    if isinstance(expr.type, Vector) and expr.type.kind is Kind.BOOL:
        hint = "write any(...) or all(...) around it"
    elif isinstance(expr.type, Scalar):
        hint = "compare it: x != 0"
    raise body.problem(ErrorCode.TYPE, must_be(what, BOOL, expr.type), node, hint)
