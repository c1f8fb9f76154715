"""Bounds of derivatives: the rules of differentiation, with intervals.

Input: the intervals of the values of a tape's operations in some cells. Output: for each cell, an
upper and a lower bound on the length of the gradient of the result.

A length ``sqrt(a^2 + b^2 + …)`` has no derivative at 0, but its slope is bounded there too: by the
largest singular value of the Jacobian of (a, b, …), which the row sums of its Gram matrix bound.

Source: L. B. Rall, "Automatic Differentiation" (1981).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.tape.operations import ELEMENTARY
from distal.tape.steps import Steps, box_of, leaves_of, terms_of

Doubles: TypeAlias = NDArray[np.float64]

# Operations that may jump. A slope says nothing of a function that jumps.
STEPS: Final = ("floor", "ceil", "round", "trunc")
JUMPS: Final = (*STEPS, "less", "less_equal", "equal", "select")
# Elementary functions whose derivative has a rule here.
_RULES: Final = (
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2"),
    *("sinh", "cosh", "tanh", "exp", "exp2", "log", "log2", "pow"),
)
NO_RULE: Final = tuple(name for name in ELEMENTARY if name not in _RULES)
# The magnitude of arguments from which on functions are constant, or may be.
_HELD: Final = {
    **{"exp": 86.0, "exp2": 125.0, "sinh": 86.0, "cosh": 86.0},
    **{"asin": 1.0, "acos": 1.0},
}
_INVERSE: Final = {"log": "exp", "log2": "exp2"}
_LOG_2: Final = float(np.log(2.0))
_COSINE_ERROR: Final = 1e-9  # more than that of a cosine, and of its argument up to 1e6


# Intervals of derivatives: arrays (2, size, n) of ends, by axis and cell.


def _times(interval: Doubles, derivative: Doubles) -> Doubles:
    """Multiply a value's interval (2, n) by a derivative (2, size, n)."""
    products = interval[:, None, None] * derivative[None]
    flat = products.reshape(4, *derivative.shape[1:])
    return np.stack([flat.min(axis=0), flat.max(axis=0)])


def _minus(a: Doubles, b: Doubles) -> Doubles:
    return np.stack([a[0] - b[1], a[1] - b[0]])


def _hull(a: Doubles, b: Doubles) -> Doubles:
    return np.stack([np.minimum(a[0], b[0]), np.maximum(a[1], b[1])])


def _inverse(interval: Doubles) -> Doubles:
    """Return 1 / interval; NaN where it contains 0."""
    crosses = (interval[0] <= 0.0) & (interval[1] >= 0.0)
    ends = 1.0 / np.where(crosses, np.nan, interval)
    return ends[::-1]


def _ordered(a: Doubles, b: Doubles) -> Doubles:
    """Return the interval between two numbers that are given in any order."""
    return np.stack([np.minimum(a, b), np.maximum(a, b)])


def _cosine(interval: Doubles) -> Doubles:
    """Return the interval of the cosine."""
    low, high = interval
    ends = _ordered(np.cos(low), np.cos(high))
    turn = 2.0 * np.pi
    # A multiple of a full turn, or one and a half: the cosine is 1, or -1, in between.
    ends[1] = np.where(np.floor(high / turn) >= np.ceil(low / turn), 1.0, ends[1])
    halves = (low - np.pi) / turn, (high - np.pi) / turn
    ends[0] = np.where(np.floor(halves[1]) >= np.ceil(halves[0]), -1.0, ends[0])
    found: Doubles = np.clip(ends + np.array([[-_COSINE_ERROR], [_COSINE_ERROR]]), -1.0, 1.0)
    return found


def _square(interval: Doubles) -> Doubles:
    """Return the interval of the square."""
    low = np.maximum(np.maximum(interval[0], -interval[1]), 0.0)
    return np.stack([low * low, _largest(interval) ** 2])


def _largest(interval: Doubles) -> Doubles:
    found: Doubles = np.abs(interval).max(axis=0)
    return found


def power_factors(base: Doubles, exponent: Doubles, slope: Doubles) -> tuple[Doubles, Doubles]:
    """Return the derivatives of ``pow`` along both arguments; NaN where one is not bounded.

    Args:
        base: The interval of the base.
        exponent: The interval of the exponent.
        slope: The slope of the exponent; if it is 0, the second derivative is not needed.
    """
    # One is subtracted from the exponent, so a root has no bounded slope at 0.
    held = np.maximum(base, 0.0)
    powers = np.stack([x ** (y - 1.0) for x in held for y in exponent])
    both = np.stack([powers.min(axis=0), powers.max(axis=0)])
    products = np.stack([p * y for p in both for y in exponent])
    along_base = np.stack([products.min(axis=0), products.max(axis=0)])
    # Below 0 it is constant.
    along_base = np.where(base[0] <= 0.0, _hull(along_base, 0.0 * along_base), along_base)
    values = np.stack([x**y for x in held for y in exponent])
    logs = np.log(held)
    products = np.stack([v * t for v in (values.min(axis=0), values.max(axis=0)) for t in logs])
    along_exponent = np.stack([products.min(axis=0), products.max(axis=0)])
    return along_base, np.where(slope == 0.0, 0.0, along_exponent)


