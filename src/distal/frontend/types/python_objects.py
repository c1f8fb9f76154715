"""Convert Python objects that scene code names to values: constants, parameters, resources.

Constants are captured when the function is lowered. NumPy's numbers and arrays are recognized by
their attributes (``dtype``, ``tolist``); NumPy itself is not imported.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum
from types import FunctionType, ModuleType
from typing import Any, Protocol

from distal.frontend.problems import must_be
from distal.frontend.signatures.annotations import struct_type, to_type
from distal.frontend.values import (
    FALSE,
    LARGEST_ARRAY,
    LARGEST_FLOAT,
    TRUE,
    Closure,
    SequenceValue,
    Static,
    Value,
    Whole,
    describe,
    whole_to,
)
from distal.ir.nodes import Compose, Const, Construct, Expr
from distal.ir.types import (
    FLOAT,
    UINT,
    VEC2,
    VEC3,
    VEC4,
    Array,
    Buffer,
    Kind,
    Matrix,
    Scalar,
    Type,
    Vector,
    vector_of,
)
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer as LangBuffer
from distal.lang.resources import TextureValue
from distal.lang.values import MatrixValue, VectorValue, uint


class RefusedError(Exception):
    """Scene code cannot use an object; the message says why."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


class Declarations(Protocol):
    """Interface that declares the module's uniforms and resources at their first use."""

    def uniform(self, parameter: Parameter) -> Expr:
        """Return the value of a parameter."""
        ...

    def computed(self, expression: Expression) -> Expr:
        """Return the value of an expression of parameters and time."""
        ...

    def resource(self, resource: TextureValue | LangBuffer, name: str, type: Type) -> Expr:
        """Return a texture or buffer.

        Args:
            resource: The texture or buffer.
            name: The preferred name.
            type: Its type in the IR.
        """
        ...


def value_of(obj: Any, text: str, declarations: Declarations) -> Value:
    """Return the value of an object; a ``Static`` for functions, types and modules.

    Args:
        obj: The object.
        text: Its name in the source, for messages.
        declarations: Declares parameters and resources.

    Raises:
        RefusedError: Scene code cannot use the object.
    """
    number = number_of(obj, text)
    if number is not None:
        return number
    match obj:
        case VectorValue() | MatrixValue():
            return lang_value(obj, text)
        case Parameter():
            return declarations.uniform(obj)
        case Expression():
            return declarations.computed(obj)
        case TextureValue():
            return declarations.resource(obj, text, obj.__distal_type__)
        case LangBuffer():
            return declarations.resource(obj, text, Buffer(obj.element))
        case tuple() | list():
            return _sequence(obj, text, declarations)
        case str() | bytes():
            raise RefusedError(f"'{text}' is text, which scene code does not have")
        case dict() | set() | frozenset():
            raise RefusedError(
                f"'{text}' is a {type(obj).__name__}, which scene code does not have",
                "use a list, a struct or a Buffer",
            )
    if "__distal_struct__" in vars(type(obj)):
        return _struct_value(obj, text, declarations)
    if hasattr(obj, "dtype") and hasattr(obj, "tolist"):
        return _array(obj, text)
    return Static(obj, text)


def number_of(obj: Any, text: str) -> Expr | Whole | None:
    """Return a Python or NumPy number as a constant; None for other objects.

    Raises:
        RefusedError: The number is NaN, infinite or too large, or an Enum's value is not a number.
    """
    if isinstance(obj, Enum):
        inner = number_of(obj.value, text)
        if inner is None:
            raise RefusedError(f"'{text}' is an Enum member whose value is not a number")
        return inner
    if hasattr(obj, "dtype") and hasattr(obj, "item") and getattr(obj, "shape", None) == ():
        unsigned = obj.dtype.kind == "u"
        obj = obj.item()
        if unsigned:
            obj = uint(obj)
    match obj:
        case bool():
            return TRUE if obj else FALSE
        case uint():
            return Const(int(obj), UINT)
        case int():
            return Whole(obj)
        case float():
            return float_constant(obj, text)
        case _:
            return None


def float_constant(value: float, text: str) -> Expr:
    """Return a float as a constant that every target can represent.

    Raises:
        RefusedError: The float is NaN, infinite or larger than a 32-bit float.
    """
    if math.isnan(value):
        raise RefusedError(f"'{text}' is not a number (NaN), which scene code does not have")
    if math.isinf(value):
        raise RefusedError(
            f"'{text}' is infinite, which scene code does not have",
            "use a large number, such as 1e9",
        )
    if abs(value) > LARGEST_FLOAT:
        raise RefusedError(
            f"'{text}' is larger than a 32-bit float can be", "the largest is 3.4e38"
        )
    return Const(value, FLOAT)


def _scalar(value: Any, kind: Kind, text: str) -> Expr:
    return float_constant(value, text) if kind is Kind.FLOAT else Const(_plain(value), Scalar(kind))


def _plain(value: Any) -> Any:
    return value if isinstance(value, bool) else int(value)


def lang_value(value: VectorValue | MatrixValue, text: str) -> Expr:
    """Return a vector or matrix of Python code as a constant.

    Raises:
        RefusedError: A component is NaN, infinite or too large.
    """
    type = value.__distal_type__
    match type:
        case Vector(kind):
            parts = tuple(_scalar(c, kind, text) for c in value)
        case Matrix():
            parts = tuple(lang_value(c, text) for c in value)
        case _:
            raise AssertionError(type)
    return Compose(parts, type)


