"""The steps of a tape by names, and the sums and boxes that they make.

Input: a tape. Output: its operations with their names; of what a value is the sum, or the largest.
The rules of both kinds of derivatives (``derivative_bounds``, ``gradient_rules``) read them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from distal.tape.operations import OPERATIONS
from distal.tape.tape import Tape


@dataclass(frozen=True, slots=True)
class TapeStep:
    """An operation of a tape.

    Attributes:
        name: Its name.
        operands: Its operands: positions of steps before it.
        number: The value of a constant.
    """

    name: str
    operands: tuple[int, ...]
    number: float = 0.0


Steps: TypeAlias = Sequence[TapeStep]


def steps_of(tape: Tape) -> list[TapeStep]:
    """Return the operations of a tape, with its constants of 64 bits."""
    steps = []
    for number, _, *operands, _ in tape.operations.tolist():
        row = OPERATIONS[number]
        constant = float(tape.numbers[operands[0]]) if row.name == "const" else 0.0
        steps.append(TapeStep(row.name, tuple(operands[: row.operands]), constant))
    return steps


def terms_of(steps: Steps, i: int, name: str) -> list[int] | None:
    """Return what a step is the sum of functions of; None if it is no such sum.

    Args:
        steps: The steps.
        i: The position of the step.
        name: The function: "square", "exp" …
    """
    step = steps[i]
    if step.name == name:
        return [step.operands[0]]
    if step.name != "add":
        return None
    first, second = (terms_of(steps, operand, name) for operand in step.operands)
    return None if first is None or second is None else first + second


def leaves_of(steps: Steps, i: int) -> list[int]:
    """Return what a step is the largest of."""
    step = steps[i]
    if step.name != "max":
        return [i]
    return [leaf for operand in step.operands for leaf in leaves_of(steps, operand)]


def is_zero(steps: Steps, i: int) -> bool:
    """Return whether a step is the constant 0."""
    return steps[i].name == "const" and steps[i].number == 0.0


def box_of(steps: Steps, outer: int, inner: int) -> tuple[int, list[int]] | None:
    """Return m and the positive parts of ``length(max(t, 0))`` and ``min(m, 0)``; None for others.

    Args:
        steps: The steps.
        outer: The position of the length.
        inner: The position of the minimum.
    """
    root, least = steps[outer], steps[inner]
    if root.name != "sqrt" or least.name != "min" or not is_zero(steps, least.operands[1]):
        return None
    squares = terms_of(steps, root.operands[0], "square")
    if squares is None:
        return None
    parts = [term for term in squares if not is_zero(steps, term)]
    for part in parts:
        step = steps[part]
        if step.name != "max" or not is_zero(steps, step.operands[1]):
            return None
    return least.operands[0], parts
