"""Parameters: values of a scene that can change without a new compilation.

Input: the author's definitions (``slider("Softness", 0.3)``) and later the values from a caller or
a command line. Output: frozen ``Parameter`` objects and plain Python values whose type and range
have been checked. A mistake raises a ``ValueError`` or ``TypeError`` that names the label. In a
compiled program each parameter is a uniform called ``name``: ``frontend/lowering/compilation.py``
declares it, ``runtime/uniform_values.py`` sets its value.
"""

from __future__ import annotations

import keyword
import re
import unicodedata
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from typing import Any, Final, assert_never

from distal.diagnostics import Span
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, Type
from distal.lang.expressions import Expression, Symbolic, refuse_comparison, uniform_of
from distal.lang.number_text import shown
from distal.lang.parameter_values import (
    TOGGLE_WORDS,
    Value,
    as_bool,
    as_color,
    as_float,
    as_int,
    as_option,
    as_point,
    joined,
    read_coordinates,
    read_number,
)
from distal.lang.source_places import author_place


class ParameterKind(Enum):
    """The kind of control; the value is its name in JSON interfaces."""

    SLIDER = "slider"
    INTEGER = "integer"
    TOGGLE = "toggle"
    CHOICE = "choice"
    COLOR = "color"
    POINT = "point"


