"""Unify operands to one type: a literal takes the other side's kind, a scalar is splatted."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import SceneError, must_match
from distal.frontend.source import Node
from distal.frontend.types.coercion import coerce, default_type, shown_type, with_default_type
from distal.frontend.values import Closure, SequenceValue, Static, Value, Whole
from distal.ir.build import splat
from distal.ir.nodes import BinaryOp, CompareOp, Expr, Read
from distal.ir.types import (
    FLOAT,
    INT,
    Array,
    Kind,
    Matrix,
    Scalar,
    Type,
    Vector,
    kind_of,
    vector_of,
)


def unify_operands(
    body: FunctionBody, lhs: Value, rhs: Value, node: Node, symbol: str
) -> tuple[Expr, Expr]:
    """Return both sides as one type: a literal takes the other's kind, a scalar is splatted.

    Args:
        body: The function being lowered.
        lhs: The left operand.
        rhs: The right operand.
        node: The node, for errors.
        symbol: The operator, or ``select``.

    Raises:
        SceneError: The types cannot be unified.
    """
    if isinstance(lhs, Whole) and not isinstance(rhs, Whole):
        right = concrete(body, rhs, lhs, node)
        return _coerce_literal(body, lhs, right, node, symbol), right
    if isinstance(rhs, Whole) and not isinstance(lhs, Whole):
        left = concrete(body, lhs, rhs, node)
        return left, _coerce_literal(body, rhs, left, node, symbol)
    left, right = concrete(body, lhs, rhs, node), concrete(body, rhs, lhs, node)
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
    """Return the operators that splat a scalar to the type of the other side."""
    return frozenset({"*", "/"}) if isinstance(type, Matrix) else _EVERY_SYMBOL


def concrete(body: FunctionBody, value: Value, other: Value, node: Node) -> Expr:
    """Return a value with its default type; a captured tuple beside a vector becomes a vector.

    Args:
        body: The function being lowered.
        value: The operand.
        other: The other operand.
        node: The node, for errors.
    """
    if isinstance(value, SequenceValue):
        other_type = default_type(other)
        if isinstance(other_type, Matrix):
            other_type = vector_of(Kind.FLOAT, other_type.size)
        if isinstance(other_type, Vector):
            coerced = coerce(body, value, other_type, node)
            if coerced is not None:
                return coerced
    return with_default_type(body, value, node)


def _coerce_literal(
    body: FunctionBody, literal: Whole, other: Expr, node: Node, symbol: str
) -> Expr:
    """Return a literal with the other side's type, splatted beside a vector or matrix."""
    kind = kind_of(other.type)
    if kind is None or kind is Kind.BOOL:
        raise do_not_mix(body, other, with_default_type(body, literal, node), node, symbol)
    scalar = coerce(body, literal, Scalar(kind), node)
    assert scalar is not None
    return splat(scalar, other.type)


def do_not_mix(body: FunctionBody, lhs: Expr, rhs: Expr, node: Node, symbol: str) -> SceneError:
    """Return the error for operands whose types an operator cannot combine.

    Args:
        body: The function being lowered.
        lhs: The left operand.
        rhs: The right operand.
        node: The node that the error points at.
        symbol: The operator.
    """
    left, right = lhs.type, rhs.type
    message = must_match(f"the operands of '{symbol}'", (left, right))
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
    return body.problem(ErrorCode.TYPE, message, node, hint)


def _int_hint(body: FunctionBody, value: Expr) -> str:
    """Return a hint how to combine an int with a float."""
    if isinstance(value, Read) and value.name in body.whole_starts:
        start = body.whole_starts[value.name]
        return f"'{value.name}' is an int because it starts as {start}: write {start}.0"
    if isinstance(value.type, Vector):
        return f"write vec{value.type.size}(...) around the {value.type}"
    return "write float(...) around the int"


def unify_values(
    body: FunctionBody, values: Sequence[Value], node: ast.expr, what: str
) -> tuple[Expr, ...]:
    """Return all values as one type: literals take the type of the others, nothing is widened.

    Args:
        body: The function being lowered.
        values: The values.
        node: The node, for errors.
        what: The values, for messages.

    Raises:
        SceneError: The types differ.
    """
    concrete = [v for v in values if not isinstance(v, Whole)]
    types = list(dict.fromkeys(default_type(v) for v in concrete))
    if not concrete:
        return tuple(with_default_type(body, v, node) for v in values)
    if len(types) == 1 and types[0] is not None:
        wanted = types[0]
        coerced = [coerce(body, v, wanted, node) for v in values]
        known = tuple(f for f in coerced if f is not None)
        if len(known) == len(values):
            return known
    for value in values:
        if isinstance(value, Static | Closure):
            with_default_type(body, value, node)
    raise body.problem(
        ErrorCode.TYPE, must_match(what, map(shown_type, values)), node, _unify_hint(values)
    )


def _unify_hint(values: Sequence[Value]) -> str | None:
    vectors = [t for v in values if isinstance(t := default_type(v), Vector)]
    scalars = [v for v in values if isinstance(default_type(v), Scalar)]
    if len(set(vectors)) == 1 and scalars:
        return f"write {vectors[0]}(...) around the {default_type(scalars[0])}"
    types = {default_type(v) for v in values}
    return "write float(...) around the int" if types == {INT, FLOAT} else None
