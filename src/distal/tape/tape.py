"""A tape: a straight-line program on floats, and the builder that shares equal operations.

Input: operations, one after the other. Output: the tape as an array that the runtime reads. Does
not depend on where the operations come from, nor on LLVM.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from distal.lang.lazy_module import LazyModule
from distal.tape.layout import MOST_OPERATIONS, OPERATION_FIELDS
from distal.tape.operations import NUMBER, OPERATIONS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
else:
    np = LazyModule("numpy")  # a file can be read, and compiled for pages, without it

# One operation of a tape that is being built: its number, and its operands.
Row: TypeAlias = tuple[int, int, int, int]

_CONST: Final = NUMBER["const"]
_MUL: Final = NUMBER["mul"]
_SQUARE: Final = NUMBER["square"]


class TapeError(ValueError):
    """A function cannot be a tape; the message says why."""


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """A straight-line program.

    Attributes:
        operations: One row for each operation, as ``layout.OPERATION_FIELDS``; operation i writes
            value i, and its operands are values before it. The last one is the result.
        constants: The constants.
        numbers: The constants before they were rounded to 32 bits.
    """

    operations: NDArray[np.uint16]
    constants: NDArray[np.float32]
    numbers: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.operations)

    def uses(self, name: str) -> bool:
        """Return whether the tape has an operation of this name, such as "z"."""
        return bool((self.operations[:, 0] == NUMBER[name]).any())

    def __str__(self) -> str:
        lines = []
        for i, (number, _, *operands, _) in enumerate(self.operations.tolist()):
            row = OPERATIONS[number]
            if number == _CONST:
                words = [repr(float(self.constants[operands[0]]))]
            else:
                words = [f"_{operand}" for operand in operands[: row.operands]]
            lines.append(" ".join((f"_{i}", row.name, *words)))
        return "\n".join(lines)


class TapeBuilder:
    """Collects the operations of a tape; equal operations are one value."""

    def __init__(self) -> None:
        self._rows: list[Row] = []
        self._known: dict[Row, int] = {}
        self._constants: dict[float | str, int] = {}
        self._numbers: list[float] = []

    def constant(self, number: float) -> int:
        """Return the value of a constant, rounded to 32 bits."""
        # Zeros of both signs are equal as keys, and NaN is not equal to itself: so text.
        key = number if number and not math.isnan(number) else repr(number)
        index = self._constants.get(key)
        if index is None:
            index = self._constants[key] = len(self._numbers)
            self._numbers.append(number)
        return self._row((_CONST, index, 0, 0))

    def operation(self, name: str, *operands: int) -> int:
        """Return the value of an operation on earlier values.

        Raises:
            TapeError: The tape has too many operations.
        """
        a, b, c = (*operands, 0, 0, 0)[:3]
        number = NUMBER[name]
        if number == _MUL and a == b:  # the interval of a square has no negative numbers
            number, b = _SQUARE, 0
        return self._row((number, a, b, c))

    def _row(self, row: Row) -> int:
        value = self._known.get(row)
        if value is None:
            value = self._known[row] = len(self._rows)
            self._rows.append(row)
        return value

    def tape(self, result: int) -> Tape:
        """Return the tape of a value, without the operations that it does not need.

        Raises:
            TapeError: The tape has too many operations.
        """
        rows = self._rows
        needed = bytearray(len(rows))
        needed[result] = 1
        for i in range(result, -1, -1):
            if needed[i]:
                number, *operands = rows[i]
                for operand in operands[: _OPERANDS[number]]:
                    needed[operand] = 1
        names = [-1] * (result + 1)
        table: list[tuple[int, ...]] = []
        constants: dict[int, int] = {}
        for i in range(result + 1):
            if not needed[i]:
                continue
            number, a, b, c = rows[i]
            count = _OPERANDS[number]
            if number == _CONST:
                a = constants.setdefault(a, len(constants))
            names[i] = len(table)
            table.append((
                number, names[i],
                names[a] if count > 0 else a,
                names[b] if count > 1 else 0,
                names[c] if count > 2 else 0,
                0,
            ))  # fmt: skip
        if len(table) > MOST_OPERATIONS:
            raise TapeError(f"a tape has at most {MOST_OPERATIONS} operations, not {len(table)}")
        operations = np.array(table, np.uint16).reshape(-1, len(OPERATION_FIELDS))
        with np.errstate(over="ignore"):
            numbers = np.array([self._numbers[i] for i in constants], np.float64)
            return Tape(operations, numbers.astype(np.float32), numbers)


_OPERANDS: Final = [row.operands for row in OPERATIONS]
