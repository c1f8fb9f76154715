"""Intervals of the gradient of a tape over boxes: the rules of differentiation, forward.

Input: the steps of a tape and the intervals of their values, one after the other. Output: for each
step the intervals of its derivatives along x, y and z. They contain the gradient at almost every
point of a box in which the value is known; where they are known too, the value has no jump there.
So a value differs from that in the middle of the box by at most them times the way (Lebourg's
mean value theorem). NaN where a derivative is not known; None where it is 0.

Source: L. B. Rall, "Automatic Differentiation" (1981); F. H. Clarke, "Optimization and Nonsmooth
Analysis" (1983), for functions without derivatives on sets of measure 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, TypeAlias

import numpy as np

from distal.ir.intrinsics import INTRINSICS
from distal.tape.derivative_bounds import angle_factors, factor_of, power_factors
from distal.tape.interval_rules import Ends, interval_of
from distal.tape.steps import TapeStep, box_of, leaves_of, terms_of

Derivative: TypeAlias = Ends | None
Gradient: TypeAlias = tuple[Derivative, Derivative, Derivative]

_NONE: Final[Gradient] = (None, None, None)
_STEPWISE: Final = ("floor", "ceil", "round", "trunc", "less", "less_equal", "equal")
# For the rounding of factors, which are not rounded outwards.
_ROUNDING: Final = 1e-12
# Near 1, the derivatives of arc sines lose their digits.
_STEEP: Final = 1e3
_LARGEST_ANGLE: Final = 1e6  # as for the values of sines


class GradientRules:
    """Computes the gradients of a tape's steps in their order.

    Args:
        steps: The steps.
        values: The intervals of their values; those of all steps up to the current one.
    """

    def __init__(self, steps: Sequence[TapeStep], values: Sequence[Ends]) -> None:
        self._steps, self._values = steps, values
        self._known: list[Gradient] = []

    def add(self, i: int) -> Gradient:
        """Compute the gradient of the next step, number i."""
        found = self._gradient(i)
        self._known.append(found)
        return found

    def _gradient(self, i: int) -> Gradient:
        step, result = self._steps[i], self._values[i]
        if not step.operands:
            one = np.ones(())
            at = "xyz".find(step.name)
            return _NONE if at < 0 else tuple((one, one) if k == at else None for k in range(3))  # type: ignore[return-value]
        values = [self._values[operand] for operand in step.operands]
        gradients = [self._known[operand] for operand in step.operands]
        match step.name:
            case "add":
                return self._of_a_box(step) or _each("add", *gradients)
            case "sub":
                return _each("add", gradients[0], _negated(gradients[1]))
            case "neg":
                return _negated(gradients[0])
            case "square":
                return _scaled(interval_of("mul", _number(2.0), values[0]), gradients[0])
            case "mul":
                first, second = _scaled(values[1], gradients[0]), _scaled(values[0], gradients[1])
                return _each("add", first, second)
            case "div":
                above = _each("add", gradients[0], _negated(_scaled(result, gradients[1])))
                return tuple(d and interval_of("div", d, values[1]) for d in above)  # type: ignore[return-value]
            case "min":
                a, b = values
                return _either(a[1] < b[0], b[1] < a[0], *gradients)
            case "max":
                a, b = values
                return _either(b[1] < a[0], a[1] < b[0], *gradients)
            case "select":
                # Undecided, the value may jump.
                always, never = values[0][0] > 0.5, values[0][1] < 0.5
                unknown = np.where(always | never, 0.0, np.nan)
                found = _either(always, never, gradients[1], gradients[2])
                return tuple(_plus(d, unknown) for d in found)  # type: ignore[return-value]
            case "sqrt":
                return self._root(step, result, gradients[0])
            case name if name in _STEPWISE:
                flat = result[0] == result[1]
                unknown = np.where(flat, 0.0, np.nan)
                return _NONE if flat.all() else ((unknown, unknown),) * 3
            case _:
                return _of_function(step.name, values, result, gradients)

    def _root(self, step: TapeStep, result: Ends, inner: Gradient) -> Gradient:
        """Return the gradient of a root; a length has a bounded one where it is 0."""
        terms = terms_of(self._steps, step.operands[0], "square")
        if terms is None:
            factor = interval_of("div", _number(0.5), result)
            return _scaled(factor, inner)
        shares = [_share(self._values[term], result) for term in terms]
        return self._sum(shares, terms)

    def _sum(self, shares: Sequence[Ends], terms: Sequence[int]) -> Gradient:
        total = _NONE
        for share, term in zip(shares, terms, strict=True):
            total = _each("add", total, _scaled(share, self._known[term]))
        return total

    def _of_a_box(self, step: TapeStep) -> Gradient | None:
        """Return the gradient of ``length(max(t, 0)) + min(max(t), 0)``; None for another sum.

        One of both terms is 0 everywhere, so their derivatives do not add up.
        """
        for outer, inner in (step.operands, step.operands[::-1]):
            found = box_of(self._steps, outer, inner)
            if found is not None:
                largest, squares = found
                parts = [self._steps[term].operands[0] for term in squares]
                return self._outside_or_inside(outer, largest, squares, parts)
        return None

    def _outside_or_inside(
        self, outer: int, largest: int, squares: Sequence[int], parts: Sequence[int]
    ) -> Gradient | None:
        """Return the gradient of a length outside of 0, and of the largest part inside.

        Args:
            outer: The length.
            largest: The largest of the parts, and perhaps of others.
            squares: The positive ones of the parts.
            parts: The parts.
        """
        whole, leaves = self._values[largest], leaves_of(self._steps, largest)
        # Where a part is positive, the largest is; so outside, the other term is 0.
        if not all(p in leaves or (self._values[p][1] <= whole[0]).all() for p in parts):
            return None
        # Where the largest is positive, a part is; so it is not 0 in between.
        if not all(leaf in parts or (self._values[leaf][1] <= 0.0).all() for leaf in leaves):
            return None
        active = [self._values[part][1] > 0.0 for part in parts]
        count = sum(a.astype(np.int64) for a in active)
        shares = []
        for term, own in zip(squares, active, strict=True):
            low, high = _share(self._values[term], self._values[outer])
            alone = own & (count == 1)
            shares.append((np.where(alone, 1.0, low), np.where(own, high, 0.0)))
        outside, inside = self._sum(shares, parts), self._known[largest]
        return _either(whole[0] > 0.0, whole[1] <= 0.0, outside, inside)


def _number(value: float) -> Ends:
    array = np.asarray(value)
    return array, array


def _each(name: str, a: Gradient, b: Gradient) -> Gradient:
    """Return the sum of two gradients; what is 0 changes nothing."""
    pairs = zip(a, b, strict=True)
    return tuple(
        second if first is None else first if second is None else interval_of(name, first, second)
        for first, second in pairs
    )  # type: ignore[return-value]


def _scaled(factor: Ends, gradient: Gradient) -> Gradient:
    return tuple(d and interval_of("mul", factor, d) for d in gradient)  # type: ignore[return-value]


def _negated(gradient: Gradient) -> Gradient:
    return tuple(d and interval_of("neg", d) for d in gradient)  # type: ignore[return-value]


def _plus(derivative: Derivative, unknown: Any) -> Ends:
    low, high = derivative or _number(0.0)
    return low + unknown, high + unknown


def _either(first: Any, second: Any, a: Gradient, b: Gradient) -> Gradient:
    """Return one of two gradients where it is certain which, else what contains both."""
    found: list[Derivative] = []
    for one, other in zip(a, b, strict=True):
        if one is None and other is None:
            found.append(None)
            continue
        p, q = one or _number(0.0), other or _number(0.0)
        low = np.where(first, p[0], np.where(second, q[0], np.minimum(p[0], q[0])))
        high = np.where(first, p[1], np.where(second, q[1], np.maximum(p[1], q[1])))
        found.append((low, high))
    return found[0], found[1], found[2]


def _share(part: Ends, whole: Ends) -> Ends:
    """Return a component divided by the length of its vector, between -1 and 1."""
    low, high = interval_of("div", part, whole)
    # The length may be 0, and there the quotient has the sign of the component, or is 0.
    near = ~(whole[0] > 0.0)
    low = np.where(near, np.where(part[0] >= 0.0, 0.0, -1.0), np.maximum(low, -1.0))
    high = np.where(near, np.where(part[1] <= 0.0, 0.0, 1.0), np.minimum(high, 1.0))
    nan_mask = 0.0 * (part[0] + part[1] + whole[1])
    return low + nan_mask, high + nan_mask


def _of_function(
    name: str, values: Sequence[Ends], result: Ends, gradients: Sequence[Gradient]
) -> Gradient:
    """Return the gradient of an elementary function."""
    if all(derivative is None for gradient in gradients for derivative in gradient):
        return _NONE
    every = np.broadcast_arrays(np.zeros(1), *(e for value in (*values, result) for e in value))[1:]
    *arrays, whole = (np.stack(every[i : i + 2]) for i in range(0, len(every), 2))
    if len(arrays) == 1:
        return _scaled(_widened(name, arrays[0], factor_of(name, arrays[0], whole)), gradients[0])
    base, other = arrays
    if name == "pow":
        varies = any(derivative is not None for derivative in gradients[1])
        factors = power_factors(base, other, np.asarray(float(varies)))
    else:
        factors = angle_factors(base, other)
    parts = [
        _scaled(_widened(name, base, factor), gradient)
        for factor, gradient in zip(factors, gradients, strict=True)
    ]
    return _each("add", parts[0], parts[1])


def _widened(name: str, value: Any, factor: Any) -> Ends:
    """Return a factor with room for its rounding; NaN if it is too steep for that.

    Args:
        name: The function.
        value: The interval of its operand.
        factor: The interval of its derivative.
    """
    low, high = factor
    if name in ("asin", "acos"):
        steep = ~(np.abs(factor).max(axis=0) < _STEEP)
        low, high = np.where(steep, np.nan, low), np.where(steep, np.nan, high)
    if name in ("sin", "cos"):
        far = np.abs(value).max(axis=0) > _LARGEST_ANGLE
        low, high = np.where(far, -1.0, low), np.where(far, 1.0, high)
    held = INTRINSICS[name].held
    if held is not None:
        # Beyond its limits, the function is constant.
        least, most = held.limits(64)
        beyond = (value[0] < least) | (value[1] > most)
        low = np.where(beyond, np.minimum(low, 0.0), low)
        high = np.where(beyond, np.maximum(high, 0.0), high)
    return low - _ROUNDING * (1.0 + np.abs(low)), high + _ROUNDING * (1.0 + np.abs(high))
