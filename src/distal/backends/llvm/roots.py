"""Compute square roots and divisions from estimates, if the processor has accurate estimates.

Input and output: leaves. AVX-512 estimates 1/sqrt(x) to 14 bits in a third of the time that the
vector divider needs for a root. One step of Newton's method increases it to 27 bits, an error of at
most one unit in the last place (the root of a denormal number keeps the estimate's 14 bits), and
whole results stay exact. The divider was the bottleneck of the first example: 64 lanes took 7.7 ms
per picture with it and 5.9 ms without it.
"""

from __future__ import annotations

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.fusion import fused_product
from distal.backends.llvm.lanes import Leaf
from distal.ir.nodes import CompareOp
from distal.ir.types import Kind

_RSQRT = "@llvm.x86.avx512.rsqrt14.ps.512"
_FIXUP = "@llvm.x86.avx512.mask.fixupimm.ps.512"
# The action of fixupimm for each class of a value, four bits each: 1 returns the value instead of
# the result. Classes: quiet and signalling NaN, zero, one, -infinity, infinity, negative, positive.
_ZERO_AND_INFINITY = 0x00100100
_INFINITIES = 0x00110000
_SMALLEST, _LARGEST = 2.0**-100, 2.0**100


def _estimates(arithmetic: LaneArithmetic, *leaves: Leaf) -> bool:
    lanes = arithmetic.lanes
    varying = not all(leaf.uniform for leaf in leaves)
    return lanes.level == "avx512" and lanes.precision == 32 and varying


def square_root(arithmetic: LaneArithmetic, x: Leaf) -> Leaf:
    """Return the square root; 0, infinity and NaN are returned unchanged, and NaN below 0."""
    if not _estimates(arithmetic, x):
        return arithmetic.intrinsic("sqrt", Kind.FLOAT, x)
    value, vector = arithmetic.writer.value, arithmetic.lanes.vector(Kind.FLOAT)
    names = []
    for name in x.names:
        y = _estimate(arithmetic, name)
        root = value(f"fmul {vector} {name}, {y}")
        half = value(f"fmul {vector} {y}, splat (float 0.5)")
        rest = _fused(arithmetic, value(f"fneg {vector} {root}"), root, name)
        better = _fused(arithmetic, rest, half, root)
        # For 0 the estimate is infinity and for infinity it is 0, so the product is NaN.
        names.append(_except(arithmetic, better, name, _ZERO_AND_INFINITY))
    return Leaf(Kind.FLOAT, tuple(names), False)


def inverse_square_root(arithmetic: LaneArithmetic, x: Leaf) -> Leaf:
    """Return ``1 / sqrt(x)``: infinity for 0, 0 for infinity."""
    if not _estimates(arithmetic, x):
        one = arithmetic.constant(1.0, Kind.FLOAT)
        return arithmetic.divide(one, square_root(arithmetic, x))
    value, vector = arithmetic.writer.value, arithmetic.lanes.vector(Kind.FLOAT)
    names = []
    for name in x.names:
        y = _estimate(arithmetic, name)
        root = value(f"fmul {vector} {name}, {y}")
        half = value(f"fmul {vector} {y}, splat (float 0.5)")
        inverse = value(f"fneg {vector} {root}")
        rest = _fused(arithmetic, inverse, y, "splat (float 1.0)")
        better = _fused(arithmetic, rest, half, y)
        names.append(_unless_nan(arithmetic, better, y))
    return Leaf(Kind.FLOAT, tuple(names), False)


