"""Arithmetic on constants with exactly the results that the targets compute.

Input: Python numbers, the components of constants. Output: the result in the module's precision.
An operation whose result would be a NaN, an infinity or a denormal (GPUs flush denormals to 0)
raises ``NotFoldableError`` and is left to the target.

The sum, difference, product, quotient and square root of two 32-bit floats, computed in 64 bits and
rounded to 32, are correctly rounded (a 53-bit significand has at least 2 * 24 + 2 bits), so this
module does not need an array library.
"""

from __future__ import annotations

import math
import operator
import struct
from collections.abc import Callable
from typing import Final, TypeAlias

from distal.ir.limits import below_one
from distal.ir.nodes import BinaryOp, CompareOp, UnaryOp
from distal.ir.types import Kind

Number: TypeAlias = bool | int | float

_FLOAT32: Final = struct.Struct("<f")
_INT32: Final = struct.Struct("<i")
_UINT32: Final = struct.Struct("<I")
_SMALLEST_NORMAL: Final = {32: 2.0**-126, 64: 2.0**-1022}


class NotFoldableError(ArithmeticError):
    """The result of an operation cannot be stored in a constant (NaN, infinity or denormal)."""


def wrap(value: int, kind: Kind) -> int:
    """Reduce an integer modulo 2 ** 32 into the range of its kind."""
    value &= 0xFFFFFFFF
    return value - (1 << 32) if kind is Kind.INT and value & 0x80000000 else value


class ConstantArithmetic:
    """Operations on components: floats of 32 or 64 bits and 32-bit integers.

    Every method whose result would be a NaN, an infinity or a denormal raises ``NotFoldableError``.
    """

    def __init__(self, precision: int) -> None:
        self.precision = precision
        self._smallest = _SMALLEST_NORMAL[precision]

    def round(self, value: float) -> float:
        """Round a float to the module's precision.

        Raises:
            NotFoldableError: The result is a NaN, an infinity or a denormal.
        """
        if not math.isfinite(value):
            raise NotFoldableError
        if self.precision == 32:
            try:
                value = _FLOAT32.unpack(_FLOAT32.pack(value))[0]
            except OverflowError:
                raise NotFoldableError from None
        if value != 0.0 and abs(value) < self._smallest:
            raise NotFoldableError
        return value

    def unary(self, op: UnaryOp, a: Number, kind: Kind) -> Number:
        """Compute one component of a Unary.

        Args:
            op: The operator.
            a: The operand's component.
            kind: The kind of the operand and the result.
        """
        match op:
            case UnaryOp.NOT:
                return not a
            case UnaryOp.NEGATE:
                return -a if kind is Kind.FLOAT else wrap(-int(a), kind)
            case UnaryOp.INVERT:
                return wrap(~int(a), kind)

    def binary(self, op: BinaryOp, a: Number, b: Number, kind: Kind) -> Number:
        """Compute one component of a Binary.

        Args:
            op: The operator.
            a: The left operand's component.
            b: The right operand's component.
            kind: The kind of both operands and the result.
        """
        if kind is Kind.FLOAT:
            return self.float_binary(op, float(a), float(b))
        if kind is Kind.BOOL:
            return bool(_BITWISE[op](int(a), int(b)))
        return wrap(_integer_binary(op, int(a), int(b)), kind)

    def float_binary(self, op: BinaryOp, a: float, b: float) -> float:
        """Compute one component of a Binary of floats.

        Args:
            op: The operator.
            a: The left operand's component.
            b: The right operand's component.

        Raises:
            NotFoldableError: The divisor is 0, or the result is no normal number.
        """
        if op in _RING:
            return self.round(_RING[op](a, b))
        if b == 0.0:
            raise NotFoldableError
        quotient = self.round(a / b)
        match op:
            case BinaryOp.DIV:
                return quotient
            case BinaryOp.FLOOR_DIV:
                return float(math.floor(quotient))
            case _:
                assert op is BinaryOp.MOD, op
                rest = self.round(a - self.round(b * float(math.floor(quotient))))
                end = self.round(b * below_one(self.precision))
                return min(max(rest, min(end, 0.0)), max(end, 0.0))

    def add(self, a: float, b: float) -> float:
        """Return ``a + b``, rounded."""
        return self.round(a + b)

    def sub(self, a: float, b: float) -> float:
        """Return ``a - b``, rounded."""
        return self.round(a - b)

    def mul(self, a: float, b: float) -> float:
        """Return ``a * b``, rounded."""
        return self.round(a * b)

    def div(self, a: float, b: float) -> float:
        """Return ``a / b``, rounded."""
        return self.float_binary(BinaryOp.DIV, a, b)

    def cast(self, a: Number, source: Kind, target: Kind) -> Number:
        """Compute one component of a Cast.

        Args:
            a: The component before the conversion.
            source: Its kind.
            target: The kind to convert to.
        """
        match target:
            case Kind.BOOL:
                return a != 0
            case Kind.FLOAT:
                return self.round(float(a))
            case Kind.INT | Kind.UINT:
                if source is not Kind.FLOAT:
                    return wrap(int(a), target)
                low, high = (
                    (-(1 << 31), (1 << 31) - 1) if target is Kind.INT else (0, (1 << 32) - 1)
                )
                return min(max(int(a), low), high)

    def bits(self, a: Number, source: Kind, target: Kind) -> Number:
        """Read the 32 bits of a component as another kind.

        Args:
            a: The component.
            source: Its kind.
            target: The kind of the result.

        Raises:
            NotFoldableError: The module's floats have 64 bits, or the result is no normal number.
        """
        if self.precision != 32:
            raise NotFoldableError
        packing = {Kind.FLOAT: _FLOAT32, Kind.INT: _INT32, Kind.UINT: _UINT32}
        value: Number = packing[target].unpack(packing[source].pack(a))[0]
        return self.round(value) if target is Kind.FLOAT else value


_RING: Final[dict[BinaryOp, Callable[[float, float], float]]] = {
    BinaryOp.ADD: operator.add,
    BinaryOp.SUB: operator.sub,
    BinaryOp.MUL: operator.mul,
}

_BITWISE: Final[dict[BinaryOp, Callable[[int, int], int]]] = {
    BinaryOp.AND: operator.and_,
    BinaryOp.OR: operator.or_,
    BinaryOp.XOR: operator.xor,
}


def _integer_binary(op: BinaryOp, a: int, b: int) -> int:
    """Compute the value before it wraps; x // 0 is x and x % 0 is 0."""
    match op:
        case BinaryOp.ADD:
            return a + b
        case BinaryOp.SUB:
            return a - b
        case BinaryOp.MUL:
            return a * b
        case BinaryOp.FLOOR_DIV:
            return a // b if b else a
        case BinaryOp.MOD:
            return a % b if b else 0
        case BinaryOp.SHL:
            return a << (b & 31)
        case BinaryOp.SHR:
            return a >> (b & 31)
        case BinaryOp.AND | BinaryOp.OR | BinaryOp.XOR:
            return _BITWISE[op](a, b)
        case BinaryOp.DIV:
            raise AssertionError("int / int is a float division in the IR")


COMPARE: Final[dict[CompareOp, Callable[[Number, Number], bool]]] = {
    CompareOp.EQ: operator.eq,
    CompareOp.NE: operator.ne,
    CompareOp.LT: operator.lt,
    CompareOp.LE: operator.le,
    CompareOp.GT: operator.gt,
    CompareOp.GE: operator.ge,
}
