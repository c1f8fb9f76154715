"""Results of built-ins for constant arguments.

Input: a ``ConstantCall``. Output: the components of the result, or NotFoldableError. Each step is
rounded to the module's precision in the order of the definition; elementary functions are computed
in 64 bits and rounded once, which is more accurate than the declared tolerance.
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
        args: The components of each argument, clamped if the intrinsic clamps its argument.
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
    """Leave the result to the target.

    Raises:
        NotFoldableError: Always.
    """
    raise NotFoldableError


def whole(function: Callable[[float], float]) -> Fold:
    """Return a fold that applies a function with integral results to each component."""
    return lambda call: tuple(float(function(a)) for a in call.args[0])


def rounded_once(function: Callable[..., float]) -> Fold:
    """Return a fold that computes each component in 64 bits and rounds it to the precision."""

    def fold(call: ConstantCall) -> Components:
        parts = zip(*call.args, strict=True)
        return tuple(_rounded(call.arithmetic, function, *p) for p in parts)

    return fold


def by_component(function: Callable[..., Number]) -> Fold:
    """Return a fold that applies an exact function of (kind, numbers of it) to each component."""
    return lambda call: tuple(function(call.kind, *p) for p in zip(*call.args, strict=True))


def stepwise(function: Callable[..., Components]) -> Fold:
    """Return a fold that calls ``function(arithmetic, *vectors)``, where each step is rounded."""
    return lambda call: function(call.arithmetic, *call.args)


def _rounded(calc: ConstantArithmetic, function: Callable[..., float], *args: Number) -> float:
    try:
        value = function(*args)
    except (ValueError, OverflowError):
        raise NotFoldableError from None
    return calc.round(value)


# Folds that take the whole call.


def any_true(call: ConstantCall) -> Components:
    """Return whether any component is true."""
    return (any(call.args[0]),)


def all_true(call: ConstantCall) -> Components:
    """Return whether every component is true."""
    return (all(call.args[0]),)


def unchanged(call: ConstantCall) -> Components:
    """Return the only argument."""
    return call.args[0]


def never(call: ConstantCall) -> Components:
    """Return False for each component: no constant is NaN or infinite."""
    return tuple(False for _ in call.args[0])


def reinterpreted(call: ConstantCall) -> Components:
    """Return the same bits as numbers of the result's kind."""
    return tuple(call.arithmetic.bits(a, call.kind, call.result) for a in call.args[0])


def in_range(call: ConstantCall) -> Components:
    """Convert each float to an integer, if the result's kind can hold it.

    Raises:
        NotFoldableError: A component is out of range.
    """
    found = tuple(int(a) for a in call.args[0])
    if any(wrap(a, call.result) != a for a in found):
        raise NotFoldableError
    return found


# Functions for ``by_component``.


def smaller(kind: Kind, a: Number, b: Number) -> Number:
    """Compute min.

    Args:
        kind: The kind of the numbers.
        a: The first number.
        b: The second number.
    """
    return b if b < a else a


def larger(kind: Kind, a: Number, b: Number) -> Number:
    """Compute max.

    Args:
        kind: The kind of the numbers.
        a: The first number.
        b: The second number.
    """
    return b if a < b else a


def clamped(kind: Kind, x: Number, low: Number, high: Number) -> Number:
    """Compute clamp, min(max(x, low), high).

    Args:
        kind: The kind of the numbers.
        x: The number to clamp.
        low: The lower limit.
        high: The upper limit.
    """
    return smaller(kind, larger(kind, x, low), high)


def magnitude(kind: Kind, a: Number) -> Number:
    """Compute abs; an int wraps."""
    return abs(a) if kind is Kind.FLOAT else wrap(abs(int(a)), kind)


def sign(kind: Kind, a: Number) -> Number:
    """Return -1, 0 or 1, with the Python type of ``a``."""
    return type(a)((a > 0) - (a < 0))


def truncated_quotient(kind: Kind, a: int, b: int) -> int:
    """Compute the quotient of integers, rounded toward zero.

    Args:
        kind: The kind of the numbers.
        a: The dividend.
        b: The divisor.

    Raises:
        NotFoldableError: The divisor is 0.
    """
    if b == 0:
        raise NotFoldableError
    quotient = abs(a) // abs(b)
    return wrap(quotient if (a < 0) == (b < 0) else -quotient, kind)


# Functions for ``rounded_once``.


def angle(y: float, x: float) -> float:
    """Compute atan2; negative zeros count as positive."""
    return math.atan2(y + 0.0, x + 0.0)


# Functions for ``stepwise``.


