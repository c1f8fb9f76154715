"""Intervals of the results of a function, at all times and for all values of its parameters.

Input: a function, and values of its arguments, many rows at once. Output: two ends for each float
of the result, one row for each row of arguments. They hold for every time and for the declared
ranges of parameters; where nothing is known, they are infinite. The follower of ``tape.from_ir``
computes with intervals in place of operations of a tape.

Source: R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis" (2009).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.backends import get_target
from distal.backends.llvm.lanes import leaf_count
from distal.compiler.driver import run_passes
from distal.ir.intrinsics import INTRINSICS, Trend
from distal.ir.nodes import Origin, UniformDeclaration
from distal.ir.types import FLOAT, INT, Kind, component_count
from distal.runtime.function_tapes import buffers_of
from distal.runtime.lowered import Lowered
from distal.tape.from_ir import PRECISION, followed
from distal.tape.scalars import Scalar, Scalars, Varying
from distal.tape.tape import TapeError

Ends: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]

# Before common functions are put into their callers, which makes expressions longer.
_LAST_PASS: Final = "specialise-prelude"
# What elementary functions may differ from exact results, for each unit of the result and in all.
_WIDER: Final = 1e-5
_TURN: Final = 2.0 * math.pi


@dataclass(frozen=True, slots=True, eq=False)
class _Swept(Varying):
    """A scalar that is anywhere between two ends.

    Attributes:
        low: The lower end, one for each row or one for all.
        high: The upper end.
        name: The operation that it is the result of.
        operands: The operands of this operation.
    """

    low: Any
    high: Any
    name: str = ""
    operands: tuple[Scalar, ...] = ()


def swept(low: Any, high: Any, name: str = "", operands: tuple[Scalar, ...] = ()) -> _Swept:
    """Return the scalar with these ends; an end that is no number is infinite."""
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    unknown = np.isnan(low) | np.isnan(high)
    low, high = np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high)
    return _Swept(0, low, high, name, operands)


class _IntervalScalars(Scalars):
    """Computes with intervals."""

    def operation(self, name: str, *operands: Scalar) -> Varying:
        """Return the interval of an operation."""
        known = _related(name, operands)
        if known is not None:
            return known
        ends = [_ends(operand) for operand in operands]
        with np.errstate(all="ignore"):
            rule = _RULES.get(name)
            low, high = rule(*ends) if rule else _elementary(name, *ends)
        return swept(low, high, name, operands)

    def cast(self, a: Scalar, source: Kind, target: Kind) -> Scalar:
        """Return a scalar converted to another kind; a whole number is its own float."""
        if isinstance(a, Varying) and target is Kind.FLOAT:
            return a
        return super().cast(a, source, target)


def _ends(scalar: Scalar) -> Ends:
    if isinstance(scalar, _Swept):
        return scalar.low, scalar.high
    assert not isinstance(scalar, Varying)
    return np.float64(scalar), np.float64(scalar)  # type: ignore[return-value]


def _related(name: str, operands: Sequence[Scalar]) -> Varying | None:
    """Return the interval of an operation on operands that depend on each other; else None.

    They are ``a - b * floor(a / b)``, which is from 0 to b, and ``(a - b) + b``, as in the matrix
    of a rotation about an axis.
    """
    if name == "add":
        for parts, b in ((_made_by(operands[i], "sub"), operands[1 - i]) for i in (0, 1)):
            if parts and parts[1] is b:
                return swept(*_ends(parts[0]))
    if name != "sub":
        return None
    a, taken = operands
    if _made_by(taken, "floor")[:1] == (a,):
        return swept(0.0, 1.0)
    factors = _made_by(taken, "mul")
    for whole, b in (factors, factors[::-1]) if factors else ():
        for quotient in _made_by(whole, "floor"):
            parts = _made_by(quotient, "div")
            if parts and parts[0] is a and _same(parts[1], b):
                low, high = _ends(b)
                return swept(np.minimum(low, 0.0), np.maximum(high, 0.0))
    return None


def _made_by(scalar: Scalar, name: str) -> tuple[Scalar, ...]:
    """Return the operands of the operation that a scalar is the result of, if it has this name."""
    return scalar.operands if isinstance(scalar, _Swept) and scalar.name == name else ()


def _same(a: Scalar, b: Scalar) -> bool:
    return a is b or (not isinstance(a, Varying) and a == b)


# Rules of operations: the ends of the operands, and those of the result.


def _product(a: Any, b: Any) -> Any:
    """Return a product of ends; numbers are finite, so 0 times an infinite end is 0."""
    return np.where((a == 0.0) | (b == 0.0), 0.0, a * b)


def _multiplied(a: Ends, b: Ends) -> Ends:
    corners = [_product(x, y) for x in a for y in b]
    return np.minimum.reduce(corners), np.maximum.reduce(corners)


def _divided(a: Ends, b: Ends) -> Ends:
    crosses = (b[0] <= 0.0) & (b[1] >= 0.0)
    inverse = np.where(crosses, -np.inf, 1.0 / b[1]), np.where(crosses, np.inf, 1.0 / b[0])
    return _multiplied(a, inverse)


def _magnitude(a: Ends) -> Ends:
    least = np.maximum(np.maximum(a[0], -a[1]), 0.0)
    return least, np.maximum(np.abs(a[0]), np.abs(a[1]))


def _squared(a: Ends) -> Ends:
    low, high = _magnitude(a)
    return low * low, high * high


def _selected(condition: Ends, yes: Ends, no: Ends) -> Ends:
    never, always = condition[1] <= 0.0, condition[0] > 0.0
    low = np.where(always, yes[0], np.where(never, no[0], np.minimum(yes[0], no[0])))
    high = np.where(always, yes[1], np.where(never, no[1], np.maximum(yes[1], no[1])))
    return low, high


def _powered(a: Ends, b: Ends) -> Ends:
    corners = [np.power(x, y) for x in a for y in b]
    known = a[0] > 0.0
    low = np.where(known, np.minimum.reduce(corners), -np.inf)
    return _widened(low, np.where(known, np.maximum.reduce(corners), np.inf))


def _each(function: Callable[[Any], Any]) -> Callable[[Ends], Ends]:
    return lambda a: (function(a[0]), function(a[1]))


_RULES: Final[dict[str, Callable[..., Ends]]] = {
    "add": lambda a, b: (a[0] + b[0], a[1] + b[1]),
    "sub": lambda a, b: (a[0] - b[1], a[1] - b[0]),
    "mul": _multiplied,
    "div": _divided,
    "min": lambda a, b: (np.minimum(a[0], b[0]), np.minimum(a[1], b[1])),
    "max": lambda a, b: (np.maximum(a[0], b[0]), np.maximum(a[1], b[1])),
    "neg": lambda a: (-a[1], -a[0]),
    "abs": _magnitude,
    "square": _squared,
    "sqrt": _each(lambda end: np.sqrt(np.maximum(end, 0.0))),
    "floor": _each(np.floor),
    "ceil": _each(np.ceil),
    "round": _each(np.rint),
    "trunc": _each(np.trunc),
    "less": lambda a, b: (a[1] < b[0], a[0] < b[1]),
    "less_equal": lambda a, b: (a[1] <= b[0], a[0] <= b[1]),
    "equal": lambda a, b: (
        (a[0] == a[1]) & (b[0] == b[1]) & (a[0] == b[0]),
        (a[0] <= b[1]) & (b[0] <= a[1]),
    ),
    "select": _selected,
    "pow": _powered,
    "atan2": lambda y, x: (-np.full_like(y[0] + x[0], 3.15), np.full_like(y[0] + x[0], 3.15)),
}


def _elementary(name: str, *operands: Ends) -> Ends:
    """Return the interval of an elementary function, by its trend."""
    trend = INTRINSICS[name].trend if name in INTRINSICS else Trend.UNKNOWN
    (low, high), *_ = operands
    if trend is Trend.WAVE:
        return _wave(low, high, 0.5 * math.pi if name == "sin" else 0.0)
    if trend is Trend.EVEN:
        low, high = _magnitude((low, high))
        trend = Trend.RISING
    row = INTRINSICS.get(name)
    if row is None or row.meaning is None or trend not in (Trend.RISING, Trend.FALLING):
        return np.full_like(low, -np.inf), np.full_like(low, np.inf)
    if row.held is not None:
        low, high = (np.clip(end, row.held.low, row.held.high) for end in (low, high))
    ends = row.meaning(np, low), row.meaning(np, high)
    return _widened(*(ends if trend is Trend.RISING else ends[::-1]), row.rtol + row.atol)


def _wave(low: Any, high: Any, peak: float) -> Ends:
    """Return the interval of a sine with a peak of 1 at ``peak``."""
    ends = np.cos(low - peak), np.cos(high - peak)
    known = np.isfinite(low) & np.isfinite(high)

    def contains(place: float) -> Any:
        turns = np.ceil((low - place) / _TURN - _WIDER) <= np.floor((high - place) / _TURN + _WIDER)
        return turns | ~known

    least, most = np.minimum(*ends), np.maximum(*ends)
    least = np.where(contains(peak + math.pi), -1.0, least)
    return _widened(least, np.where(contains(peak), 1.0, most))


def _widened(low: Any, high: Any, by: float = _WIDER) -> Ends:
    return low - by * (1.0 + np.abs(low)), high + by * (1.0 + np.abs(high))


def sweep(lowered: Lowered, columns: Sequence[NDArray[np.float64]]) -> list[Ends]:
    """Return the two ends of each float of a function's result.

    Args:
        lowered: The function.
        columns: The values of each parameter: (n,) or (n, components).
    """
    module = run_passes(lowered.module, get_target("llvm"), PRECISION, after=_LAST_PASS)
    entry = module.function(module.entry)
    args = [
        tuple(swept(part, part) for part in (column.T if column.ndim > 1 else (column,)))
        for column in columns
    ]
    uniforms = {u.name: _of_uniform(u) for u in module.uniforms if u.origin is not Origin.NUMBER}
    try:
        found = followed(module, args, uniforms, buffers_of(module), _IntervalScalars())
    except TapeError:
        # It has something without an interval.
        return [(np.array(-np.inf), np.array(np.inf))] * leaf_count(entry.result)
    return [_ends(scalar) for scalar in found]


def _of_uniform(uniform: UniformDeclaration) -> tuple[Scalar, ...]:
    """Return what the values of a parameter or of the time are between."""
    about: dict[str, Any] = dict(uniform.interface)
    low, high = about.get("low"), about.get("high")
    if uniform.type is INT and about.get("options"):
        low, high = 0, len(about["options"]) - 1
    if uniform.type not in (FLOAT, INT):
        low = high = None
    ends = -np.inf if low is None else low, np.inf if high is None else high
    return (swept(*ends),) * component_count(uniform.type)
