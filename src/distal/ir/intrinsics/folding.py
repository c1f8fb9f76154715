"""What a built-in gives for constant arguments.

Input: a ``ConstantCall``. Output: the components of the result, or NotFoldableError. Each step
rounds to the module's precision in the order of the definition; elementary functions are computed
in 64 bits and rounded once, closer than the declared tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from distal.ir import limits
from distal.ir.constant_arithmetic import ConstantArithmetic, NotFoldableError, Number, wrap
from distal.ir.nodes import BinaryOp
from distal.ir.types import Kind

Components: TypeAlias = tuple[Number, ...]
Floats: TypeAlias = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ConstantCall:
    """A call with constant arguments.

    Attributes:
        args: The components of each argument, clamped where the intrinsic says so.
        kind: The kind of the first argument's components.
        result: The kind of the result's components.
        arithmetic: Operations in the module's precision.
    """

    args: tuple[Components, ...]
    kind: Kind
    result: Kind
    arithmetic: ConstantArithmetic


Fold: TypeAlias = Callable[[ConstantCall], Components]


def not_folded(call: ConstantCall) -> Components:
    """The result comes from the target."""
    raise NotFoldableError


def whole(function: Callable[[float], float]) -> Fold:
    """A whole number for each component."""
    return lambda call: tuple(float(function(a)) for a in call.args[0])


def rounded_once(function: Callable[..., float]) -> Fold:
    """A function of 64 bits for each component, rounded to the precision."""

    def fold(call: ConstantCall) -> Components:
        parts = zip(*call.args, strict=True)
        return tuple(_rounded(call.arithmetic, function, *p) for p in parts)

    return fold


def by_component(function: Callable[..., Number]) -> Fold:
    """An exact function of a kind and of numbers of it, for each component."""
    return lambda call: tuple(function(call.kind, *p) for p in zip(*call.args, strict=True))


def stepwise(function: Callable[..., Components]) -> Fold:
    """A function of ``ConstantArithmetic`` and vectors, each step rounded."""
    return lambda call: function(call.arithmetic, *call.args)


def _rounded(calc: ConstantArithmetic, function: Callable[..., float], *args: Number) -> float:
    try:
        value = function(*args)
    except (ValueError, OverflowError):
        raise NotFoldableError from None
    return calc.round(value)


# Folds of whole calls.


def any_true(call: ConstantCall) -> Components:
    """Whether a component is true."""
    return (any(call.args[0]),)


def all_true(call: ConstantCall) -> Components:
    """Whether every component is true."""
    return (all(call.args[0]),)


def never(call: ConstantCall) -> Components:
    """False for each component: no constant is NaN or infinite."""
    return tuple(False for _ in call.args[0])


def reinterpreted(call: ConstantCall) -> Components:
    """The same bits as numbers of the result's kind."""
    return tuple(call.arithmetic.bits(a, call.kind, call.result) for a in call.args[0])


def in_range(call: ConstantCall) -> Components:
    """Each float as a whole number, if the result's kind holds it."""
    found = tuple(int(a) for a in call.args[0])
    if any(wrap(a, call.result) != a for a in found):
        raise NotFoldableError
    return found


# For ``by_component``.


def smaller(kind: Kind, a: Number, b: Number) -> Number:
    """Min."""
    return b if b < a else a


def larger(kind: Kind, a: Number, b: Number) -> Number:
    """Max."""
    return b if a < b else a


def clamped(kind: Kind, x: Number, low: Number, high: Number) -> Number:
    """Clamp: min(max(x, low), high)."""
    return smaller(kind, larger(kind, x, low), high)


def magnitude(kind: Kind, a: Number) -> Number:
    """Abs."""
    return abs(a) if kind is Kind.FLOAT else wrap(abs(int(a)), kind)


def sign(kind: Kind, a: Number) -> Number:
    """-1, 0 or 1 of a's own type."""
    return type(a)((a > 0) - (a < 0))


def truncated_quotient(kind: Kind, a: int, b: int) -> int:
    """The quotient of whole numbers toward zero."""
    if b == 0:
        raise NotFoldableError
    quotient = abs(a) // abs(b)
    return wrap(quotient if (a < 0) == (b < 0) else -quotient, kind)