@dataclass(frozen=True, slots=True)
class Parameter(Symbolic):
    """One adjustable value of a scene. Operators and built-ins applied to it return expressions.

    Attributes:
        name: Identifier, chosen or made from the label: the name of the uniform, and for ``--set``.
        label: The name shown to a person.
        kind: The kind of control.
        default: float, int, bool, the option's index for a choice, a tuple of linear red, green,
            blue for a color, or a tuple of 2 or 3 coordinates for a point.
        low: Smallest value of a slider or integer, else None.
        high: Largest value of a slider or integer, else None.
        step: Distance between positions of a slider or integer; None for a continuous slider.
        log: Whether equal steps of the slider multiply the value instead of adding to it.
        group: The heading that it is listed under, or "".
        help: One sentence about its effect, or "".
        options: Names of a choice's options, else empty.
        span: Where the author declares it.
    """

    name: str
    label: str
    kind: ParameterKind
    default: Value
    low: float | None = None
    high: float | None = None
    step: float | None = None
    log: bool = False
    group: str = ""
    help: str = ""
    options: tuple[str, ...] = ()
    span: Span | None = field(default_factory=author_place, compare=False)

    def __repr__(self) -> str:
        """Return the call that declares it, without what it has by default."""
        texts = [repr(self.label)]
        if self.kind is ParameterKind.CHOICE and isinstance(self.default, int):
            texts += [repr(list(self.options)), repr(self.options[self.default])]
        else:
            texts.append(repr(self.default))
        if self.kind in (ParameterKind.SLIDER, ParameterKind.INTEGER):
            texts += [repr(self.low), repr(self.high)]
            if self.step != (1 if self.kind is ParameterKind.INTEGER else None):
                texts.append(repr(self.step))
        for name in ("log", "group", "help"):
            if value := getattr(self, name):
                texts.append(f"{name}={value!r}")
        if self.name != _usual_name(self.label):
            texts.append(f"name={self.name!r}")
        return f"{self.kind.value}({', '.join(texts)})"

    @property
    def arguments(self) -> dict[str, Any]:
        """The arguments of ``slider`` or its like, by name; no ``name`` if the label gives it."""
        code = _DECLARED_BY[self.kind].__code__
        names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        known = {name: getattr(self, name) for name in names}
        if self.name == _usual_name(self.label):
            del known["name"]
        return known

    def replace(self, **changes: Any) -> Parameter:
        """Return the parameter with other arguments: ``radius.replace(high=5.0)``.

        Args:
            changes: The arguments that change, by name.

        Raises:
            TypeError: There is no such argument, or it has the wrong type.
            ValueError: A value is out of range.
        """
        for name in changes.keys() - {*self.arguments, "name"}:
            takes = ", ".join([*self.arguments, "name"])
            raise TypeError(f"a {self.kind.value} has no '{name}'; it takes {takes}")
        return _DECLARED_BY[self.kind](**{**self.arguments, **changes})

    def __replace__(self, /, **changes: Any) -> Parameter:
        return self.replace(**changes)

    def as_expression(self) -> Expression:
        """Return its value as an expression."""
        return uniform_of(self)

    def __eq__(self, other: object) -> Any:
        """Return whether it is the same parameter; comparing with a value is an error."""
        if isinstance(other, Parameter):
            return self is other or _fields_of(self) == _fields_of(other)
        if isinstance(other, int | float) or other in self.options:
            refuse_comparison("==")
        return NotImplemented

    def _pickled(self) -> Any:
        return Parameter, tuple(getattr(self, each.name) for each in fields(self))

    def __hash__(self) -> int:
        return hash((self.name, self.label, self.kind))

    @property
    def interface(self) -> tuple[tuple[str, object], ...]:
        """Its entries in a JSON interface, in order, besides its name, type and default."""
        return (
            ("label", self.label),
            ("kind", self.kind.value),
            ("low", self.low),
            ("high", self.high),
            ("step", self.step),
            ("log", self.log),
            ("group", self.group),
            ("help", self.help),
            ("options", self.options),
        )

    @property
    def type(self) -> Type:
        """The type of its value in scene code."""
        match self.kind:
            case ParameterKind.SLIDER:
                return FLOAT
            case ParameterKind.INTEGER | ParameterKind.CHOICE:
                return INT
            case ParameterKind.TOGGLE:
                return BOOL
            case ParameterKind.COLOR:
                return VEC3
            case ParameterKind.POINT:
                return VEC2 if _size(self.default) == 2 else VEC3
            case _:
                assert_never(self.kind)

    def check(self, value: object) -> Value:
        """Return the value as plain Python numbers.

        Accepts every form of the kind (a choice by name or index, a color as "#hex" or linear
        numbers), and also NumPy scalars and arrays.

        Raises:
            TypeError: The value has the wrong type.
            ValueError: The value is out of range.
        """
        match self.kind:
            case ParameterKind.SLIDER:
                return self._within(as_float(self.label, value))
            case ParameterKind.INTEGER:
                return self._within(as_int(self.label, value))
            case ParameterKind.TOGGLE:
                return as_bool(self.label, value)
            case ParameterKind.CHOICE:
                return as_option(self.label, self.options, value)
            case ParameterKind.COLOR:
                return as_color(self.label, value)
            case ParameterKind.POINT:
                return as_point(self.label, value, (_size(self.default),))
            case _:
                assert_never(self.kind)

    def parse(self, text: str) -> Value:
        """Parse the text of a value, as given to ``--set``.

        Raises:
            ValueError: The text is not a value of this kind, or the value is out of range.
        """
        text = text.strip()
        try:
            return self.check(self._read(text))
        except TypeError as error:
            raise ValueError(str(error)) from None

    def _read(self, text: str) -> object:
        match self.kind:
            case ParameterKind.SLIDER:
                return read_number(self.label, text, float, "a number")
            case ParameterKind.INTEGER:
                return read_number(self.label, text, int, "a whole number")
            case ParameterKind.TOGGLE:
                if text.lower() not in TOGGLE_WORDS:
                    raise ValueError(f"'{self.label}' takes true or false, not '{text:.40}'")
                return TOGGLE_WORDS[text.lower()]
            case ParameterKind.CHOICE:
                # An option may be called "2", so option names are tried first.
                is_number = text.isascii() and text.isdigit() and text not in self.options
                return int(text) if is_number else text
            case ParameterKind.COLOR:
                return (
                    text
                    if text.startswith("#") or text.isalpha()
                    else read_coordinates(self.label, text)
                )
            case ParameterKind.POINT:
                return read_coordinates(self.label, text)
            case _:
                assert_never(self.kind)

    def _within(self, value: int | float) -> int | float:
        assert self.low is not None and self.high is not None
        if not self.low <= value <= self.high:
            low, high = shown(self.low), shown(self.high)
            raise ValueError(f"'{self.label}' lies between {low} and {high}, not {shown(value)}")
        return value

    def describe(self) -> str:
        """Describe the valid values in a few words: "a number from 0 to 1 (default 0.3)"."""
        match self.kind:
            case ParameterKind.SLIDER:
                assert self.low is not None and self.high is not None
                assert isinstance(self.default, float | int)
                low, high, default = map(shown, (self.low, self.high, self.default))
                return f"a number from {low} to {high} (default {default})"
            case ParameterKind.INTEGER:
                return f"a whole number from {self.low} to {self.high} (default {self.default})"
            case ParameterKind.TOGGLE:
                return f"true or false (default {str(self.default).lower()})"
            case ParameterKind.CHOICE:
                assert isinstance(self.default, int)
                return f"{', '.join(self.options)} (default {self.options[self.default]})"
            case ParameterKind.COLOR:
                return f"#rrggbb, a name or linear r,g,b (default {joined(self.default)})"
            case ParameterKind.POINT:
                axes = ",".join("xyz"[: _size(self.default)])
                return f"{axes} (default {joined(self.default)})"
            case _:
                assert_never(self.kind)


def _fields_of(parameter: Parameter) -> tuple[object, ...]:
    return tuple(getattr(parameter, each.name) for each in fields(parameter) if each.compare)