def angle_factors(y: Doubles, x: Doubles) -> tuple[Doubles, Doubles]:
    """Return the derivatives of ``atan2``; NaN where it jumps from -pi to pi, and at (0, 0)."""
    smooth = (x[0] > 0.0) | (y[0] > 0.0) | (y[1] < 0.0)
    squares = np.where(smooth, _square(x) + _square(y), np.nan)
    along_y, along_x = (
        np.stack([ratios.min(axis=0), ratios.max(axis=0)])
        for ratios in (np.stack([p / q for p in part for q in squares]) for part in (x, -y))
    )
    # No component is larger than one over the distance.
    most = 1.0 / np.sqrt(squares[0])
    return np.clip(along_y, -most, most), np.clip(along_x, -most, most)


def factor_of(name: str, value: Doubles, result: Doubles) -> Doubles:
    """Return the interval of the derivative of a function of one number; NaN if none is known.

    Args:
        name: The function.
        value: The interval of its operand.
        result: The interval of its result.
    """
    ones = np.ones_like(value)
    match name:
        case "neg":
            return -ones
        case "abs":
            low = np.where(value[0] > 0.0, 1.0, -1.0)
            return np.stack([low, np.where(value[1] < 0.0, -1.0, 1.0)])
        case "square":
            return 2.0 * value
        case "sin":
            return _cosine(value)
        case "cos":
            return _cosine(value + 0.5 * np.pi)
        case "exp":
            return result
        case "exp2":
            return _LOG_2 * result
        case "log" | "log2":
            inverse = np.where(value[0] > 0.0, _inverse(value), np.nan)
            return inverse / _LOG_2 if name == "log2" else inverse
        case "asin" | "acos":
            rest = 1.0 - np.minimum(_square(value), 1.0)[::-1]
            slope = 1.0 / np.sqrt(rest[::-1])
            return slope if name == "asin" else -slope[::-1]
        case "atan":
            return 1.0 / (1.0 + _square(value)[::-1])
        case "tan":
            return 1.0 + _square(result)
        case "sinh":
            nearest = np.maximum(np.maximum(value[0], -value[1]), 0.0)
            return np.stack([np.cosh(nearest), np.cosh(_largest(value))])
        case "cosh":
            return np.stack([np.sinh(value[0]), np.sinh(value[1])])
        case "tanh":
            return np.clip(1.0 - _square(result)[::-1], 0.0, 1.0)
        case _:
            return np.full_like(value, np.nan)


