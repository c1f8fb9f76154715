"""Lower constructor calls: ``vec3(...)``, ``int(x)``, ``mat2(...)``, structs."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import did_you_mean, must_be
from distal.frontend.signatures.annotations import AnnotationError, struct_defaults, struct_type
from distal.frontend.types.coercion import (
    coerce,
    coerce_or_raise,
    default_type,
    shown_type,
    with_default_type,
)
from distal.frontend.types.python_objects import RefusedError, value_of
from distal.frontend.values import LARGEST_ARRAY, Closure, SequenceValue, Static, Value, Whole
from distal.ir.build import cast, integer, number, splat
from distal.ir.constant_arithmetic import wrap
from distal.ir.nodes import Compose, Const, Construct, Expr, Index
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    UINT,
    Array,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Type,
    Vector,
    component_count,
    vector_of,
)


def construct(body: FunctionBody, type: Type, args: Sequence[Value], node: ast.Call) -> Value:
    """Return a scalar, vector or matrix made from ``args``.

    Args:
        body: The function being lowered.
        type: The type to make.
        args: The lowered arguments.
        node: The call.

    Raises:
        SceneError: The type cannot be made from these arguments.
    """
    if node.keywords:
        message = f"'{type}' takes no keyword arguments"
        raise body.problem(ErrorCode.CALL, message, node.keywords[0])
    for arg in args:
        if isinstance(arg, Static | Closure):
            with_default_type(body, arg, node)
    match type:
        case Scalar(kind):
            return _scalar(body, kind, args, node)
        case Vector():
            return _vector(body, type, args, node)
        case Matrix():
            return _matrix(body, type, args, node)
        case _:
            raise body.problem(ErrorCode.LANGUAGE, f"{type} is not made by a call", node)


def _scalar(body: FunctionBody, kind: Kind, args: Sequence[Value], node: ast.Call) -> Value:
    type = Scalar(kind)
    if len(args) != 1:
        raise body.problem(ErrorCode.CALL, f"'{type}' takes 1 argument, got {len(args)}", node)
    (arg,) = args
    if isinstance(arg, Whole):
        wraps = arg.computed and kind in (Kind.INT, Kind.UINT)
        return _literal(body, wrap(arg.value, kind) if wraps else arg.value, type, node)
    value = with_default_type(body, arg, node)
    if not isinstance(value.type, Scalar):
        hint = None
        if isinstance(value.type, Vector):
            hint = f"pick a component, such as .x, or write {vector_of(kind, value.type.size)}(...)"
        message = must_be(f"the argument of '{type}'", "a number or a bool", value.type)
        raise body.problem(ErrorCode.TYPE, message, node, hint)
    return cast(value, kind)


def _literal(body: FunctionBody, value: int, type: Scalar, node: ast.Call) -> Expr:
    match type.kind:
        case Kind.BOOL:
            return Const(value != 0, BOOL)
        case Kind.FLOAT:
            coerced = coerce(body, Whole(value), FLOAT, node)
            assert coerced is not None
            return coerced
        case Kind.INT | Kind.UINT:
            if not -(2**31) <= value < 2**32:
                raise body.problem(ErrorCode.NUMBER, f"{value:.6g} does not fit into 32 bits", node)
            if type is UINT:
                return Const(value & 0xFFFFFFFF, UINT)
            return Const(value - 2**32 if value >= 2**31 else value, INT)


def _vector(body: FunctionBody, type: Vector, args: Sequence[Value], node: ast.Call) -> Expr:
    if not args:
        raise body.problem(
            ErrorCode.SIZE, f"'{type}' needs {type.size} components", node, f"write {type}(0)"
        )
    if len(args) == 1:
        args = _elements(body, args[0], node)
    parts = [_component(body, a, type, node) for a in args]
    if len(parts) == 1:
        (part,) = parts
        if isinstance(part.type, Scalar):
            return splat(part, type)
        if part.type is type:
            return part
    total = sum(component_count(p.type) for p in parts)
    if total != type.size:
        hint = None
        if len(parts) == 1 and total > type.size:
            hint = f"write .{'xyzw'[: type.size]} to take the first {type.size}"
        elif total < type.size:
            hint = f"give {type.size - total} more: {type}(…{', 0.0' * (type.size - total)})"
        raise body.problem(
            ErrorCode.SIZE, f"{type} has {type.size} components, not {total}", node, hint
        )
    return Compose(tuple(parts), type, span=body.span(node))


def _elements(body: FunctionBody, arg: Value, node: ast.Call) -> Sequence[Value]:
    """Return the elements of an array of 2 to 4 numbers; otherwise the argument itself."""
    if isinstance(arg, SequenceValue):
        return [arg]
    match default_type(arg):
        case Array(Scalar() as element, length) if 2 <= length <= 4:
            array = body.bind("values", with_default_type(body, arg, node))
            return [Index(array, integer(i), element) for i in range(length)]
        case _:
            return [arg]


def _component(body: FunctionBody, arg: Value, type: Vector, node: ast.Call) -> Expr:
    scalar = Scalar(type.kind)
    if isinstance(arg, Whole):
        if type.kind is Kind.BOOL:
            return Const(arg.value != 0, BOOL)
        coerced = coerce(body, arg, scalar, node)
        assert coerced is not None
        return coerced
    if isinstance(arg, SequenceValue) and 2 <= len(arg.items) <= 4:
        parts = tuple(_component(body, i, type, node) for i in arg.items)
        if all(isinstance(p.type, Scalar) for p in parts):
            return Compose(parts, vector_of(type.kind, len(parts)))
    value = with_default_type(body, arg, node)
    match value.type:
        case Scalar() | Vector():
            return cast(value, type.kind)
        case _:
            message = must_be(f"an argument of '{type}'", "a number or a vector", value.type)
            raise body.problem(ErrorCode.TYPE, message, node)


def _matrix(body: FunctionBody, type: Matrix, args: Sequence[Value], node: ast.Call) -> Expr:
    size, column = type.size, Vector(Kind.FLOAT, type.size)
    if len(args) == 1:
        only = args[0]
        if default_type(only) is type:
            return with_default_type(body, only, node)
        scalar = coerce(body, only, FLOAT, node)
        if scalar is not None:
            return _diagonal(scalar, type)
    if len(args) == size:
        columns = [coerce(body, a, column, node) for a in args]
        if all(c is not None for c in columns):
            return Compose(tuple(c for c in columns if c is not None), type, span=body.span(node))
    if len(args) == size * size:
        cells = [coerce(body, a, FLOAT, node) for a in args]
        known = tuple(c for c in cells if c is not None)
        if len(known) == len(cells):
            rows = (known[i : i + size] for i in range(0, len(known), size))
            return Compose(tuple(Compose(r, column) for r in rows), type, span=body.span(node))
    wanted = f"{size} columns ({column}), {size * size} floats column by column, or a {type}"
    types = [shown_type(a) for a in args] or ["nothing"]
    raise body.problem(ErrorCode.TYPE, must_be(f"what '{type}' takes", wanted, *types), node)


def _diagonal(scalar: Expr, type: Matrix) -> Expr:
    size, zero = type.size, number(0)
    columns = (
        Compose(tuple(scalar if i == j else zero for i in range(size)), Vector(Kind.FLOAT, size))
        for j in range(size)
    )
    return Compose(tuple(columns), type)


def construct_struct(body: FunctionBody, cls: type, args: Sequence[Value], node: ast.Call) -> Expr:
    """Return a struct, for example ``Hit(distance, material=2)``; missing fields take defaults.

    Args:
        body: The function being lowered.
        cls: The ``@struct`` class.
        args: The lowered positional arguments.
        node: The call.

    Raises:
        SceneError: The arguments do not match the fields.
    """
    try:
        type = body.compilation.adopt(struct_type(cls))
    except AnnotationError as error:
        raise body.problem(ErrorCode.ANNOTATION, error.message, node, error.hint) from None
    assert isinstance(type, Struct)
    names = [name for name, _ in type.fields]
    if len(args) > len(names):
        raise body.problem(
            ErrorCode.CALL, f"'{type}' has {len(names)} fields, got {len(args)}", node
        )
    given: dict[str, tuple[Value, ast.expr]] = {
        name: (value, at) for name, value, at in zip(names, args, node.args, strict=False)
    }

    def take(keyword: ast.keyword) -> None:
        if keyword.arg is None:
            raise body.problem(
                ErrorCode.LANGUAGE, "'**' in a call is not part of scene code", keyword
            )
        if keyword.arg not in names:
            hint = did_you_mean(keyword.arg, names) or f"fields: {', '.join(names)}"
            raise body.problem(
                ErrorCode.NAME, f"'{type}' has no field '{keyword.arg}'", keyword, hint
            )
        if keyword.arg in given:
            raise body.problem(
                ErrorCode.CALL, f"'{type}' gets field '{keyword.arg}' twice", keyword
            )
        given[keyword.arg] = (body.expression(keyword.value), keyword.value)

    body.each(take, node.keywords)
    parts = body.each(lambda f: _struct_field(body, cls, type, *f, given, node), type.fields)
    return Construct(tuple(parts), type, span=body.span(node))


def _struct_field(
    body: FunctionBody,
    cls: type,
    type: Struct,
    name: str,
    wanted: Type,
    given: dict[str, tuple[Value, ast.expr]],
    node: ast.Call,
) -> Expr:
    what = f"field '{name}' of '{type}'"
    if name in given:
        value, at = given[name]
        return coerce_or_raise(body, value, wanted, at, what)
    make = struct_defaults(cls).get(name)
    if make is None:
        raise body.problem(ErrorCode.CALL, f"'{type}' needs its field '{name}'", node)
    try:
        default = value_of(make(), f"{type}.{name}", body.compilation)
    except RefusedError as refused:
        raise body.problem(ErrorCode.VALUE, refused.message, node, refused.hint) from None
    return coerce_or_raise(body, default, wanted, node, what)


def length_of(body: FunctionBody, value: Value, node: ast.expr) -> Value:
    """Return ``len(x)`` of an array, vector, matrix or tuple, which is known at compile time.

    Args:
        body: The function being lowered.
        value: The argument.
        node: The call.

    Raises:
        SceneError: The value has no length.
    """
    if isinstance(value, SequenceValue):
        return Whole(len(value.items))
    expr = with_default_type(body, value, node)
    match expr.type:
        case Array(_, length):
            return Whole(length)
        case Vector(_, size) | Matrix(size):
            return Whole(size)
        case Struct(_, fields, is_tuple) if is_tuple:
            return Whole(len(fields))
        case _:
            wanted = "an array, a vector, a matrix or a tuple"
            raise body.problem(
                ErrorCode.TYPE, must_be("the argument of 'len'", wanted, expr.type), node
            )


def _size(value: Value) -> int:
    """Return how many single values a list or tuple contains, nested ones included."""
    return sum(map(_size, value.items)) if isinstance(value, SequenceValue) else 1


def repeated(body: FunctionBody, element: Value, count: Value, node: ast.expr) -> Value:
    """Return ``[x] * n``: an array of equal elements.

    Args:
        body: The function being lowered.
        element: The list.
        count: How often it is repeated.
        node: The product.

    Raises:
        SceneError: The count is not known at compile time, or the array is too large or empty.
    """
    if not isinstance(count, Whole) or not isinstance(element, SequenceValue):
        raise body.problem(ErrorCode.SIZE, "a list is repeated a number of times known now", node)
    total = _size(element) * count.value
    if not 1 <= total <= LARGEST_ARRAY:
        message = f"an array has 1 to {LARGEST_ARRAY} components, not {total}"
        raise body.problem(
            ErrorCode.SIZE, message, node, "more belong into a Buffer" if total > 0 else None
        )
    return SequenceValue(element.items * count.value, is_list=True)