def power(calc: ConstantArithmetic, x: Floats, y: Floats) -> Floats:
    """Compute pow with its limits.

    Args:
        calc: Operations in the module's precision.
        x: The bases.
        y: The exponents.
    """

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
    """Compute the inner product, summed from the first component to the last.

    Args:
        calc: Operations in the module's precision.
        a: The first vector.
        b: The second vector.
    """
    total = calc.mul(a[0], b[0])
    for x, y in zip(a[1:], b[1:], strict=True):
        total = calc.add(total, calc.mul(x, y))
    return (total,)


def _root(calc: ConstantArithmetic, a: float) -> float:
    return _rounded(calc, math.sqrt, a)


def length(calc: ConstantArithmetic, a: Floats) -> tuple[float]:
    """Compute the Euclidean length."""
    return (_root(calc, dot(calc, a, a)[0]),)


def distance(calc: ConstantArithmetic, a: Floats, b: Floats) -> tuple[float]:
    """Compute the length of a - b.

    Args:
        calc: Operations in the module's precision.
        a: The first point.
        b: The second point.
    """
    return length(calc, tuple(calc.sub(x, y) for x, y in zip(a, b, strict=True)))


def normalized(calc: ConstantArithmetic, a: Floats) -> Floats:
    """Divide the vector by its length; the zero vector gives 0."""
    square = max(dot(calc, a, a)[0], limits.smallest(calc.precision))
    return tuple(calc.div(x, _root(calc, square)) for x in a)


def cross(calc: ConstantArithmetic, a: Floats, b: Floats) -> Floats:
    """Compute the cross product.

    Args:
        calc: Operations in the module's precision.
        a: The first vector.
        b: The second vector.
    """
    pairs = ((1, 2), (2, 0), (0, 1))
    return tuple(calc.sub(calc.mul(a[i], b[j]), calc.mul(a[j], b[i])) for i, j in pairs)


def inverse_square_root(calc: ConstantArithmetic, a: Floats) -> Floats:
    """Compute 1 / sqrt(x) for each component."""
    return tuple(calc.div(1.0, _root(calc, x)) for x in a)


def fraction(calc: ConstantArithmetic, a: Floats) -> Floats:
    """Compute x - floor(x) for each component, below 1."""
    most = limits.below_one(calc.precision)
    return tuple(min(calc.sub(x, float(math.floor(x))), most) for x in a)


def nearer_zero(calc: ConstantArithmetic, a: Floats) -> Floats:
    """Compute the next float in the direction of 0 for each component."""
    return tuple(calc.mul(x, limits.below_one(calc.precision)) for x in a)


def remainder(calc: ConstantArithmetic, a: Floats, b: Floats) -> Floats:
    """Compute mod; 0 where b counts as 0.

    Args:
        calc: Operations in the module's precision.
        a: The dividends.
        b: The divisors.
    """
    parts = zip(a, b, strict=True)
    least = limits.SMALLEST_DIVISOR
    return tuple(0.0 if abs(y) < least else calc.float_binary(BinaryOp.MOD, x, y)
                 for x, y in parts)  # fmt: skip


def stepped(calc: ConstantArithmetic, edge: Floats, a: Floats) -> Floats:
    """Compute step: 0 where a < edge, else 1.

    Args:
        calc: Operations in the module's precision.
        edge: The limits.
        a: The values.
    """
    return tuple(0.0 if x < e else 1.0 for e, x in zip(edge, a, strict=True))


def mixed(calc: ConstantArithmetic, a: Floats, b: Floats, t: Floats) -> Floats:
    """Compute a + (b - a) * t.

    Args:
        calc: Operations in the module's precision.
        a: The values at t = 0.
        b: The values at t = 1.
        t: The weights of ``b``.
    """
    parts = zip(a, b, t, strict=True)
    return tuple(calc.add(x, calc.mul(calc.sub(y, x), s)) for x, y, s in parts)


def smoothstepped(calc: ConstantArithmetic, low: Floats, high: Floats, a: Floats) -> Floats:
    """Compute smoothstep; a step where low and high are equal.

    Args:
        calc: Operations in the module's precision.
        low: Where the result is 0.
        high: Where the result is 1.
        a: The values.
    """
    result = []
    for bottom, top, x in zip(low, high, a, strict=True):
        extent = calc.sub(top, bottom)
        if abs(extent) < limits.SMALLEST:
            t = 0.0 if x < bottom else 1.0
        else:
            t = min(max(calc.div(calc.sub(x, bottom), extent), 0.0), 1.0)
        result.append(calc.mul(calc.mul(t, t), calc.sub(3.0, calc.mul(2.0, t))))
    return tuple(result)
