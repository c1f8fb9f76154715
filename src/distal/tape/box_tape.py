"""Evaluate a tape over boxes with intervals of 64 bits that are rounded outwards.

Input: a tape, and corners of boxes. Output: ends of its value in each box, and a shorter tape that
has the same values in these boxes. The ends contain the exact value, as a real number, of the
tape with its constants at every point of the box; the intervals of ``interval_interpreter`` contain
rounded values of 32 bits instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.tape.gradient_rules import GradientRules
from distal.tape.interval_rules import Ends, interval_of
from distal.tape.steps import TapeStep, steps_of
from distal.tape.tape import Tape

Doubles: TypeAlias = NDArray[np.float64]

_AXES: Final = "xyz"


def _columns(low: Doubles, high: Doubles) -> list[Ends]:
    return [(low[:, i].copy(), high[:, i].copy()) for i in range(low.shape[1])]


class BoxTape:
    """A tape that is evaluated over boxes.

    Args:
        steps: The operations; operands are earlier ones, and the last one is the result.
    """

    def __init__(self, steps: Sequence[TapeStep]) -> None:
        self._steps = steps
        last = {operand: i for i, step in enumerate(steps) for operand in step.operands}
        # Values that are not needed after each step, so that long tapes need little memory.
        self._done: list[list[int]] = [[] for _ in steps]
        for operand, i in last.items():
            self._done[i].append(operand)

    @classmethod
    def of(cls, tape: Tape) -> BoxTape:
        """Return the tape with its constants of 64 bits."""
        return cls(steps_of(tape))

    def __len__(self) -> int:
        return len(self._steps)

    def values(self, low: Doubles, high: Doubles) -> tuple[Doubles, Doubles, BoxTape]:
        """Return the ends of the value in boxes, and a tape with the same values in them.

        Args:
            low: The lower corners, (n, 2) or (n, 3).
            high: The upper corners.

        Returns:
            The lower and the upper ends, (n,), NaN where nothing is known, and the tape without
            operands of ``min``, ``max`` and ``select`` that matter in none of the boxes.
        """
        held: list[Ends | None] = [None] * len(self._steps)
        chosen: dict[int, int] = {}
        columns = _columns(low, high)
        with np.errstate(all="ignore"):
            for i in range(len(self._steps)):
                held[i] = self._value(i, columns, held, chosen)
                for operand in self._done[i]:
                    held[operand] = None
        ends = held[-1]
        assert ends is not None
        lower, upper = (np.broadcast_to(end, (len(low),)) for end in ends)
        return lower, upper, self._shortened(chosen)

    def gradients(self, low: Doubles, high: Doubles) -> tuple[Doubles, Doubles]:
        """Return the ends of the derivatives in boxes, (n, 3) each; NaN where nothing is known.

        In a box whose value and derivatives are known, the value changes by at most them times the
        way. Memory: 64 bytes for each step and box.

        Args:
            low: The lower corners, (n, 3).
            high: The upper corners.
        """
        held: list[Ends] = []
        columns = _columns(low, high)
        with np.errstate(all="ignore"):
            rules = GradientRules(self._steps, held)
            for i in range(len(self._steps)):
                held.append(self._value(i, columns, held, {}))
                found = rules.add(i)
        shape = (len(low),)
        zero = np.zeros(()), np.zeros(())
        ends = [[np.broadcast_to(end, shape) for end in d or zero] for d in found]
        lower, upper = (np.stack([pair[side] for pair in ends], axis=1) for side in (0, 1))
        return lower, upper

    def _value(
        self,
        i: int,
        columns: Sequence[Ends],
        held: Sequence[Ends | None],
        chosen: dict[int, int],
    ) -> Ends:
        """Return the ends of a step; add the operand that it always is to ``chosen``.

        Args:
            i: The position of the step.
            columns: The ends of the coordinates.
            held: The ends of the steps before it.
            chosen: The operands that were chosen so far, by position.
        """
        step = self._steps[i]
        if step.name == "const":
            constant = np.asarray(step.number)
            return constant, constant
        if step.name in _AXES:
            axis = _AXES.index(step.name)
            return columns[axis] if axis < len(columns) else (np.zeros(()),) * 2
        operands = []
        for operand in step.operands:
            ends = held[operand]
            assert ends is not None
            operands.append(ends)
        match step.name:
            case "min" | "max":
                a, b = step.operands
                smaller, larger = (a, b) if step.name == "min" else (b, a)
                # Comparisons with NaN do not hold: what is not known is not dropped.
                if (operands[0][1] < operands[1][0]).all():
                    chosen[i] = smaller
                elif (operands[1][1] < operands[0][0]).all():
                    chosen[i] = larger
            case "select":
                if (operands[0][0] > 0.5).all():
                    chosen[i] = step.operands[1]
                elif (operands[0][1] < 0.5).all():
                    chosen[i] = step.operands[2]
        if i in chosen:
            ends = held[chosen[i]]
            assert ends is not None
            return ends
        return interval_of(step.name, *operands)

    def _shortened(self, chosen: dict[int, int]) -> BoxTape:
        """Return the tape in which some steps are replaced by one of their operands."""
        if not chosen:
            return self
        needed = [False] * len(self._steps)
        needed[-1] = True
        for i in range(len(self._steps) - 1, -1, -1):
            if needed[i]:
                for operand in (chosen[i],) if i in chosen else self._steps[i].operands:
                    needed[operand] = True
        places: dict[int, int] = {}
        steps: list[TapeStep] = []
        for i, step in enumerate(self._steps):
            if not needed[i]:
                continue
            if i in chosen:
                places[i] = places[chosen[i]]
                continue
            places[i] = len(steps)
            operands = tuple(places[operand] for operand in step.operands)
            steps.append(TapeStep(step.name, operands, step.number))
        # The result may be a step before the last one that is left.
        return BoxTape(steps[: places[len(self._steps) - 1] + 1])