def slider(
    label: str,
    default: float,
    low: float = 0.0,
    high: float = 1.0,
    step: float | None = None,
    *,
    log: bool = False,
    group: str = "",
    help: str = "",
    name: str | None = None,
) -> Parameter:
    """Declare a float between ``low`` and ``high`` that a person moves with a slider.

    Args:
        label: The name shown to a person, in any script.
        default: The initial value.
        low: Smallest value.
        high: Largest value.
        step: Distance between positions; None for a continuous slider.
        log: Make equal steps multiply the value; ``low`` must then be above 0.
        group: The heading under which it is listed.
        help: One sentence about its effect.
        name: The name in ``--set``, ``render`` and interfaces; None makes one of the label's
            letters and digits.

    Raises:
        TypeError: An argument has the wrong type.
        ValueError: The range is empty or the default is out of range.
    """
    name = parameter_name(label, name)
    low, high = as_float(label, low), as_float(label, high)
    step = None if step is None else as_float(label, step)
    _check_range(label, low, high, step)
    if log and low <= 0.0:
        raise ValueError(f"'{label}': a logarithmic slider needs low above 0, not {low:g}")
    return _checked(
        Parameter(
            name, label, ParameterKind.SLIDER, default, low, high, step, bool(log), group, help
        )
    )


def integer(
    label: str,
    default: int,
    low: int = 0,
    high: int = 100,
    step: int = 1,
    *,
    group: str = "",
    help: str = "",
    name: str | None = None,
) -> Parameter:
    """Declare a whole number between ``low`` and ``high``; an int in scene code.

    Args:
        label: The name shown to a person, in any script.
        default: The initial value.
        low: Smallest value.
        high: Largest value.
        step: Distance between positions.
        group: The heading under which it is listed.
        help: One sentence about its effect.
        name: The name in ``--set``, ``render`` and interfaces; None makes one of the label's
            letters and digits.

    Raises:
        TypeError: An argument is not a whole number.
        ValueError: The range is empty, the default is out of range, or a value exceeds 32 bits.
    """
    name = parameter_name(label, name)
    low, high, step = (as_int(label, n) for n in (low, high, step))
    _check_range(label, low, high, step)
    return _checked(
        Parameter(
            name, label, ParameterKind.INTEGER, default, low, high, step, group=group, help=help
        )
    )


def toggle(
    label: str,
    default: bool = False,
    *,
    group: str = "",
    help: str = "",
    name: str | None = None,
) -> Parameter:
    """Declare an on/off switch; a bool in scene code.

    Args:
        label: The name shown to a person, in any script.
        default: The initial value.
        group: The heading under which it is listed.
        help: One sentence about its effect.
        name: The name in ``--set``, ``render`` and interfaces; None makes one of the label's
            letters and digits.

    Raises:
        TypeError: The default is not a bool.
    """
    return _checked(
        Parameter(
            parameter_name(label, name),
            label,
            ParameterKind.TOGGLE,
            default,
            group=group,
            help=help,
        )
    )


def choice(
    label: str,
    options: Sequence[str],
    default: str | int = 0,
    *,
    group: str = "",
    help: str = "",
    name: str | None = None,
) -> Parameter:
    """Declare a choice between named options; in scene code an int, the index from 0.

    Args:
        label: The name shown to a person, in any script.
        options: The names of the options.
        default: The initial option, by name or by index from 0.
        group: The heading under which it is listed.
        help: One sentence about its effect.
        name: The name in ``--set``, ``render`` and interfaces; None makes one of the label's
            letters and digits.

    Raises:
        TypeError: An option is not a text.
        ValueError: There are no options, a name is empty or repeated, or there is no such default.
    """
    name = parameter_name(label, name)
    if isinstance(options, str):
        raise TypeError(f"'{label}' takes a list of options, not one text")
    named = tuple(options)
    if not named:
        raise ValueError(f"'{label}' has no options")
    for option in named:
        if not isinstance(option, str):
            raise TypeError(f"'{label}': an option is a text, not {type(option).__name__}")
        if not option.strip():
            raise ValueError(f"'{label}': an option is empty")
    if len(set(named)) < len(named):
        raise ValueError(f"'{label}' names an option twice")
    number = as_option(label, named, default)
    return Parameter(
        name, label, ParameterKind.CHOICE, number, group=group, help=help, options=named
    )


def color(
    label: str,
    default: str | Sequence[float] = "#ffffff",
    *,
    group: str = "",
    help: str = "",
    name: str | None = None,
) -> Parameter:
    """Declare a color; in scene code a vec3 of linear red, green and blue.

    Args:
        label: The name shown to a person, in any script.
        default: The initial color: "#rrggbb" in sRGB, a CSS name ("tomato"), or three linear
            numbers from 0 to 1.
        group: The heading under which it is listed.
        help: One sentence about its effect.
        name: The name in ``--set``, ``render`` and interfaces; None makes one of the label's
            letters and digits.

    Raises:
        TypeError: The default is neither a text nor three numbers.
        ValueError: The text is not a color, or a number is outside 0 to 1.
    """
    return _checked(
        Parameter(
            parameter_name(label, name),
            label,
            ParameterKind.COLOR,
            as_color(label, default),
            group=group,
            help=help,
        )
    )


