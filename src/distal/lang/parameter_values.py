"""Parse and check values of parameters.

Input: a value from an author, a caller or a command line, and the label for messages. Output: plain
finite Python numbers that fit in 32 bits. Errors are a ``TypeError`` (wrong type) or a
``ValueError`` (right type, but out of range). Does not depend on ``Parameter``.
"""

from __future__ import annotations

import importlib
import math
import operator
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Final, TypeAlias

from distal.lang.color_names import code_of_name, hint_for
from distal.lang.number_text import shown
from distal.lang.values import VectorValue

Value: TypeAlias = "float | int | bool | tuple[float, ...]"

LARGEST_FLOAT: Final = 3.4028234663852886e38  # the largest 32-bit float; targets compute in 32 bits
INT_RANGE: Final = range(-(2**31), 2**31)

TOGGLE_WORDS: Final = {
    **dict.fromkeys(("true", "yes", "on", "1"), True),
    **dict.fromkeys(("false", "no", "off", "0"), False),
}


def read_number(label: str, text: str, read: Callable[[str], object], expected: str) -> object:
    """Parse the number in a text.

    Args:
        label: The label for messages.
        text: The text.
        read: Parses the text; raises ``ValueError`` if that fails.
        expected: A description of valid texts, for the message.

    Raises:
        ValueError: The text cannot be parsed.
    """
    try:
        return read(text)
    except ValueError:
        raise ValueError(f"'{label}' takes {expected}, not '{text:.40}'") from None


def as_float(label: str, value: object) -> float:
    """Convert a number to a finite 32-bit float.

    Raises:
        TypeError: The value is not a number, or is a bool.
        ValueError: The number is not finite, or too large for 32 bits.
    """
    value = _plain(value)
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"'{label}' takes a number, not {_kind_of(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not abs(number) <= LARGEST_FLOAT:
        raise ValueError(f"'{label}' takes a finite 32-bit number, not {number:g}")
    return number


def as_int(label: str, value: object) -> int:
    """Convert a whole number to a 32-bit int.

    Raises:
        TypeError: The value is not a whole number, or is a bool or a float.
        ValueError: The number is too large for 32 bits.
    """
    value = _plain(value)
    if isinstance(value, bool):
        raise TypeError(f"'{label}' takes a whole number, not {_kind_of(value)}")
    try:
        number = operator.index(value)  # type: ignore[arg-type]  # or TypeError
    except TypeError:
        raise TypeError(f"'{label}' takes a whole number, not {_kind_of(value)}") from None
    if number not in INT_RANGE:
        raise ValueError(f"'{label}' takes a 32-bit whole number")
    return number


def as_bool(label: str, value: object) -> bool:
    """Return a bool unchanged.

    Raises:
        TypeError: The value is not a bool.
    """
    value = _plain(value)
    if not isinstance(value, bool):
        raise TypeError(f"'{label}' takes True or False, not {_kind_of(value)}")
    return value


def as_option(label: str, options: tuple[str, ...], value: object) -> int:
    """Return the index of an option.

    Args:
        label: The label for messages.
        options: The names of all options.
        value: The name or the index of an option.

    Raises:
        TypeError: The value is neither a text nor a whole number.
        ValueError: There is no such option.
    """
    if isinstance(value, str):
        if value not in options:
            raise ValueError(f"'{label}' takes one of {', '.join(options)}, not '{value:.40}'")
        return options.index(value)
    number = as_int(label, value)
    if not 0 <= number < len(options):
        raise ValueError(f"'{label}' has options 0 to {len(options) - 1}, not {number}")
    return number


def as_color(label: str, value: object) -> tuple[float, ...]:
    """Return linear red, green and blue of a color: linear, "#rrggbb" in sRGB, or a CSS name.

    Raises:
        TypeError: The value is neither a text nor three numbers.
        ColorNameError: The text is not a color.
        ValueError: A number is outside 0 to 1.
    """
    if isinstance(value, str):
        return _decode_text(label, value)
    numbers = as_point(label, value, (3,))
    if not all(0.0 <= c <= 1.0 for c in numbers):
        raise ValueError(f"'{label}' takes numbers from 0 to 1, not {joined(numbers)}")
    return numbers


class ColorNameError(ValueError):
    """A text is not a color.

    Attributes:
        message: What is wrong.
        hint: What to write instead, or None.
    """

    def __init__(self, message: str, hint: str | None) -> None:
        super().__init__(message if hint is None else f"{message}: {hint}")
        self.message, self.hint = message, hint


def _decode_text(label: str, text: str) -> tuple[float, ...]:
    # Imported here to avoid a cycle: that module is scene code and imports users of this module.
    srgb = importlib.import_module("distal.lang.srgb")
    linear: tuple[float, ...] | None = srgb.linear_of(code_of_name(text) or text)
    if linear is None:
        message = f"'{label}' takes a color like #rrggbb or tomato, not '{text:.40}'"
        raise ColorNameError(message, hint_for(text))
    return linear


def as_point(label: str, value: object, sizes: tuple[int, ...]) -> tuple[float, ...]:
    """Return a tuple of finite floats.

    Args:
        label: The label for messages.
        value: A sequence of numbers.
        sizes: The allowed lengths.

    Raises:
        TypeError: The value is not a sequence of numbers.
        ValueError: Its length is not allowed, or a number is not finite.
    """
    value = _plain(value)
    expected = " or ".join(map(str, sizes))
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"'{label}' takes {expected} numbers, not {_kind_of(value)}")
    if len(value) not in sizes:
        raise ValueError(f"'{label}' takes {expected} numbers, not {len(value)}")
    return tuple(as_float(label, c) for c in value)


def read_coordinates(label: str, text: str) -> tuple[object, ...]:
    """Parse numbers separated by commas."""
    return tuple(
        read_number(label, c.strip(), float, "numbers between commas") for c in text.split(",")
    )


def joined(value: Value) -> str:
    """Return coordinates as text, separated by commas."""
    assert isinstance(value, tuple)
    return ",".join(map(shown, value))


def _plain(value: object) -> object:
    if isinstance(value, VectorValue):
        return tuple(value)
    # ``tolist`` converts NumPy's scalars and arrays without importing NumPy.
    convert: Callable[[], object] | None = getattr(value, "tolist", None)
    return convert() if callable(convert) else value


def _kind_of(value: object) -> str:
    return "None" if value is None else f"{type(value).__name__} {value!r:.40}"
