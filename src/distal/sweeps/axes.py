"""The values of a sweep's parameters.

Input: texts such as "0:1:20" or "1,2,3", or lists of values. Output: checked values by parameter.
Does not depend on pictures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Any, Final

from distal.lang.parameters import Parameter
from distal.sweeps.columns import InputColumn, column_of

MOST: Final = 100_000


@dataclass(frozen=True, slots=True)
class Axis:
    """The values that one parameter takes.

    Attributes:
        column: The parameter, or the time.
        values: Plain values.
    """

    column: InputColumn
    values: tuple[Any, ...]

    @property
    def name(self) -> str:
        """The parameter's name, or "time"."""
        return self.column.name

    @property
    def label(self) -> str:
        """What a person reads."""
        return self.column.label

    @property
    def texts(self) -> tuple[str, ...]:
        """The values as short texts."""
        return tuple(map(self.column.shown, self.values))


def axis_of(name: str, given: Any, parameters: Sequence[Parameter]) -> Axis:
    """Return the values of one parameter.

    Args:
        name: The name or label of a parameter, or "time".
        given: A text, FIRST:LAST:COUNT or values with commas between them (semicolons for colors
            and points); or a sequence of values; or one value.
        parameters: The parameters of the scene.

    Raises:
        ValueError: There is no such parameter, or a value is out of its range.
    """
    column = column_of(name, parameters)
    spread: Sequence[Any] | None = _spread(column.label, given) if column.is_number else None
    if spread is None:
        spread = _listed(column, given)
    elif column.is_integer:
        ends = (spread[0], spread[-1])
        if any(end != round(end) for end in ends):
            raise ValueError(f"'{column.label}' takes whole numbers, not '{given:.60}'")
        spread = list(dict.fromkeys(map(round, spread)))
    if not spread:
        raise ValueError(f"'{column.label}' has no values")
    return Axis(column, tuple(map(column.checked, spread)))


def _spread(label: str, given: Any) -> list[float] | None:
    """Return the numbers of FIRST:LAST:COUNT; None for another form."""
    if not isinstance(given, str) or ":" not in given:
        return None
    parts = given.split(":")
    try:
        first, last = float(parts[0]), float(parts[1])
        count = int(parts[2]) if len(parts) == 3 else round(abs(last - first)) + 1
        if len(parts) > 3 or count < 1 or not (isfinite(first) and isfinite(last)):
            raise ValueError
    except (ValueError, OverflowError):
        raise ValueError(f"'{label}' takes FIRST:LAST:COUNT, not '{given:.60}'") from None
    if count > MOST:
        raise ValueError(f"'{label}' takes at most {MOST} values, not {count}")
    if count == 1:
        return [first]
    # Of the numbers as they are written, so that a tenth of 0:1 is .1, and the last one is LAST.
    begin, end = (Fraction(repr(number)) for number in (first, last))
    return [float(begin + (end - begin) * i / (count - 1)) for i in range(count)]


def _listed(column: InputColumn, given: Any) -> list[Any]:
    if isinstance(given, str):
        return _parts_of(given, ";" if column.parts else ",", column.options)
    if isinstance(given, Sequence) or hasattr(given, "__array__"):
        return list(given)
    return [given]


def _parts_of(text: str, separator: str, options: Sequence[str]) -> list[str]:
    """Return what stands between separators; an option that contains separators is one part."""
    pieces = text.split(separator)
    longest = max((option.count(separator) for option in options), default=0) + 1
    found, begin = [], 0
    while begin < len(pieces):
        for end in range(min(begin + longest, len(pieces)), begin, -1):
            whole = separator.join(pieces[begin:end])
            part = whole if whole in options else whole.strip()
            if part in options or end == begin + 1:
                break
        found.append(part)
        begin = end
    return [part for part in found if part]


def chosen_axes(values: Mapping[str, Any], parameters: Sequence[Parameter]) -> list[Axis]:
    """Return the axes of a sweep, in the order in which they were given.

    Raises:
        ValueError: A parameter or its values are wrong, or it is given by two names.
    """
    axes = [axis_of(name, given, parameters) for name, given in values.items()]
    for number, axis in enumerate(axes):
        if axis.name in (other.name for other in axes[:number]):
            raise ValueError(f"'{axis.label}' has values twice: give all of them once")
    return axes
