"""Calls of the table's rows on constants.

Input: a row's name and the components of its constant arguments. Output: the
components of the result, or NotFoldableError. Each step rounds to the module's precision in the
order of the row's definition; elementary functions are computed in 64 bits and rounded once,
closer than the table's tolerance. What is not here (hashes, inverse) is simply not folded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

from distal.ir import limits
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import BinaryOp
from distal.ir.types import Kind, Type, kind_of
from distal.passes.fold.arithmetic import Arithmetic, NotFoldableError, Number, wrap

Components: TypeAlias = tuple[Number, ...]


def fold_builtin(
    name: str, args: Sequence[Components], types: Sequence[Type], result: Type, math32: Arithmetic
) -> Components:
    """The components of ``name(*args)``."""
    kind = kind_of(types[0])
    target = kind_of(result)
    if kind is None or target is None:
        raise NotFoldableError
    rows = _Rows(math32)
    if name in _BIT_CASTS:
        return tuple(math32.bits(a, kind, target) for a in args[0])
    if name == "truncated_quotient":
        return tuple(_truncated(int(a), int(b), kind) for a, b in zip(*args, strict=True))
    if name in ("saturated_int", "saturated_uint"):
        return tuple(_in_range(float(a), target) for a in args[0])
    if name in ("any", "all"):
        return ((any if name == "any" else all)(args[0]),)
    if name in ("isnan", "isinf"):
        return tuple(False for _ in args[0])
    if name in ("min", "max", "clamp", "abs", "sign"):
        return tuple(_choosing(name, parts, kind) for parts in zip(*args, strict=True))
    if kind is not Kind.FLOAT:
        raise NotFoldableError
    floats = [tuple(float(c) for c in arg) for arg in args]
    held = INTRINSICS[name].held
    if held is not None:
        low, high = held.limits(math32.precision)
        floats = [tuple(min(max(c, low), high) for c in arg) for arg in floats]
    if name == "pow":
        parts = zip(*floats, strict=True)
        return tuple(math32.round(_power(x, y, math32.precision)) for x, y in parts)
    if name in _ROUNDING:
        return tuple(float(_ROUNDING[name](a)) for a in floats[0])
    if name in _ELEMENTARY:
        return tuple(rows.elementary(name, parts) for parts in zip(*floats, strict=True))
    steps = _STEPS.get(name)
    if steps is None:
        raise NotFoldableError
    return steps(rows, *floats)


_BIT_CASTS: Final = frozenset(
    ("float_bits_to_int", "float_bits_to_uint", "int_bits_to_float", "uint_bits_to_float")
)

_ROUNDING: Final[dict[str, Callable[[float], float]]] = {
    "floor": math.floor,
    "ceil": math.ceil,
    "round": round,  # Python's is half to even too
    "trunc": math.trunc,
}

_ELEMENTARY: Final[dict[str, Callable[..., float]]] = {
    "exp": math.exp,
    "exp2": math.exp2,
    "log": math.log,
    "log2": math.log2,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "atan2": lambda y, x: math.atan2(y + 0.0, x + 0.0),  # no zero is negative
    "raw_atan2": math.atan2,
    "sinh": math.sinh,
    "cosh": math.cosh,
    "tanh": math.tanh,
    "raw_power": math.pow,
    "radians": math.radians,
    "degrees": math.degrees,
}


def _power(x: float, y: float, precision: int) -> float:
    most = limits.largest_power(precision)
    if x < limits.smallest(precision):
        return 1.0 if y == 0.0 else most if y < 0.0 else 0.0
    try:
        return min(math.pow(x, y), most)
    except OverflowError:
        return most


def _choosing(name: str, parts: tuple[Number, ...], kind: Kind) -> Number:
    a = parts[0]
    match name:
        case "min":
            return parts[1] if parts[1] < a else a
        case "max":
            return parts[1] if a < parts[1] else a
        case "clamp":
            raised = parts[1] if a < parts[1] else a
            return parts[2] if parts[2] < raised else raised
        case "abs":
            return abs(a) if kind is Kind.FLOAT else wrap(abs(int(a)), kind)
        case _:
            assert name == "sign", name
            return type(a)((a > 0) - (a < 0))


def _truncated(a: int, b: int, kind: Kind) -> int:
    if b == 0:
        raise NotFoldableError
    quotient = abs(a) // abs(b)
    return wrap(quotient if (a < 0) == (b < 0) else -quotient, kind)


def _in_range(a: float, target: Kind) -> int:
    whole = int(a)
    if wrap(whole, target) != whole:
        raise NotFoldableError
    return whole


class _Rows:
    """Float rows in steps that round one by one."""

    def __init__(self, math32: Arithmetic) -> None:
        self._math = math32

    def elementary(self, name: str, parts: tuple[float, ...]) -> float:
        try:
            value = _ELEMENTARY[name](*parts)
        except (ValueError, OverflowError):
            raise NotFoldableError from None
        return self._math.round(value)

    def op(self, op: BinaryOp, a: float, b: float) -> float:
        return float(self._math.binary(op, a, b, Kind.FLOAT))

    def add(self, a: float, b: float) -> float:
        return self.op(BinaryOp.ADD, a, b)

    def sub(self, a: float, b: float) -> float:
        return self.op(BinaryOp.SUB, a, b)

    def mul(self, a: float, b: float) -> float:
        return self.op(BinaryOp.MUL, a, b)

    def div(self, a: float, b: float) -> float:
        return self.op(BinaryOp.DIV, a, b)

    def sqrt(self, a: float) -> float:
        return self.elementary("sqrt", (a,))

    def dot(self, a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float]:
        total = self.mul(a[0], b[0])
        for x, y in zip(a[1:], b[1:], strict=True):
            total = self.add(total, self.mul(x, y))
        return (total,)

    def length(self, a: tuple[float, ...]) -> tuple[float]:
        return (self.sqrt(self.dot(a, a)[0]),)

    def distance(self, a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float]:
        return self.length(tuple(self.sub(x, y) for x, y in zip(a, b, strict=True)))

    def normalize(self, a: tuple[float, ...]) -> tuple[float, ...]:
        square = max(self.dot(a, a)[0], limits.smallest(self._math.precision))
        return tuple(self.div(x, self.sqrt(square)) for x in a)

    def cross(self, a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
        pairs = ((1, 2), (2, 0), (0, 1))
        return tuple(self.sub(self.mul(a[i], b[j]), self.mul(a[j], b[i])) for i, j in pairs)

    def inversesqrt(self, a: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(self.div(1.0, self.sqrt(x)) for x in a)

    def fract(self, a: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(self.sub(x, float(math.floor(x))) for x in a)

    def mod(self, a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
        parts = zip(a, b, strict=True)
        least = limits.SMALLEST_DIVISOR
        return tuple(0.0 if abs(y) < least else self.op(BinaryOp.MOD, x, y) for x, y in parts)

    def step(self, edge: tuple[float, ...], a: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(0.0 if x < e else 1.0 for e, x in zip(edge, a, strict=True))

    def mix(
        self, a: tuple[float, ...], b: tuple[float, ...], t: tuple[float, ...]
    ) -> tuple[float, ...]:
        parts = zip(a, b, t, strict=True)
        return tuple(self.add(x, self.mul(self.sub(y, x), s)) for x, y, s in parts)

    def smoothstep(
        self, low: tuple[float, ...], high: tuple[float, ...], a: tuple[float, ...]
    ) -> tuple[float, ...]:
        result = []
        for bottom, top, x in zip(low, high, a, strict=True):
            extent = self.sub(top, bottom)
            if abs(extent) < limits.SMALLEST:
                t = 0.0 if x < bottom else 1.0
            else:
                t = min(max(self.div(self.sub(x, bottom), extent), 0.0), 1.0)
            result.append(self.mul(self.mul(t, t), self.sub(3.0, self.mul(2.0, t))))
        return tuple(result)


_STEPS: Final[dict[str, Callable[..., Components]]] = {
    "dot": _Rows.dot,
    "length": _Rows.length,
    "distance": _Rows.distance,
    "normalize": _Rows.normalize,
    "cross": _Rows.cross,
    "inversesqrt": _Rows.inversesqrt,
    "fract": _Rows.fract,
    "mod": _Rows.mod,
    "step": _Rows.step,
    "mix": _Rows.mix,
    "smoothstep": _Rows.smoothstep,
}