def point(
    label: str,
    default: Sequence[float] = (0.0, 0.0, 0.0),
    *,
    group: str = "",
    help: str = "",
    name: str | None = None,
) -> Parameter:
    """Declare a point; a vec2 or vec3 in scene code, depending on the length of the default.

    Args:
        label: The name shown to a person, in any script.
        default: The initial point: 2 or 3 coordinates in scene units.
        group: The heading under which it is listed.
        help: One sentence about its effect.
        name: The name in ``--set``, ``render`` and interfaces; None makes one of the label's
            letters and digits.

    Raises:
        TypeError: The default is not made of numbers.
        ValueError: The default does not have 2 or 3 coordinates, or one is not finite.
    """
    where = as_point(label, default, (2, 3))
    return Parameter(
        parameter_name(label, name), label, ParameterKind.POINT, where, group=group, help=help
    )


_DECLARED_BY: Final[dict[ParameterKind, Callable[..., Parameter]]] = {
    ParameterKind.SLIDER: slider,
    ParameterKind.INTEGER: integer,
    ParameterKind.TOGGLE: toggle,
    ParameterKind.CHOICE: choice,
    ParameterKind.COLOR: color,
    ParameterKind.POINT: point,
}


def parameter_name(label: object, name: object = None) -> str:
    """Return the name of a parameter: the chosen one, or one made from its label.

    A name is a Python identifier in the form in which Python keeps identifiers (NFKC), so that it
    can be the name of an argument. The back ends write it with ASCII letters.

    Args:
        label: The label.
        name: The name that the author chose; None makes one of the label's letters and digits.

    Raises:
        TypeError: The label or the name is not a text.
        ValueError: The label is empty, or has no letter or digit; or the name is no identifier.
    """
    if not isinstance(label, str):
        raise TypeError(f"a parameter's label is a text, not {type(label).__name__}")
    if not label.strip():
        raise ValueError("a parameter needs a label")
    if not label.isprintable():
        raise ValueError(f"a parameter's label is one line of printable text, not {label!r}")
    if name is not None:
        return _chosen_name(label, name)
    # Accents are removed from Latin letters, so that "Größe" becomes grosse and not gr_e; in other
    # scripts a mark makes another letter.
    letters: list[str] = []
    for char in unicodedata.normalize("NFKD", label.casefold()):
        if not unicodedata.combining(char) or not _is_latin(letters[-1:]):
            letters.append(char)
    whole = unicodedata.normalize("NFKC", "".join(letters))
    parts = "".join(c if f"a{c}".isidentifier() else "_" for c in whole)
    derived = re.sub(r"_+", "_", parts).strip("_")
    if not derived:
        raise ValueError(
            f"the label '{label}' has no letter or digit to make a name of; choose one: name=\"…\""
        )
    return derived if derived.isidentifier() else f"p_{derived}"


def _usual_name(label: str) -> str | None:
    try:
        return parameter_name(label)
    except ValueError:  # it has no letter to make one of
        return None


def _chosen_name(label: str, name: object) -> str:
    if not isinstance(name, str):
        raise TypeError(f"'{label}': name is a text, not {type(name).__name__}")
    # In JavaScript "__proto__" is no ordinary key.
    if not name.isidentifier() or keyword.iskeyword(name) or name.startswith("_"):
        raise ValueError(
            f"'{label}': name is a Python identifier that begins with a letter, like radius_2, "
            f"not {name!r:.60}"
        )
    return unicodedata.normalize("NFKC", name)


def _is_latin(letter: Sequence[str]) -> bool:
    return bool(letter) and unicodedata.name(letter[0], "").startswith("LATIN ")


def _checked(parameter: Parameter) -> Parameter:
    """Return the parameter with its default checked and converted to plain numbers."""
    try:
        default = parameter.check(parameter.default)
    except ValueError as error:
        raise ValueError(f"default of {error}") from None
    except TypeError as error:
        raise TypeError(f"default of {error}") from None
    return replace(parameter, default=default)


def _check_range(label: str, low: float, high: float, step: float | None) -> None:
    if low >= high:
        raise ValueError(f"'{label}': low ({low:g}) must be below high ({high:g})")
    if step is not None and step <= 0:
        raise ValueError(f"'{label}': step must be above 0, not {step:g}")


def _size(value: Value) -> int:
    assert isinstance(value, tuple)
    return len(value)
