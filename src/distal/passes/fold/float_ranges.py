"""Compute an interval that certainly contains a float expression.

Input: an expression and the values of immutable locals. Output: an interval that contains every
component; infinite where nothing better is known. The intervals are used to leave out guards that
are not needed, so that ``exp(-0.02 * t * t)`` keeps its short form. To allow for rounding, inexact
operations widen an interval slightly, but 0 stays 0. The intervals say nothing about NaN.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Final

from distal.ir.intrinsics import INTRINSICS
from distal.ir.intrinsics.declaration import ANYWHERE, NOT_NEGATIVE, WIDER, Interval
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Compose,
    Const,
    Expr,
    Read,
    Select,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
)

_DEPTH: Final = 10  # the largest depth of nested operations that is examined


def interval(e: Expr, known: Mapping[Expr, Expr], depth: int = _DEPTH) -> Interval:
    """Return an interval that contains every component of ``e``.

    Args:
        e: A float expression.
        known: The Reads of immutable locals -> their values.
        depth: How many levels of nested operations are examined.
    """
    if depth == 0:
        return ANYWHERE

    def of(part: Expr) -> Interval:
        return interval(part, known, depth - 1)

    match e:
        case Const(value):
            return float(value), float(value)
        case Read() if e in known:
            return of(known[e])
        case Splat(value) | Swizzle(value):
            return of(value)
        case Compose(parts):
            return _hull([of(part) for part in parts])
        case Select(_, yes, no):
            return _hull([of(yes), of(no)])
        case Unary(UnaryOp.NEGATE, operand):
            low, high = of(operand)
            return -high, -low
        case Binary(BinaryOp.ADD | BinaryOp.SUB as op, lhs, rhs):
            a, b = of(lhs), of(rhs)
            if op is BinaryOp.SUB:
                b = -b[1], -b[0]
            return _widened(a[0] + b[0], a[1] + b[1])
        case Binary(BinaryOp.MUL):
            return _product(e, of)
        case Builtin():
            return _result(e, known, depth)
        case _:
            return ANYWHERE


def _result(e: Builtin, known: Mapping[Expr, Expr], depth: int) -> Interval:
    def of(part: Expr) -> Interval:
        return interval(part, known, depth - 1)

    match e.name, e.args:
        case "abs", (x,):
            low, high = of(x)
            return max(low, -high, 0.0), max(-low, high)
        case "min" | "max" as name, (a, b):
            pick = min if name == "min" else max
            first, second = of(a), of(b)
            return pick(first[0], second[0]), pick(first[1], second[1])
        case "clamp", (x, low_end, high_end):
            (low, high), least, most = of(x), of(low_end), of(high_end)
            return min(max(low, least[0]), most[0]), min(max(high, least[1]), most[1])
        case "dot", (a, b) if a is b:
            return _sum_of_squares(a, known, of)
        case _:
            return INTRINSICS[e.name].results


def _hull(parts: list[Interval]) -> Interval:
    return min(low for low, _ in parts), max(high for _, high in parts)


def _widened(low: float, high: float) -> Interval:
    """Widen the interval of a rounded operation; a NaN bound becomes infinite."""
    low = -math.inf if math.isnan(low) else low - abs(low) * WIDER if math.isfinite(low) else low
    high = math.inf if math.isnan(high) else high + abs(high) * WIDER
    return low, high


def _product(e: Binary, of: Callable[[Expr], Interval]) -> Interval:
    """Return the interval of a chain of factors; a factor that occurs twice is a square."""
    factors: list[Expr] = []
    rest: list[Expr] = [e]
    while rest and len(factors) < 8:
        part = rest.pop()
        if isinstance(part, Splat):
            part = part.value
        if isinstance(part, Binary) and part.op is BinaryOp.MUL:
            rest += [part.lhs, part.rhs]
        else:
            factors.append(part)
    low, high = 1.0, 1.0
    for factor, count in Counter([*factors, *rest]).items():
        single = of(factor)
        for _ in range(count // 2):
            low, high = _times((low, high), _square(single))
        if count % 2:
            low, high = _times((low, high), single)
    return low, high


def _times(a: Interval, b: Interval) -> Interval:
    ends = [x * y for x in a for y in b]
    if any(map(math.isnan, ends)):  # 0 * infinity: only the signs are known
        if a[0] >= 0.0 and b[0] >= 0.0:
            return NOT_NEGATIVE
        if (a[1] <= 0.0 and b[0] >= 0.0) or (a[0] >= 0.0 and b[1] <= 0.0):
            return -math.inf, 0.0
        return ANYWHERE
    return _widened(min(ends), max(ends))


def _square(a: Interval) -> Interval:
    low = max(a[0], -a[1], 0.0)
    high = max(-a[0], a[1])
    return _widened(low * low, high * high)


def _sum_of_squares(
    v: Expr, known: Mapping[Expr, Expr], of: Callable[[Expr], Interval]
) -> Interval:
    while v in known or isinstance(v, Unary):
        v = v.operand if isinstance(v, Unary) else known[v]
    parts = v.parts if isinstance(v, Compose) else (v,)
    squares = [_square(of(part)) for part in parts]
    return _widened(sum(low for low, _ in squares), math.inf)
