"""How much steeper a shape is because its numbers differ from place to place.

Input: the numbers as a function of the point, and the shape as a function of the point and of its
numbers. Output: a bound on ``sum |d shape / d number| * |gradient of the number|`` in a region, at
all times and for all values of parameters in their limits: by the chain rule, what the slope of the
shape with constant numbers grows by.

The region is cut into cells as in ``tape.proofs``. A shape below an operator is a value about which
only its slope and its box are known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.ir.nodes import Origin
from distal.runtime.function_tapes import buffers_of
from distal.runtime.lowered import Lowered
from distal.runtime.sweeps import ends_of_uniform
from distal.tape.cells import grid_of, halves_of
from distal.tape.from_ir import LAST_PASS, PRECISION
from distal.tape.interval_rules import Ends
from distal.tape.recording import RecordedFunction
from distal.tape.tape import TapeError

Doubles: TypeAlias = NDArray[np.float64]

# Along each side that is cut, at first, by how many are.
_CELLS: Final = {0: 1, 1: 64, 2: 12, 3: 6}
_ROUNDS: Final = 8  # of cutting the steepest cells
_MOST_CUT: Final = {0: 1, 1: 64, 2: 64, 3: 32}  # cells that are cut in a round
_ENOUGH: Final = 1.02  # cells this close to the middle one are not cut
_MARGIN: Final = 1.0 + 1e-6  # for the rounding of this module's own arithmetic
_LARGEST: Final = 1e18  # what has no end ends here: 0 times infinity is unknown


# What is known of a shape below an operator: a bound on its slope, and the corners of its box.
Inner: TypeAlias = tuple[float, tuple[float, ...], tuple[float, ...]]

# The ends of the components of arguments of which no more is known.
Unknown: TypeAlias = Sequence[Sequence[tuple[float, float]]]


@dataclass(frozen=True, slots=True)
class VaryingShape:
    """A shape whose numbers differ from place to place.

    Attributes:
        numbers: The numbers: a function of the point, and of values that are known in no place.
        shape: The point at which inner shapes are evaluated and the value: a function of the point,
            of each number, of the same unknown values, and of the value of each inner shape.
        changes: How much the value changes at most for each unit of each number; None where that is
            not known.
        unknown: The ends of the components of the unknown values.
        inner: The inner shapes.
        own: Whether the shape is a function of the author, of which nothing is known; a shape of
            the library has no jumps.
    """

    numbers: Lowered
    shape: Lowered
    changes: Sequence[float | None]
    unknown: Unknown
    inner: Sequence[Inner]
    own: bool


def added_slope(what: VaryingShape, low: Sequence[float], high: Sequence[float]) -> float:
    """Return by how much the slope of a shape grows at most in a region.

    Args:
        what: The shape.
        low: The lower corner of the region, two or three numbers.
        high: Its upper corner.

    Raises:
        TapeError: No bound is known; the message says why.
    """
    cells = _NumberCells(what, len(low))
    cells.begin(low, high)
    for _ in range(_ROUNDS):
        if not cells.cut():
            break
    worst = int(np.argmax(cells.slopes))
    if not cells.slopes[worst] < _LARGEST:
        middle = cells.ends[:, worst].mean(axis=0)
        place = ", ".join(f"{number:.3g}" for number in middle)
        raise TapeError(f"it may be endlessly steep near ({place})")
    return float(cells.slopes[worst]) * _MARGIN


class _NumberCells:
    """Cells of the region, and a bound in each.

    Attributes:
        ends: The lower and the upper corners, (2, n, size).
        slopes: The bounds, infinite where none is known.
    """

    def __init__(self, what: VaryingShape, size: int) -> None:
        self._what, self._size = what, size
        self._numbers, self._shape = _recorded(what.numbers), _recorded(what.shape)
        inputs = self._shape.inputs
        self._numbers.refuse_jumps()
        if what.own:
            self._shape.refuse_jumps()
        # A point moves no inner shape's value by more than its slope, wherever it is.
        reads = set(self._numbers.reads(0))
        cut = reads if what.inner else reads | {*self._shape.reads(0)}
        self._cut = sorted(cut, reverse=True)  # halves along the last axis are neighbors
        self._counts = list(map(len, inputs[1 : len(inputs) - len(what.unknown) - len(what.inner)]))
        self.ends: Doubles = np.empty((2, 0, size))
        self.slopes: Doubles = np.empty(0)

    def begin(self, low: Sequence[float], high: Sequence[float]) -> None:
        """Look at the region, which has these corners; one cell along an axis without end."""
        count = _CELLS[len(self._cut)]
        sides = [
            np.linspace(a, b, count + 1)
            if axis in self._cut and b - a < _LARGEST / 1000.0
            else np.array([a, b])
            for axis, (a, b) in enumerate(zip(low, high, strict=True))
        ]
        self.add(grid_of(sides))

    def add(self, cells: Doubles) -> None:
        """Look at more cells."""
        with np.errstate(all="ignore"):
            found = self._added(cells)
        found = np.nan_to_num(found, nan=np.inf, posinf=np.inf)
        self.ends = np.concatenate([self.ends, cells], axis=1)
        self.slopes = np.concatenate([self.slopes, found])

    def cut(self) -> bool:
        """Cut the steepest cells along each axis that matters; return whether there are any."""
        middle = np.sort(self.slopes)[len(self.slopes) // 2]
        order = np.argsort(-self.slopes, kind="stable")[: _MOST_CUT[len(self._cut)]]
        chosen = order[self.slopes[order] > _ENOUGH * middle]
        if len(chosen) == 0 or not self._cut:
            return False
        halves = halves_of(self.ends[:, chosen], self._cut)
        kept = np.ones(len(self.slopes), bool)
        kept[chosen] = False
        self.ends, self.slopes = self.ends[:, kept], self.slopes[kept]
        self.add(halves)
        return True

    def _added(self, cells: Doubles) -> Doubles:
        """Return the bound in each cell."""
        size, what = self._size, self._what
        point = [(cells[0, :, i].copy(), cells[1, :, i].copy()) for i in range(size)]
        unknown = [[_clipped(ends) for ends in each] for each in what.unknown]
        values = self._numbers.values([point, *unknown])
        rows = self._numbers.results
        rises = [length for _, length in self._numbers.derivatives(values, 0)]
        numbers, steepness, at = [], [], 0
        for count in self._counts:
            numbers.append([(values[r, 0], values[r, 1]) for r in rows[at : at + count]])
            steepness.append(np.array(rises[at : at + count]))
            at += count
        given = [point, *numbers, *unknown]
        far: Ends = np.array(-_LARGEST), np.array(_LARGEST)
        seen = self._shape.values([*given, *([far] for _ in what.inner)])
        inner = [[self._value_of(each, seen)] for each in what.inner]
        if inner:
            seen = self._shape.values([*given, *inner])
        shares = self._shares_of_inner(seen, len(given))
        total = np.zeros(cells.shape[1])
        for position, (rise, change) in enumerate(zip(steepness, what.changes, strict=True), 1):
            if change is not None:
                total = total + change * rise.sum(axis=0)
                continue
            *moved, (own, length) = self._shape.derivatives(seen, position)
            along = np.stack([_largest(d) for d, _ in moved]) if moved else np.zeros((0, 1, 1))
            moves = np.sqrt((along**2).sum(axis=0))  # (components, cells)
            each = (rise * (_largest(own) + shares * moves)).sum(axis=0)
            whole = np.sqrt((moves**2).sum(axis=0))
            together = np.sqrt((rise**2).sum(axis=0)) * (length + shares * whole)
            total = total + np.fmin(each, together)
        return total

    def _shares_of_inner(self, seen: Doubles, first: int) -> Any:
        """Return by how much the value changes for each unit that the inner shapes' point moves."""
        total: Any = 0.0
        for k, each in enumerate(self._what.inner):
            _, share = self._shape.derivatives(seen, first + k)[-1]
            total = total + share * each[0]
        return total

    def _value_of(self, inner: Inner, seen: Doubles) -> Ends:
        """Return the ends of an inner shape's value: it has a point of its surface in its box."""
        slope, *corners = inner
        square: Any = 0.0
        for row, low, high in zip(self._shape.results[:-1], *corners, strict=True):
            square = square + np.maximum(high - seen[row, 0], seen[row, 1] - low) ** 2
        most = np.fmin(np.sqrt(square) * slope, _LARGEST)
        return -most, most


def _largest(interval: Doubles) -> Doubles:
    found: Doubles = np.abs(interval).max(axis=0)
    return found


def _clipped(ends: tuple[float, float]) -> Ends:
    low, high = np.clip(ends, -_LARGEST, _LARGEST)
    return np.asarray(low), np.asarray(high)


def _recorded(lowered: Lowered) -> RecordedFunction:
    module = run_passes(lowered.module, get_target("llvm"), PRECISION, after=LAST_PASS)
    entry = module.function(module.entry)
    uniforms = {
        u.name: [_clipped(ends) for ends in ends_of_uniform(u)]
        for u in module.uniforms
        if u.origin is not Origin.NUMBER
    }
    types = [param.type for param in entry.params]
    return RecordedFunction(module, types, uniforms, buffers_of(module))
