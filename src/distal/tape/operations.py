"""The operations of a tape: one table row each.

A row says how many operands an operation takes, and whether intervals may decide between its
operands. What it computes is written once for floats (``float_code``) and once for intervals
(``interval_code``); elementary functions are the built-ins of scene code (``elementary``).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final


class Bound(Enum):
    """How an elementary function's interval follows from values at single points."""

    RISING = "rising"  # from the values at both ends
    FALLING = "falling"
    WAVE = "wave"  # from the value in the middle: slope at most 1, values from -1 to 1
    NONE = "none"  # no rule: the whole line


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation.

    Attributes:
        name: Its name in printed tapes.
        operands: The number of operands; 0 for inputs and constants.
        chooses: Whether the result may be one of the operands, as intervals decide.
        bound: The interval rule of an elementary function; None for other operations.
    """

    name: str
    operands: int
    chooses: bool = False
    bound: Bound | None = None


OPERATIONS: Final = (
    Operation("const", 0),  # the first operand is the number of the constant
    Operation("x", 0),
    Operation("y", 0),
    Operation("z", 0),
    Operation("add", 2),
    Operation("sub", 2),
    Operation("mul", 2),
    Operation("div", 2),
    Operation("min", 2, chooses=True),  # b if b < a else a
    Operation("max", 2, chooses=True),  # b if a < b else a
    Operation("neg", 1),
    Operation("abs", 1),
    Operation("square", 1),
    Operation("sqrt", 1),  # of max(x, 0)
    Operation("floor", 1),
    Operation("ceil", 1),
    Operation("round", 1),  # half to even
    Operation("trunc", 1),
    Operation("less", 2),  # 1 if a < b else 0
    Operation("less_equal", 2),
    Operation("equal", 2),
    Operation("select", 3, chooses=True),  # b if a is not 0 else c; a is 0 or 1
    Operation("sin", 1, bound=Bound.WAVE),
    Operation("cos", 1, bound=Bound.WAVE),
    Operation("tan", 1, bound=Bound.NONE),
    Operation("exp", 1, bound=Bound.RISING),
    Operation("exp2", 1, bound=Bound.RISING),
    Operation("log", 1, bound=Bound.RISING),
    Operation("log2", 1, bound=Bound.RISING),
    Operation("asin", 1, bound=Bound.RISING),
    Operation("acos", 1, bound=Bound.FALLING),
    Operation("atan", 1, bound=Bound.RISING),
    Operation("sinh", 1, bound=Bound.RISING),
    Operation("cosh", 1, bound=Bound.NONE),
    Operation("tanh", 1, bound=Bound.RISING),
    Operation("atan2", 2, bound=Bound.NONE),
    Operation("pow", 2, bound=Bound.NONE),
)

NUMBER: Final = {row.name: number for number, row in enumerate(OPERATIONS)}
ELEMENTARY: Final = tuple(row.name for row in OPERATIONS if row.bound is not None)
FIRST_ELEMENTARY: Final = NUMBER[ELEMENTARY[0]]
