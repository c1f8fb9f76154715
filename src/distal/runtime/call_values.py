"""Convert Python values to arguments of scene functions, and results to Python values.

Input: the arguments of a call of a ``@func``: numbers, vectors, lists, arrays of points. Output:
the types of an overload and arrays with one row per point; and the reverse. ``float_type`` says in
which precision a call computes. Does not depend on a device.
"""

from __future__ import annotations

import dataclasses
from collections import namedtuple
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from operator import itemgetter
from typing import Any, TypeVar, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, FunctionSignature, element_annotation
from distal.ir.types import (
    FLOAT,
    VEC2,
    VEC3,
    VEC4,
    Array,
    Buffer,
    FunctionType,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Texture,
    Type,
    Vector,
)
from distal.lang.values import VALUE_CLASSES, MatrixValue, VectorValue

# What holds numbers of Python, not an array of a type of its own.
_PLAIN = (int, float, list, tuple, VectorValue, MatrixValue)
_KINDS = {Kind.FLOAT: "fiub", Kind.INT: "iu", Kind.UINT: "iu", Kind.BOOL: "b"}


class Collected(tuple[Any, ...]):
    """The arguments that a parameter ``*values`` collects: each a value, or one per point."""

    __slots__ = ()


def collected(signature: FunctionSignature, args: Sequence[Any]) -> Sequence[Any]:
    """Return positional arguments with those that ``*values`` collects joined to one.

    Args:
        signature: The signature, for so many arguments (``FunctionSignature.collecting``).
        args: Values by position.
    """
    first = sum(p.positional for p in signature.parameters)
    if len(args) <= first or not any(p.collects for p in signature.parameters):
        return args
    return [*args[:first], Collected(args[first:])]


def bind(
    function: str, defaults: Mapping[str, Any], args: Sequence[Any], kwargs: Mapping[str, Any]
) -> list[Any]:
    """Return the value of each parameter in order, with defaults for missing arguments.

    Args:
        function: The name of the function, for messages.
        defaults: The defaults by name, in parameter order; ``MISSING`` if there is no default.
        args: Values by position.
        kwargs: Values by name.

    Raises:
        TypeError: The call does not match the signature; the message is worded like Python's.
    """
    if len(args) > len(defaults):
        raise TypeError(f"{function}() takes {len(defaults)} arguments but {len(args)} were given")
    given = dict(zip(defaults, args, strict=False))
    for name, value in kwargs.items():
        if name in given:
            raise TypeError(f"{function}() got multiple values for argument '{name}'")
        if name not in defaults:
            raise TypeError(f"{function}() got an unexpected keyword argument '{name}'")
        given[name] = value
    missing = [n for n, default in defaults.items() if n not in given and default is MISSING]
    if missing:
        raise TypeError(f"{function}() misses its arguments: {', '.join(missing)}")
    return [given.get(name, default) for name, default in defaults.items()]


def choose_types(
    header: FunctionSignature, values: Sequence[Any]
) -> tuple[tuple[Type, ...], list[Any]] | None:
    """Return parameter types that accept every value, and the converted values; else None.

    For a generic parameter, the types of its type variable are tried in order.

    Args:
        header: The signature of the function.
        values: One value per parameter.
    """
    variables: list[TypeVar] = []
    for slot in header.parameters:
        variable = element_annotation(slot)
        if isinstance(variable, TypeVar) and variable not in variables:
            variables.append(variable)
    constraints = [v.__constraints__ or (FLOAT, VEC2, VEC3, VEC4) for v in variables]
    for choice in product(*constraints):
        bindings = {v: to_type(c) for v, c in zip(variables, choice, strict=True)}
        try:
            types = tuple(to_type(s.annotation, bindings) for s in header.parameters)
        except (AnnotationError, UnboundVariableError):
            return None
        rows = rows_of(values, types)
        if rows is not None:
            return types, rows
    return None


def rows_of(values: Sequence[Any], types: Sequence[Type]) -> list[Any] | None:
    """Return the values converted by ``lanes``; None if a value does not have its type.

    Args:
        values: One value per type; each may also be an array of values.
        types: The types of the parameters.
    """
    try:
        dtype = float_type(values, types)
        return [lanes(v, t, dtype) for v, t in zip(values, types, strict=True)]
    except (TypeError, ValueError, OverflowError):
        return None


