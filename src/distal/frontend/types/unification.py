"""Two operands becoming one type: a literal takes the other side's kind, a scalar is splatted."""

from __future__ import annotations

import ast
from typing import Final

from distal.frontend.lowering.body import Body
from distal.frontend.problems import SceneError
from distal.frontend.types.coercion import fit, natural_type, settle
from distal.frontend.values import Display, Value, Whole
from distal.ir.build import splat
from distal.ir.nodes import BinaryOp, CompareOp, Expr, Read
from distal.ir.types import Array, Kind, Matrix, Scalar, Type, Vector, kind_of, vector_of


def meet(
    body: Body, lhs: Value, rhs: Value, node: ast.expr | ast.stmt, symbol: str
) -> tuple[Expr, Expr]:
    """Both sides as one type: a literal takes the other side's kind, a scalar is splatted."""
    if isinstance(lhs, Whole) and not isinstance(rhs, Whole):
        right = firm(body, rhs, lhs, node)
        return _literal_beside(body, lhs, right, node, symbol), right
    if isinstance(rhs, Whole) and not isinstance(lhs, Whole):
        left = firm(body, lhs, rhs, node)
        return left, _literal_beside(body, rhs, left, node, symbol)
    left, right = firm(body, lhs, rhs, node), firm(body, rhs, lhs, node)
    if left.type is right.type:
        return left, right
    if kind_of(left.type) is kind_of(right.type) and kind_of(left.type) is not None:
        if isinstance(left.type, Scalar) and symbol in _widening(right.type):
            return splat(left, right.type), right
        if isinstance(right.type, Scalar) and symbol in _widening(left.type):
            return left, splat(right, left.type)
    raise do_not_mix(body, left, right, node, symbol)


_EVERY_SYMBOL: Final = frozenset(
    [*(op.value for op in BinaryOp), *(op.value for op in CompareOp), "**", "select"]
)


def _widening(type: Type) -> frozenset[str]:
    """The operators that repeat a scalar in every component of the other side."""
    return frozenset({"*", "/"}) if isinstance(type, Matrix) else _EVERY_SYMBOL


def firm(body: Body, value: Value, other: Value, node: ast.expr | ast.stmt) -> Expr:
    """A value with its own type; a captured tuple is a vector beside a vector."""
    if isinstance(value, Display):
        other_type = natural_type(other)
        if isinstance(other_type, Matrix):
            other_type = vector_of(Kind.FLOAT, other_type.size)
        if isinstance(other_type, Vector):
            fitted = fit(body, value, other_type, node)
            if fitted is not None:
                return fitted
    return settle(body, value, node)


def _literal_beside(
    body: Body, literal: Whole, other: Expr, node: ast.expr | ast.stmt, symbol: str
) -> Expr:
    """The literal as the other side's kind; a scalar, or splatted beside a vector or matrix."""
    kind = kind_of(other.type)
    if kind is None or kind is Kind.BOOL:
        raise do_not_mix(body, other, settle(body, literal, node), node, symbol)
    scalar = fit(body, literal, Scalar(kind), node)
    assert scalar is not None
    return splat(scalar, other.type)


def do_not_mix(
    body: Body, lhs: Expr, rhs: Expr, node: ast.expr | ast.stmt, symbol: str
) -> SceneError:
    """The mistake of bringing two types together that an operator does not join."""
    left, right = lhs.type, rhs.type
    message = f"{left} and {right} do not mix in '{symbol}'"
    hint = None
    kinds = {kind_of(left), kind_of(right)}
    if (isinstance(left, Matrix) and isinstance(right, Matrix | Vector) and symbol == "*") or (
        isinstance(right, Matrix) and isinstance(left, Vector) and symbol == "*"
    ):
        hint = "the product of matrices is written @"
    elif kinds == {Kind.INT, Kind.FLOAT}:
        hint = _int_hint(body, lhs if kind_of(left) is Kind.INT else rhs)
    elif kinds == {Kind.INT, Kind.UINT}:
        hint = "convert one side: int(...) or uint(...)"
    elif isinstance(left, Array) or isinstance(right, Array):
        hint = "write vec3(...), or another vector, around an array of numbers"
    elif Kind.BOOL in kinds and None not in kinds:
        hint = "convert the bool: int(b) or float(b)"
    elif isinstance(left, Vector) and isinstance(right, Vector) and left.kind is right.kind:
        wide, narrow = (left, right) if left.size > right.size else (right, left)
        hint = f"pick {narrow.size} components of the {wide}, such as .{'xyzw'[: narrow.size]}"
    return body.problem(message, node, hint)


def _int_hint(body: Body, value: Expr) -> str:
    """How an int meets a float."""
    if isinstance(value, Read) and value.name in body.whole_starts:
        start = body.whole_starts[value.name]
        return f"'{value.name}' is an int because it starts as {start}: write {start}.0"
    if isinstance(value.type, Vector):
        return f"write vec{value.type.size}(...) around the {value.type}"
    return "write float(...) around the int"
