"""Record the operations of a function, and bound its derivatives by its inputs.

Input: a module, and values that may be anywhere between two ends: arguments, parameters, the time.
Output: rows as those of a tape, whose values and derivatives have intervals in many cells at once.
A tape has the coordinates of a point as inputs and one result; here every argument is an input, and
there are as many results as the function's has floats.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.ir.nodes import Module
from distal.ir.types import Type, component_count
from distal.tape.derivative_bounds import JUMPS, Derivatives
from distal.tape.from_ir import PRECISION, followed
from distal.tape.interval_rules import Ends, interval_of
from distal.tape.operations import NUMBER, OPERATIONS
from distal.tape.scalars import Scalar, Scalars, Varying
from distal.tape.tape import TapeError

Doubles: TypeAlias = NDArray[np.float64]
_Row: TypeAlias = tuple[int, int, int, int]

_CONST: Final = NUMBER["const"]
_MUL: Final = NUMBER["mul"]


class _RecordedScalars(Scalars):
    """Collects rows; equal ones are one value."""

    def __init__(self) -> None:
        super().__init__(PRECISION)
        self.rows: list[_Row] = []
        self.numbers: list[Ends | None] = []
        self._known: dict[Any, int] = {}

    def value(self, scalar: Scalar) -> int:
        """Return the row of a scalar."""
        if isinstance(scalar, Varying):
            return scalar.value
        number = float(scalar)
        return self._added(("number", repr(number)), (_CONST, 0, 0, 0), _single(number))

    def operation(self, name: str, *operands: Scalar) -> Varying:
        """Add an operation."""
        places = [self.value(operand) for operand in operands]
        number = NUMBER[name]
        if number == _MUL and places[0] == places[1]:
            number, places = NUMBER["square"], places[:1]
        a, b, c = (*places, 0, 0, 0)[:3]
        row = number, a, b, c
        return Varying(self._added(row, row, None))

    def input(self, ends: Ends | None) -> Varying:
        """Add a value that is not computed: one between two ends, or one given later."""
        return Varying(self._added(object(), (_CONST, 0, 0, 0), ends))

    def _added(self, key: Any, row: _Row, number: Ends | None) -> int:
        at = self._known.get(key)
        if at is None:
            at = self._known[key] = len(self.rows)
            self.rows.append(row)
            self.numbers.append(number)
        return at


def _single(number: float) -> Ends:
    array = np.asarray(number, np.float64)
    return array, array


class RecordedFunction:
    """The operations of a function.

    Args:
        module: The module.
        types: The types of the entry's parameters.
        uniforms: The ends of those uniforms that are no constants, for each component.
        resources: Buffers by name.

    Attributes:
        inputs: The rows of the components of each parameter.
        results: The rows of the floats of the result.

    Raises:
        TapeError: The function has something that cannot be recorded.
    """

    def __init__(
        self,
        module: Module,
        types: Sequence[Type],
        uniforms: Mapping[str, Sequence[Ends]],
        resources: Mapping[str, Any],
    ) -> None:
        scalars = _RecordedScalars()
        args = [tuple(scalars.input(None) for _ in range(component_count(t))) for t in types]
        known = {name: tuple(map(scalars.input, ends)) for name, ends in uniforms.items()}
        found = followed(module, args, known, resources, scalars)
        self.results = [scalars.value(scalar) for scalar in found]
        self.inputs = [[scalar.value for scalar in arg] for arg in args]
        self._rows, self._numbers = scalars.rows, scalars.numbers

    def values(self, inputs: Sequence[Sequence[Ends]]) -> Doubles:
        """Return the ends of each row in each cell, (rows, 2, cells); NaN where nothing is known.

        Args:
            inputs: The ends of the components of each parameter, (cells,) each.
        """
        given = {
            row: ends
            for rows, parts in zip(self.inputs, inputs, strict=True)
            for row, ends in zip(rows, parts, strict=True)
        }
        count = max((low.size for low, _ in given.values()), default=1)
        held: list[Ends] = []
        with np.errstate(all="ignore"):
            for i, (number, *operands) in enumerate(self._rows):
                own = given.get(i, self._numbers[i])
                row = OPERATIONS[number]
                if own is None:
                    own = interval_of(row.name, *(held[k] for k in operands[: row.operands]))
                held.append(own)
        ends = [[np.broadcast_to(end, (count,)) for end in pair] for pair in held]
        return np.array(ends, np.float64)

    def refuse_jumps(self) -> None:
        """Refuse a function that may jump: its derivatives say nothing of its slope.

        Raises:
            TapeError: It may jump.
        """
        names = {OPERATIONS[number].name for number, *_ in self._rows}
        if jumps := sorted(names & {*JUMPS}):
            raise TapeError(f"it may jump: it uses {jumps[0]}")

    def reads(self, parameter: int) -> list[int]:
        """Return which components of a parameter the results depend on."""
        needed = set(self.results)
        for i in range(len(self._rows) - 1, -1, -1):
            if i in needed:
                number, *operands = self._rows[i]
                needed.update(operands[: OPERATIONS[number].operands])
        return [axis for axis, row in enumerate(self.inputs[parameter]) if row in needed]

    def derivatives(self, values: Doubles, parameter: int) -> list[tuple[Doubles, Doubles]]:
        """Return the derivatives of each result by the components of a parameter.

        Returns:
            For each result its derivatives' ends, (2, components, cells), and a bound on the length
            of all of them together, (cells,). NaN or infinite where nothing is known.

        Args:
            values: Those that ``values`` returned.
            parameter: The position of the parameter.
        """
        axes = {row: axis for axis, row in enumerate(self.inputs[parameter])}
        found = Derivatives([(n, 0, *rest) for n, *rest in self._rows], values, len(axes), axes)
        return found.of(self.results)
