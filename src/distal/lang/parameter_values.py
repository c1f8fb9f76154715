"""Reading and checking the values of parameters.

Input: whatever an author, a caller or a command line gave, and the label to name in a
message. Output: plain finite Python numbers that 32 bits hold, or a ``TypeError`` (another
kind of thing) or ``ValueError`` (the right kind, out of reach). Knows no ``Parameter``.
"""

from __future__ import annotations

import importlib
import math
import operator
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Final, TypeAlias

from distal.lang.number_text import shown
from distal.lang.values import VectorValue

Value: TypeAlias = "float | int | bool | tuple[float, ...]"

LARGEST_FLOAT: Final = 3.4028234663852886e38  # of 32 bits: what every target computes in
INT_RANGE: Final = range(-(2**31), 2**31)

TOGGLE_WORDS: Final = {
    **dict.fromkeys(("true", "yes", "on", "1"), True),
    **dict.fromkeys(("false", "no", "off", "0"), False),
}


def read_number(label: str, text: str, read: Callable[[str], object], expected: str) -> object:
    """The number in a text; ``expected`` says in words what it should be."""
    try:
        return read(text)
    except ValueError:
        raise ValueError(f"'{label}' takes {expected}, not '{text:.40}'") from None


def as_float(label: str, value: object) -> float:
    """A finite float of 32 bits; a bool is no number here."""
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
    """A whole number of 32 bits; a bool or a float is none."""
    value = _plain(value)
    if isinstance(value, bool):
        raise TypeError(f"'{label}' takes a whole number, not {_kind_of(value)}")
    try:
        number = operator.index(value)  # type: ignore[arg-type]  # asking is the check
    except TypeError:
        raise TypeError(f"'{label}' takes a whole number, not {_kind_of(value)}") from None
    if number not in INT_RANGE:
        raise ValueError(f"'{label}' takes a 32-bit whole number")
    return number


def as_bool(label: str, value: object) -> bool:
    """A truth value; a number is refused."""
    value = _plain(value)
    if not isinstance(value, bool):
        raise TypeError(f"'{label}' takes True or False, not {_kind_of(value)}")
    return value


def as_option(label: str, options: tuple[str, ...], value: object) -> int:
    """The number of an option, given by its name or its number."""
    if isinstance(value, str):
        if value not in options:
            raise ValueError(f"'{label}' takes one of {', '.join(options)}, not '{value:.40}'")
        return options.index(value)
    number = as_int(label, value)
    if not 0 <= number < len(options):
        raise ValueError(f"'{label}' has options 0 to {len(options) - 1}, not {number}")
    return number


def as_color(label: str, value: object) -> tuple[float, ...]:
    """Linear red, green, blue, given so or as "#rrggbb" in sRGB."""
    if isinstance(value, str):
        return _decode_hex(label, value)
    numbers = as_point(label, value, (3,))
    if not all(0.0 <= c <= 1.0 for c in numbers):
        raise ValueError(f"'{label}' takes numbers from 0 to 1, not {joined(numbers)}")
    return numbers


def _decode_hex(label: str, text: str) -> tuple[float, ...]:
    # Imported when needed: it is scene code, and imports what imports this module.
    srgb = importlib.import_module("distal.lang.srgb")
    linear: tuple[float, ...] | None = srgb.linear_of(text)
    if linear is None:
        raise ValueError(f"'{label}' takes a color like #rrggbb, not '{text:.40}'")
    return linear


def as_point(label: str, value: object, sizes: tuple[int, ...]) -> tuple[float, ...]:
    """A tuple of finite floats with one of the given sizes."""
    value = _plain(value)
    expected = " or ".join(map(str, sizes))
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"'{label}' takes {expected} numbers, not {_kind_of(value)}")
    if len(value) not in sizes:
        raise ValueError(f"'{label}' takes {expected} numbers, not {len(value)}")
    return tuple(as_float(label, c) for c in value)


def read_coordinates(label: str, text: str) -> tuple[object, ...]:
    """The numbers between a text's commas."""
    return tuple(
        read_number(label, c.strip(), float, "numbers between commas") for c in text.split(",")
    )


def joined(value: Value) -> str:
    """Coordinates as a person types them."""
    assert isinstance(value, tuple)
    return ",".join(map(shown, value))


def _plain(value: object) -> object:
    if isinstance(value, VectorValue):
        return tuple(value)
    # NumPy's scalars and arrays know their plain form; this module need not know NumPy.
    convert: Callable[[], object] | None = getattr(value, "tolist", None)
    return convert() if callable(convert) else value


def _kind_of(value: object) -> str:
    return "None" if value is None else f"{type(value).__name__} {value!r:.40}"