def _sequence(items: Sequence[Any], text: str, declarations: Declarations) -> Value:
    if not items:
        raise RefusedError(f"'{text}' is empty", "an array has at least one element")
    _check_size(len(items), text)
    inner = [i for i in items if isinstance(i, tuple | list)]
    if len(inner) == len(items):
        vectors = _rows(inner, text)
        if vectors is not None:
            return SequenceValue(vectors, is_list=True, captured=True)
    values = tuple(value_of(i, f"{text}[{n}]", declarations) for n, i in enumerate(items))
    for value in values:
        if isinstance(value, Static):
            raise RefusedError(
                f"'{text}' holds {value.object!r:.60}, which is no value of scene code"
            )
    return SequenceValue(values, is_list=True, captured=True)


def _check_size(size: int, text: str) -> None:
    if size > LARGEST_ARRAY:
        message = f"'{text}' has {size} elements; an array has at most {LARGEST_ARRAY}"
        raise RefusedError(message, "make it a Buffer")


def _rows(rows: list[Any], text: str) -> tuple[Value, ...] | None:
    """Return rows of 2 to 4 numbers as float vectors; None if they are not, or are all whole."""
    size = len(rows[0])
    if not 2 <= size <= 4 or any(len(r) != size for r in rows):
        return None
    numbers = [[number_of(x, text) for x in row] for row in rows]
    flat = [n for row in numbers for n in row]
    if all(isinstance(n, Whole) for n in flat):
        return None
    if not all(isinstance(n, Whole) or (n is not None and n.type is FLOAT) for n in flat):
        return None
    type = vector_of(Kind.FLOAT, size)
    return tuple(
        Compose(
            tuple(
                float_constant(float(n.value), text) for n in row if isinstance(n, Whole | Const)
            ),
            type,
        )
        for row in numbers
    )


def _struct_value(obj: Any, text: str, declarations: Declarations) -> Expr:
    struct = struct_type(type(obj))
    parts = []
    for name, field_type in struct.fields:
        value = value_of(getattr(obj, name), f"{text}.{name}", declarations)
        coerced = coerce_constant(value, field_type)
        if coerced is None:
            raise RefusedError(must_be(f"'{text}.{name}'", field_type, describe(value)))
        parts.append(coerced)
    return Construct(tuple(parts), struct)


def _array(obj: Any, text: str) -> Value:
    kind = {"f": Kind.FLOAT, "i": Kind.INT, "u": Kind.UINT, "b": Kind.BOOL}.get(obj.dtype.kind)
    if kind is None:
        raise RefusedError(f"'{text}' is an array of {obj.dtype}, which scene code does not have")
    shape = tuple(obj.shape)
    _check_size(math.prod(shape), text)
    if len(shape) == 2 and shape[0] == shape[1] and 2 <= shape[0] <= 4 and kind is Kind.FLOAT:
        # NumPy's matrices are stored by rows, matrices of scene code by columns.
        columns = [[obj[r, c].item() for r in range(shape[0])] for c in range(shape[0])]
        vector = vector_of(Kind.FLOAT, shape[0])
        parts = (Compose(tuple(_scalar(x, kind, text) for x in c), vector) for c in columns)
        return Compose(tuple(parts), Matrix(shape[0]))
    if len(shape) == 1 and shape[0] > 0:
        items = tuple(_scalar(x, kind, text) for x in obj.tolist())
        return SequenceValue(items, is_list=True, captured=True)
    if len(shape) == 2 and 2 <= shape[1] <= 4 and shape[0] > 0:
        vector = vector_of(kind, shape[1])
        rows = (Compose(tuple(_scalar(x, kind, text) for x in row), vector) for row in obj.tolist())
        return SequenceValue(tuple(rows), is_list=True, captured=True)
    raise RefusedError(
        f"'{text}' is an array of shape {shape}, which no type holds", "use a Buffer"
    )


def coerce_constant(value: Value, type: Type) -> Expr | None:
    """Return a captured value as a constant of exactly this type, or None."""
    match value:
        case Whole(number):
            return whole_to(number, type)
        case SequenceValue(items):
            return _coerce_sequence(items, type)
        case Static() | Closure():
            return None
        case _:
            return value if value.type is type else None


def _coerce_sequence(items: tuple[Value, ...], type: Type) -> Expr | None:
    match type:
        case Array(element, length) if length == len(items):
            parts = [coerce_constant(i, element) for i in items]
        case Vector(kind, size) if size == len(items):
            parts = [coerce_constant(i, Scalar(kind)) for i in items]
        case _:
            return None
    known = tuple(p for p in parts if p is not None)
    if len(known) < len(parts):
        return None
    return Compose(known, type) if isinstance(type, Vector) else Construct(known, type)


def type_of_value(obj: Any) -> Type | None:
    """Return the type that a Python value has as an argument of a scene function, or None."""
    try:
        number = number_of(obj, "value")
    except RefusedError:
        return FLOAT  # NaN and infinity are allowed as arguments, but not as constants
    if isinstance(number, Whole):
        return to_type(int)
    if number is not None:
        return number.type
    if isinstance(obj, VectorValue | MatrixValue):
        return obj.__distal_type__
    if "__distal_struct__" in vars(type(obj)):
        return struct_type(type(obj))
    if isinstance(obj, tuple) and 2 <= len(obj) <= 4 and all(isinstance(x, float) for x in obj):
        return (VEC2, VEC3, VEC4)[len(obj) - 2]
    return None


def kind_of_object(obj: Any) -> str:
    """Return a description of an unusable object, for a message."""
    if isinstance(obj, ModuleType):
        return "a module"
    if isinstance(obj, FunctionType):
        return "a plain Python function"
    if isinstance(obj, Func):
        return "a function"
    if isinstance(obj, type):
        return "a type"
    return f"a {type(obj).__name__}"
