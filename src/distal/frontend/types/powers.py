"""Lower ``base ** exponent``: products for constant whole exponents, else the built-in ``pow``."""

from __future__ import annotations

from typing import Final

from distal.diagnostics import Span
from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import must_be, must_match
from distal.frontend.source import Node
from distal.frontend.types.coercion import with_default_type
from distal.frontend.types.unification import unify_operands
from distal.frontend.values import Value, Whole
from distal.ir.build import builtin, compare, number, select
from distal.ir.limits import LARGEST_POWER, SMALLEST
from distal.ir.nodes import Binary, BinaryOp, CompareOp, Const, Expr
from distal.ir.types import FLOAT, Kind, Matrix, kind_of

_OPERAND: Final = "an operand of '**'"


def power(body: FunctionBody, base: Value, exponent: Value, node: Node) -> Value:
    """Lower ``base ** exponent``: products for constant whole exponents, else ``pow``.

    Args:
        body: The function being lowered.
        base: The base.
        exponent: The exponent.
        node: The node, for errors.

    Raises:
        SceneError: The operands have no power.
    """
    whole = _whole_exponent(exponent)
    if isinstance(base, Whole) and whole is not None and isinstance(exponent, Whole):
        return _fold_power(body, base.value, whole, node)
    if isinstance(base, Whole) and whole is None:
        exponent_expr = with_default_type(body, exponent, node)
        if kind_of(exponent_expr.type) is not Kind.FLOAT:
            raise body.problem(
                ErrorCode.NUMBER, "int ** int needs an exponent known now", node, "use float(...)"
            )
    if whole is None:
        left, right = unify_operands(body, base, exponent, node, "**")
        if kind_of(left.type) is not Kind.FLOAT or isinstance(left.type, Matrix):
            if kind_of(left.type) in (Kind.INT, Kind.UINT):
                raise body.problem(
                    ErrorCode.NUMBER,
                    "int ** int needs an exponent known now",
                    node,
                    "use float(...)",
                )
            raise body.problem(
                ErrorCode.TYPE, must_be(_OPERAND, "a number or a vector", left.type), node
            )
        return builtin("pow", left, right)
    value = with_default_type(body, base, node)
    kind = kind_of(value.type)
    if kind is Kind.BOOL or kind is None or isinstance(value.type, Matrix):
        raise body.problem(
            ErrorCode.TYPE, must_be(_OPERAND, "a number or a vector", value.type), node
        )
    if kind is not Kind.FLOAT:
        if not isinstance(exponent, Whole):
            message = must_match("the operands of '**'", (value.type, FLOAT))
            raise body.problem(ErrorCode.TYPE, message, node, "use float(...)")
        if whole < 0:
            raise body.problem(
                ErrorCode.NUMBER, "an int to a negative power is not an int", node, "use float(...)"
            )
    return _multiplied(body, value, whole, node)


def _whole_exponent(exponent: Value) -> int | None:
    match exponent:
        case Whole(value):
            return value
        case Const(value, type) if type is FLOAT and float(value).is_integer():
            # Larger float exponents are not computed as repeated products.
            return int(value) if abs(value) <= 1024 else None
        case _:
            return None


def _fold_power(body: FunctionBody, base: int, exponent: int, node: Node) -> Value:
    if exponent < 0:
        if base == 0:
            raise body.problem(ErrorCode.NUMBER, "division by zero", node)
        return number(float(base) ** exponent)
    if abs(base) > 1 and exponent * abs(base).bit_length() > 128:
        raise body.problem(
            ErrorCode.NUMBER, "this number is too large", node, "write it as a float"
        )
    return Whole(base**exponent, computed=True)


def _multiplied(body: FunctionBody, base: Expr, exponent: int, node: Node) -> Expr:
    """Return a power by repeated squaring; each power of two is computed once."""
    if exponent == 0:
        return number(1, base.type)
    span = body.span(node)
    power = body.bind("base", base) if abs(exponent) > 1 else base
    result: Expr | None = None
    left = abs(exponent)
    while True:
        if left & 1:
            result = (
                power
                if result is None
                else Binary(BinaryOp.MUL, result, power, base.type, span=span)
            )
        left >>= 1
        if not left:
            break
        power = Binary(BinaryOp.MUL, power, power, base.type, span=span)
        if left > 1:
            power = body.bind("power", power)
    assert result is not None
    return result if exponent > 0 else _reciprocal(body, result, span)


def _reciprocal(body: FunctionBody, product: Expr, span: Span) -> Expr:
    """Return 1 / product; where the product is 0, the largest value that ``pow`` returns."""
    product = body.bind("product", product)
    inverse = Binary(BinaryOp.DIV, number(1, product.type), product, product.type, span=span)
    size = builtin("abs", product)
    is_zero = compare(CompareOp.LT, size, number(SMALLEST, product.type))
    return select(is_zero, number(LARGEST_POWER, product.type), inverse)
