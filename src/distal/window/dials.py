"""Controls of parameters as table rows: a slider is one row, a color is three.

Input: parameters and their values. Output: for each row its text, the position of its bar, and the
parameter's value after a move. Does not depend on windows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias, assert_never

from distal.lang.number_text import precise, shown
from distal.lang.parameter_values import Value
from distal.lang.parameters import Parameter, ParameterKind
from distal.lang.srgb import code_of, light_of
from distal.scene.viewing import interaction

_FINER: Final = 10
_LAST_CODE: Final = 255
_CODE_STEP: Final = 5


@dataclass(frozen=True, slots=True)
class Dial:
    """The control in one row: for a parameter, or for one component of it.

    Attributes:
        parameter: The parameter.
        part: The index of a color's or a point's component; None if the value has no components.
    """

    parameter: Parameter
    part: int | None = None

    @property
    def label(self) -> str:
        """The text of the row."""
        if self.part is None:
            return self.parameter.label
        names = "rgb" if self.parameter.kind is ParameterKind.COLOR else "xyz"
        return f"{self.parameter.label} {names[self.part]}"

    def words(self, value: Value) -> str:
        """Return the value as text."""
        match self.parameter.kind:
            case ParameterKind.TOGGLE:
                return "on" if value else "off"
            case ParameterKind.CHOICE:
                assert isinstance(value, int)
                return self.parameter.options[value]
            case ParameterKind.INTEGER:
                return str(value)
            case ParameterKind.COLOR:
                return str(code_of(self._number(value)))
            case ParameterKind.SLIDER | ParameterKind.POINT:
                return shown(self._number(value))
            case _:
                assert_never(self.parameter.kind)

    def share(self, value: Value) -> float | None:
        """Return the position of the bar, from 0 to 1; None for a control without ends."""
        number = self._number(value)
        match self.parameter.kind:
            case ParameterKind.SLIDER | ParameterKind.INTEGER:
                return interaction.position_of(number, *self._range) / self._count
            case ParameterKind.CHOICE:
                return number / max(len(self.parameter.options) - 1, 1)
            case ParameterKind.TOGGLE:
                return number
            case ParameterKind.COLOR:
                return code_of(number) / _LAST_CODE
            case ParameterKind.POINT:
                return None
            case _:
                assert_never(self.parameter.kind)

    def placed(self, value: Value, share: float) -> Value:
        """Return the value for a position of the bar from 0 to 1; unchanged if there is no bar."""
        share = min(max(share, 0.0), 1.0)
        match self.parameter.kind:
            case ParameterKind.SLIDER | ParameterKind.INTEGER:
                return self._at(interaction.whole(share * self._count))
            case ParameterKind.CHOICE:
                return round(share * (len(self.parameter.options) - 1))
            case ParameterKind.TOGGLE:
                return share >= 0.5
            case ParameterKind.COLOR:
                return self._with_code(value, round(share * _LAST_CODE))
            case ParameterKind.POINT:
                return value
            case _:
                assert_never(self.parameter.kind)

    def moved(self, value: Value, steps: int, *, finely: bool = False) -> Value:
        """Return the value ``steps`` positions away; choices wrap around, others stop at ends.

        Args:
            value: The current value.
            steps: Number of positions.
            finely: Whether to move by smaller steps.
        """
        match self.parameter.kind:
            case ParameterKind.SLIDER | ParameterKind.INTEGER:
                return self._slid(self._number(value), steps, finely)
            case ParameterKind.CHOICE:
                return int(self._number(value) + steps) % len(self.parameter.options)
            case ParameterKind.TOGGLE:
                return steps > 0
            case ParameterKind.COLOR:
                code = code_of(self._number(value)) + steps * (1 if finely else _CODE_STEP)
                return self._with_code(value, code)
            case ParameterKind.POINT:
                way = steps * interaction.POINT_STEP / (_FINER if finely else 1)
                return self._with_part(value, self._number(value) + way)
            case _:
                assert_never(self.parameter.kind)

    def _slid(self, number: float, steps: int, finely: bool) -> Value:
        """Move by positions; ``finely`` by tenths of them, if the slider has no steps."""
        low, high, step, log = self._range
        if finely and step is None:
            parts = interaction.POSITIONS * _FINER
            if log:
                moved = precise(number * (high / low) ** (steps / parts), 4)
            else:
                unit = (high - low) / parts
                moved = interaction.rounded(number + steps * unit, unit)
            return interaction.clamped(moved, low, high)
        at = interaction.whole(interaction.position_of(number, low, high, step, log))
        return self._at(at + steps)

    def _number(self, value: Value) -> float:
        if isinstance(value, tuple):
            assert self.part is not None
            return value[self.part]
        return float(value)

    def _with_part(self, value: Value, number: float) -> Value:
        assert isinstance(value, tuple) and self.part is not None
        rounded = round(number, 9)  # so that ten steps of a tenth add up to one
        return tuple(rounded if i == self.part else v for i, v in enumerate(value))

    def _with_code(self, value: Value, code: int) -> Value:
        """Return the color with one component changed to a display code from 0 to 255."""
        assert isinstance(value, tuple)
        light = light_of(min(max(code, 0), _LAST_CODE))
        return tuple(light if i == self.part else v for i, v in enumerate(value))

    def _at(self, position: float) -> Value:
        default = self.parameter.default
        assert isinstance(default, int | float)
        return self._value(interaction.value_at(position, *self._range, default))

    def _value(self, number: float) -> Value:
        return int(number) if self.parameter.kind is ParameterKind.INTEGER else number

    @property
    def _count(self) -> float:
        low, high, step, _ = self._range
        return interaction.position_count(low, high, step)

    @property
    def _range(self) -> tuple[float, float, float | None, bool]:
        low, high = self.parameter.low, self.parameter.high
        assert low is not None and high is not None
        return low, high, self.parameter.step, self.parameter.log

    def swatch(self, value: Value) -> tuple[int, int, int] | None:
        """Return the whole color of which this is a component, as display codes; else None."""
        if self.parameter.kind is not ParameterKind.COLOR:
            return None
        assert isinstance(value, tuple)
        red, green, blue = (min(max(code_of(v), 0), _LAST_CODE) for v in value)
        return red, green, blue


# A row of the table: a control, or the name of a group above its controls.
Line: TypeAlias = Dial | str


def dials(parameters: Sequence[Parameter]) -> list[Dial]:
    """Return a control for each number that can be moved: group by group, as on a page."""
    groups = list(dict.fromkeys(parameter.group for parameter in parameters))
    rows: list[Dial] = []
    for parameter in sorted(parameters, key=lambda p: groups.index(p.group)):
        if isinstance(parameter.default, tuple):
            rows += (Dial(parameter, part) for part in range(len(parameter.default)))
        else:
            rows.append(Dial(parameter))
    return rows


def lines_of(rows: Sequence[Dial]) -> list[Line]:
    """Return the controls with the names of their groups above them."""
    lines: list[Line] = []
    group = ""
    for dial in rows:
        if dial.parameter.group != group:
            group = dial.parameter.group
            lines.append(group)
        lines.append(dial)
    return lines


def valid_values(parameters: Sequence[Parameter], values: Mapping[str, Value]) -> dict[str, Value]:
    """Return the values that are still valid for parameters with these names."""
    known = {parameter.name: parameter for parameter in parameters}
    return {
        name: value
        for name, value in values.items()
        if name in known and _is_valid(known[name], value)
    }


def _is_valid(parameter: Parameter, value: Value) -> bool:
    try:
        parameter.check(value)
    except (TypeError, ValueError):
        return False
    return True