def lanes(value: Any, type: Type, dtype: np.dtype[Any]) -> Any:
    """Return the value as an array with a leading axis of points (length 1 for a single value).

    Shapes: scalars (n,), vectors (n, size), matrices (n, rows, columns), arrays (n, length, ...);
    a struct is a tuple of the arrays of its fields.

    Args:
        value: The Python value.
        type: Its type in scene code.
        dtype: The type of floats in the arrays.

    Raises:
        TypeError: The value does not have this type.
        OverflowError: An integer exceeds 32 bits.
    """
    match type:
        case Scalar(kind):
            return _numbers(value, (), kind, dtype)
        case Vector(kind, size):
            return _numbers(value, (size,), kind, dtype)
        case Matrix(size):
            if isinstance(value, MatrixValue):
                value = np.array([tuple(c) for c in value]).T
            return _numbers(value, (size, size), Kind.FLOAT, dtype)
        case Array(element, length):
            return _elements(value, element, length, dtype)
        case Struct(_, fields):
            if not dataclasses.is_dataclass(value) and not isinstance(value, tuple):
                raise TypeError(f"{value!r} is no {type}")
            parts = value if isinstance(value, tuple) else [getattr(value, n) for n, _ in fields]
            return tuple(lanes(v, t, dtype) for v, (_, t) in zip(parts, fields, strict=True))
        case Texture() | Buffer() | FunctionType():
            raise TypeError(f"only scene code passes {type}")
        case _:
            assert_never(type)


def float_type(values: Sequence[Any], types: Sequence[Type]) -> np.dtype[Any]:
    """Return the type in which a call computes: float32 arrays in, float32 out; everything else 64.

    It is float32 if floats come in float32 arrays, and in no array of another type. Beside such
    arrays, a number or a vector of Python is read as float32, as in NumPy; a list of values for
    several points has 64 bits. Arrays for ints and bools do not count.

    Args:
        values: One value per parameter.
        types: The types of the parameters.
    """
    found = {is_single for v, t in zip(values, types, strict=True) for is_single in _arrays(v, t)}
    return np.dtype(np.float32 if found == {True} else np.float64)


def _arrays(value: Any, type: Type) -> Iterator[bool]:
    """Yield for each array of floats in a value whether it is of 32 bits."""
    match type:
        case Struct(_, fields):
            parts = value if isinstance(value, tuple) else [getattr(value, n, 0) for n, _ in fields]
            for part, (_, of_part) in zip(parts, fields, strict=True):
                yield from _arrays(part, of_part)
        case Array(element) if _is_of_values(value, element):
            for part in value:
                yield from _arrays(part, element)
        case Scalar(kind) | Vector(kind) | Array(Scalar(kind) | Vector(kind)):
            if kind is Kind.FLOAT:
                yield from _array(value, type)
        case _:
            yield from _array(value, type)


def _array(value: Any, type: Type) -> Iterator[bool]:
    if isinstance(value, np.generic) or not isinstance(value, _PLAIN):
        dtype = np.asarray(value).dtype
        yield dtype.kind == "f" and dtype.itemsize == 4
    elif is_many(value, type):
        yield False


def _numbers(value: Any, shape: tuple[int, ...], kind: Kind, dtype: np.dtype[Any]) -> NDArray[Any]:
    if not shape and isinstance(value, tuple | VectorValue):
        # As in scene code, a tuple is a vector; numbers for several points are a list or an array.
        raise TypeError(f"{value!r} is a vector")
    if isinstance(value, VectorValue):
        value = tuple(value)
    if isinstance(value, list) and not value:  # no points
        return np.empty((0, *shape), _dtype(kind, dtype))
    array = np.asarray(value)
    if array.dtype.kind not in _KINDS[kind]:
        raise TypeError(f"{array.dtype} is not {kind.value}")
    if array.dtype.kind == "b" and kind is not Kind.BOOL:
        raise TypeError(f"a bool is not {kind.value}")
    if array.shape == shape:
        array = array[None]
    elif array.shape[1:] != shape or array.ndim != len(shape) + 1:
        raise TypeError(f"shape {array.shape} is not {shape} or (n, *{shape})")
    return _converted(array, kind, dtype)


def _converted(array: NDArray[Any], kind: Kind, dtype: np.dtype[Any]) -> NDArray[Any]:
    match kind:
        case Kind.FLOAT:
            return np.ascontiguousarray(array, dtype)
        case Kind.BOOL:
            return np.ascontiguousarray(array)
        case Kind.INT | Kind.UINT:
            wanted = np.dtype(np.int32 if kind is Kind.INT else np.uint32)
            if array.size:
                limits = np.iinfo(wanted)
                if array.min() < limits.min or array.max() > limits.max:
                    raise OverflowError(f"a value does not fit {kind.value}")
            return np.ascontiguousarray(array, wanted)
        case _:
            assert_never(kind)


def _is_of_values(value: Any, element: Type) -> bool:
    """Return whether an array of scene code is given as one value for each element."""
    return isinstance(value, Collected) or not isinstance(element, Scalar | Vector)


def _elements(value: Any, element: Type, length: int, dtype: np.dtype[Any]) -> Any:
    if not _is_of_values(value, element):
        assert isinstance(element, Scalar | Vector)
        shape = (length,) if isinstance(element, Scalar) else (length, element.size)
        if isinstance(value, list | tuple):
            value = [tuple(v) if isinstance(v, VectorValue) else v for v in value]
        return _numbers(value, shape, element.kind, dtype)
    if not isinstance(value, list | tuple) or len(value) != length:
        raise TypeError(f"not {length} values")
    elements = [lanes(v, element, dtype) for v in value]
    return _stacked(elements, count(elements) or 1)


