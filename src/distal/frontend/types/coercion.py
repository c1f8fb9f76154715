"""Coerce values to types: literals take the required type, other values are not converted.

``coerce`` returns an expression of exactly the required type, or None. ``with_default_type``
returns the value with its default type. A number never changes its kind, and a scalar is never
widened, except by the rules of operators and built-ins.
"""

from __future__ import annotations

from collections.abc import Sequence

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import SceneError, must_be, must_match
from distal.frontend.source import Node
from distal.frontend.types.python_objects import kind_of_object
from distal.frontend.values import Closure, SequenceValue, Static, Value, Whole, describe, whole_to
from distal.ir.constant_arithmetic import wrap
from distal.ir.nodes import Compose, Const, Construct, Expr
from distal.ir.types import (
    FLOAT,
    INT,
    TEXTURE_2D,
    Array,
    FunctionType,
    Kind,
    Scalar,
    Struct,
    Type,
    Vector,
    is_static,
    tuple_type,
)
from distal.lang.functions import Func, Image
from distal.lang.names import LangForm, LangFunction


def is_callable(value: Value) -> bool:
    """Return whether a value can be passed to a parameter that is a function."""
    match value:
        case Closure():
            return True
        case Static(obj):
            return isinstance(obj, Func | LangFunction)
        case Whole() | SequenceValue():
            return False
        case _:
            return isinstance(value.type, FunctionType)


def coerce(body: FunctionBody, value: Value, type: Type, node: Node) -> Expr | None:
    """Return the value as an expression of exactly ``type``; None if it has another type.

    Args:
        body: The function being lowered.
        value: The value.
        type: The required type.
        node: The node, for errors.

    Raises:
        SceneError: A whole number is out of the range of the type.
    """
    match value:
        case Whole():
            return _coerce_whole(body, value, type, node)
        case SequenceValue(items, is_list, captured):
            return _coerce_sequence(body, items, type, node, vectors=captured or not is_list)
        case Static() | Closure():
            if isinstance(type, FunctionType) and is_callable(value):
                return body.compilation.function_value(body, value, type, node)
            return last_frame(body, value) if type is TEXTURE_2D else None
        case _:
            return value if value.type is type else None


def last_frame(body: FunctionBody, value: Value) -> Expr | None:
    """Return the texture of the latest picture of an image that scene code names, or None."""
    if not isinstance(value, Static) or not isinstance(value.object, Image):
        return None
    texture = value.object.last_frame
    return body.compilation.resource(texture, value.text, texture.__distal_type__)


def _coerce_whole(body: FunctionBody, value: Whole, type: Type, node: Node) -> Expr | None:
    if not isinstance(type, Scalar) or type.kind is Kind.BOOL:
        return None
    number = value.value
    if value.computed and type.kind is not Kind.FLOAT:
        number = wrap(number, type.kind)
    coerced = whole_to(number, type)
    if coerced is None:
        raise body.problem(
            ErrorCode.NUMBER, f"{_shown(number)} is out of the range of {type}", node
        )
    return coerced


def _shown(number: int) -> str:
    text = str(number) if abs(number) < 10**30 else "the number"
    return text


def _coerce_sequence(
    body: FunctionBody,
    items: Sequence[Value],
    type: Type,
    node: Node,
    *,
    vectors: bool,
) -> Expr | None:
    match type:
        case Array(element, length):
            wanted: tuple[Type, ...] = (element,) * length
        case Struct(_, fields, is_tuple) if is_tuple:
            wanted = tuple(t for _, t in fields)
        case Vector(kind, size) if vectors:
            wanted = (Scalar(kind),) * size
        case _:
            return None
    if len(wanted) != len(items):
        return None
    parts = [coerce(body, item, t, node) for item, t in zip(items, wanted, strict=True)]
    known = tuple(p for p in parts if p is not None)
    if len(known) < len(parts):
        return None
    return Compose(known, type) if isinstance(type, Vector) else Construct(known, type)


def vector_type(value: Value) -> Type | None:
    """Return the vector type that a captured list or a tuple of 2 to 4 numbers can become.

    None for other values.
    """
    if not isinstance(value, SequenceValue) or not 2 <= len(value.items) <= 4:
        return None
    if value.is_list and not value.captured:
        return None
    kinds = {Kind.INT if isinstance(i, Whole) else _scalar_kind(i) for i in value.items}
    if kinds <= {Kind.INT, Kind.FLOAT}:
        return Vector(Kind.FLOAT, len(value.items))
    return None


def _scalar_kind(value: Value) -> Kind | None:
    type = default_type(value)
    return type.kind if isinstance(type, Scalar) else None


def default_type(value: Value) -> Type | None:
    """Return the default type of a value; None if it is not a value or has no single type."""
    match value:
        case Whole():
            return INT
        case SequenceValue(items, is_list, captured):
            types = [default_type(i) for i in items]
            if any(t is None for t in types):
                return None
            known = [t for t in types if t is not None]
            if not is_list and not captured:
                return tuple_type(tuple(known))
            element = _common(items, known)
            return None if element is None else Array(element, len(items))
        case Static() | Closure():
            return None
        case _:
            return value.type


