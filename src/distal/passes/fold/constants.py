"""Find constant expressions, and compute operations on constants.

Input: expressions, and the values of immutable locals. Output: components of constants, rounded to
the module's precision, and expressions built from such components.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set

from distal.ir.constant_arithmetic import COMPARE, ConstantArithmetic, NotFoldableError, Number
from distal.ir.intrinsics import INTRINSICS
from distal.ir.intrinsics.folding import Components, ConstantCall
from distal.ir.nodes import (
    Binary,
    Builtin,
    Cast,
    Compare,
    Compose,
    Const,
    Expr,
    Field,
    PerFrame,
    Read,
    Resource,
    Splat,
    Swizzle,
    Unary,
    Uniform,
)
from distal.ir.types import Kind, Matrix, Scalar, Type, Vector, component_count, kind_of
from distal.ir.walk import is_unchanging


def constant(type: Type, values: Components) -> Expr:
    """Return the expression of a scalar, vector or matrix with these components."""
    kind = kind_of(type)
    assert kind is not None
    scalars = [Const(v, Scalar(kind)) for v in values]
    match type:
        case Scalar():
            return scalars[0]
        case Matrix(size):
            columns = (values[i : i + size] for i in range(0, len(values), size))
            return Compose(tuple(constant(Vector(kind, size), c) for c in columns), type)
        case _:
            return (
                Splat(scalars[0], type) if len(set(scalars)) == 1 else Compose(tuple(scalars), type)
            )


def fold_builtin(
    name: str,
    args: Sequence[Components],
    types: Sequence[Type],
    result: Type,
    arithmetic: ConstantArithmetic,
) -> Components:
    """Compute the components of ``name(*args)``.

    Args:
        name: An intrinsic.
        args: The components of each argument.
        types: The type of each argument.
        result: The type of the result.
        arithmetic: Operations in the module's precision.

    Raises:
        NotFoldableError: The result is left to the target.
    """
    intrinsic, kind, result_kind = INTRINSICS[name], kind_of(types[0]), kind_of(result)
    if kind is None or result_kind is None:
        raise NotFoldableError
    if kind is Kind.FLOAT:
        args = [tuple(map(float, arg)) for arg in args]
    if intrinsic.held is not None:
        low, high = intrinsic.held.limits(arithmetic.precision)
        args = [tuple(min(max(c, low), high) for c in arg) for arg in args]
    return intrinsic.fold(ConstantCall(tuple(args), kind, result_kind, arithmetic))


class Constants:
    """Constant expressions of one function.

    Args:
        arithmetic: Operations in the module's precision.
        known: The Read of an immutable local -> its value; may grow between calls.
        mutable: The names of the locals that an Assign changes.
    """

    def __init__(
        self, arithmetic: ConstantArithmetic, known: Mapping[Expr, Expr], mutable: Set[str]
    ) -> None:
        self._math = arithmetic
        self._known = known
        self._mutable = mutable

    def is_trivial(self, e: Expr) -> bool:
        """Return whether an expression can be repeated at no cost.

        True for constants, uniforms and immutable locals, and for their components and fields.
        """
        while isinstance(e, Swizzle | Field):
            e = e.base
        if isinstance(e, Splat):
            e = e.value
        return is_unchanging(e, self._mutable)

    def components(self, e: Expr) -> Components | None:
        """Return the components of a constant scalar, vector or matrix, rounded; else None."""
        match e:
            case Const(value):
                return (self._math.round(value),) if isinstance(value, float) else (value,)
            case Splat(value, type):
                inner = self.components(value)
                return inner and inner * component_count(type)
            case Compose(parts):
                found: list[Number] = []
                for part in parts:
                    inner = self.components(part)
                    if inner is None:
                        return None
                    found.extend(inner)
                return tuple(found)
            case Read():
                bound = self._known.get(e)
                return None if bound is None else self.components(bound)
            case _:
                return None

    def same(self, e: Expr) -> Number | None:
        """Return the common value of all components of a constant, else None."""
        try:
            found = self.components(e)
        except NotFoldableError:
            return None
        if found is None or any(c != found[0] for c in found):
            return None
        return found[0]

    def folded(self, e: Expr) -> Expr | None:
        """Return the result of an operation if all operands are constants, else None.

        Raises:
            NotFoldableError: The result is left to the target.
        """
        match e:
            case Unary(unary_op, operand, type):
                return self._each(type, operand, lambda k, a: self._math.unary(unary_op, a, k))
            case Cast(operand, type):
                target = kind_of(type)
                assert target is not None
                return self._each(type, operand, lambda k, a: self._math.cast(a, k, target))
            case Binary(op, lhs, rhs, type):
                kind = kind_of(type)
                pair = self._pair(lhs, rhs)
                if pair is None or kind is None:
                    return None
                return constant(
                    type,
                    tuple(self._math.binary(op, a, b, kind) for a, b in zip(*pair, strict=True)),
                )
            case Compare(compare_op, lhs, rhs, type):
                pair = self._pair(lhs, rhs)
                if pair is None:
                    return None
                test = COMPARE[compare_op]
                return constant(type, tuple(test(a, b) for a, b in zip(*pair, strict=True)))
            case Builtin(name, args, type):
                values = []
                for arg in args:
                    inner = self.components(arg)
                    if inner is None:
                        return None
                    values.append(inner)
                types = [a.type for a in args]
                return constant(type, fold_builtin(name, values, types, type, self._math))
            case _:
                return None

    def _each(
        self, type: Type, operand: Expr, apply: Callable[[Kind, Number], Number]
    ) -> Expr | None:
        kind = kind_of(operand.type)
        values = self.components(operand)
        if values is None or kind is None:
            return None
        return constant(type, tuple(apply(kind, a) for a in values))

    def _pair(self, lhs: Expr, rhs: Expr) -> tuple[Components, Components] | None:
        left = self.components(lhs)
        right = None if left is None else self.components(rhs)
        return None if left is None or right is None else (left, right)


def is_plain(e: Expr) -> bool:
    """Return whether an expression can be repeated at no cost at the same place.

    True for a leaf and for its components. Unlike ``Constants.is_trivial``, also True for a local
    that may change later.
    """
    while isinstance(e, Swizzle | Field):
        e = e.base
    if isinstance(e, Splat):
        e = e.value
    return isinstance(e, Const | Uniform | PerFrame | Read | Resource)
