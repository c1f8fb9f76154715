"""Intervals of operations in 64 bits, rounded outwards: one rule for each operation of a tape.

Input: the name of an operation and the ends of its operands, as arrays. Output: the ends of its
result. They contain the exact result of the operation, as real numbers, for all exact operands
between the given ends. An end that is infinite is no bound. If ends are NaN, nothing is known, and
the value may be NaN: every result that depends on it is NaN, too. Operations are those of
``operations``; elementary functions follow the ``trend`` of their intrinsic.

Source: R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis" (2009);
S. M. Rump, "Verification Methods", Acta Numerica 19 (2010), for rounding outwards without changing
the rounding mode: c - (2^-52 |c| + 2^-1022) is below the exact result whose rounded one is c.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final, TypeAlias, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.ir.intrinsics import INTRINSICS, Intrinsic, Trend
from distal.ir.limits import largest_power

Ends: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]

_UNIT: Final = 2.0**-52
_TINY: Final = 2.0**-1022
# More than the errors of elementary functions of NumPy, which are a few units in the last place.
_FUNCTION_ERROR: Final = 1e-14
_TURN: Final = 2.0 * math.pi
# Beyond it, the rounding of turns is no longer small beside ``_TURN_ERROR``.
_LARGEST_ANGLE: Final = 1e6
_TURN_ERROR: Final = 1e-9


def interval_of(name: str, *operands: Ends) -> Ends:
    """Return the ends of the result of an operation.

    Args:
        name: The operation.
        operands: The ends of its operands. If both ends are one array, the operand is one number.
    """
    rule = _RULES.get(name)
    return _elementary(name, operands) if rule is None else rule(*operands)


def is_elementary(name: str) -> bool:
    """Return whether an operation is an elementary function."""
    return name not in _RULES


def _outwards(low: Any, high: Any, share: float = _UNIT) -> Ends:
    return low - (share * np.abs(low) + _TINY), high + (share * np.abs(high) + _TINY)


def _product(a: Any, b: Any) -> Any:
    """Return a product of ends: 0 times an infinite end is 0, since numbers are finite."""
    product = a * b
    return np.where(np.isnan(product) & ~(np.isnan(a) | np.isnan(b)), 0.0, product)


def _least_and_most(values: list[Any]) -> tuple[Any, Any]:
    low = high = values[0]
    for value in values[1:]:
        low, high = np.minimum(low, value), np.maximum(high, value)
    return low, high


def _multiplied(a: Ends, b: Ends) -> Ends:
    firsts, seconds = (ends[:1] if ends[0] is ends[1] else ends for ends in (a, b))
    low, high = _least_and_most([x * y for x in firsts for y in seconds])
    if np.isnan(low).any():
        low, high = _least_and_most([_product(x, y) for x in firsts for y in seconds])
    return _outwards(low, high)


def _divided(a: Ends, b: Ends) -> Ends:
    crosses = (b[0] <= 0.0) & (b[1] >= 0.0)
    low, high = _least_and_most([x / y for x in a for y in b])
    low, high = _outwards(low, high)
    return np.where(crosses, np.nan, low), np.where(crosses, np.nan, high)


def _magnitude(a: Ends) -> Ends:
    return np.maximum(np.maximum(a[0], -a[1]), 0.0), np.maximum(-a[0], a[1])


def _squared(a: Ends) -> Ends:
    near, far = _magnitude(a)
    low, high = _outwards(near * near, far * far)
    return np.maximum(low, 0.0), high


def _root(a: Ends) -> Ends:
    low, high = (np.sqrt(np.maximum(end, 0.0)) for end in a)
    low, high = _outwards(low, high)
    return np.maximum(low, 0.0), high


def _selected(condition: Ends, yes: Ends, no: Ends) -> Ends:
    """Return the interval of a selection by 0 or 1; nothing has to be known of the condition."""
    never, always = condition[1] < 0.5, condition[0] > 0.5
    low, high = np.minimum(yes[0], no[0]), np.maximum(yes[1], no[1])
    low = np.where(always, yes[0], np.where(never, no[0], low))
    return low, np.where(always, yes[1], np.where(never, no[1], high))


def _comparison(always: Any, never: Any) -> Ends:
    """Return 1 to 1, 0 to 0, or 0 to 1. A comparison with NaN does not hold."""
    return np.asarray(always, np.float64), 1.0 - np.asarray(never, np.float64)


def _each(function: Callable[[Any], Any]) -> Callable[[Ends], Ends]:
    return lambda a: (function(a[0]), function(a[1]))


_RULES: Final[dict[str, Callable[..., Ends]]] = {
    "add": lambda a, b: _outwards(a[0] + b[0], a[1] + b[1]),
    "sub": lambda a, b: _outwards(a[0] - b[1], a[1] - b[0]),
    "mul": _multiplied,
    "div": _divided,
    "min": lambda a, b: (np.minimum(a[0], b[0]), np.minimum(a[1], b[1])),
    "max": lambda a, b: (np.maximum(a[0], b[0]), np.maximum(a[1], b[1])),
    "neg": lambda a: (-a[1], -a[0]),
    "abs": _magnitude,
    "square": _squared,
    "sqrt": _root,
    "floor": _each(np.floor),
    "ceil": _each(np.ceil),
    "round": _each(np.rint),
    "trunc": _each(np.trunc),
    "less": lambda a, b: _comparison(a[1] < b[0], a[0] >= b[1]),
    "less_equal": lambda a, b: _comparison(a[1] <= b[0], a[0] > b[1]),
    "equal": lambda a, b: _comparison(
        (a[0] == a[1]) & (b[0] == b[1]) & (a[0] == b[0]), (a[0] > b[1]) | (a[1] < b[0])
    ),
    "select": _selected,
}


def _elementary(name: str, operands: tuple[Ends, ...]) -> Ends:
    """Return the interval of an elementary function, by its trend."""
    row = INTRINSICS.get(name)
    trend = Trend.UNKNOWN if row is None else row.trend
    (low, high), *others = operands
    if row is not None and row.held is not None:
        least, most = row.held.limits(64)
        low, high = np.clip(low, least, most), np.clip(high, least, most)
    if row is None or row.meaning is None:
        return _nothing(low)
    match trend:
        case Trend.UNKNOWN:
            return _nothing(low)
        case Trend.WAVE:
            return _wave(row, low, high)
        case Trend.MONOTONE:
            return _power((low, high), others[0])
        case Trend.ANGLE:
            return _angle((low, high), others[0])
        case Trend.EVEN:
            low, high = _magnitude((low, high))
        case Trend.FALLING:
            low, high = high, low
        case Trend.BRANCHES:
            pole = ~_same_branch(low, high)
            low, high = np.where(pole, np.nan, low), np.where(pole, np.nan, high)
        case Trend.RISING:
            pass
        case _:
            assert_never(trend)
    return _outwards(row.meaning(np, low), row.meaning(np, high), _FUNCTION_ERROR)


def _nothing(like: Any) -> Ends:
    nothing = np.full_like(like, np.nan, np.float64)
    return nothing, nothing


def _nan_mask(*ends: Any) -> Any:
    """Return NaN where an end is NaN, else 0."""
    found = np.isnan(ends[0])
    for end in ends[1:]:
        found = found | np.isnan(end)
    return np.where(found, np.nan, 0.0)


def _wave(row: Intrinsic, low: Any, high: Any) -> Ends:
    """Return the interval of a sine or cosine: its values at the ends, and its peaks between."""
    assert row.meaning is not None
    peak = 0.5 * math.pi if row.name == "sin" else 0.0
    far = ~(np.maximum(-low, high) < _LARGEST_ANGLE)

    def contains(place: float) -> Any:
        first = np.ceil((low - place) / _TURN - _TURN_ERROR)
        return far | (first <= np.floor((high - place) / _TURN + _TURN_ERROR))

    least, most = _least_and_most([row.meaning(np, low), row.meaning(np, high)])
    least = np.where(contains(peak + math.pi), -1.0, np.maximum(least - _FUNCTION_ERROR, -1.0))
    most = np.where(contains(peak), 1.0, np.minimum(most + _FUNCTION_ERROR, 1.0))
    nan_mask = _nan_mask(low, high)
    return least + nan_mask, most + nan_mask


def _same_branch(low: Any, high: Any) -> Any:
    """Return whether a tangent has no pole between two ends."""
    first = np.floor(low / math.pi + 0.5 - _TURN_ERROR)
    last = np.floor(high / math.pi + 0.5 + _TURN_ERROR)
    return (first == last) & (np.maximum(-low, high) < _LARGEST_ANGLE)


def _power(base: Ends, exponent: Ends) -> Ends:
    """Return the interval of ``max(x, 0) ** y``; nothing is known around 0 to no positive power."""
    meaning = INTRINSICS["pow"].meaning
    assert meaning is not None
    both = [np.broadcast_arrays(x, y) for x in base for y in exponent]
    low, high = _least_and_most([meaning(np, x, y) for x, y in both])
    low, high = _outwards(low, high, 1e3 * _FUNCTION_ERROR)
    near = base[0] < math.sqrt(_TINY)
    low = np.where(near, 0.0, np.maximum(low, 0.0))
    high = np.where(high >= 0.5 * largest_power(64), np.inf, high)
    unknown = near & ~(exponent[0] > 0.0)
    nan_mask = np.where(unknown, np.nan, _nan_mask(*base, *exponent))
    return low + nan_mask, high + nan_mask


def _angle(y: Ends, x: Ends) -> Ends:
    """Return the interval of an angle: all of them where it may jump, and at the origin."""
    meaning = INTRINSICS["atan2"].meaning
    assert meaning is not None
    smooth = (x[0] > 0.0) | (y[0] > 0.0) | (y[1] < 0.0)
    both = [np.broadcast_arrays(a, b) for a in y for b in x]
    low, high = _outwards(
        *_least_and_most([meaning(np, a, b) for a, b in both]), share=_FUNCTION_ERROR
    )
    nan_mask = _nan_mask(*y, *x)
    half = math.pi * (1.0 + _FUNCTION_ERROR)
    return np.where(smooth, low, -half) + nan_mask, np.where(smooth, high, half) + nan_mask
