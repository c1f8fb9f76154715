"""Write the built-ins that the CPU computes directly.

Input: a built-in's name, and the leaves of its arguments. Output: the leaves of the result. All
other built-ins have been decomposed into calls of prelude functions. In 64 bits the prelude's
polynomials are not accurate enough, so elementary functions call the C library lane by lane.
"""

from __future__ import annotations

import math

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.lanes import Leaf, Leaves, leaf_count
from distal.backends.llvm.roots import inverse_square_root, square_root
from distal.ir.intrinsics import INTRINSICS
from distal.ir.limits import largest_power, smallest
from distal.ir.nodes import BinaryOp, CompareOp
from distal.ir.types import Kind, Matrix, Type

# LLVM's names of the rounding functions.
_ROUNDING = {"floor": "floor", "ceil": "ceil", "round": "rint", "trunc": "trunc"}


def builtin(
    arithmetic: LaneArithmetic, name: str, args: tuple[Leaves, ...], types: tuple[Type, ...]
) -> Leaves:
    """Return the result of a built-in.

    Args:
        arithmetic: Writes the operations.
        name: The built-in.
        args: The leaves of each argument.
        types: The types of the arguments.
    """
    first = args[0]
    match name:
        case "dot":
            return (_dot(arithmetic, first, args[1]),)
        case "length":
            return (square_root(arithmetic, _dot(arithmetic, first, first)),)
        case "cross":
            return _cross(arithmetic, first, args[1])
        case "any":
            return (_joined(arithmetic, "or", first),)
        case "all":
            return (_joined(arithmetic, "and", first),)
        case "transpose":
            (matrix,) = types
            assert isinstance(matrix, Matrix)
            n = matrix.size
            return tuple(first[row * n + column] for column in range(n) for row in range(n))
        case _:
            # The remaining built-ins are componentwise: all arguments have equally many leaves.
            assert all(leaf_count(t) == len(first) for t in types)
            return tuple(_component(arithmetic, name, row) for row in zip(*args, strict=True))


def _dot(arithmetic: LaneArithmetic, a: Leaves, b: Leaves) -> Leaf:
    total = arithmetic.binary(BinaryOp.MUL, a[0], b[0])
    for x, y in zip(a[1:], b[1:], strict=True):
        product = arithmetic.binary(BinaryOp.MUL, x, y)
        total = arithmetic.binary(BinaryOp.ADD, total, product)
    return total


def _cross(arithmetic: LaneArithmetic, a: Leaves, b: Leaves) -> Leaves:
    def minor(i: int, j: int) -> Leaf:
        plus = arithmetic.binary(BinaryOp.MUL, a[i], b[j])
        return arithmetic.binary(BinaryOp.SUB, plus, arithmetic.binary(BinaryOp.MUL, a[j], b[i]))

    return minor(1, 2), minor(2, 0), minor(0, 1)


def _joined(arithmetic: LaneArithmetic, op: str, leaves: Leaves) -> Leaf:
    joined = leaves[0]
    for leaf in leaves[1:]:
        joined = arithmetic.apply(Kind.BOOL, f"{op} {{t0}} {{0}}, {{1}}", joined, leaf)
    return joined


def _component(arithmetic: LaneArithmetic, name: str, args: Leaves) -> Leaf:
    x, kind = args[0], args[0].kind
    match name:
        case "abs":
            if kind is Kind.FLOAT:
                return arithmetic.intrinsic("fabs", kind, x)
            return arithmetic.intrinsic("abs", kind, x, rest=", i1 false")
        case "sign":
            return _sign(arithmetic, x)
        case "floor" | "ceil" | "round" | "trunc":
            return arithmetic.intrinsic(_ROUNDING[name], kind, x)
        case "min":
            # b < a ? b : a is x86's minimum instruction, even for NaN.
            return arithmetic.select(arithmetic.compare(CompareOp.LT, args[1], x), args[1], x)
        case "max":
            return arithmetic.select(arithmetic.compare(CompareOp.LT, x, args[1]), args[1], x)
        case "sqrt":
            return square_root(arithmetic, x)
        case "inversesqrt":
            return inverse_square_root(arithmetic, x)
        case "isnan":
            return arithmetic.apply(Kind.BOOL, "fcmp uno {t0} {0}, {1}", x, x)
        case "isinf":
            infinity = arithmetic.constant(math.inf, kind)
            magnitude = arithmetic.intrinsic("fabs", kind, x)
            return arithmetic.compare(CompareOp.EQ, magnitude, infinity)
        case "float_bits_to_int" | "float_bits_to_uint":
            return _bits_of(arithmetic, x, Kind.INT if name.endswith("_int") else Kind.UINT)
        case "int_bits_to_float" | "uint_bits_to_float":
            return _float_of(arithmetic, x)
        case "truncated_quotient":
            return arithmetic.truncated_quotient(x, args[1])
        case "saturated_int":
            return arithmetic.cast(x, Kind.INT)
        case "saturated_uint":
            return arithmetic.cast(x, Kind.UINT)
        case _:
            return _library(arithmetic, name, args)


