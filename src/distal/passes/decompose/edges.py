"""Handle the edge cases of built-ins: clamp arguments, and decide if a target's function is usable.

Input: a call of an intrinsic and the values of immutable locals. Output: the call with its argument
clamped to the intrinsic's limits (``ir.limits``; the fold pass removes clamps that are not needed),
and whether the target's own function gives the declared result for these arguments. GLSL leaves
smoothstep with equal edges, clamp with low > high, and normalize of a zero vector undefined; WGSL
rejects some of them. Most calls are provably none of these.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final

from distal.ir.build import binary, builtin, divide, literal_components, multiply, number, subtract
from distal.ir.intrinsics import Intrinsic
from distal.ir.limits import SMALLEST, SMALLEST_DIVISOR, below_one
from distal.ir.nodes import BinaryOp, Builtin, Expr
from distal.ir.target import Target
from distal.passes.fold.float_ranges import interval

_OURS: Final = ("numpy", "llvm")

Known = Mapping[Expr, Expr]


def held(e: Builtin, intrinsic: Intrinsic, target: Target, precision: int) -> Builtin:
    """Return the call with its argument clamped to the intrinsic's limits.

    Args:
        e: The call.
        intrinsic: Its declaration.
        target: The target to compile for.
        precision: The bits of a float, 32 or 64.
    """
    if intrinsic.held is None or not (intrinsic.held.by_targets or target.family in _OURS):
        return e
    (x,) = e.args
    low, high = intrinsic.held.limits(precision)
    bottom, top = number(low, x.type), number(high, x.type)
    if math.isinf(low):
        argument = builtin("min", x, top)
    elif math.isinf(high):
        argument = builtin("max", x, bottom)
    elif target.family in _OURS:
        argument = builtin("min", builtin("max", x, bottom), top)
    else:
        argument = builtin("clamp", x, bottom, top)
    return Builtin(e.name, (argument,), e.type, span=e.span)


def never_crossed(e: Builtin) -> Expr:
    """Return a clamp; as min(max(x, low), high) unless its bounds are provably in order."""
    x, low, high = e.args
    if _in_order(low, high, lambda a, b: a <= b):
        return e
    return builtin("min", builtin("max", x, low), high)


def target_serves(e: Builtin, known: Known) -> bool:
    """Return whether the target's own function gives the declared result for these arguments."""
    match e.name, e.args:
        case "smoothstep", (low, high, _):
            return _in_order(low, high, lambda a, b: b - a > SMALLEST)
        case "normalize", (v,):
            return interval(Builtin("dot", (v, v), v.type), known)[0] >= SMALLEST
        case _:
            return False


def divides(divisor: Expr, known: Known) -> bool:
    """Return whether a divisor is provably not 0 (and not so small that it counts as 0)."""
    low, high = interval(divisor, known)
    return low >= SMALLEST_DIVISOR or high <= -SMALLEST_DIVISOR


def remainder(a: Expr, b: Expr, known: Known, precision: int) -> Expr:
    """Return ``a - b * floor(a / b)``, between 0 and the float next to ``b``; see ``divides``.

    Args:
        a: The dividend.
        b: The divisor, provably not 0.
        known: The values of immutable locals.
        precision: The bits of a float, 32 or 64.
    """
    rest = subtract(a, multiply(b, builtin("floor", divide(a, b))))
    none, end = number(0.0, b.type), nearer_zero(b, precision)
    if interval(b, known)[0] > 0.0:
        return builtin("min", builtin("max", rest, none), end)
    return builtin("max", builtin("min", rest, none), end)


def nearer_zero(x: Expr, precision: int) -> Expr:
    """Return the next float in the direction of 0, of a normal number.

    The product is half a unit or more, and less than a unit, smaller than ``x``, so that it is
    rounded to the neighbor.
    """
    return multiply(x, number(below_one(precision), x.type))


def floor_quotient(a: Expr, b: Expr) -> Expr:
    """Return ``floor(a / b)``."""
    return builtin("floor", binary(BinaryOp.DIV, a, b))


def _in_order(low: Expr, high: Expr, test: Callable[[float, float], bool]) -> bool:
    """Return whether both are literals and the test holds for every component."""
    bottoms, tops = literal_components(low), literal_components(high)
    if bottoms is None or tops is None:
        return False
    return all(test(a, b) for a, b in zip(bottoms, tops, strict=True))
