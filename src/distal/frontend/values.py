"""The values that an author's expression can have before it has an IR type.

Most are plain ``ir.nodes`` expressions. A whole-number literal can still take the type of the
other operand. ``[a, b]`` or ``(a, b)`` becomes an array, a tuple or a vector where it is used. A
function, type or module exists only at compile time.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

from distal.ir.nodes import Const, Expr
from distal.ir.types import BOOL, FLOAT, INT, UINT, Type

if TYPE_CHECKING:
    from distal.frontend.function_body import FunctionBody

LARGEST_FLOAT = 3.4028234663852886e38
LARGEST_ARRAY = 1 << 16  # components; larger data must be a Buffer
WHOLE_RANGES: dict[Type, range] = {INT: range(-(2**31), 2**31), UINT: range(2**32)}


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number known at compile time (literal or captured int); its default type is int.

    Attributes:
        value: The number.
        computed: Whether operators of scene code computed it: then it wraps as an int or uint,
            where a number that is written must fit. As a float it is exact.
    """

    value: int
    computed: bool = False


@dataclass(frozen=True, slots=True)
class SequenceValue:
    """``[a, b]`` or ``(a, b)``, or a captured list or tuple.

    Attributes:
        items: The elements.
        is_list: Whether it is a list, whose default is an array; otherwise a tuple.
        captured: Whether it comes from Python, outside the function.
    """

    items: tuple[Value, ...]
    is_list: bool
    captured: bool = False


@dataclass(frozen=True, slots=True)
class Static:
    """A Python object that is not a value at run time: a function, a type, a module.

    Attributes:
        object: The object.
        text: Its name in the source.
    """

    object: Any
    text: str


@dataclass(eq=False, slots=True)
class Closure:
    """A lambda or a nested ``def``, which is lifted to a module function when it is used.

    Attributes:
        node: Its syntax.
        owner: The function body that contains it and the names that it captures.
        name: The name of the lifted function.
        defaults: The default values, by parameter name.
        instances: The lifted functions, by argument and result types.
    """

    node: ast.Lambda | ast.FunctionDef
    owner: FunctionBody
    name: str
    defaults: dict[str, Value] = field(default_factory=dict)
    instances: dict[tuple[Type | None, ...], Any] = field(default_factory=dict)


Value: TypeAlias = "Expr | Whole | SequenceValue | Static | Closure"


def describe(value: Value) -> str:
    """Return a description of a value's type for messages."""
    match value:
        case Whole():
            return "int"
        case SequenceValue(items, is_list):
            kind = "a list" if is_list else "a tuple"
            return f"{kind} of {len(items)}"
        case Static(_, text):
            return f"'{text}'"
        case Closure(_, _, name):
            return "a lambda" if name == "lambda" else f"the function '{name}'"
        case _:
            return str(value.type)


def whole_to(value: int, type: Type) -> Expr | None:
    """Return a whole number as a constant of a type; None if out of range or not a number type."""
    if type is FLOAT:
        try:
            number = float(value)
        except OverflowError:
            return None
        return Const(number, FLOAT) if abs(number) <= LARGEST_FLOAT else None
    matching = WHOLE_RANGES.get(type)
    return Const(value, type) if matching is not None and value in matching else None


TRUE, FALSE = Const(True, BOOL), Const(False, BOOL)
