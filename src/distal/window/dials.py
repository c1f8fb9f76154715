"""Parameters as rows that a person can move: a slider is one, a color is three.

What flows in: parameters and their values. What flows out: for each row its words, where its bar
stands, and the parameter's value after a move. Knows no window.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, assert_never

from distal.lang.parameter_values import Value
from distal.lang.parameters import Parameter, ParameterKind

_STEPS: Final = 50  # moves from one end of a range to the other
_FINER: Final = 10
_POINT_STEP: Final = 0.05
_COLOR_STEP: Final = 0.02


@dataclass(frozen=True, slots=True)
class Dial:
    """One row: a parameter, or one part of it.

    Attributes:
        parameter: Whose value it moves.
        part: Which of a color's or a point's numbers; None where the value has no parts.
    """

    parameter: Parameter
    part: int | None = None

    @property
    def label(self) -> str:
        """What a person reads."""
        if self.part is None:
            return self.parameter.label
        names = "rgb" if self.parameter.kind is ParameterKind.COLOR else "xyz"
        return f"{self.parameter.label} {names[self.part]}"

    def words(self, value: Value) -> str:
        """The value as a person reads it."""
        match self.parameter.kind:
            case ParameterKind.TOGGLE:
                return "on" if value else "off"
            case ParameterKind.CHOICE:
                assert isinstance(value, int)
                return self.parameter.options[value]
            case ParameterKind.INTEGER:
                return str(value)
            case ParameterKind.SLIDER | ParameterKind.COLOR | ParameterKind.POINT:
                return f"{self._number(value):.4g}"
            case _:
                assert_never(self.parameter.kind)

    def share(self, value: Value) -> float | None:
        """Where its bar stands, from 0 to 1; None for what has no ends."""
        number = self._number(value)
        match self.parameter.kind:
            case ParameterKind.SLIDER | ParameterKind.INTEGER:
                return self._share_of_range(number)
            case ParameterKind.CHOICE:
                return number / max(len(self.parameter.options) - 1, 1)
            case ParameterKind.TOGGLE | ParameterKind.COLOR:
                return number
            case ParameterKind.POINT:
                return None
            case _:
                assert_never(self.parameter.kind)

    def placed(self, value: Value, share: float) -> Value:
        """The value with the bar at a share from 0 to 1; as it is where there is no bar."""
        share = min(max(share, 0.0), 1.0)
        match self.parameter.kind:
            case ParameterKind.SLIDER | ParameterKind.INTEGER:
                return self._from_range(self._at_share(share))
            case ParameterKind.CHOICE:
                return round(share * (len(self.parameter.options) - 1))
            case ParameterKind.TOGGLE:
                return share >= 0.5
            case ParameterKind.COLOR:
                return self._with_part(value, share)
            case ParameterKind.POINT:
                return value
            case _:
                assert_never(self.parameter.kind)

    def moved(self, value: Value, steps: int, *, finely: bool = False) -> Value:
        """The value so many steps up or down; ends are ends, but choices go around."""
        divisor = _FINER if finely else 1
        match self.parameter.kind:
            case ParameterKind.SLIDER:
                return self._slid(self._number(value), steps, finely)
            case ParameterKind.INTEGER:
                return self._from_range(self._number(value) + steps * (self.parameter.step or 1))
            case ParameterKind.CHOICE:
                return int(self._number(value) + steps) % len(self.parameter.options)
            case ParameterKind.TOGGLE:
                return steps > 0
            case ParameterKind.COLOR:
                number = self._number(value) + steps * _COLOR_STEP / divisor
                return self._with_part(value, min(max(number, 0.0), 1.0))
            case ParameterKind.POINT:
                return self._with_part(value, self._number(value) + steps * _POINT_STEP / divisor)
            case _:
                assert_never(self.parameter.kind)

    def _slid(self, number: float, steps: int, finely: bool) -> Value:
        if self.parameter.step is not None:
            return self._from_range(number + steps * self.parameter.step)
        count = _STEPS * _FINER if finely else _STEPS
        return self._from_range(self._at_share(self._share_of_range(number) + steps / count))

    def _number(self, value: Value) -> float:
        if isinstance(value, tuple):
            assert self.part is not None
            return value[self.part]
        return float(value)

    def _with_part(self, value: Value, number: float) -> Value:
        assert isinstance(value, tuple) and self.part is not None
        rounded = round(number, 9)  # ten steps of a tenth are one
        return tuple(rounded if i == self.part else v for i, v in enumerate(value))

    def _share_of_range(self, number: float) -> float:
        low, high = self._range
        if self.parameter.log:
            return math.log(number / low) / math.log(high / low)
        return (number - low) / (high - low)

    def _at_share(self, share: float) -> float:
        low, high = self._range
        if self.parameter.log:
            # The exponent in steps: at the ends the value is the end, to the last bit.
            return low * math.pow(high / low, min(max(share, 0.0), 1.0))
        return low + (high - low) * share

    def _from_range(self, number: float) -> Value:
        """The nearest value that the parameter takes."""
        low, high = self._range
        step = self.parameter.step
        if step is not None:
            number = low + round((number - low) / step) * step
        number = min(max(round(number, 9), low), high)
        return int(number) if self.parameter.kind is ParameterKind.INTEGER else number

    @property
    def _range(self) -> tuple[float, float]:
        low, high = self.parameter.low, self.parameter.high
        assert low is not None and high is not None
        return low, high


def dials(parameters: Sequence[Parameter]) -> list[Dial]:
    """A row for each number that can be moved, in the order of the parameters."""
    rows: list[Dial] = []
    for parameter in parameters:
        if isinstance(parameter.default, tuple):
            rows += (Dial(parameter, part) for part in range(len(parameter.default)))
        else:
            rows.append(Dial(parameter))
    return rows
