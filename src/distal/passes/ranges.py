"""Compute the interval of values that an integer expression can have.

Input: int and uint expressions and the ranges of the locals that they read. Output: a closed
interval for each expression; the whole range of its type if nothing better is known. Arithmetic
that may wrap gives the whole range. Var locals are not tracked.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Final, TypeAlias

from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Const,
    Expr,
    For,
    Let,
    Read,
    Select,
    Unary,
    UnaryOp,
    Uniform,
    UniformDeclaration,
)
from distal.ir.types import BOOL, INT, UINT, Type

Range: TypeAlias = tuple[int, int]

_WHOLE: Final[dict[Type, Range]] = {INT: (-(2**31), 2**31 - 1), UINT: (0, 2**32 - 1)}


class Ranges:
    """Ranges of the locals of one function, entered in the order of its statements.

    Args:
        meanings: The names of module functions that compute "clamp" or "%" -> the operation.
        uniforms: The ranges of uniforms. Leave it out where memory safety depends on the result: a
            host may pass a value outside the declared range.
    """

    def __init__(
        self,
        meanings: Mapping[str, str] | None = None,
        uniforms: Mapping[str, Range] | None = None,
    ) -> None:
        self._meanings = meanings or {}
        self._uniforms = uniforms or {}
        self._locals: dict[str, Range] = {}
        self._memo: dict[Expr, Range] = {}

    def enter(self, stmt: Let | For) -> None:
        """Record the range of a local before its reads."""
        if isinstance(stmt, Let):
            if stmt.value.type in _WHOLE:
                self._locals[stmt.name] = self.of(stmt.value)
            return
        start, stop = self.of(stmt.start), self.of(stmt.stop)
        low, high = (start[0], stop[1] - 1) if stmt.step > 0 else (stop[0] + 1, start[1])
        # If the range is empty, the body never runs, so every bound is valid; keep low <= high.
        self._locals[stmt.name] = (low, max(low, high))

    def of(self, e: Expr) -> Range:
        """Return the interval of an int or uint expression."""
        found = self._memo.get(e)
        if found is None:
            whole = _WHOLE[e.type]
            low, high = self._found(e) or whole
            found = self._memo[e] = (low, high) if whole[0] <= low and high <= whole[1] else whole
        return found

    def constant(self, e: Expr) -> int | None:
        """Return the value of the expression if it can have only one, else None."""
        low, high = self.of(e)
        return low if low == high else None

    def _found(self, e: Expr) -> Range | None:
        match e:
            case Const(value):
                return (int(value), int(value))
            case Read(name):
                return self._locals.get(name)
            case Uniform(name):
                return self._uniforms.get(name)
            case Unary(UnaryOp.NEGATE, operand):
                low, high = self.of(operand)
                return (-high, -low)
            case Binary(op, lhs, rhs):
                return self._binary(op, lhs, rhs)
            case Select(_, yes, no):
                a, b = self.of(yes), self.of(no)
                return (min(a[0], b[0]), max(a[1], b[1]))
            case Cast(value) if value.type is BOOL:
                return (0, 1)
            case Cast(value) if value.type in _WHOLE:
                return self.of(value)
            case Builtin(name, args):
                return self._operation(name, args)
            case Call(function, args):
                return self._operation(self._meanings.get(function, ""), args)
            case _:
                return None

    def _binary(self, op: BinaryOp, lhs: Expr, rhs: Expr) -> Range | None:
        a, b = self.of(lhs), self.of(rhs)
        match op:
            case BinaryOp.ADD:
                return (a[0] + b[0], a[1] + b[1])
            case BinaryOp.SUB:
                return (a[0] - b[1], a[1] - b[0])
            case BinaryOp.MUL:
                corners = [x * y for x in a for y in b]
                return (min(corners), max(corners))
            case BinaryOp.MOD:
                return _remainder(b)
            case BinaryOp.AND if b[0] >= 0:
                return (0, b[1])
            case BinaryOp.AND if a[0] >= 0:
                return (0, a[1])
            case BinaryOp.SHR | BinaryOp.FLOOR_DIV if a[0] >= 0 and b[0] > 0:
                return (0, a[1])
            case _:
                return None

    def _operation(self, name: str, args: tuple[Expr, ...]) -> Range | None:
        if name not in ("min", "max", "clamp", "%") or args[0].type not in _WHOLE:
            return None
        ranges = [self.of(a) for a in args]
        match name:
            case "%":
                return _remainder(ranges[1])
            case "min":
                return _both(min, ranges[0], ranges[1])
            case "max":
                return _both(max, ranges[0], ranges[1])
            case _:
                return _both(min, _both(max, ranges[0], ranges[1]), ranges[2])


def _remainder(divisor: Range) -> Range | None:
    """Return the range of a floored remainder; the remainder by 0 is 0."""
    return (0, max(0, divisor[1] - 1)) if divisor[0] >= 0 else None


def _both(choose: Callable[[int, int], int], a: Range, b: Range) -> Range:
    return (choose(a[0], b[0]), choose(a[1], b[1]))


def declared_ranges(uniforms: Iterable[UniformDeclaration]) -> dict[str, Range]:
    """Return the declared ranges of int parameters. A host may pass values outside of them."""
    found: dict[str, Range] = {}
    for uniform in uniforms:
        about = dict(uniform.interface)
        low, high, options = about.get("low"), about.get("high"), about.get("options")
        if uniform.type is INT and options:
            found[uniform.name] = (0, len(options) - 1)
        elif uniform.type is INT and low is not None and high is not None:
            found[uniform.name] = (int(low), int(high))
    return found
