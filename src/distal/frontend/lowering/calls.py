"""Lower calls; the rules depend on what is called: function, built-in, type, form or object."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from types import FunctionType as PythonFunction
from types import ModuleType
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.lowering.builtin_calls import PYTHON_FUNCTIONS, call_builtin
from distal.frontend.lowering.lowered_nodes import LoweredNode, methods_of, unstarred
from distal.frontend.other_languages import COUNTERPARTS
from distal.frontend.problems import LOWERING_ERRORS, SceneError, must_be
from distal.frontend.signatures.annotations import AnnotationError, to_type
from distal.frontend.types.coercion import (
    coerce_or_raise,
    last_frame,
    shown_type,
    with_default_type,
)
from distal.frontend.types.constructors import construct, construct_struct, length_of
from distal.frontend.types.unification import unify_operands
from distal.frontend.values import Closure, SequenceValue, Static, Value, Whole
from distal.ir.build import splat
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Apply, Expr, Gradient, Sample, Select, Size, Texel
from distal.ir.types import (
    FLOAT,
    INT,
    IVEC2,
    IVEC3,
    VEC2,
    VEC3,
    VEC4,
    Buffer,
    FunctionType,
    Kind,
    Scalar,
    Struct,
    Texture,
    TextureShape,
    Type,
    Vector,
    kind_of,
    tuple_type,
)
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.names import (
    LangForm,
    LangFunction,
    gradient,
    sample,
    select,
    size,
    texel,
    value_and_gradient,
)

_HINTS: Final[dict[Any, str]] = {
    builtins.print: "nothing is printed per pixel; return the value as a color to see it",
    builtins.sum: "add in a loop: for x in values: total += x",
    builtins.range: "range belongs in a for loop: for i in range(n)",
    builtins.enumerate: "enumerate belongs in a for loop: for i, value in enumerate(values)",
    builtins.zip: "zip belongs in a for loop: for a, b in zip(starts, ends)",
    builtins.sorted: "arrays have a fixed order here",
    builtins.map: "write a loop",
    builtins.divmod: "write a // b and a % b",
}


def lower_call(body: FunctionBody, node: ast.Call) -> Value:
    """Lower ``function(arguments)``.

    Raises:
        SceneError: The called value is not a function, or does not take these arguments.
    """
    node = unstarred(body, node)
    try:
        if isinstance(node.func, ast.Attribute):
            node = _of_value(body, node, node.func)
        called = body.expression(node.func)
    except LOWERING_ERRORS as error:
        rest = (*node.args, *_keyword_nodes(node))
        raise body.followup(error, rest, body.expression) from None
    match called:
        case Static(obj, text):
            return _static_call(body, obj, text, node)
        case Closure():
            return body.compilation.call_closure(body, called, arguments(body, node), node)
        case Whole() | SequenceValue():
            pass
        case _:
            if isinstance(called.type, FunctionType):
                return _apply(body, called, node)
    raise body.problem(
        ErrorCode.TYPE, must_be("what is called", "a function", shown_type(called)), node.func
    )


def _of_value(body: FunctionBody, node: ast.Call, func: ast.Attribute) -> ast.Call:
    """Return ``ray.at(t)`` as a call of the method with ``ray`` as its first argument.

    A call of anything else is returned with what stands before the dot lowered.
    """
    base = body.expression(func.value)
    held: ast.expr = LoweredNode(base, func.value)
    type = getattr(base, "type", None)
    method = methods_of(type).get(func.attr)
    if method is not None and not (isinstance(type, Struct) and type.field(func.attr)):
        called = LoweredNode(Static(method, func.attr), func)
        return ast.copy_location(ast.Call(called, [held, *node.args], node.keywords), node)
    if isinstance(base, Static):
        return node
    attribute = ast.copy_location(ast.Attribute(held, func.attr, func.ctx), func)
    return ast.copy_location(ast.Call(attribute, node.args, node.keywords), node)


def arguments(body: FunctionBody, node: ast.Call) -> list[Value]:
    """Lower the positional arguments of a call."""
    try:
        return body.each(body.expression, node.args)
    except LOWERING_ERRORS as error:
        raise body.followup(error, _keyword_nodes(node), body.expression) from None


def _keyword_nodes(node: ast.Call) -> Iterator[ast.expr]:
    return (k.value for k in node.keywords if k.arg is not None)


def _static_call(body: FunctionBody, obj: Any, text: str, node: ast.Call) -> Value:
    if isinstance(obj, Func):
        return body.compilation.call(body, obj, arguments(body, node), node)
    if isinstance(obj, Composed):
        return _apply(body, body.compilation.composed(obj).reference(), node, text)
    intrinsic = obj.row if isinstance(obj, LangFunction) else _python_builtin(obj)
    if intrinsic is not None:
        args = arguments(body, node)
        if node.keywords:
            args = _builtin_arguments(body, intrinsic.name, intrinsic.args, args, node)
        return call_builtin(body, intrinsic, args, node)
    if isinstance(obj, LangForm):
        return _form(body, obj, node)
    if obj is len:
        args = _exactly(body, "len", 1, node)
        value = args[0]
        if not isinstance(value, Whole | SequenceValue | Static | Closure) and isinstance(
            value.type, Buffer
        ):
            return Size(value, INT, span=body.span(node))
        return length_of(body, value, node)
    if isinstance(obj, type):
        return _type_call(body, obj, text, node)
    raise _not_scene_code(body, obj, text, node)


def _python_builtin(obj: Any) -> Any:
    try:
        return PYTHON_FUNCTIONS.get(obj)
    except TypeError:  # not hashable
        return None


def _builtin_arguments(
    body: FunctionBody, name: str, names: Sequence[str], args: list[Value], node: ast.Call
) -> list[Value]:
    parameters: dict[str, Value] = dict(zip(names, args, strict=False))

    def take(keyword: ast.keyword) -> None:
        if keyword.arg is None or keyword.arg not in names:
            hint = f"its arguments: {', '.join(names)}"
            raise body.problem(
                ErrorCode.CALL, f"'{name}' has no argument '{keyword.arg}'", keyword, hint
            )
        if keyword.arg in parameters:
            raise body.problem(
                ErrorCode.CALL, f"'{name}' gets argument '{keyword.arg}' twice", keyword
            )
        parameters[keyword.arg] = body.expression(keyword.value)

    body.each(take, node.keywords)
    return [parameters[n] for n in names if n in parameters]


def _type_call(body: FunctionBody, cls: type, text: str, node: ast.Call) -> Value:
    if "__distal_struct__" in vars(cls):
        return construct_struct(body, cls, arguments(body, node), node)
    try:
        type = to_type(cls)
    except AnnotationError:
        raise _not_scene_code(body, cls, text, node) from None
    return construct(body, type, arguments(body, node), node)


def _not_scene_code(body: FunctionBody, obj: Any, text: str, node: ast.Call) -> SceneError:
    hint = None
    with suppress(TypeError):  # not hashable
        hint = _HINTS.get(obj)
    if hint is None:
        name = getattr(obj, "__name__", None)
        if isinstance(obj, PythonFunction):
            hint = "write @func above its def"
        elif isinstance(name, str) and name in INTRINSICS and not INTRINSICS[name].hidden:
            hint = f"from distal.lang import {name}"
        elif isinstance(obj, type) and issubclass(obj, Composed):
            hint = f"make it outside of the function, shape = {text}(…), and call shape(p) here"
        elif isinstance(obj, type) and hasattr(obj, "__annotations__"):
            hint = "write @struct above the class"
        elif isinstance(name, str):
            hint = COUNTERPARTS.get(name)
    if not callable(obj):
        noun = "a module" if isinstance(obj, ModuleType) else f"a {type(obj).__name__}"
        return body.problem(
            ErrorCode.LANGUAGE, f"'{text}' is {noun}, not a function", node.func, hint
        )
    return body.problem(
        ErrorCode.LANGUAGE, f"'{text}' is not a function of scene code", node.func, hint
    )


def _apply(body: FunctionBody, function: Expr, node: ast.Call, name: str | None = None) -> Expr:
    """Call a function value: a parameter, or the function of an object."""
    type = function.type
    assert isinstance(type, FunctionType)
    name = name or ast.unparse(node.func)
    args = _exactly(body, name, len(type.params), node)

    def coerced(i: int) -> Expr:
        what = f"argument {i + 1} of '{name}'"
        return coerce_or_raise(body, args[i], type.params[i], node.args[i], what)

    values = tuple(body.each(coerced, range(len(args))))
    return Apply(function, values, type.result, span=body.span(node))


def _exactly(
    body: FunctionBody, name: str, count: int, node: ast.Call, hint: str | None = None
) -> list[Value]:
    if node.keywords:
        raise body.problem(
            ErrorCode.CALL, f"'{name}' takes no keyword arguments", node.keywords[0], hint
        )
    args = arguments(body, node)
    if len(args) != count:
        plural = "" if count == 1 else "s"
        raise body.problem(
            ErrorCode.CALL, f"'{name}' takes {count} argument{plural}, got {len(args)}", node, hint
        )
    return args


def _form(body: FunctionBody, form: LangForm, node: ast.Call) -> Value:
    count = form.signature.count(",") + 1
    args = _exactly(body, form.name, count, node, form.signature)
    return _FORMS[form](body, args, node)


def _select(body: FunctionBody, args: list[Value], node: ast.Call) -> Value:
    test = with_default_type(body, args[0], node.args[0])
    yes, no = unify_operands(body, args[1], args[2], node, "select")
    match test.type:
        case Scalar(Kind.BOOL):
            return Select(test, yes, no, yes.type, span=body.span(node))
        case Vector(Kind.BOOL, count):
            kind = kind_of(yes.type)
            wide: Type | None = None if kind is None else Vector(kind, count)
            if isinstance(yes.type, Scalar) and wide is not None:
                yes, no = splat(yes, wide), splat(no, wide)
            if yes.type is wide:
                return Select(test, yes, no, yes.type, span=body.span(node))
            wanted = f"numbers or vectors of {count}"
            message = must_be(f"the choices of 'select' by {test.type}", wanted, yes.type)
            raise body.problem(ErrorCode.TYPE, message, node)
        case _:
            hint = "compare it: select(x > 0.0, ...)" if isinstance(test.type, Scalar) else None
            message = must_be("the condition of 'select'", "bool or bvec2 to bvec4", test.type)
            raise body.problem(ErrorCode.TYPE, message, node.args[0], hint)


def _gradient(body: FunctionBody, args: list[Value], node: ast.Call, *, with_value: bool) -> Value:
    point = with_default_type(body, args[1], node.args[1])
    name = "value_and_gradient" if with_value else "gradient"
    if point.type not in (FLOAT, VEC2, VEC3, VEC4):
        message = must_be(f"the point of '{name}'", "float or vec2 to vec4", point.type)
        raise body.problem(ErrorCode.TYPE, message, node.args[1])
    wanted = FunctionType((point.type,), FLOAT)
    what = f"the field of '{name}'"
    field = coerce_or_raise(body, args[0], wanted, node.args[0], what)
    type = tuple_type((FLOAT, point.type)) if with_value else point.type
    return Gradient(field, point, with_value, type, span=body.span(node))


def _texture(
    body: FunctionBody, value: Value, name: str, node: ast.Call
) -> tuple[Expr, TextureShape]:
    texture = last_frame(body, value) or with_default_type(body, value, node.args[0])
    if not isinstance(texture.type, Texture):
        message = must_be(f"argument 1 of '{name}'", "a texture", texture.type)
        raise body.problem(ErrorCode.TYPE, message, node.args[0])
    return texture, texture.type.shape


def _sample(body: FunctionBody, args: list[Value], node: ast.Call) -> Value:
    texture, shape = _texture(body, args[0], "sample", node)
    wanted = VEC2 if shape is TextureShape.FLAT else VEC3
    what = f"the place in a {shape.value}"
    return Sample(texture, coerce_or_raise(body, args[1], wanted, node.args[1], what), VEC4)


def _texel(body: FunctionBody, args: list[Value], node: ast.Call) -> Value:
    texture, shape = _texture(body, args[0], "texel", node)
    wanted = IVEC2 if shape is TextureShape.FLAT else IVEC3
    what = f"the index of a {shape.value}"
    return Texel(texture, coerce_or_raise(body, args[1], wanted, node.args[1], what), VEC4)


def _size(body: FunctionBody, args: list[Value], node: ast.Call) -> Value:
    resource = last_frame(body, args[0]) or with_default_type(body, args[0], node.args[0])
    match resource.type:
        case Texture(shape):
            return Size(resource, IVEC3 if shape is TextureShape.VOLUME else IVEC2)
        case Buffer():
            return Size(resource, INT)
        case _:
            hint = "the length of an array is len(...)"
            message = must_be("the argument of 'size'", "a texture or a buffer", resource.type)
            raise body.problem(ErrorCode.TYPE, message, node.args[0], hint)


_FORMS: Final[dict[LangForm, Callable[[FunctionBody, list[Value], ast.Call], Value]]] = {
    select: _select,
    gradient: lambda body, args, node: _gradient(body, args, node, with_value=False),
    value_and_gradient: lambda body, args, node: _gradient(body, args, node, with_value=True),
    sample: _sample,
    texel: _texel,
    size: _size,
}
