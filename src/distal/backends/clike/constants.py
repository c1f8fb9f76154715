"""Recognize constant expressions: tables of literals, and operations on literals."""

from __future__ import annotations

from distal.ir.nodes import (
    Binary,
    Builtin,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Expr,
    Logical,
    MatMul,
    Select,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
)
from distal.ir.types import Array, Kind, kind_of
from distal.ir.walk import children, nodes_in

_OPERATIONS = Unary | Binary | MatMul | Compare | Logical | Select | Cast | Builtin


def is_table(e: Expr) -> bool:
    """Return whether an expression is an array of literals, declared outside the functions."""
    if not isinstance(e, Construct) or not isinstance(e.type, Array):
        return False
    literal = (Const, Splat, Compose, Construct)
    return all(isinstance(part, literal) for part in nodes_in(*e.parts))


def is_literal_operation(e: Expr) -> bool:
    """Return whether an expression is an operation on literals only, other than a negated one.

    WGSL computes it at compile time, in another precision, and rejects results that are infinite.
    """
    if not isinstance(e, _OPERATIONS):
        return False
    if isinstance(e, Unary) and isinstance(e.operand, Const):
        return e.op is UnaryOp.NEGATE and kind_of(e.type) is Kind.UINT
    below = nodes_in(*children(e))
    return all(isinstance(node, Const | Compose | Splat | Swizzle) for node in below)
