"""Differentiate one node, given the tangents of its operands.

Input: an expression with rewritten operands and, along one direction, the tangent of each operand
(in the order of ``children``). Output: the tangent of the expression along that direction. The
rules of built-ins are in their declarations.
"""

from __future__ import annotations

from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Compose,
    Construct,
    Expr,
    Field,
    Index,
    MatMul,
    Select,
    Splat,
    Swizzle,
    Unary,
)
from distal.ir.tangents import (
    Lanes,
    Tangent,
    composed,
    element,
    filled,
    member,
    minus,
    negative,
    over,
    picked,
    plus,
    scaled,
    splatted,
    swizzled,
)


def node_tangent(e: Expr, d: Lanes) -> Tangent:
    """Return the tangent of a node along one direction, from the tangents of its operands.

    Raises:
        AssertionError: The node has no derivative rule.
    """
    match e:
        case Unary(_, _):
            return negative(d[0])
        case Binary():
            return _binary_tangent(e, d)
        case MatMul(lhs, rhs):
            first = None if d[0] is None else MatMul(d[0], rhs, e.type)
            second = None if d[1] is None else MatMul(lhs, d[1], e.type)
            return plus(first, second)
        case Select(condition):
            return picked(condition, d[1], d[2], e.type)
        case Splat():
            return splatted(d[0], e.type)
        case Compose(parts):
            return composed(parts, d, e.type)
        case Swizzle(_, lanes):
            return swizzled(d[0], lanes)
        case Index(_, index):
            return element(d[0], index, e.type)
        case Field(_, name):
            return member(d[0], name, e.type)
        case Construct(parts):
            if all(t is None for t in d):
                return None
            return Construct(
                tuple(filled(t, p.type) for t, p in zip(d, parts, strict=True)), e.type
            )
        case Builtin(name):
            rule = INTRINSICS[name].derivative
            assert rule is not None, f"{name} has no derivative"
            return rule(e, d)
        case _:
            raise AssertionError(f"{e} has no rule")


def _binary_tangent(e: Binary, d: Lanes) -> Tangent:
    match e.op:
        case BinaryOp.ADD:
            return plus(d[0], d[1])
        case BinaryOp.SUB:
            return minus(d[0], d[1])
        case BinaryOp.MUL:
            return plus(scaled(d[0], e.rhs), scaled(d[1], e.lhs))
        case BinaryOp.DIV:
            return over(minus(d[0], scaled(d[1], e)), e.rhs)
        case BinaryOp.FLOOR_DIV:
            return None
        case BinaryOp.MOD:
            return node_tangent(Builtin("mod", (e.lhs, e.rhs), e.type), d)
        case _:
            raise AssertionError(f"{e.op} of floats")
