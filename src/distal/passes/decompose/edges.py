"""Built-ins at their edges: arguments held, and where a target's own function serves.

Input: a call of an intrinsic and what is known of immutable locals. Output: the call with its
argument between the intrinsic's limits (``ir.limits``; the fold pass takes away what is not
needed), and whether the target's own function means what the table says for such arguments. GLSL
leaves a smoothstep of equal edges, a clamp of crossed ones and the direction of nothing undefined,
WGSL refuses some of them; most calls are seen to be none of these.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final

from distal.ir.build import binary, builtin, divide, literal_components, multiply, number, subtract
from distal.ir.intrinsics import Intrinsic
from distal.ir.limits import SMALLEST, SMALLEST_DIVISOR
from distal.ir.nodes import BinaryOp, Builtin, Expr
from distal.ir.target import Target
from distal.passes.fold.float_ranges import interval

_OURS: Final = ("numpy", "llvm")

Known = Mapping[Expr, Expr]


def held(e: Builtin, intrinsic: Intrinsic, target: Target, precision: int) -> Builtin:
    """The call with its argument between the intrinsic's limits."""
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
    """A clamp, as min(max(x, low), high) unless its bounds are seen to be in order."""
    x, low, high = e.args
    if _in_order(low, high, lambda a, b: a <= b):
        return e
    return builtin("min", builtin("max", x, low), high)


def target_serves(e: Builtin, known: Known) -> bool:
    """True when a language's own function means the same for these arguments."""
    match e.name, e.args:
        case "smoothstep", (low, high, _):
            return _in_order(low, high, lambda a, b: b - a > SMALLEST)
        case "normalize", (v,):
            return interval(Builtin("dot", (v, v), v.type), known)[0] >= SMALLEST
        case _:
            return False


def divides(divisor: Expr, known: Known) -> bool:
    """True when a remainder by it is seen to be one by a number that is not 0."""
    low, high = interval(divisor, known)
    return low >= SMALLEST_DIVISOR or high <= -SMALLEST_DIVISOR


def remainder(a: Expr, b: Expr) -> Expr:
    """``a - b * floor(a / b)``."""
    return subtract(a, multiply(b, builtin("floor", divide(a, b))))


def floor_quotient(a: Expr, b: Expr) -> Expr:
    """``floor(a / b)``."""
    return builtin("floor", binary(BinaryOp.DIV, a, b))


def _in_order(low: Expr, high: Expr, test: Callable[[float, float], bool]) -> bool:
    """True when both are constants and the test holds for every component."""
    bottoms, tops = literal_components(low), literal_components(high)
    if bottoms is None or tops is None:
        return False
    return all(test(a, b) for a, b in zip(bottoms, tops, strict=True))
