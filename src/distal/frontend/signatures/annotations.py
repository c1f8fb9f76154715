"""Convert an evaluated annotation (a Python object) to an IR type.

Type variables are looked up in the bindings of the call. Does not depend on syntax: the caller
evaluates names and texts in the function's namespace.
"""

from __future__ import annotations

import collections.abc
import dataclasses
import threading
import typing
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypeAlias, TypeVar

from distal.frontend.problems import one_of
from distal.frontend.values import LARGEST_ARRAY
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    UINT,
    Array,
    Buffer,
    FunctionType,
    Matrix,
    Scalar,
    Struct,
    Texture,
    Type,
    Vector,
    is_static,
    tuple_type,
)
from distal.lang.annotations import ArrayAnnotation
from distal.lang.resources import BufferAnnotation
from distal.lang.structs import METHODS, StructNames

Bindings: TypeAlias = Mapping[TypeVar, Type]
NO_BINDINGS: Bindings = {}

_PYTHON_TYPES: dict[object, Type] = {float: FLOAT, int: INT, bool: BOOL}


class AnnotationError(Exception):
    """An annotation is not a type of scene code; the message says why."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


class UnboundVariableError(Exception):
    """A type variable has no binding in this call."""

    def __init__(self, variable: TypeVar) -> None:
        super().__init__(variable.__name__)
        self.variable = variable


def to_type(annotation: Any, bindings: Bindings = NO_BINDINGS) -> Type:
    """Return the IR type of an evaluated annotation.

    Raises:
        AnnotationError: It is not a type of scene code.
        UnboundVariableError: It contains a type variable that has no binding.
    """
    if isinstance(annotation, type):
        found = _class_type(annotation)
        if found is not None:
            return found
    match annotation:
        case Scalar() | Vector() | Matrix() | Struct() | Array() | Texture() | Buffer():
            return annotation
        case FunctionType():
            return annotation
        case ArrayAnnotation(element, length):
            return _array(to_type(element, bindings), length)
        case BufferAnnotation(element):
            return _buffer(to_type(element, bindings))
        case TypeVar():
            if annotation not in bindings:
                raise UnboundVariableError(annotation)
            return bindings[annotation]
    return _generic(annotation, bindings)


def _class_type(cls: type) -> Type | None:
    if cls in _PYTHON_TYPES:
        return _PYTHON_TYPES[cls]
    if "__distal_struct__" in vars(cls):
        return struct_type(cls)
    found = getattr(cls, "__distal_type__", None)
    return typing.cast("Type | None", found)


def _generic(annotation: Any, bindings: Bindings) -> Type:
    arguments = typing.get_args(annotation)
    match typing.get_origin(annotation):
        case collections.abc.Callable if len(arguments) == 2 and isinstance(arguments[0], list):
            params = tuple(to_type(a, bindings) for a in arguments[0])
            return FunctionType(params, to_type(arguments[1], bindings))
        case origin if origin is tuple and arguments and Ellipsis not in arguments:
            items = tuple(to_type(a, bindings) for a in arguments)
            if any(is_static(i) for i in items):
                raise AnnotationError("a tuple holds values only")
            return tuple_type(items)
    name = getattr(annotation, "__name__", None) or repr(annotation)
    if annotation is tuple or annotation is list:
        raise AnnotationError(
            f"'{name}' does not say what it holds", "write tuple[float, vec3], or array[float, 4]"
        )
    if name in ("Callable", "collections.abc.Callable", "typing.Callable"):
        raise AnnotationError(
            "'Callable' does not say what it takes", "write Callable[[vec3], float]"
        )
    if name == "Buffer":
        raise AnnotationError("'Buffer' does not say what it holds", "write Buffer[float]")
    raise AnnotationError(f"'{name}' is not a type of scene code")


def _array(element: Type, length: Any) -> Type:
    if typing.get_origin(length) is typing.Literal:
        # Type checkers require the length as Literal[4].
        (length,) = typing.get_args(length)[:1]
    if isinstance(length, bool) or not isinstance(length, int):
        raise AnnotationError("the length of an array is a whole number known now")
    if not 1 <= length <= LARGEST_ARRAY:
        raise AnnotationError(f"the length of an array lies between 1 and {LARGEST_ARRAY}")
    if is_static(element):
        raise AnnotationError(f"an array cannot hold {element}")
    return Array(element, int(length))


def _buffer(element: Type) -> Type:
    match element:
        case Scalar() if element in (FLOAT, INT, UINT):
            return Buffer(element)
        case Vector(kind) if Scalar(kind) is FLOAT:
            return Buffer(element)
        case _:
            raise AnnotationError(
                f"a Buffer cannot hold {element}", "it holds float, int, uint, vec2, vec3 or vec4"
            )


def evaluate(text: str, names: Mapping[str, Any], module: Mapping[str, Any]) -> Any:
    """Evaluate an annotation given as text.

    Args:
        text: The annotation.
        names: The names of the enclosing scopes, looked up first.
        module: The names of the module.

    Raises:
        AnnotationError: The evaluation fails.
    """
    try:
        return eval(text, dict(module), names)
    except Exception as error:
        raise AnnotationError(f"'{text}' is not a type of scene code ({error})") from None


class _InProgress(threading.local):
    """The structs whose fields this thread reads, outermost first."""

    def __init__(self) -> None:
        self.structs: list[type] = []


_IN_PROGRESS = _InProgress()


def struct_type(cls: type) -> Struct:
    """Return the IR type of a ``@struct`` class.

    Raises:
        AnnotationError: A field has no valid type, or the struct is empty or contains itself.
    """
    known = vars(cls).get("__distal_struct_type__")
    if isinstance(known, Struct):
        return known
    in_progress = _IN_PROGRESS.structs
    if cls in in_progress:
        raise AnnotationError(f"the struct '{cls.__name__}' contains itself")
    names: StructNames = vars(cls)["__distal_struct__"]
    in_progress.append(cls)
    try:
        fields = tuple(_field(cls, f, names) for f in dataclasses.fields(cls))
    finally:
        in_progress.pop()
    if not fields:
        raise AnnotationError(f"the struct '{cls.__name__}' has no fields")
    owner = cls if METHODS in vars(cls) else None
    made = Struct(cls.__name__, fields, False, owner)
    cls.__distal_struct_type__ = made  # type: ignore[attr-defined]
    return made


def _field(cls: type, field: dataclasses.Field[Any], names: StructNames) -> tuple[str, Type]:
    annotation = field.type
    if isinstance(annotation, str):
        annotation = evaluate(annotation, names.enclosing, names.module)
    where = f"field '{field.name}' of '{cls.__name__}'"
    try:
        found = to_type(annotation)
    except UnboundVariableError:
        raise AnnotationError(f"{where} has no type") from None
    except AnnotationError as error:
        raise AnnotationError(f"{where}: {error.message}", error.hint) from None
    if is_static(found):
        raise AnnotationError(f"{where} cannot be {found}")
    return field.name, found


def struct_defaults(cls: type) -> dict[str, Callable[[], Any]]:
    """Return a function that makes the default, for each field that has one."""
    defaults: dict[str, Callable[[], Any]] = {}
    for field in dataclasses.fields(cls):
        if field.default is not dataclasses.MISSING:
            defaults[field.name] = partial(_same, field.default)
        elif field.default_factory is not dataclasses.MISSING:
            defaults[field.name] = field.default_factory
    return defaults


def _same(value: Any) -> Any:
    return value


def admits(variable: TypeVar, type: Type) -> bool:
    """Return whether a type variable can be bound to a type."""
    allowed = variable.__constraints__ or (variable.__bound__ and (variable.__bound__,)) or ()
    return not is_static(type) and (not allowed or any(to_type(a) is type for a in allowed))


def choices(variable: TypeVar) -> str:
    """Return the types that a type variable can be bound to, as text for a message."""
    return one_of(str(to_type(a)) for a in variable.__constraints__)
