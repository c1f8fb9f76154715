"""Prove how steep a tape is, and where it is not positive, in a region.

Input: a tape and a box, the region. Output: a bound on the length of its gradient in the region,
and a box around all its points where the value is not positive. Both hold for every point of the
region, not only for those that were looked at: the region is cut into cells, the runtime gives an
interval for the value of each operation in each cell, and the rules of differentiation give
intervals for the derivatives. Cells that decide the result are cut again.

A length ``sqrt(a^2 + b^2 + …)`` has no derivative at 0, but its slope is bounded there too: by the
largest singular value of the Jacobian of (a, b, …), which the row sums of its Gram matrix bound.

Source: E. Galin et al., "Segment Tracing Using Local Lipschitz Bounds", Computer Graphics Forum 39
(2020), for bounds by cells; L. B. Rall, "Automatic Differentiation" (1981), for the rules.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.tape.operations import ELEMENTARY, NUMBER, OPERATIONS
from distal.tape.runtime import TapeProgram
from distal.tape.tape import Tape, TapeError

Doubles: TypeAlias = NDArray[np.float64]

_CELLS: Final = {2: 48, 3: 14}  # along each side of the region, at first
_CHUNK: Final = 256  # cells that are looked at together, to limit the memory
_ROUNDS: Final = 5  # of cutting the cells that decide
_MOST_CUT: Final = 2048  # cells that are cut in a round
_ENOUGH: Final = 1.02  # a bound this close to what a better one could be is not improved
_MARGIN: Final = 1.0 + 1e-5  # for the rounding of this module's own arithmetic
# Operations that may jump. A slope says nothing of a function that jumps.
_JUMPS: Final = ("floor", "ceil", "round", "trunc", "less", "less_equal", "equal", "select")
# Elementary functions whose derivative has a rule here.
_RULES: Final = ("sin", "cos", "exp", "exp2", "log", "log2", "asin", "acos", "atan", "tanh")
_NO_RULE: Final = tuple(name for name in ELEMENTARY if name not in _RULES)
_LOG_2: Final = float(np.log(2.0))


@dataclass(frozen=True, slots=True)
class Proof:
    """What holds in a region.

    Attributes:
        slope: A bound on the length of the gradient.
        low: The lower corner of a box around the points where the value is not positive; None if
            there are none.
        high: Its upper corner.
    """

    slope: float
    low: tuple[float, ...] | None
    high: tuple[float, ...] | None


def prove(tape: Tape, low: Any, high: Any) -> Proof:
    """Return what holds in a region.

    Args:
        tape: The tape.
        low: The lower corner of the region, two or three numbers.
        high: Its upper corner.

    Raises:
        TapeError: No bound can be proved; the message says why.
    """
    names = {OPERATIONS[number].name for number in set(tape.operations[:, 0].tolist())}
    if jumps := sorted(names & set(_JUMPS)):
        raise TapeError(f"it may jump: it uses {jumps[0]}")
    if unknown := sorted(names & set(_NO_RULE)):
        raise TapeError(f"there is no rule for the slope of {unknown[0]}")
    size = len(low)
    program = TapeProgram(tape)
    sides = [np.linspace(a, b, _CELLS[size] + 1) for a, b in zip(low, high, strict=True)]
    starts = np.meshgrid(*(side[:-1] for side in sides), indexing="ij")
    ends = np.meshgrid(*(side[1:] for side in sides), indexing="ij")
    cells = np.stack([np.stack(c, axis=-1).reshape(-1, size) for c in (starts, ends)])
    looked = _ProvedCells(program, size)
    looked.add(cells)
    for _ in range(_ROUNDS):
        if not looked.cut():
            break
    return looked.proof()


class _ProvedCells:
    """The cells of a region, and what is known of each.

    Attributes:
        ends: The lower and the upper corners, (2, n, size).
        slopes: A bound of each cell, infinite or NaN if none is known.
        lowest: A lower bound of the value, minus infinity if none is known.
    """

    def __init__(self, program: TapeProgram, size: int) -> None:
        self._program = program
        self._size = size
        self.ends: Doubles = np.empty((2, 0, size))
        self.slopes: Doubles = np.empty(0)
        self.lowest: Doubles = np.empty(0)

    def add(self, cells: Doubles) -> None:
        """Look at more cells."""
        slopes, lowest = [self.slopes], [self.lowest]
        for begin in range(0, cells.shape[1], _CHUNK):
            some = cells[:, begin : begin + _CHUNK]
            corners = np.zeros((2, some.shape[1], 3))
            corners[..., : self._size] = some
            values = self._program.traces(corners[0], corners[1])
            # If an end is not finite, nothing is known of the value.
            known: NDArray[np.bool_] = np.logical_and.reduce(np.isfinite(values), axis=1)
            values = np.where(known[:, None], values, np.nan)
            slopes.append(_Derivatives(self._program.tape, values, self._size).slope())
            lowest.append(np.where(known[-1], values[-1, 0], -np.inf))
        self.ends = np.concatenate([self.ends, cells], axis=1)
        self.slopes = np.nan_to_num(np.concatenate(slopes), nan=np.inf, posinf=np.inf)
        self.lowest = np.concatenate(lowest)

    def cut(self) -> bool:
        """Cut the cells that decide the slope or the box; return whether there are any."""
        order = np.sort(self.slopes)
        # The slope is at least that of half of the cells, so only steeper ones matter.
        steep = self.slopes > _ENOUGH * order[len(order) // 2]
        low, high = self._box()
        edge = np.zeros_like(steep)
        if low is not None and high is not None:
            touches = (self.ends[0] <= low) | (self.ends[1] >= high)
            edge = (self.lowest <= 0.0) & touches.any(axis=1)
        chosen = np.nonzero(steep | edge)[0]
        worth = np.where(steep[chosen], self.slopes[chosen], 0.0)
        chosen = chosen[np.argsort(-worth, kind="stable")][:_MOST_CUT]
        if len(chosen) == 0:
            return False
        first, last = self.ends[:, chosen]
        middle = (first + last) / 2.0
        parts = []
        for number in range(2**self._size):
            upper = np.array([number >> axis & 1 for axis in range(self._size)], bool)
            parts.append(np.stack([np.where(upper, middle, first), np.where(upper, last, middle)]))
        kept = np.ones(len(self.slopes), bool)
        kept[chosen] = False
        self.ends, self.slopes = self.ends[:, kept], self.slopes[kept]
        self.lowest = self.lowest[kept]
        self.add(np.concatenate(parts, axis=1))
        return True

    def _box(self) -> tuple[Doubles | None, Doubles | None]:
        inside = self.lowest <= 0.0
        if not inside.any():
            return None, None
        return self.ends[0, inside].min(axis=0), self.ends[1, inside].max(axis=0)

    def proof(self) -> Proof:
        """Return what all cells say together.

        Raises:
            TapeError: No slope is known of a cell.
        """
        worst = int(np.argmax(self.slopes))
        if not np.isfinite(self.slopes[worst]):
            middle = self.ends[:, worst].mean(axis=0)
            place = ", ".join(f"{number:.3g}" for number in middle)
            raise TapeError(f"it may be endlessly steep near ({place})")
        low, high = self._box()
        return Proof(
            float(self.slopes[worst]) * _MARGIN,
            None if low is None else tuple(low.tolist()),
            None if high is None else tuple(high.tolist()),
        )


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


def _largest(interval: Doubles) -> Doubles:
    found: Doubles = np.abs(interval).max(axis=0)
    return found


class _Derivatives:
    """The derivatives of every operation of a tape in some cells.

    Each has an interval for every axis, and a bound on the length of the gradient, which may be
    smaller than what the intervals allow.
    """

    def __init__(self, tape: Tape, values: Doubles, size: int) -> None:
        self._rows = tape.operations.tolist()
        self._values = values
        self._size = size
        self._intervals: list[Doubles] = []
        self._lengths: list[Doubles] = []

    def slope(self) -> Doubles:
        """Return a bound on the gradient's length in each cell, not finite if none is known."""
        with np.errstate(all="ignore"):
            for index, (number, _, *operands, _) in enumerate(self._rows):
                row = OPERATIONS[number]
                found = self._derivative(row.name, operands[: row.operands], index)
                interval, length = found
                of_axes = np.sqrt((_largest(interval) ** 2).sum(axis=0))
                self._intervals.append(interval)
                # A bound that is not known is no bound.
                self._lengths.append(np.fmin(np.where(np.isnan(length), np.inf, length), of_axes))
        return self._lengths[-1]

    def _derivative(self, name: str, operands: list[int], index: int) -> tuple[Doubles, Doubles]:
        """Return the intervals of an operation's derivatives, and a bound on their length."""
        shape = (2, self._size, self._values.shape[-1])
        if not operands:
            interval = np.zeros(shape)
            if name in ("x", "y", "z") and "xyz".index(name) < self._size:
                interval[:, "xyz".index(name)] = 1.0
            return interval, np.sqrt((interval[0] ** 2).sum(axis=0))
        a = operands[0]
        da, la = self._intervals[a], self._lengths[a]
        if len(operands) == 1:
            if name == "sqrt":
                return self._root(a, index)
            factor = self._factor(name, self._values[a], self._values[index])
            return _times(factor, da), _largest(factor) * la
        b = operands[1]
        db, lb = self._intervals[b], self._lengths[b]
        va, vb = self._values[a], self._values[b]
        match name:
            case "add":
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
            case _:
                return np.full(shape, np.nan), np.full(shape[-1], np.nan)

    def _factor(self, name: str, value: Doubles, result: Doubles) -> Doubles:
        """Return the interval of the derivative of a function of one number."""
        ones = np.ones_like(value)
        match name:
            case "neg":
                return -ones
            case "abs":
                low = np.where(value[0] > 0.0, 1.0, -1.0)
                return np.stack([low, np.where(value[1] < 0.0, -1.0, 1.0)])
            case "square":
                return 2.0 * value
            case "sin" | "cos":
                return np.stack([-ones[0], ones[0]])
            case "exp":
                return result
            case "exp2":
                return _LOG_2 * result
            case "log" | "log2":
                inverse = np.where(value[0] > 0.0, _inverse(value), np.nan)
                return inverse / _LOG_2 if name == "log2" else inverse
            case "asin" | "acos":
                most = np.minimum(_largest(value), 1.0)
                steepest = 1.0 / np.sqrt(1.0 - most * most)
                return np.stack([-steepest, steepest])
            case "atan":
                return np.stack([0.0 * ones[0], ones[0]])
            case "tanh":
                return np.stack([0.0 * ones[0], ones[0]])
            case _:
                return np.full_like(value, np.nan)

    def _root(self, a: int, index: int) -> tuple[Doubles, Doubles]:
        """Return the derivative of a square root: by its rule, and as a length where it is one."""
        inverse = 0.5 * _inverse(self._values[index])
        plain = _times(inverse, self._intervals[a])
        by_rule = _largest(inverse) * self._lengths[a]
        terms = self._squares(a)
        if terms is None:
            return plain, by_rule
        gram = self._row_sums(terms)
        length = np.fmin(np.where(np.isnan(by_rule), np.inf, by_rule), np.sqrt(gram))
        # No component of a gradient is larger than its length.
        low = np.fmax(plain[0], -length)
        high = np.fmin(plain[1], length)
        return np.stack([low, high]), length

    def _squares(self, value: int) -> list[int] | None:
        """Return the values whose squares a value is the sum of; None if it is no such sum."""
        number, _, a, b, *_ = self._rows[value]
        if number == NUMBER["square"]:
            return [a]
        if number != NUMBER["add"]:
            return None
        left, right = self._squares(a), self._squares(b)
        return None if left is None or right is None else left + right

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
