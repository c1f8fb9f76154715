"""Bringing a value to a type: literals take the type that is wanted, nothing else is converted.

``fit`` gives an expression of exactly the wanted type or None; ``settle`` gives the type a value
has alone. A number is never turned into another kind, and a scalar never widened, except where a
rule of an operator or a built-in says so.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence

from distal.frontend.lowering.body import Body
from distal.frontend.objects import kind_of_object
from distal.frontend.problems import SceneError
from distal.frontend.values import Closure, Display, Static, Value, Whole, describe, whole_to
from distal.ir.nodes import Compose, Const, Construct, Expr
from distal.ir.types import (
    FLOAT,
    INT,
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
from distal.lang.functions import Func
from distal.lang.names import LangForm, LangFunction


def is_callable(value: Value) -> bool:
    """Whether a value may be a function for a parameter that takes one."""
    match value:
        case Closure():
            return True
        case Static(obj):
            return isinstance(obj, Func | LangFunction)
        case Whole() | Display():
            return False
        case _:
            return isinstance(value.type, FunctionType)


def fit(body: Body, value: Value, type: Type, node: ast.expr | ast.stmt) -> Expr | None:
    """The value as an expression of exactly ``type``; None where it is of another."""
    match value:
        case Whole(number):
            return _fit_whole(body, number, type, node)
        case Display(items, is_list, captured):
            return _fit_display(body, items, type, node, vectors=captured or not is_list)
        case Static() | Closure():
            if isinstance(type, FunctionType) and is_callable(value):
                return body.program.function_value(body, value, type, node)
            return None
        case _:
            return value if value.type is type else None


def _fit_whole(body: Body, number: int, type: Type, node: ast.expr | ast.stmt) -> Expr | None:
    if not isinstance(type, Scalar) or type.kind is Kind.BOOL:
        return None
    fitted = whole_to(number, type)
    if fitted is None:
        raise body.problem(f"{_shown(number)} is out of the range of {type}", node)
    return fitted


def _shown(number: int) -> str:
    text = str(number) if abs(number) < 10**30 else "the number"
    return text


def _fit_display(
    body: Body, items: Sequence[Value], type: Type, node: ast.expr | ast.stmt, *, vectors: bool
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
    parts = [fit(body, item, t, node) for item, t in zip(items, wanted, strict=True)]
    known = tuple(p for p in parts if p is not None)
    if len(known) < len(parts):
        return None
    return Compose(known, type) if isinstance(type, Vector) else Construct(known, type)


def vector_type(value: Value) -> Type | None:
    """The vector that a captured list or a tuple of 2 to 4 numbers may stand for."""
    if not isinstance(value, Display) or not 2 <= len(value.items) <= 4:
        return None
    if value.is_list and not value.captured:
        return None
    kinds = {Kind.INT if isinstance(i, Whole) else _scalar_kind(i) for i in value.items}
    if kinds <= {Kind.INT, Kind.FLOAT}:
        return Vector(Kind.FLOAT, len(value.items))
    return None


def _scalar_kind(value: Value) -> Kind | None:
    type = natural_type(value)
    return type.kind if isinstance(type, Scalar) else None


def natural_type(value: Value) -> Type | None:
    """The type a value has alone; None for what is no value or does not know yet."""
    match value:
        case Whole():
            return INT
        case Display(items, is_list, captured):
            types = [natural_type(i) for i in items]
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
    """The one element type: whole-number literals join floats."""
    firm = {t for i, t in zip(items, types, strict=True) if not isinstance(i, Whole)}
    if not firm:
        return INT
    if len(firm) == 1:
        (element,) = firm
        if all(not isinstance(i, Whole) for i in items) or isinstance(element, Scalar):
            return element
    return None


def settle(body: Body, value: Value, node: ast.expr | ast.stmt) -> Expr:
    """The value with the type it has alone."""
    match value:
        case Static(obj, text):
            raise not_a_value(body, obj, text, node)
        case Closure(_, _, name):
            hint = "call it, or pass it to a function that takes one"
            raise body.problem(f"the function '{name}' is not a value", node, hint)
        case Whole() | Display():
            type = natural_type(value)
            fitted = None if type is None else fit(body, value, type, node)
            if fitted is None:
                raise _mixed_display(body, value, node)
            return fitted
        case _:
            return value


def not_a_value(body: Body, obj: object, text: str, node: ast.expr | ast.stmt) -> SceneError:
    """The mistake of using a function, a type or a module as a value."""
    hint = None
    if isinstance(obj, Func | LangFunction | LangForm):
        hint = f"call it: {text}(...)"
    return body.problem(f"'{text}' is {_kind(obj)}, not a value", node, hint)


def _kind(obj: object) -> str:
    if isinstance(obj, LangFunction | LangForm):
        return "a built-in function"
    return kind_of_object(obj)


def _mixed_display(body: Body, value: Value, node: ast.expr | ast.stmt) -> SceneError:
    assert isinstance(value, Display)
    for item in value.items:
        if isinstance(item, Static | Closure):
            return body.problem(f"{describe(item)} is not a value", node)
    kinds = list(dict.fromkeys(describe(i) for i in value.items))
    return body.problem(f"the elements of an array have one type, not {' and '.join(kinds)}", node)


def fit_or_refuse(
    body: Body, value: Value, type: Type, node: ast.expr | ast.stmt, what: str
) -> Expr:
    """The value as ``type``; otherwise the mistake ``what is type, not …``."""
    fitted = fit(body, value, type, node)
    if fitted is not None:
        return fitted
    if isinstance(type, FunctionType) and is_callable(value):
        raise body.problem(
            f"{what} is {type}, not {shown_type(value)}", node, callable_hint(body, value)
        )
    if isinstance(value, Static):
        raise not_a_value(body, value.object, value.text, node)
    raise body.problem(
        f"{what} is {type}, not {shown_type(value)}", node, conversion_hint(value, type)
    )


def callable_hint(body: Body, value: Value) -> str | None:
    """What a function takes, where another one is wanted."""
    match value:
        case Static(Func() as function):
            return " or ".join(body.program.signature(o) for o in function.overloads)
        case _:
            return None


def shown_type(value: Value) -> str:
    """The type of a value, or what it is."""
    if isinstance(value, Display):
        natural = natural_type(value)
        return describe(value) if natural is None else str(natural)
    return describe(value)


def conversion_hint(value: Value, wanted: Type) -> str | None:
    """How to turn a value into the wanted type, where there is a natural way."""
    given = natural_type(value)
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


def unify(body: Body, values: Sequence[Value], node: ast.expr, what: str) -> tuple[Expr, ...]:
    """All values as one type: literals take the type of the others, nothing is widened."""
    firm = [v for v in values if not isinstance(v, Whole)]
    types = list(dict.fromkeys(natural_type(v) for v in firm))
    if not firm:
        return tuple(settle(body, v, node) for v in values)
    if len(types) == 1 and types[0] is not None:
        wanted = types[0]
        fitted = [fit(body, v, wanted, node) for v in values]
        known = tuple(f for f in fitted if f is not None)
        if len(known) == len(values):
            return known
    for value in values:
        if isinstance(value, Static | Closure):
            settle(body, value, node)
    kinds = " and ".join(dict.fromkeys(shown_type(v) for v in values))
    hint = _unify_hint(values)
    raise body.problem(f"{what} {kinds}", node, hint)


def _unify_hint(values: Sequence[Value]) -> str | None:
    vectors = [t for v in values if isinstance(t := natural_type(v), Vector)]
    scalars = [v for v in values if isinstance(natural_type(v), Scalar)]
    if len(set(vectors)) == 1 and scalars:
        return f"write {vectors[0]}(...) around the {natural_type(scalars[0])}"
    types = {natural_type(v) for v in values}
    return "write float(...) around the int" if types == {INT, FLOAT} else None


def constant_int(value: Value) -> int | None:
    """A whole number known now, or None."""
    match value:
        case Whole(number):
            return number
        case Const(number, type) if type is INT:
            return int(number)
        case _:
            return None
