"""The values of a sweep's parameters.

Input: texts such as "0:1:20" or "1,2,3", or lists of values. Output: checked values by parameter,
and all combinations of them. Does not depend on pictures.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.lang.chosen_values import by_key
from distal.lang.number_text import shown
from distal.lang.parameters import Parameter, ParameterKind

# Name of the axis that is no parameter.
TIME: Final = "time"
MOST: Final = 100_000
_LISTS: Final = (ParameterKind.COLOR, ParameterKind.POINT)


@dataclass(frozen=True, slots=True)
class Axis:
    """The values that one parameter takes.

    Attributes:
        name: The parameter's name, or "time".
        label: What a person reads.
        values: Plain values.
        texts: The same as texts.
        is_time: Whether it is the time, and no parameter.
    """

    name: str
    label: str
    values: tuple[Any, ...]
    texts: tuple[str, ...]
    is_time: bool = False


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
    known = by_key(parameters)
    if name not in known:
        if name == TIME:
            times = tuple(map(float, _spread(name, given) or _listed(given, ",")))
            if not times:
                raise ValueError(f"'{TIME}' has no values")
            return Axis(TIME, TIME, times, tuple(map(shown, times)), is_time=True)
        names = ", ".join([*dict.fromkeys(p.name for p in known.values()), TIME])
        raise ValueError(f"there is no parameter '{name:.60}'; a sweep takes {names}")
    parameter = known[name]
    spread = None if parameter.kind in _LISTS else _spread(parameter.label, given)
    values: tuple[Any, ...]
    if spread is not None:
        if parameter.kind is ParameterKind.INTEGER:
            spread = list(dict.fromkeys(map(round, spread)))
        values = tuple(parameter.check(value) for value in spread)
    else:
        separator = ";" if parameter.kind in _LISTS else ","
        values = tuple(
            parameter.parse(v) if isinstance(v, str) else parameter.check(v)
            for v in _listed(given, separator)
        )
    if not values:
        raise ValueError(f"'{parameter.label}' has no values")
    return Axis(parameter.name, parameter.label, values, tuple(_text(parameter, v) for v in values))


def _spread(label: str, given: Any) -> list[float] | None:
    """Return the numbers of FIRST:LAST:COUNT; None for another form."""
    if not isinstance(given, str) or ":" not in given:
        return None
    parts = given.split(":")
    try:
        first, last = float(parts[0]), float(parts[1])
        count = int(parts[2]) if len(parts) == 3 else round(abs(last - first)) + 1
        if len(parts) > 3 or count < 1:
            raise ValueError
    except (ValueError, OverflowError):
        raise ValueError(f"'{label}' takes FIRST:LAST:COUNT, not '{given:.60}'") from None
    if count > MOST:
        raise ValueError(f"'{label}' takes at most {MOST} values, not {count}")
    if count == 1:
        return [first]
    return [first + (last - first) * i / (count - 1) for i in range(count)]


def _listed(given: Any, separator: str) -> list[Any]:
    if isinstance(given, str):
        return [part.strip() for part in given.split(separator) if part.strip()]
    if isinstance(given, Sequence) or hasattr(given, "__array__"):
        return list(given)
    return [given]


def _text(parameter: Parameter, value: Any) -> str:
    if parameter.kind is ParameterKind.CHOICE:
        return str(parameter.options[value])
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return " ".join(map(shown, value))
    return str(shown(value))


def combinations(axes: Sequence[Axis]) -> Iterator[dict[str, Any]]:
    """Return all combinations, the values of the last axis fastest."""
    for values in itertools.product(*(axis.values for axis in axes)):
        yield {axis.name: value for axis, value in zip(axes, values, strict=True)}


def count_of(axes: Sequence[Axis]) -> int:
    """Return how many combinations there are.

    Raises:
        ValueError: There are none, or too many.
    """
    if not axes:
        raise ValueError("a sweep takes values: --set NAME=FIRST:LAST:COUNT or NAME=A,B,C")
    count = 1
    for axis in axes:
        count *= len(axis.values)
    if count > MOST:
        raise ValueError(f"a sweep has at most {MOST} pictures, not {count}")
    return count


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