# For ``rounded_once``.


def angle(y: float, x: float) -> float:
    """atan2; no zero is negative."""
    return math.atan2(y + 0.0, x + 0.0)


# For ``stepwise``.


def power(calc: ConstantArithmetic, x: Floats, y: Floats) -> Floats:
    """Pow, within its limits."""

    def one(base: float, exponent: float) -> float:
        most = limits.largest_power(calc.precision)
        if base < limits.smallest(calc.precision):
            return 1.0 if exponent == 0.0 else most if exponent < 0.0 else 0.0
        try:
            return min(math.pow(base, exponent), most)
        except OverflowError:
            return most

    return tuple(calc.round(one(*pair)) for pair in zip(x, y, strict=True))


def dot(calc: ConstantArithmetic, a: Floats, b: Floats) -> tuple[float]:
    """The inner product, from the first component to the last."""
    total = calc.mul(a[0], b[0])
    for x, y in zip(a[1:], b[1:], strict=True):
        total = calc.add(total, calc.mul(x, y))
    return (total,)


def _root(calc: ConstantArithmetic, a: float) -> float:
    return _rounded(calc, math.sqrt, a)


def length(calc: ConstantArithmetic, a: Floats) -> tuple[float]:
    """The Euclidean length."""
    return (_root(calc, dot(calc, a, a)[0]),)


def distance(calc: ConstantArithmetic, a: Floats, b: Floats) -> tuple[float]:
    """The length of a - b."""
    return length(calc, tuple(calc.sub(x, y) for x, y in zip(a, b, strict=True)))


def normalized(calc: ConstantArithmetic, a: Floats) -> Floats:
    """The vector over its length; 0 for the zero vector."""
    square = max(dot(calc, a, a)[0], limits.smallest(calc.precision))
    return tuple(calc.div(x, _root(calc, square)) for x in a)


def cross(calc: ConstantArithmetic, a: Floats, b: Floats) -> Floats:
    """The vector product."""
    pairs = ((1, 2), (2, 0), (0, 1))
    return tuple(calc.sub(calc.mul(a[i], b[j]), calc.mul(a[j], b[i])) for i, j in pairs)


def inverse_square_root(calc: ConstantArithmetic, a: Floats) -> Floats:
    """1 / sqrt(x)."""
    return tuple(calc.div(1.0, _root(calc, x)) for x in a)


def fraction(calc: ConstantArithmetic, a: Floats) -> Floats:
    """X - floor(x)."""
    return tuple(calc.sub(x, float(math.floor(x))) for x in a)


def remainder(calc: ConstantArithmetic, a: Floats, b: Floats) -> Floats:
    """Mod; 0 where b counts as 0."""
    parts = zip(a, b, strict=True)
    least = limits.SMALLEST_DIVISOR
    return tuple(0.0 if abs(y) < least else calc.float_binary(BinaryOp.MOD, x, y)
                 for x, y in parts)  # fmt: skip


def stepped(calc: ConstantArithmetic, edge: Floats, a: Floats) -> Floats:
    """Step: 0 where a < edge, else 1."""
    return tuple(0.0 if x < e else 1.0 for e, x in zip(edge, a, strict=True))


def mixed(calc: ConstantArithmetic, a: Floats, b: Floats, t: Floats) -> Floats:
    """A + (b - a) * t."""
    parts = zip(a, b, t, strict=True)
    return tuple(calc.add(x, calc.mul(calc.sub(y, x), s)) for x, y, s in parts)


def smoothstepped(calc: ConstantArithmetic, low: Floats, high: Floats, a: Floats) -> Floats:
    """Smoothstep; a step where low and high are equal."""
    result = []
    for bottom, top, x in zip(low, high, a, strict=True):
        extent = calc.sub(top, bottom)
        if abs(extent) < limits.SMALLEST:
            t = 0.0 if x < bottom else 1.0
        else:
            t = min(max(calc.div(calc.sub(x, bottom), extent), 0.0), 1.0)
        result.append(calc.mul(calc.mul(t, t), calc.sub(3.0, calc.mul(2.0, t))))
    return tuple(result)