def _common(items: Sequence[Value], types: Sequence[Type]) -> Type | None:
    """Return the common element type, or None; whole-number literals take the others' type."""
    concrete = {t for i, t in zip(items, types, strict=True) if not isinstance(i, Whole)}
    if not concrete:
        return INT
    if len(concrete) == 1:
        (element,) = concrete
        if all(not isinstance(i, Whole) for i in items) or isinstance(element, Scalar):
            return element
    return None


def with_default_type(body: FunctionBody, value: Value, node: Node) -> Expr:
    """Return the value with its default type.

    Args:
        body: The function being lowered.
        value: The value.
        node: The node, for errors.

    Raises:
        SceneError: It is not a value, or a list whose elements have different types.
    """
    match value:
        case Static(obj, text):
            raise not_a_value(body, obj, text, node)
        case Closure(_, _, name):
            hint = "call it, or pass it to a function that takes one"
            raise body.problem(ErrorCode.VALUE, f"the function '{name}' is not a value", node, hint)
        case Whole() | SequenceValue():
            type = default_type(value)
            coerced = None if type is None else coerce(body, value, type, node)
            if coerced is None:
                raise _mixed_sequence(body, value, node)
            return coerced
        case _:
            return value


def not_a_value(body: FunctionBody, obj: object, text: str, node: Node) -> SceneError:
    """Return the error for a function, type or module that is used as a value.

    Args:
        body: The function being lowered.
        obj: The object.
        text: Its name in the source.
        node: The node that the error points at.
    """
    hint = None
    if isinstance(obj, Func | LangFunction | LangForm):
        hint = f"call it: {text}(...)"
    return body.problem(ErrorCode.VALUE, f"'{text}' is {_kind(obj)}, not a value", node, hint)


def _kind(obj: object) -> str:
    if isinstance(obj, LangFunction | LangForm):
        return "a built-in function"
    return kind_of_object(obj)


def _mixed_sequence(body: FunctionBody, value: Value, node: Node) -> SceneError:
    assert isinstance(value, SequenceValue)
    for item in value.items:
        if isinstance(item, Static | Closure):
            return body.problem(ErrorCode.VALUE, f"{describe(item)} is not a value", node)
    kinds = list(dict.fromkeys(describe(i) for i in value.items))
    return body.problem(ErrorCode.TYPE, must_match("the elements of an array", kinds), node)


def coerce_or_raise(body: FunctionBody, value: Value, type: Type, node: Node, what: str) -> Expr:
    """Return the value as an expression of exactly ``type``.

    Args:
        body: The function being lowered.
        value: The value.
        type: The required type.
        node: The node that the error points at.
        what: The subject of the message "``what`` must be ``type``, but this is …".

    Raises:
        SceneError: The value has another type.
    """
    coerced = coerce(body, value, type, node)
    if coerced is not None:
        return coerced
    raise wrong_type(body, value, type, node, what)


def wrong_type(body: FunctionBody, value: Value, type: Type, node: Node, what: str) -> SceneError:
    """Return the error for a value of the wrong type; arguments as for ``coerce_or_raise``."""
    if isinstance(value, Static) and not (isinstance(type, FunctionType) and is_callable(value)):
        return not_a_value(body, value.object, value.text, node)
    hint = conversion_hint(value, type) or callable_hint(body, value)
    return body.problem(ErrorCode.TYPE, must_be(what, type, shown_type(value)), node, hint)


def callable_hint(body: FunctionBody, value: Value) -> str | None:
    """Return a hint with the signatures of a scene function; None for other values."""
    match value:
        case Static(Func() as function):
            return " or ".join(body.compilation.signature_text(o) for o in function.overloads)
        case _:
            return None


def shown_type(value: Value) -> str:
    """Return the type of a value for messages, or a description if it has no type."""
    if isinstance(value, SequenceValue):
        default = default_type(value)
        return describe(value) if default is None else str(default)
    return describe(value)


def conversion_hint(value: Value, wanted: Type) -> str | None:
    """Return a hint how to convert a value to the wanted type; None if there is no obvious way."""
    given = default_type(value)
    if given is None or is_static(given) or is_static(wanted):
        return None
    match given, wanted:
        case (Scalar(), Scalar()):
            if given is INT and wanted is FLOAT:
                return "write float(...) around it"
            return f"write {wanted}(...) around it"
        case (Scalar(a), Vector(b)) if a is b or isinstance(value, Whole):
            return f"write {wanted}(...) to repeat it in every component"
        case (Vector(_, n), Vector(_, m)):
            if n == m:
                return f"write {wanted}(...) around it"
            return "pick components, such as .xy" if n > m else f"write {wanted}(v, ...)"
        case (Vector(), Scalar()):
            return "pick a component, such as .x"
        case _:
            return None


def constant_int(value: Value) -> int | None:
    """Return the value of a whole number that is known at compile time, or None."""
    match value:
        case Whole(number):
            return number
        case Const(number, type) if type is INT:
            return int(number)
        case _:
            return None
