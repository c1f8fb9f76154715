"""Simplify one expression whose operands are already simplified.

Input: an expression. Output: an equal expression; the same expression if no rule applies. Every
rule gives exactly the same bits, except for the sign of a zero in ``x + 0.0`` (it may be ignored).
"""

from __future__ import annotations

import math
from typing import Final

from distal.ir.constant_arithmetic import NotFoldableError, Number
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Cast,
    Compare,
    CompareOp,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    Index,
    Logical,
    LogicalOp,
    Select,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
)
from distal.ir.types import BOOL, Kind, Matrix, Scalar, Type, Vector, component_count, kind_of
from distal.passes.fold.aggregates import Aggregates
from distal.passes.fold.constants import constant
from distal.passes.fold.float_ranges import interval

_INVERSE: Final = {
    CompareOp.EQ: CompareOp.NE,
    CompareOp.NE: CompareOp.EQ,
    CompareOp.LT: CompareOp.GE,
    CompareOp.GE: CompareOp.LT,
    CompareOp.GT: CompareOp.LE,
    CompareOp.LE: CompareOp.GT,
}


class Rules(Aggregates):
    """The rules for one function (see ``Constants`` for its arguments)."""

    def simplify(self, e: Expr) -> Expr:
        """Apply the rules to the root node of ``e``."""
        try:
            folded = self.folded(e)
        except NotFoldableError:
            folded = None
        if folded is not None:
            return folded
        match e:
            case Unary():
                return self._unary(e)
            case Binary():
                return self._binary(e)
            case Compare(op, lhs, rhs):
                if lhs is rhs and kind_of(lhs.type) is not Kind.FLOAT:
                    result = op in (CompareOp.EQ, CompareOp.LE, CompareOp.GE)
                    return constant(e.type, (result,) * component_count(e.type))
                return e
            case Logical():
                return self._logical(e)
            case Select():
                return self._select(e)
            case Cast(value, type):
                return self._cast(e, value, type)
            case Compose():
                return self.compose(e)
            case Swizzle():
                return self.swizzle(e)
            case Index():
                return self.index(e)
            case Field():
                return self.field(e)
            case Construct(parts):
                return self.construct(e, parts)
            case Builtin(name, args):
                return self._builtin(e, name, args)
            case _:
                # Leaves, Splat, MatMul, Call, textures: only constant folding applies.
                return e

    def _unary(self, e: Unary) -> Expr:
        match e.op, e.operand:
            case (UnaryOp.NEGATE | UnaryOp.NOT | UnaryOp.INVERT as op, Unary(inner, value)) if (
                op is inner
            ):
                return value
            case UnaryOp.NOT, Compare(op, lhs, rhs, type):
                # With a NaN, only == and != are opposites of each other.
                equality = op in (CompareOp.EQ, CompareOp.NE)
                if equality or kind_of(lhs.type) is not Kind.FLOAT:
                    return Compare(_INVERSE[op], lhs, rhs, type, span=e.span)
        return e

    def _binary(self, e: Binary) -> Expr:
        op, lhs, rhs = e.op, e.lhs, e.rhs
        kind = kind_of(e.type)
        simpler = self._float(e) if kind is Kind.FLOAT else self._integer(e, kind)
        if simpler is not e:
            return simpler
        if isinstance(lhs, Splat) and isinstance(rhs, Splat) and isinstance(e.type, Vector):
            # One operation on scalars instead of one for each component.
            inner = Binary(op, lhs.value, rhs.value, lhs.value.type, span=e.span)
            return Splat(self.simplify(inner), e.type, span=e.span)
        return e

    def _float(self, e: Binary) -> Expr:
        op, lhs, rhs, type = e.op, e.lhs, e.rhs, e.type
        left, right = self.same(lhs), self.same(rhs)
        match op:
            case BinaryOp.ADD:
                if right == 0.0:
                    return lhs
                if left == 0.0:
                    return rhs
                if negated := _negated(rhs):
                    return Binary(BinaryOp.SUB, lhs, negated, type, span=e.span)
                if negated := _negated(lhs):
                    return Binary(BinaryOp.SUB, rhs, negated, type, span=e.span)
            case BinaryOp.SUB:
                if right == 0.0:
                    return lhs
                if negated := _negated(rhs):
                    return Binary(BinaryOp.ADD, lhs, negated, type, span=e.span)
            case BinaryOp.MUL:
                if right == 1.0:
                    return lhs
                if left == 1.0:
                    return rhs
                if right == -1.0:
                    return self._negate(lhs)
                if left == -1.0:
                    return self._negate(rhs)
                minus_a, minus_b = _negated(lhs), _negated(rhs)
                if minus_a and minus_b:
                    return Binary(op, minus_a, minus_b, type, span=e.span)
            case BinaryOp.DIV:
                return self._float_quotient(e, right)
            case _:
                return e
        return e

    def _float_quotient(self, e: Binary, divisor: Number | None) -> Expr:
        if divisor == 1.0:
            return e.lhs
        if divisor == -1.0:
            return self._negate(e.lhs)
        if divisor and abs(math.frexp(divisor)[0]) == 0.5:
            # The reciprocal of a power of two is exact, unless it is not a normal float.
            try:
                reciprocal = self._math.round(1.0 / divisor)
            except NotFoldableError:
                return e
            factor = constant(e.type, (reciprocal,) * component_count(e.type))
            if isinstance(e.type, Matrix):
                factor = Splat(Const(reciprocal, Scalar(Kind.FLOAT)), e.type)
            return Binary(BinaryOp.MUL, e.lhs, factor, e.type, span=e.span)
        return e

    def _negate(self, e: Expr) -> Expr:
        return self.simplify(Unary(UnaryOp.NEGATE, e, e.type))

    def _integer(self, e: Binary, kind: Kind | None) -> Expr:
        """Simplify integer arithmetic. Ints wrap, so all rules modulo 2 ** 32 are valid."""
        op, lhs, rhs = e.op, e.lhs, e.rhs
        left, right = self.same(lhs), self.same(rhs)
        if kind is Kind.BOOL:
            return _truth(e, left, right)
        match op:
            case BinaryOp.ADD | BinaryOp.OR | BinaryOp.XOR if left == 0:
                return rhs
            case (
                BinaryOp.ADD
                | BinaryOp.SUB
                | BinaryOp.OR
                | BinaryOp.XOR
                | BinaryOp.SHL
                | BinaryOp.SHR
                | BinaryOp.FLOOR_DIV
            ) if right == 0:
                return lhs
            case BinaryOp.MUL if left == 1:
                return rhs
            case BinaryOp.MUL | BinaryOp.FLOOR_DIV if right == 1:
                return lhs
            case BinaryOp.MUL | BinaryOp.AND if left == 0 or right == 0:
                return constant(e.type, (0,) * component_count(e.type))
            case BinaryOp.MOD if right in (0, 1):
                return constant(e.type, (0,) * component_count(e.type))
            case BinaryOp.SUB | BinaryOp.XOR if lhs is rhs:
                return constant(e.type, (0,) * component_count(e.type))
            case BinaryOp.AND | BinaryOp.OR if lhs is rhs:
                return lhs
            case BinaryOp.FLOOR_DIV | BinaryOp.MOD if right and right > 0:
                return _power_of_two(e, int(right))
            case _:
                return e

    def _logical(self, e: Logical) -> Expr:
        short = e.op is LogicalOp.OR  # the operand value that decides the result
        left, right = self.same(e.lhs), self.same(e.rhs)
        if left is not None:
            return Const(short, BOOL) if left == short else e.rhs
        if right is not None:
            return Const(short, BOOL) if right == short else e.lhs
        return e.lhs if e.lhs is e.rhs else e

    def _select(self, e: Select) -> Expr:
        condition, yes, no = e.condition, e.yes, e.no
        if yes is no:
            return yes
        picked = self.same(condition)
        if picked is not None:
            return yes if picked else no
        if isinstance(condition, Unary):  # NOT is the only Unary of a bool
            return self.simplify(Select(condition.operand, no, yes, e.type, span=e.span))
        if kind_of(e.type) is Kind.BOOL and condition.type is e.type:
            when_yes, when_no = self.same(yes), self.same(no)
            if when_yes is True and when_no is False:
                return condition
            if when_yes is False and when_no is True:
                return self.simplify(Unary(UnaryOp.NOT, condition, e.type, span=e.span))
        return e

    def _cast(self, e: Cast, value: Expr, type: Type) -> Expr:
        if value.type is type:
            return value
        if isinstance(value, Splat) and isinstance(type, Vector):
            inner = Cast(value.value, Scalar(type.kind), span=e.span)
            return Splat(self.simplify(inner), type, span=e.span)
        if isinstance(value, Cast):
            first, between, last = (kind_of(t) for t in (value.value.type, value.type, type))
            whole = (Kind.INT, Kind.UINT)
            if first in whole and between in whole and last in whole:
                return self.simplify(Cast(value.value, type, span=e.span))
            if first is last is Kind.BOOL:
                return value.value
        return e

    def _builtin(self, e: Builtin, name: str, args: tuple[Expr, ...]) -> Expr:
        match name, args:
            case "min" | "max", (a, b) if a is b:
                return a
            case "min" | "max", (a, b) if self._is_idle(name, a, b):
                return a
            case "abs", (Unary(UnaryOp.NEGATE, inner),):
                return Builtin("abs", (inner,), e.type, span=e.span)
            case "abs", (Builtin("abs"),):
                return args[0]
            case "floor" | "ceil" | "round" | "trunc", (
                Builtin("floor" | "ceil" | "round" | "trunc"),
            ):
                return args[0]
            case _:
                return e

    def _is_idle(self, name: str, a: Expr, b: Expr) -> bool:
        """Return whether min or max with the bound ``b`` provably leaves ``a`` unchanged."""
        if kind_of(a.type) is not Kind.FLOAT or self.components(b) is None:
            return False
        (low, high), bound = interval(a, self._known), interval(b, {})
        return low >= bound[1] if name == "max" else high <= bound[0]


def _negated(e: Expr) -> Expr | None:
    return e.operand if isinstance(e, Unary) and e.op is UnaryOp.NEGATE else None


def _truth(e: Binary, left: Number | None, right: Number | None) -> Expr:
    match e.op:
        case BinaryOp.AND:
            decides = False
        case BinaryOp.OR:
            decides = True
        case _:
            if left is False:
                return e.rhs
            return e.lhs if right is False else e
    if left is not None:
        return e.lhs if left is decides else e.rhs
    if right is not None:
        return e.rhs if right is decides else e.lhs
    return e.lhs if e.lhs is e.rhs else e


def _power_of_two(e: Binary, divisor: int) -> Expr:
    """Replace a division by a shift, a remainder by a mask; both are correct for negative ints."""
    if divisor & (divisor - 1):
        return e
    count = component_count(e.type)
    if e.op is BinaryOp.FLOOR_DIV:
        shift = constant(e.type, (divisor.bit_length() - 1,) * count)
        return Binary(BinaryOp.SHR, e.lhs, shift, e.type, span=e.span)
    mask = constant(e.type, (divisor - 1,) * count)
    return Binary(BinaryOp.AND, e.lhs, mask, e.type, span=e.span)
