"""What an expression of the author's can be before it has a type of the IR.

Most are plain ``ir.nodes`` expressions. A whole-number literal still takes the other side's type;
a display ``[a, b]`` or ``(a, b)`` becomes an array, a tuple or a vector where it is used; a
function, type or module is there at compile time only.
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
LARGEST_ARRAY = 1 << 16  # components; more belong into a Buffer
WHOLE_RANGES: dict[Type, range] = {INT: range(-(2**31), 2**31), UINT: range(2**32)}


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number known now: a literal, or a captured int. Alone it is an int."""

    value: int


@dataclass(frozen=True, slots=True)
class SequenceValue:
    """``[a, b]`` or ``(a, b)``, or a captured list or tuple; ``is_list`` makes it an array."""

    items: tuple[Value, ...]
    is_list: bool
    captured: bool = False


@dataclass(frozen=True, slots=True)
class Static:
    """A Python object that is no value: a function, a type, a module."""

    object: Any
    text: str


@dataclass(eq=False, slots=True)
class Closure:
    """A lambda or a nested ``def``: lifted to a module function when it is used.

    Attributes:
        node: Its syntax.
        owner: The function body that contains it and has the names it captures.
        name: What the lifted function is called.
        defaults: Values of parameters that have one, by name.
        instances: The lifted functions by argument types.
    """

    node: ast.Lambda | ast.FunctionDef
    owner: FunctionBody
    name: str
    defaults: dict[str, Value] = field(default_factory=dict)
    instances: dict[tuple[Type | None, ...], Any] = field(default_factory=dict)


Value: TypeAlias = "Expr | Whole | SequenceValue | Static | Closure"


def describe(value: Value) -> str:
    """A value's type in the author's words."""
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
    """The constant of a scalar type, or None where it is out of range or no number."""
    if type is FLOAT:
        try:
            number = float(value)
        except OverflowError:
            return None
        return Const(number, FLOAT) if abs(number) <= LARGEST_FLOAT else None
    matching = WHOLE_RANGES.get(type)
    return Const(value, type) if matching is not None and value in matching else None


TRUE, FALSE = Const(True, BOOL), Const(False, BOOL)
