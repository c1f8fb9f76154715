"""The operations of a tape: one table row each.

A row says how many operands an operation takes, and whether intervals may decide between its
operands. What it computes is written in the interpreters, once for floats and once for intervals;
elementary functions are the built-ins of scene code, as the table of intrinsics declares them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from distal.ir.intrinsics import INTRINSICS, Trend


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation.

    Attributes:
        name: Its name in printed tapes.
        operands: The number of operands; 0 for inputs and constants.
        chooses: Whether the result may be one of the operands, as intervals decide.
        trend: The interval rule of an elementary function; None for other operations.
    """

    name: str
    operands: int
    chooses: bool = False
    trend: Trend | None = None


_ARITHMETIC: Final = (
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
)
_ELEMENTARY: Final = tuple(
    Operation(row.name, len(row.args), trend=row.trend)
    for row in INTRINSICS.values()
    if (row.spelling("llvm") or "").startswith("@elementary.") and not row.hidden
)
OPERATIONS: Final = (*_ARITHMETIC, *_ELEMENTARY)

NUMBER: Final = {row.name: number for number, row in enumerate(OPERATIONS)}
ELEMENTARY: Final = tuple(row.name for row in _ELEMENTARY)
FIRST_ELEMENTARY: Final = len(_ARITHMETIC)