def _stacked(elements: Sequence[Any], points: int) -> Any:
    """Stack elements along a new second axis; for structs, each field separately."""
    if isinstance(elements[0], tuple):
        return tuple(_stacked(field, points) for field in zip(*elements, strict=True))
    shape = (points, *elements[0].shape[1:])
    return np.stack([np.broadcast_to(e, shape) for e in elements], axis=1)


def _element(result: Any, position: int) -> Any:
    """Return one element of an array value, for all points."""
    if isinstance(result, tuple):
        return tuple(_element(part, position) for part in result)
    return result[:, position]


def count(values: Sequence[Any]) -> int | None:
    """Return the number of points of the arguments; None if each argument has a single value.

    Raises:
        ValueError: Two arguments have different numbers of points.
    """
    sizes = {leaf.shape[0] for value in values for leaf in leaves(value)} - {1}
    if len(sizes) > 1:
        listed = " and ".join(map(str, sorted(sizes)))
        raise ValueError(f"the arguments have different numbers of points: {listed}")
    return sizes.pop() if sizes else None


def leaves(value: Any) -> list[NDArray[Any]]:
    """Return the arrays that a value consists of."""
    if isinstance(value, tuple):
        return [leaf for part in value for leaf in leaves(part)]
    return [value]


def is_many(value: Any, type: Type) -> bool:
    """Return whether the caller passed one value per point (even if there is one point only)."""
    match type:
        case Scalar():
            return _depth(value) == 1
        case Vector():
            return not isinstance(value, VectorValue) and _depth(value) == 2
        case Matrix():
            return not isinstance(value, MatrixValue) and _depth(value) == 3
        case Struct(_, fields):
            if isinstance(value, tuple):
                parts = list(value)
            else:
                parts = [getattr(value, n) for n, _ in fields]
            return any(is_many(v, t) for v, (_, t) in zip(parts, fields, strict=True))
        case Array(element, _) if isinstance(value, Collected):
            return any(is_many(v, element) for v in value)
        case Array(Scalar() | Vector() as element, _):
            return _depth(value) == (2 if isinstance(element, Scalar) else 3)
        case Array(element, _):
            return any(is_many(v, element) for v in value)
        case _:
            return False


def _depth(value: Any) -> int:
    """Return the number of axes of a value, without a look at all parts of a list."""
    depth = 0
    while isinstance(value, list | tuple | VectorValue) and len(value):
        value, depth = value[0], depth + 1
    return depth + int(np.ndim(value))


def single(result: Any, type: Type) -> Any:
    """Return the result for a single point as a plain Python value."""
    match type:
        case Scalar():
            return result[0].item()
        case Vector():
            return VALUE_CLASSES[type](*result[0].tolist())
        case Matrix():
            return VALUE_CLASSES[type](
                *(VALUE_CLASSES[Vector(Kind.FLOAT, type.size)](*c) for c in result[0].T.tolist())
            )
        case Struct(_, fields):
            return with_names(
                tuple(single(r, t) for r, (_, t) in zip(result, fields, strict=True)), type
            )
        case Array(element, length):
            return [single(_element(result, i), element) for i in range(length)]
        case _:
            raise AssertionError(f"{type} is no result")


def with_names(result: Any, type: Type) -> Any:
    """Return a struct's values as a named tuple; return any other value unchanged."""
    if not isinstance(type, Struct) or type.is_tuple:
        return result
    names = [name for name, _ in type.fields]
    # A field may be called _x in scene code, but not in a namedtuple: add it as a property.
    named = namedtuple(type.name, names, rename=True)  # type: ignore[misc]  # a name made here
    for position, name in enumerate(names):
        if name not in named._fields:
            setattr(named, name, property(itemgetter(position)))
    return named(*result)


def empty(type: Type, dtype: np.dtype[Any]) -> Any:
    """Return the result for zero points."""
    match type:
        case Scalar(kind):
            return np.empty(0, _dtype(kind, dtype))
        case Vector(kind, size):
            return np.empty((0, size), _dtype(kind, dtype))
        case Matrix(size):
            return np.empty((0, size, size), dtype)
        case Array(element, length):
            return _stacked([empty(element, dtype)] * length, 0)
        case Struct(_, fields):
            return tuple(empty(t, dtype) for _, t in fields)
        case _:
            raise AssertionError(f"{type} is no result")


def _dtype(kind: Kind, dtype: np.dtype[Any]) -> np.dtype[Any]:
    plain = {Kind.INT: np.int32, Kind.UINT: np.uint32, Kind.BOOL: np.bool_}
    return dtype if kind is Kind.FLOAT else np.dtype(plain[kind])
