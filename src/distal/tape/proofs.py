"""Prove how steep a tape is, and where it is not positive, in a region.

Input: a tape and a box, the region. Output: a bound on the length of its gradient in the region,
and a box around all its points where the value is not positive. Both hold for every point of the
region, not only for those that were looked at: the region is cut into cells, the runtime gives an
interval for the value of each operation in each cell, and the rules of differentiation give
intervals for the derivatives. Cells that decide the result are cut again.

Source: E. Galin et al., "Segment Tracing Using Local Lipschitz Bounds", Computer Graphics Forum 39
(2020), for bounds by cells; L. B. Rall, "Automatic Differentiation" (1981), for the rules.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.tape.cells import grid_of, halves_of
from distal.tape.derivative_bounds import JUMPS, NO_RULE, Derivatives, Doubles
from distal.tape.operations import OPERATIONS
from distal.tape.runtime import TapeProgram
from distal.tape.steps import steps_of
from distal.tape.tape import Tape, TapeError

_CELLS: Final = {2: 48, 3: 14}  # along each side of the region, at first
_AXES: Final = {"x": 0, "y": 1, "z": 2}
_CHUNK: Final = 256  # cells that are looked at together, to limit the memory
_ROUNDS: Final = 5  # of cutting the cells that decide
_MOST_CUT: Final = 2048  # cells that are cut in a round
_DEEPEST: Final = 24  # rounds of looking for a place that refutes a slope
_FEW: Final = 96  # cells that are cut in each of them
_ENOUGH: Final = 1.02  # a bound this close to what a better one could be is not improved
_MARGIN: Final = 1.0 + 1e-5  # for the rounding of this module's own arithmetic


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


@dataclass(frozen=True, slots=True)
class Refutation:
    """A place where a tape is steeper than some slope.

    Attributes:
        slope: The gradient is at least this long everywhere in a cell of the region.
        place: The middle of the cell.
    """

    slope: float
    place: tuple[float, ...]


def prove(tape: Tape, low: Any, high: Any, most: int | None = None) -> Proof:
    """Return what holds in a region.

    Args:
        tape: The tape.
        low: The lower corner of the region, two or three numbers.
        high: Its upper corner.
        most: The largest number of operations, to limit the time; None has no limit.

    Raises:
        TapeError: No bound can be proved; the message says why.
    """
    if most is not None and len(tape) > most:
        raise TapeError(f"it has {len(tape)} operations, more than {most}")
    _check(tape)
    size = len(low)
    program = TapeProgram(tape)
    looked = _ProvedCells(program, size)
    looked.add(_grid(low, high, _CELLS[size]))
    for _ in range(_ROUNDS):
        if not looked.cut():
            break
    return looked.proof()


def refute(tape: Tape, slope: float, low: Any, high: Any) -> Refutation | None:
    """Return a place where a tape is certainly steeper than a slope, or None if none is found.

    The cells that may be the steepest are cut again and again: in each round the first few of them.

    Args:
        tape: The tape.
        slope: The slope.
        low: The lower corner of the region, two or three numbers.
        high: Its upper corner.

    Raises:
        TapeError: Nothing can be said of the tape's slope; the message says why.
    """
    _check(tape)
    size = len(low)
    looked = _ProvedCells(TapeProgram(tape), size)
    looked.add(_grid(low, high, _CELLS[size]))
    for _ in range(_DEEPEST):
        at = int(np.argmax(looked.least))
        if looked.least[at] > slope * _MARGIN:
            place = looked.ends[:, at].mean(axis=0)
            return Refutation(float(looked.least[at]) / _MARGIN, tuple(place.tolist()))
        if not looked.cut_steepest(slope):
            return None
    return None


def _check(tape: Tape) -> None:
    """Refuse a tape whose slope cannot be bounded."""
    names = {OPERATIONS[number].name for number in set(tape.operations[:, 0].tolist())}
    if jumps := sorted(names & set(JUMPS)):
        raise TapeError(f"it may jump: it uses {jumps[0]}")
    if unknown := sorted(names & set(NO_RULE)):
        raise TapeError(f"there is no rule for the slope of {unknown[0]}")


def _grid(low: Any, high: Any, count: int) -> Doubles:
    """Return the cells of a region, (2, n, size): ``count`` along each side."""
    sides = [np.linspace(a, b, count + 1) for a, b in zip(low, high, strict=True)]
    return grid_of(sides)


class _ProvedCells:
    """The cells of a region, and what is known of each.

    Attributes:
        ends: The lower and the upper corners, (2, n, size).
        slopes: A bound of each cell, infinite or NaN if none is known.
        least: A lower bound of the gradient's length in each cell, 0 if none is known.
        lowest: A lower bound of the value, minus infinity if none is known.
    """

    def __init__(self, program: TapeProgram, size: int) -> None:
        self._program, self._steps = program, steps_of(program.tape)
        names = enumerate(step.name for step in self._steps)
        self._axes = {i: _AXES[name] for i, name in names if _AXES.get(name, size) < size}
        self._size = size
        self.ends: Doubles = np.empty((2, 0, size))
        self.slopes: Doubles = np.empty(0)
        self.least: Doubles = np.empty(0)
        self.lowest: Doubles = np.empty(0)

    def add(self, cells: Doubles) -> None:
        """Look at more cells."""
        slopes, least, lowest = [self.slopes], [self.least], [self.lowest]
        for begin in range(0, cells.shape[1], _CHUNK):
            some = cells[:, begin : begin + _CHUNK]
            corners = np.zeros((2, some.shape[1], 3))
            corners[..., : self._size] = some
            values = self._program.traces(corners[0], corners[1])
            # If an end is not finite, nothing is known of the value.
            known: NDArray[np.bool_] = np.logical_and.reduce(np.isfinite(values), axis=1)
            values = np.where(known[:, None], values, np.nan)
            below, above = Derivatives(self._steps, values, self._size, self._axes).bounds()
            least.append(below)
            slopes.append(above)
            lowest.append(np.where(known[-1], values[-1, 0], -np.inf))
        self.ends = np.concatenate([self.ends, cells], axis=1)
        self.slopes = np.nan_to_num(np.concatenate(slopes), nan=np.inf, posinf=np.inf)
        self.least, self.lowest = np.concatenate(least), np.concatenate(lowest)

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
        self._halve(chosen)
        return True

    def cut_steepest(self, slope: float) -> bool:
        """Cut the cells with the largest bounds above a slope; return whether there are any."""
        chosen = np.nonzero(self.slopes > slope)[0]
        chosen = chosen[np.argsort(-self.slopes[chosen], kind="stable")][:_FEW]
        if len(chosen) == 0:
            return False
        self._halve(chosen)
        return True

    def _halve(self, chosen: NDArray[np.intp]) -> None:
        """Replace cells by their halves along each axis."""
        halves = halves_of(self.ends[:, chosen], range(self._size))
        kept = np.ones(len(self.slopes), bool)
        kept[chosen] = False
        self.ends, self.slopes = self.ends[:, kept], self.slopes[kept]
        self.least, self.lowest = self.least[kept], self.lowest[kept]
        self.add(halves)

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
