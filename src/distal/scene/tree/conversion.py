"""Conversion of an author's values to ``Number``s; errors are reported at the author's line.

Input: Python and NumPy numbers, tuples, lists, arrays, vectors, colors (``"#hex"``, CSS names),
parameters and expressions, also mixed. Output: checked plain numbers, or one expression. Checks
limits (``fields.guarantees``); does not depend on the functions that take the numbers.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from distal.diagnostics import Span
from distal.fields.guarantees import ENDLESS, UNBOUNDED, Limit
from distal.ir.nodes import Cast, Compose, Const, Expr, Splat, Uniform
from distal.ir.types import FLOAT, INT, TEXTURE_2D, TEXTURE_3D, Kind, Scalar, Texture, Type, Vector
from distal.ir.types import Buffer as BufferType
from distal.lang.expressions import Expression, Symbolic
from distal.lang.parameter_values import (
    LARGEST_FLOAT,
    ColorNameError,
    as_bool,
    as_color,
    as_float,
    as_int,
)
from distal.lang.parameters import Parameter
from distal.lang.places import CELL, places_in
from distal.lang.resources import Buffer, Texture2D, Texture3D, TextureValue
from distal.lang.source import folder_of
from distal.lang.values import VectorValue
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.former_names import solid_of
from distal.scene.tree.whole_numbers import whole_ends

Component: TypeAlias = "float | Expression"
Plain: TypeAlias = "float | tuple[float, ...]"

# The values of an object without values, shared by all of them.
NO_VALUES: Final[Mapping[str, Any]] = MappingProxyType({})
_OF_ARRAYS: Final[Mapping[Type, type[TextureValue]]] = {
    TEXTURE_2D: Texture2D,
    TEXTURE_3D: Texture3D,
}
_WORDS: Final = {2: "two", 3: "three", 4: "four"}
# A direction written with six digits is accepted as having length 1.
_UNIT_TOLERANCE: Final = 1e-5
_SEQUENCES: Final = (tuple, list)
_UNWRAPPED: Final = (float, Expression, tuple, list, int)


@dataclass(frozen=True, slots=True, init=False)
class Number:
    """A float, a vector of floats, or a changing int or bool among the arguments of a scene object.

    Attributes:
        type: float, vec2, vec3 or vec4; int or bool, if the value is an expression.
        value: Constant numbers, or an expression of this type.
    """

    type: Type
    value: Plain | Expression

    def __init__(self, type: Type, value: Plain | Expression) -> None:
        # There are some for each part of a scene, so it is made without object.__setattr__.
        _set_type(self, type)
        _set_value(self, value)

    @property
    def plain(self) -> Plain | None:
        """The value if it is constant, else None."""
        return None if isinstance(self.value, Expression) else self.value

    def may_exceed(self, low: float) -> bool:
        """Return whether a component is, or may become, larger than ``low``."""
        known = self.plain
        return known is None or any(c > low for c in components(known))


@dataclass(frozen=True, slots=True, init=False)
class HostNumber(Number):
    """A number that whoever shows the scene sets, by its name: one uniform for all who read it.

    Attributes:
        name: The name of the uniform; begins with a capital letter.
    """

    name: str

    def __init__(self, name: str, type: Type, value: Plain) -> None:
        Number.__init__(self, type, value)
        object.__setattr__(self, "name", name)


_set_type: Final = vars(Number)["type"].__set__
_set_value: Final = vars(Number)["value"].__set__


@dataclass(frozen=True, slots=True)
class Asked:
    """The parameter that a value is for: its name in messages, its type and its limits.

    Attributes:
        name: The name of the parameter: "radius".
        what: The name of the object that is made: "Sphere".
        type: The type of the scene function's parameter.
        limit: The limit of each number.
        is_color: Whether "#rrggbb", a CSS name and a single number (a grey) are accepted, and
            components must not be negative.
        splats: Whether one number sets all components.
        place: The author's line.
        is_fixed: Whether an int or a bool is fixed when the scene is compiled.
        is_endless: Whether components may be infinite; they become ``UNBOUNDED``.
        varies: What the number may depend on besides parameters and time: "cell", "p".
    """

    name: str
    what: str
    type: Type
    limit: Limit = Limit.ANY
    is_color: bool = False
    splats: bool = False
    place: Span | None = None
    is_fixed: bool = False
    varies: frozenset[str] = frozenset()
    is_endless: bool = False

    @property
    def label(self) -> str:
        """The name in messages."""
        return f"{self.name} of {self.what}"


def number(value: Any, asked: Asked) -> Number:
    """Convert a value to a float or a vector.

    Raises:
        SceneTypeError: The value is not a number, or has the wrong number of components.
        SceneValueError: A number is not finite, or is beyond its limit.
    """
    value = unwrapped(value)
    if asked.type is FLOAT:
        made = Number(FLOAT, _component(value, asked))
    else:
        assert isinstance(asked.type, Vector) and asked.type.kind is Kind.FLOAT, asked.type
        made = _vector(value, asked, asked.type)
    if isinstance(made.value, Expression):
        _check_places(made.value, asked)
    _check_limit(made, asked)
    if asked.is_endless and made.plain is not None and min(components(made.plain)) >= ENDLESS:
        refuse(
            f"'{asked.label}' is infinite along all axes, and nothing ends there",
            "leave one side finite",
            asked.place,
        )
    return made


def plain_number(
    value: Any, type_: Type | None, limit: Limit, *, is_color: bool = False
) -> Number | None:
    """Convert a plain number, or a tuple or list of them, that needs no other conversion.

    It accepts what ``number`` accepts, in a fifth of the time, and returns None for other values,
    which ``number`` converts or reports.

    Args:
        value: The value.
        type_: The type of the scene function's parameter.
        limit: The limit of each number.
        is_color: Whether components must not be negative.
    """
    plain: Plain | None
    if type_ is FLOAT:
        plain = plain_float(value, limit)
        if is_color and plain is not None and plain < 0.0:
            return None
    elif isinstance(type_, Vector) and type_.kind is Kind.FLOAT:
        plain = plain_floats(value, type_.size, limit, is_color=is_color)
    else:
        return None
    return None if plain is None else Number(type_, plain)


def plain_float(value: Any, limit: Limit) -> float | None:
    """Return a float or an int as a float; None if it is another value, or beyond its limit."""
    if not is_plain_scalar(value) or not -LARGEST_FLOAT <= value <= LARGEST_FLOAT:
        return None
    kept = True if limit is Limit.ANY else _keeps(limit, value, value, (value,))
    return float(value) if kept else None


def plain_floats(
    value: Any, size: int, limit: Limit, *, is_color: bool
) -> tuple[float, ...] | None:
    """Return a tuple or a list of floats and ints; None if it is another value, or beyond limits.

    Args:
        value: The value.
        size: The number of components.
        limit: The limit of each.
        is_color: Whether they must not be negative.
    """
    if type(value) not in _SEQUENCES or len(value) != size:
        return None
    for c in value:
        if not (isinstance(c, float) or type(c) is int) or not -LARGEST_FLOAT <= c <= LARGEST_FLOAT:
            return None
    floats = tuple(map(float, value))
    if limit is Limit.ANY and not is_color:
        return floats
    least = min(floats)
    if is_color and least < 0.0:
        return None
    return floats if _keeps(limit, least, max(floats), floats) else None


def choice(value: Any, asked: Asked) -> Number | int | bool:
    """Convert a value to an int or a bool.

    A plain one is fixed when the scene is compiled. A parameter or an expression of parameters
    becomes a number of the scene, whose largest and smallest value keep the limit.

    Raises:
        SceneTypeError: The value has the wrong type, or can change and must not.
        SceneValueError: The value is beyond its limit, or its limits are not known.
    """
    value = unwrapped(value)
    if isinstance(value, Symbolic):
        return _changing_choice(value, asked)
    if asked.type is INT:
        whole: int = _checked(as_int, value, asked)
        _check_limit(Number(INT, whole), asked)
        return whole
    return bool(_checked(as_bool, value, asked))


def plain_choice(value: Any, asked: Asked) -> int | bool:
    """Convert a value to an int or a bool that is fixed when the scene is compiled.

    Raises as ``choice``.
    """
    found = choice(value, replace(asked, is_fixed=True))
    assert not isinstance(found, Number)
    return found


def _changing_choice(value: Symbolic, asked: Asked) -> Number:
    """Convert a parameter or an expression to an int or a bool of the scene."""
    held = value.as_expression()
    is_whole = asked.type is INT
    if asked.is_fixed:
        kind = "whole number" if is_whole else "True or False"
        refuse_kind(
            f"'{asked.label}' is fixed when the scene is compiled; {_described(value)} is not",
            f"give a plain {kind}",
            asked.place,
        )
    if is_whole and CELL in places_in(held):
        refuse(
            f"'{asked.label}' is the same in all cells",
            "choose between shapes: select(cell.x < 1.5, a, b)",
            asked.place,
        )
    if held.node.type is not asked.type:
        kind, hint = ("a whole number", "integer(…)") if is_whole else ("a condition", "toggle(…)")
        refuse_kind(
            f"'{asked.label}' takes {kind}; {_described(value)} is a {held.node.type}",
            f"make it with {hint}" + ("" if is_whole else ", or compare: x > 0.5"),
            asked.place,
        )
    _check_places(held, asked)
    if is_whole:
        _check_ends(held, asked)
    return Number(asked.type, held)


def _check_places(held: Expression, asked: Asked) -> None:
    """Refuse an expression that depends on the cell or the place where nothing gives them."""
    for place in sorted(places_in(held) - asked.varies):
        if place == CELL:
            refuse(
                f"'{asked.label}' cannot depend on the cell",
                "numbers of shapes that are repeated, and of their materials, may",
                asked.place,
            )
        refuse(
            f"'{asked.label}' cannot depend on the place",
            "numbers of shapes, of operators and of materials may",
            asked.place,
        )


def _check_ends(held: Expression, asked: Asked) -> None:
    """Refuse a whole number whose limits are not known, or beyond those of the parameter."""
    ends = whole_ends(held)
    if ends is None:
        refuse(
            f"'{asked.label}' needs a largest value, and this expression has none that is known",
            "limit it: clamp(n, 1, 12) of distal.lang",
            asked.place,
        )
    for end, plain in zip(("low", "high"), ends, strict=True):
        wrong = complaint(float(plain), asked.limit)
        if wrong is not None:
            refuse(
                f"'{asked.label}' must be {wrong}; it goes {_reach(end)} {plain}", None, asked.place
            )


def resource(value: Any, asked: Asked) -> TextureValue | Buffer:
    """Convert a value to a texture or a buffer: a resource, a picture's file, or a list of points.

    Raises:
        SceneTypeError: The value has the wrong type.
        SceneValueError: The value is empty, or contains numbers that are not finite.
    """
    if isinstance(asked.type, Texture):
        return _texture(value, asked, asked.type)
    assert isinstance(asked.type, BufferType), asked.type
    return _buffer(value, asked, asked.type.element)


def unwrapped(value: Any) -> Any:
    """Convert NumPy scalars, arrays and vectors to plain numbers and tuples."""
    if type(value) in _UNWRAPPED:
        return value
    if isinstance(value, VectorValue):
        return tuple(value)
    convert: Callable[[], object] | None = getattr(value, "tolist", None)
    return convert() if callable(convert) else value


def is_scalar(value: Any) -> bool:
    """Return whether a value is one number, constant or computed."""
    value = unwrapped(value)
    if isinstance(value, Symbolic):
        return isinstance(value.as_expression().node.type, Scalar)
    return isinstance(value, int | float) or (
        hasattr(value, "__float__") and not isinstance(value, Sequence)
    )


def is_plain_scalar(value: Any) -> bool:
    """Return whether a value is a float (NumPy's float64 is one) or an int, not a bool."""
    return isinstance(value, float) or type(value) is int


def components(value: Plain) -> tuple[float, ...]:
    """Return the floats of a constant number."""
    return value if isinstance(value, tuple) else (value,)


def _described(value: Symbolic) -> str:
    if isinstance(value, Parameter):
        return f"the {value.kind.value} '{value.label}'"
    return "an expression of parameters or time"


def _checked(read: Callable[[str, object], Any], value: object, asked: Asked) -> Any:
    try:
        return read(asked.label, value)
    except TypeError as error:
        message = str(error)
        refuse_kind(message, place=asked.place)
    except ColorNameError as error:
        message, hint = error.message, error.hint
        refuse(message, hint, asked.place)
    except ValueError as error:
        message = str(error)
        refuse(message, place=asked.place)


def _component(value: Any, asked: Asked) -> Component:
    value = unwrapped(value)
    if not isinstance(value, Symbolic):
        if asked.is_endless and isinstance(value, float) and value == math.inf:
            return UNBOUNDED
        found: float = _checked(as_float, value, asked)
        return found
    held = value.as_expression()
    if held.node.type is FLOAT:
        return held
    if held.node.type is INT:
        return Expression(Cast(held.node, FLOAT), held.parameters)
    refuse_kind(
        f"'{asked.label}' takes a number; {_described(value)} is a {held.node.type}",
        place=asked.place,
    )


def _vector(value: Any, asked: Asked, type: Vector) -> Number:
    if asked.is_color and isinstance(value, str):
        return Number(type, _checked(as_color, value, asked))
    if isinstance(value, Symbolic):
        held = value.as_expression()
        if held.node.type is type:
            return Number(type, held)
    if is_scalar(value) and (asked.splats or asked.is_color):
        one = _component(value, asked)
        if isinstance(one, Expression):
            return Number(type, Expression(Splat(one.node, type), one.parameters))
        return Number(type, (one,) * type.size)
    if isinstance(value, str) or not isinstance(value, Sequence):
        _refuse_vector(value, asked, type)
    if len(value) != type.size:
        refuse_kind(
            f"'{asked.label}' takes {_WORDS[type.size]} numbers, not {len(value)}",
            solid_of(asked.what),
            asked.place,
        )
    return _gathered(tuple(_component(c, asked) for c in value), type)


def _refuse_vector(value: Any, asked: Asked, type: Vector) -> None:
    takes = f"{_WORDS[type.size]} numbers"
    if asked.is_color:
        takes = "a color: '#rrggbb', a name, or linear red, green and blue"
    if isinstance(value, Symbolic):
        given = f"{_described(value)}, a {value.as_expression().node.type}"
    elif value is None:
        given = "None"
    else:
        given = f"{type_name(value)} {value!r:.40}"
    refuse_kind(f"'{asked.label}' takes {takes}, not {given}", place=asked.place)


def type_name(value: object) -> str:
    """Return the name of a value's type for messages."""
    return type(value).__name__


def _gathered(parts: Sequence[Component], type: Vector) -> Number:
    """Return a vector of numbers, some of which may be expressions."""
    plain = tuple(p for p in parts if not isinstance(p, Expression))
    if len(plain) == len(parts):
        return Number(type, plain)
    parameters: dict[Parameter, None] = {}
    nodes: list[Expr] = []
    for part in parts:
        if isinstance(part, Expression):
            parameters.update(dict.fromkeys(part.parameters))
            nodes.append(part.node)
        else:
            nodes.append(Const(part, FLOAT))
    return Number(type, Expression(Compose(tuple(nodes), type), tuple(parameters)))


# Limits


def _check_limit(made: Number, asked: Asked) -> None:
    known = made.plain
    if known is not None:
        _check_plain(known, asked)
        return
    assert isinstance(made.value, Expression)
    node, parameters = made.value.node, made.value.parameters
    if len(parameters) != 1 or not isinstance(node, Uniform):
        return  # a computed value: its range is not known here
    _check_parameter(parameters[0], asked)


def _check_plain(known: Plain, asked: Asked) -> None:
    wrong = complaint(known, asked.limit)
    if wrong is None and asked.is_color and min(components(known)) < 0.0:
        wrong = "a color without negative parts"
    if wrong is not None:
        refuse(
            f"'{asked.label}' must be {wrong}, not {shown(known)}",
            _color_hint(known) if asked.is_color else _direction_hint(known, asked.limit),
            asked.place,
        )


def _check_parameter(parameter: Parameter, asked: Asked) -> None:
    assert not isinstance(parameter.default, bool)
    named = f"the {parameter.kind.value} '{parameter.label}'"
    wrong = complaint(parameter.default, asked.limit)
    if wrong is not None:
        refuse(
            f"'{asked.label}' must be {wrong}; {named} has {shown(parameter.default)} at first",
            place=asked.place,
        )
    for end, value in (("low", parameter.low), ("high", parameter.high)):
        wrong = None if value is None else complaint(value, asked.limit)
        if value is not None and wrong is not None:
            hint = None
            if asked.limit in (Limit.POSITIVE, Limit.NOT_NEGATIVE, Limit.NOT_ZERO):
                hint = f"give it low={'0.0' if asked.limit is Limit.NOT_NEGATIVE else '0.01'}"
            refuse(
                f"'{asked.label}' must be {wrong}; {named} goes {_reach(end)} {value:g}",
                hint,
                asked.place,
            )


def _reach(end: str) -> str:
    return "down to" if end == "low" else "up to"


def complaint(known: Plain, limit: Limit) -> str | None:
    """Return the limit that a number violates, in words, or None."""
    parts = components(known)
    return None if _keeps(limit, min(parts), max(parts), parts) else limit.value


def _keeps(limit: Limit, least: float, largest: float, parts: Sequence[float]) -> bool:
    """Return whether numbers are within a limit.

    Args:
        limit: The limit.
        least: The least number.
        largest: The largest number.
        parts: The numbers.
    """
    if limit is Limit.POSITIVE:
        return least > 0.0
    if limit is Limit.NOT_NEGATIVE:
        return least >= 0.0
    if limit is Limit.FRACTION:
        return least >= 0.0 and largest <= 1.0
    if limit is Limit.NOT_ZERO:
        return 0.0 not in parts
    if limit is Limit.UNIT:
        return abs(math.hypot(*parts) - 1.0) <= _UNIT_TOLERANCE
    assert limit is Limit.ANY, limit
    return True


def _color_hint(known: Plain) -> str | None:
    """Return the text of a color that is given by whole numbers up to 255."""
    parts = components(known)
    if len(parts) != 3 or max(parts) < 16 or not all(c in range(256) for c in parts):
        return None  # a small number may be meant as a factor
    return f"write '#{bytes(map(int, parts)).hex()}'"


def _direction_hint(known: Plain, limit: Limit) -> str | None:
    if limit is not Limit.UNIT:
        return None
    parts = components(known)
    length = math.hypot(*parts)
    if length == 0.0:
        return "a vector of zeros has no direction"
    return f"write {shown(tuple(c / length for c in parts))}"


def shown(known: Plain) -> str:
    """Return a number as an author writes it."""
    if isinstance(known, tuple):
        return f"({', '.join(f'{c:.6g}' for c in known)})"
    return f"{known:.6g}"


# Data


def _texture(value: Any, asked: Asked, type: Texture) -> TextureValue:
    if isinstance(value, str | os.PathLike) and type is TEXTURE_2D:
        return Texture2D(beside(value, asked.place))
    if isinstance(value, TextureValue) and value.__distal_type__ is type:
        return value
    if hasattr(value, "dtype") and hasattr(value, "shape") and type in _OF_ARRAYS:
        return _OF_ARRAYS[type](value)
    hint = "or an array"
    if type is TEXTURE_2D:
        hint += ", or the name of a picture's file"
    refuse_kind(
        f"'{asked.label}' takes a {type}, not {type_name(value)} {value!r:.40}", hint, asked.place
    )


def beside(value: str | os.PathLike[str], place: Span | None) -> str | os.PathLike[str]:
    """Return a file's path in the folder of the author's file if it exists there, else the name."""
    if place is None:
        return value
    folder = os.path.abspath(folder_of(place.file))
    candidate = os.path.join(folder, os.fspath(value))
    return candidate if os.path.exists(candidate) else value


def _buffer(value: Any, asked: Asked, element: Type) -> Buffer:
    if isinstance(value, Buffer):
        if value.element is not element:
            refuse_kind(
                f"'{asked.label}' takes a Buffer of {element}, not of {value.element}",
                place=asked.place,
            )
        return value
    rows = unwrapped(value)
    if isinstance(rows, str) or not isinstance(rows, Sequence):
        refuse_kind(
            f"'{asked.label}' takes a list of {element}, not {type_name(value)} {value!r:.40}",
            place=asked.place,
        )
    if not rows:
        refuse(f"'{asked.label}' needs at least one {element}", place=asked.place)
    return Buffer([_row(row, position, asked, element) for position, row in enumerate(rows)])


def _row(row: Any, position: int, asked: Asked, element: Type) -> Any:
    inner = Asked(f"{asked.name}[{position}]", asked.what, element, place=asked.place)
    if element is INT:
        return plain_choice(row, inner)
    found = number(row, inner)
    if found.plain is None:
        refuse_kind(
            f"'{inner.label}' is data: plain numbers, no parameters or time", place=asked.place
        )
    return found.plain