class Derivatives:
    """The derivatives of every operation of a tape in some cells.

    Each has an interval for every axis, and a bound on the length of the gradient, which may be
    smaller than what the intervals allow.
    """

    def __init__(self, steps: Steps, values: Doubles, size: int, axes: Mapping[int, int]) -> None:
        """Take the values of a tape's operations.

        Args:
            steps: The operations.
            values: The intervals of their values, (operations, 2, cells).
            size: The number of axes.
            axes: The axes of the inputs, by operation.
        """
        self._steps = steps
        self._values = values
        self._size = size
        self._axes = axes
        self._intervals: list[Doubles] = []
        self._lengths: list[Doubles] = []

    def bounds(self) -> tuple[Doubles, Doubles]:
        """Return bounds on the gradient's length in each cell.

        The lower one is 0, the upper one is not finite, if none is known.
        """
        self._follow()
        low, high = self._intervals[-1]
        least = np.maximum(np.maximum(low, -high), 0.0)
        with np.errstate(over="ignore"):
            below = np.sqrt((least**2).sum(axis=0))
        return np.nan_to_num(below, posinf=0.0), self._lengths[-1]

    def of(self, results: Sequence[int]) -> list[tuple[Doubles, Doubles]]:
        """Return the intervals of some operations' derivatives, and bounds on their lengths."""
        self._follow()
        return [(self._intervals[i], self._lengths[i]) for i in results]

    def _follow(self) -> None:
        with np.errstate(all="ignore"):
            for index, step in enumerate(self._steps):
                found = self._derivative(step.name, step.operands, index)
                interval, length = found
                of_axes = np.sqrt((_largest(interval) ** 2).sum(axis=0))
                self._intervals.append(interval)
                # A bound that is not known is no bound.
                self._lengths.append(np.fmin(np.where(np.isnan(length), np.inf, length), of_axes))

    def _derivative(
        self, name: str, operands: Sequence[int], index: int
    ) -> tuple[Doubles, Doubles]:
        """Return the intervals of an operation's derivatives, and a bound on their length."""
        shape = (2, self._size, self._values.shape[-1])
        if not operands:
            interval = np.zeros(shape)
            if index in self._axes:
                interval[:, self._axes[index]] = 1.0
            return interval, np.sqrt((interval[0] ** 2).sum(axis=0))
        a = operands[0]
        da, la = self._intervals[a], self._lengths[a]
        if len(operands) == 1:
            if name == "sqrt":
                return self._root(a, index)
            if name in STEPS:
                return np.zeros(shape), np.zeros(shape[-1])
            if name in _INVERSE:
                terms = terms_of(self._steps, self._clamped(a), _INVERSE[name])
                if terms is not None:
                    return self._mean(terms)
            factor = factor_of(name, self._values[a], self._values[index])
            if name in _HELD:  # beyond its limit, the function is constant
                beyond = _largest(self._values[a]) >= _HELD[name]
                factor = np.where(beyond, _hull(factor, 0.0 * factor), factor)
            return _times(factor, da), _largest(factor) * la
        b = operands[1]
        db, lb = self._intervals[b], self._lengths[b]
        va, vb = self._values[a], self._values[b]
        match name:
            case "add":
                if self._is_of_a_box(a, b) or self._is_of_a_box(b, a):
                    return _hull(da, db), np.maximum(la, lb)
                return da + db, la + lb
            case "sub":
                return _minus(da, db), la + lb
            case "mul":
                return _times(vb, da) + _times(va, db), _largest(vb) * la + _largest(va) * lb
            case "div":
                quotient, inverse = self._values[index], _inverse(vb)
                above = _minus(da, _times(quotient, db))
                length = _largest(inverse) * (la + _largest(quotient) * lb)
                return _times(inverse, above), length
            case "min" | "max":
                order = (va, vb) if name == "min" else (vb, va)
                first, second = order[0][1] < order[1][0], order[1][1] < order[0][0]
                both = _hull(da, db)
                interval = np.where(first, da, np.where(second, db, both))
                length = np.where(first, la, np.where(second, lb, np.maximum(la, lb)))
                return interval, length
            case "pow" | "atan2":
                factors = power_factors(va, vb, lb) if name == "pow" else angle_factors(va, vb)
                interval = _times(factors[0], da) + _times(factors[1], db)
                return interval, _largest(factors[0]) * la + _largest(factors[1]) * lb
            case "select":  # of a value without jumps: ``JUMPS`` are refused for others
                never, always = va[1] < 0.5, va[0] > 0.5
                dc, lc = self._intervals[operands[2]], self._lengths[operands[2]]
                interval = np.where(always, db, np.where(never, dc, _hull(db, dc)))
                length = np.where(always, lb, np.where(never, lc, np.maximum(lb, lc)))
                return interval, length
            case "less" | "less_equal" | "equal":
                return np.zeros(shape), np.zeros(shape[-1])
            case _:
                return np.full(shape, np.nan), np.full(shape[-1], np.nan)

    def _mean(self, terms: list[int]) -> tuple[Doubles, Doubles]:
        """Return the derivative of ``log(exp(a) + exp(b) + …)``, a smooth union.

        It is a mean of those of a, b, … with positive weights, or 0 where the sum is clamped, or
        exponentials are too small or too large for floats.
        """
        interval, length = np.zeros_like(self._intervals[terms[0]]), 0.0 * self._lengths[terms[0]]
        for term in terms:
            interval = _hull(interval, self._intervals[term])
            length = np.maximum(length, self._lengths[term])
        return interval, length

    def _root(self, a: int, index: int) -> tuple[Doubles, Doubles]:
        """Return the derivative of a square root: by its rule, and as a length where it is one."""
        inverse = 0.5 * _inverse(self._values[index])
        plain = _times(inverse, self._intervals[a])
        by_rule = _largest(inverse) * self._lengths[a]
        terms = terms_of(self._steps, a, "square")
        if terms is None:
            return plain, by_rule
        gram = self._row_sums(terms)
        length = np.fmin(np.where(np.isnan(by_rule), np.inf, by_rule), np.sqrt(gram))
        # No component of a gradient is larger than its length.
        low = np.fmax(plain[0], -length)
        high = np.fmin(plain[1], length)
        return np.stack([low, high]), length

    def _is_of_a_box(self, outer: int, inner: int) -> bool:
        """Return whether of ``length(max(t, 0))`` and ``min(max(t), 0)`` one is 0 everywhere.

        Then the derivative of their sum is that of one of them.
        """
        found = box_of(self._steps, outer, inner)
        if found is None:
            return False
        largest = leaves_of(self._steps, found[0])
        return all(self._steps[part].operands[0] in largest for part in found[1])

    def _clamped(self, value: int) -> int:
        """Return what a value is the larger one of, beside a constant; else the value."""
        step = self._steps[value]
        is_clamped = step.name == "max" and self._steps[step.operands[1]].name == "const"
        return step.operands[0] if is_clamped else value

    def _row_sums(self, terms: list[int]) -> Doubles:
        """Return the largest row sum of the Gram matrix of some gradients."""
        sums = []
        for i in terms:
            total = np.zeros(self._values.shape[-1])
            for j in terms:
                a, b = self._intervals[i], self._intervals[j]
                products = (a[:, None] * b[None]).reshape(4, *a.shape[1:])
                low, high = products.min(axis=0).sum(axis=0), products.max(axis=0).sum(axis=0)
                product = np.maximum(np.abs(low), np.abs(high))
                total = total + np.fmin(product, self._lengths[i] * self._lengths[j])
            sums.append(total)
        found: Doubles = np.maximum.reduce(sums)
        return found
