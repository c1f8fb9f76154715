"""A parameter, or the time, as columns of a table.

Input: a parameter's name and values of it. Output: checked plain values; the names of its columns
and the texts in them, which read back to the bit. Does not depend on files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.lang.chosen_values import by_key
from distal.lang.number_text import shown
from distal.lang.parameters import Parameter, ParameterKind
from distal.lang.render_options import checked_time

# Name of the column that is no parameter.
TIME: Final = "time"
# What begins the names of columns of inputs. Names of parameters have no dot: none collides with
# another column, whatever it is called.
INPUT: Final = "input."


@dataclass(frozen=True, slots=True)
class InputColumn:
    """A parameter that has a value for each picture.

    Attributes:
        name: The parameter's name, or "time".
        label: What a person reads.
        parameter: The parameter; None for the time.
    """

    name: str
    label: str
    parameter: Parameter | None

    @property
    def is_integer(self) -> bool:
        """Whether its values are whole numbers."""
        return self.parameter is not None and self.parameter.kind is ParameterKind.INTEGER

    @property
    def is_number(self) -> bool:
        """Whether its values are numbers, which FIRST:LAST:COUNT has."""
        numbers = (ParameterKind.SLIDER, ParameterKind.INTEGER)
        return self.parameter is None or self.parameter.kind in numbers

    @property
    def options(self) -> tuple[str, ...]:
        """The names of its options; none of other kinds."""
        return () if self.parameter is None else self.parameter.options

    @property
    def parts(self) -> str:
        """The letters of its coordinates; "" if a value is one number or name."""
        if self.parameter is None or not isinstance(self.parameter.default, tuple):
            return ""
        is_color = self.parameter.kind is ParameterKind.COLOR
        return "rgb" if is_color else "xyz"[: len(self.parameter.default)]

    @property
    def headers(self) -> tuple[str, ...]:
        """The names of its columns."""
        name = f"{INPUT}{self.name}"
        return tuple(f"{name}.{part}" for part in self.parts) or (name,)

    def checked(self, value: Any) -> Any:
        """Return the plain value of a value or of its text.

        Raises:
            ValueError: It is none, or out of range.
        """
        try:
            if self.parameter is None:
                return checked_time(value)
            if not isinstance(value, str) or value in self.parameter.options:
                return self.parameter.check(value)
            return self.parameter.parse(value)
        except TypeError as error:
            raise ValueError(str(error)) from None

    def of_cells(self, cells: Sequence[str]) -> Any:
        """Return the plain value of the texts of its columns.

        Raises:
            ValueError: They are no value, or one that is out of range.
        """
        if len(cells) == 1:
            return self.checked(cells[0])
        return self.checked(",".join(cell.strip().replace(",", ";") for cell in cells))

    def cells(self, value: Any) -> tuple[str, ...]:
        """Return a plain value as the texts of its columns: all digits of a float."""
        return tuple(map(cell_of, value)) if self.parts else (cell_of(self.named(value)),)

    def named(self, value: Any) -> Any:
        """Return a plain value as a caller writes it: an option by its name."""
        if self.parameter is not None and self.parameter.options:
            return self.parameter.options[value]
        return value

    def shown(self, value: Any) -> str:
        """Return a plain value as a short text for a person."""
        if isinstance(value, tuple):
            return " ".join(map(shown, value))
        value = self.named(value)
        return cell_of(value) if isinstance(value, str | bool) else str(shown(value))


def cell_of(value: Any) -> str:
    """Return a value as the text of a cell: "" for None, all digits of a float."""
    match value:
        case None:
            return ""
        case bool():
            return str(value).lower()
        case float():
            return repr(float(value))
        case _:
            return str(value)


def column_of(name: str, parameters: Sequence[Parameter]) -> InputColumn:
    """Return the column of a parameter.

    Args:
        name: The name or label of a parameter, or "time".
        parameters: The parameters of the scene.

    Raises:
        ValueError: There is no such parameter.
    """
    known: Mapping[str, Parameter] = by_key(parameters)
    if name in known:
        return InputColumn(known[name].name, known[name].label, known[name])
    if name == TIME:
        return InputColumn(TIME, TIME, None)
    names = ", ".join(dict.fromkeys([*(p.name for p in known.values()), TIME]))
    raise ValueError(f"there is no parameter '{name!s:.60}'; a sweep takes {names}")