def _sign(arithmetic: LaneArithmetic, x: Leaf) -> Leaf:
    zero = arithmetic.constant(0, x.kind)
    below = arithmetic.compare(CompareOp.LT, x, zero)
    above = arithmetic.compare(CompareOp.LT, zero, x)
    negative = arithmetic.select(below, arithmetic.constant(-1, x.kind), zero)
    return arithmetic.select(above, arithmetic.constant(1, x.kind), negative)


def _bits_of(arithmetic: LaneArithmetic, x: Leaf, kind: Kind) -> Leaf:
    """Return the bits of a value as a 32-bit float, in either precision."""
    if arithmetic.lanes.precision == 32:
        return arithmetic.apply(kind, "bitcast {t0} {0} to {r}", x)
    names = []
    for name in x.names:
        double = arithmetic.lanes.type(Kind.FLOAT, uniform=x.uniform)
        narrow = double.replace("double", "float")
        single = arithmetic.writer.value(f"fptrunc {double} {name} to {narrow}")
        whole = arithmetic.lanes.type(kind, uniform=x.uniform)
        names.append(arithmetic.writer.value(f"bitcast {narrow} {single} to {whole}"))
    return Leaf(kind, tuple(names), x.uniform)


def _float_of(arithmetic: LaneArithmetic, x: Leaf) -> Leaf:
    """Return the 32-bit float with these bits, converted to the precision."""
    if arithmetic.lanes.precision == 32:
        return arithmetic.apply(Kind.FLOAT, "bitcast {t0} {0} to {r}", x)
    names = []
    for name in x.names:
        whole = arithmetic.lanes.type(x.kind, uniform=x.uniform)
        narrow = whole.replace("i32", "float")
        single = arithmetic.writer.value(f"bitcast {whole} {name} to {narrow}")
        double = arithmetic.lanes.type(Kind.FLOAT, uniform=x.uniform)
        names.append(arithmetic.writer.value(f"fpext {narrow} {single} to {double}"))
    return Leaf(Kind.FLOAT, tuple(names), x.uniform)


def _library(arithmetic: LaneArithmetic, name: str, args: Leaves) -> Leaf:
    """Return an elementary function of the C library; the base of a power is clamped to 0."""
    if name in ("atan2", "raw_atan2"):
        # For y = 0 the result must not depend on the signs of zeros; the library returns pi for
        # x = -0, and the negative angle for y = -0.
        zero, half_turn = (arithmetic.constant(a, Kind.FLOAT) for a in (0.0, math.pi))
        flat = arithmetic.compare(CompareOp.EQ, args[0], zero)
        behind = arithmetic.compare(CompareOp.LT, args[1], zero)
        angle = arithmetic.intrinsic("atan2", Kind.FLOAT, *args)
        return arithmetic.select(flat, arithmetic.select(behind, half_turn, zero), angle)
    if name in ("pow", "raw_power"):
        precision = arithmetic.lanes.precision
        zero = arithmetic.constant(0.0, Kind.FLOAT)
        least = arithmetic.constant(smallest(precision), Kind.FLOAT)
        most = arithmetic.constant(largest_power(precision), Kind.FLOAT)
        below = arithmetic.compare(CompareOp.LT, args[0], least)
        base = arithmetic.select(below, zero, args[0])
        power = arithmetic.intrinsic("pow", Kind.FLOAT, base, args[1])
        return arithmetic.select(arithmetic.compare(CompareOp.LT, most, power), most, power)
    spelling = INTRINSICS[name].spelling("llvm")
    assert spelling is not None and spelling.startswith("@elementary."), name
    return arithmetic.intrinsic(name, Kind.FLOAT, args[0])