def quotient(arithmetic: LaneArithmetic, a: Leaf, b: Leaf) -> Leaf:
    """Return ``a / b``, using the reciprocal if all lanes share the divisor.

    The product with the rounded reciprocal is corrected by its remainder (P. Markstein,
    "Computation of Elementary Functions on the IBM RISC System/6000 Processor", 1990): the result
    is the correctly rounded quotient, except near the ends of the range of floats.

    Args:
        arithmetic: Writes the operations.
        a: The dividend.
        b: The divisor.
    """
    if not (_estimates(arithmetic, a) and b.uniform):
        return arithmetic.divide(a, b)
    one = arithmetic.constant(1.0, Kind.FLOAT)
    (divisor,) = b.names
    reciprocal, correction = arithmetic.once(
        ("reciprocal", divisor), lambda: _reciprocals(arithmetic, b, one)
    )
    value, vector = arithmetic.writer.value, arithmetic.lanes.vector(Kind.FLOAT)
    names = []
    inverses, corrections = arithmetic.vectors(reciprocal), arithmetic.vectors(correction)
    negated = arithmetic.once(
        ("negated", divisor), lambda: arithmetic.vectors(arithmetic.negate(b))
    )
    for c, name in enumerate(a.names):
        first = value(f"fmul {vector} {name}, {inverses[c]}")
        rest = _fused(arithmetic, negated[c], first, name)
        better = _fused(arithmetic, rest, corrections[c], first)
        # An infinite quotient, or a quotient by infinity, needs no correction.
        if b.constant:
            names.append(_except(arithmetic, better, first, _INFINITIES))
        else:
            names.append(_unless_nan(arithmetic, better, first))
    return Leaf(Kind.FLOAT, tuple(names), False)


def _reciprocals(arithmetic: LaneArithmetic, b: Leaf, one: Leaf) -> tuple[Leaf, Leaf]:
    """Return ``1 / b``, and the factor of the correction: the same, or 0 if ``b`` is extreme."""
    reciprocal = arithmetic.divide(one, b)
    size = arithmetic.intrinsic("fabs", Kind.FLOAT, b)
    above = arithmetic.compare(CompareOp.GT, size, arithmetic.constant(_SMALLEST, Kind.FLOAT))
    below = arithmetic.compare(CompareOp.LT, size, arithmetic.constant(_LARGEST, Kind.FLOAT))
    zero = arithmetic.constant(0.0, Kind.FLOAT)
    return reciprocal, arithmetic.select(arithmetic.both(above, below), reciprocal, zero)


def _estimate(arithmetic: LaneArithmetic, name: str) -> str:
    vector = arithmetic.lanes.vector(Kind.FLOAT)
    arithmetic.declarations.add(f"declare {vector} {_RSQRT}({vector}, {vector}, i16)")
    return arithmetic.writer.value(
        f"call {vector} {_RSQRT}({vector} {name}, {vector} zeroinitializer, i16 -1)"
    )


def _fused(arithmetic: LaneArithmetic, a: str, b: str, c: str) -> str:
    """Return ``a * b + c``, rounded once."""
    vector = arithmetic.lanes.vector(Kind.FLOAT)
    return arithmetic.writer.value(fused_product(vector, a, b, c, arithmetic.declarations))


def _except(arithmetic: LaneArithmetic, value: str, own: str, classes: int) -> str:
    """Return ``value``, but ``own`` in lanes where ``own`` is in one of some classes of numbers."""
    vector, whole = arithmetic.lanes.vector(Kind.FLOAT), arithmetic.lanes.vector(Kind.INT)
    arithmetic.declarations.add(
        f"declare {vector} {_FIXUP}({vector}, {vector}, {whole}, i32, i16, i32)"
    )
    return arithmetic.writer.value(
        f"call {vector} {_FIXUP}({vector} {value}, {vector} {own}, {whole} splat (i32 {classes}), "
        "i32 0, i16 -1, i32 4)"
    )


def _unless_nan(arithmetic: LaneArithmetic, value: str, otherwise: str) -> str:
    vector, bools = arithmetic.lanes.vector(Kind.FLOAT), arithmetic.lanes.vector(Kind.BOOL)
    nan = arithmetic.writer.value(f"fcmp uno {vector} {value}, {value}")
    return arithmetic.writer.value(f"select {bools} {nan}, {vector} {otherwise}, {vector} {value}")
