"""Lower functions as values: built-ins, scene functions, lambdas and nested functions.

A lambda or nested ``def`` is lifted to a function of the module. The enclosing locals that it uses
become its last parameters. A reference to it contains their values at that moment.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TYPE_CHECKING

from distal.diagnostics import Diagnostic, Label
from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody, Variable
from distal.frontend.lowering import scene_calls
from distal.frontend.lowering.argument_matching import parameter_type
from distal.frontend.lowering.builtin_calls import exact_instances
from distal.frontend.lowering.instances import Instance
from distal.frontend.problems import FollowupError, SceneError, must_be
from distal.frontend.scopes import analyse_scopes, plain_parameters
from distal.frontend.signatures.signatures import MISSING, FunctionSignature
from distal.frontend.source import Node
from distal.frontend.types.coercion import coerce_or_raise, with_default_type
from distal.frontend.types.python_objects import RefusedError, value_of
from distal.frontend.values import Closure, Static, Value
from distal.ir.intrinsics import Intrinsic
from distal.ir.nodes import Builtin, Call, Expr, Function, FunctionRef, Param, Read, Return
from distal.ir.types import FunctionType, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.names import LangFunction

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation


def function_value(body: FunctionBody, value: Value, type: FunctionType, node: Node) -> Expr | None:
    """Return a function as a value of exactly ``type``; None if its type is different.

    Args:
        body: The function that uses the value.
        value: The function.
        type: The required function type.
        node: The node, for errors.

    Raises:
        SceneError: The function takes or returns something else.
        FollowupError: The function has errors, which are reported already.
    """
    match value:
        case Closure():
            return _closure_value(body, value, type, node)
        case Static(Func() as function):
            return _func_value(body, function, type, node)
        case Static(LangFunction(intrinsic)):
            return _builtin_value(body.compilation, intrinsic, type)
        case Static(Composed() as obj):
            found = body.compilation.composed(obj).reference()
            return found if found.type is type else None
        case _:
            return None


def _func_value(body: FunctionBody, function: Func, type: FunctionType, node: Node) -> Expr | None:
    problem: SceneError | None = None
    for overload in function.overloads:
        signature = body.compilation.signature(overload)
        if signature.problems:
            raise FollowupError
        try:
            found = _signature_value(body, signature, type, node)
        except SceneError as error:
            problem = error
            continue
        if found is not None:
            return found
    if problem is not None:
        raise problem
    return None


def _signature_value(
    body: FunctionBody,
    signature: FunctionSignature,
    type: FunctionType,
    node: Node,
) -> Expr | None:
    parameters = [p for p in signature.parameters if p.positional]
    count = len(type.params)
    extra = signature.parameters[count:]
    collecting = next((p for p in signature.parameters if p.collects), None)
    if collecting is not None:
        message = f"'{signature.name}' collects '*{collecting.name}', and is no function value"
        raise body.problem(ErrorCode.CALL, message, node, "pass a lambda that calls it")
    if len(parameters) < count or any(p.default is MISSING for p in extra):
        message = f"'{signature.name}' takes {len(parameters)} arguments where {type} is wanted"
        raise body.problem(ErrorCode.CALL, message, node)
    bindings = {
        p.annotation: t
        for p, t in zip(parameters, type.params, strict=False)
        if getattr(p.annotation, "__constraints__", None) is not None
    }
    types = tuple(parameter_type(body, p, bindings) for p in signature.parameters)
    if types[:count] != type.params:
        return None
    captures = tuple(
        _default(body, signature.name, p.name, p.default, t, node)
        for p, t in zip(extra, types[count:], strict=True)
    )
    instance = scene_calls.instantiate(body.compilation, signature, types, bindings, (body, node))
    if instance.result is None:
        raise FollowupError
    if instance.result is not type.result:
        message = must_be(f"the value of '{signature.name}'", type.result, instance.result)
        raise body.problem(ErrorCode.TYPE, message, node)
    return FunctionRef(instance.name, captures, type)


def _default(
    body: FunctionBody,
    function: str,
    name: str,
    default: object,
    type: Type,
    node: Node,
) -> Expr:
    try:
        value = value_of(default, name, body.compilation)
    except RefusedError as refused:
        raise body.problem(ErrorCode.VALUE, refused.message, node, refused.hint) from None
    return coerce_or_raise(body, value, type, node, f"the default of '{name}' of '{function}'")


def _builtin_value(
    compilation: Compilation, intrinsic: Intrinsic, type: FunctionType
) -> Expr | None:
    """Return a built-in as a value: a reference to a small function that calls it."""
    result = exact_instances(intrinsic.name).get(type.params)
    if result is not type.result:
        return None
    instance = builtin_function(compilation, intrinsic, type.params)
    return FunctionRef(instance.name, (), type)


def builtin_function(
    compilation: Compilation, intrinsic: Intrinsic, types: tuple[Type, ...]
) -> Instance:
    """Return a function of the module that only calls a built-in.

    Args:
        compilation: The compilation that gets the function.
        intrinsic: The built-in.
        types: The argument types; an exact instance of the built-in must exist.
    """
    key = (intrinsic.name, types)
    instance = compilation.instances.get(key)
    if instance is None:
        with compilation.recording():
            result = exact_instances(intrinsic.name)[types]
            name = compilation.unique_name(f"{intrinsic.name}_function", str(types[0]))
            params = tuple(Param(n, t) for n, t in zip(intrinsic.args, types, strict=True))
            value = Builtin(intrinsic.name, tuple(Read(p.name, p.type) for p in params), result)
            compilation.add(Function(name, params, result, (Return(value),), intrinsic.name))
            instance = Instance(name, intrinsic.name, types, result)
            compilation.instances[key] = instance
    compilation.record("builtin", (intrinsic, types), instance.name)
    return instance


def _closure_value(
    body: FunctionBody, closure: Closure, type: FunctionType, node: Node
) -> Expr | None:
    args = plain_parameters(closure.node.args)
    extra = args[len(type.params) :]
    if len(args) < len(type.params) or any(a.arg not in closure.defaults for a in extra):
        wanted = len(type.params)
        count = f"{wanted} argument{'' if wanted == 1 else 's'}"
        what = "the lambda" if closure.name == "lambda" else f"'{closure.name}'"
        raise body.problem(ErrorCode.CALL, f"{what} takes {len(args)} where {count} come", node)
    defaults = [with_default_type(body, closure.defaults[a.arg], node) for a in extra]
    types = (*type.params, *(d.type for d in defaults))
    instance = lift_closure(body, closure, types, type.result, node)
    if instance.result is None:
        raise FollowupError
    if instance.result is not type.result:
        what = "the lambda" if closure.name == "lambda" else f"'{closure.name}'"
        message = must_be(f"the value of {what}", type.result, instance.result)
        raise body.problem(ErrorCode.TYPE, message, node)
    captures = tuple(captured(body, v, node) for v in instance.captures)
    return FunctionRef(instance.name, (*defaults, *captures), type)


def captured(body: FunctionBody, variable: Variable, node: Node) -> Expr:
    """Return the value of a captured variable at the place where the function is used.

    Args:
        body: The function that uses the lifted function.
        variable: The variable.
        node: The node, for errors.

    Raises:
        SceneError: The variable may have no value here.
    """
    if variable not in variable.owner.assigned and variable.owner.reachable:
        message = f"'{variable.name}' may be read before it has a value"
        raise body.problem(ErrorCode.UNSET, message, node, "give it a value first")
    return body.capture(variable)


def call_closure(
    body: FunctionBody,
    closure: Closure,
    args: Sequence[Value],
    node: ast.Call,
) -> Expr:
    """Lower a direct call of a lambda or nested function.

    Args:
        body: The calling function.
        closure: The lambda or nested function.
        args: The lowered positional arguments.
        node: The call.

    Raises:
        SceneError: The arguments do not match its parameters.
        FollowupError: The called function has errors, which are reported already.
    """
    params = plain_parameters(closure.node.args)
    given: dict[str, tuple[Value, ast.expr]] = {}
    if len(args) > len(params):
        message = f"'{closure.name}' takes {len(params)} arguments, got {len(args)}"
        raise body.problem(ErrorCode.CALL, message, node)
    for param, value, at in zip(params, args, node.args, strict=False):
        given[param.arg] = (value, at)
    for name, argument in scene_calls.keyword_arguments(body, node).items():
        if name not in {p.arg for p in params}:
            raise body.problem(
                ErrorCode.CALL, f"'{closure.name}' has no parameter '{name}'", argument.node
            )
        if name in given:
            raise body.problem(
                ErrorCode.CALL, f"'{closure.name}' gets parameter '{name}' twice", argument.node
            )
        given[name] = (argument.value, argument.node)
    for param in params:
        if param.arg in closure.defaults:
            given.setdefault(param.arg, (closure.defaults[param.arg], node))
        if param.arg not in given:
            raise body.problem(
                ErrorCode.CALL, f"'{closure.name}' needs its parameter '{param.arg}'", node
            )
    coerced = body.each(lambda p: _closure_argument(body, closure, p, *given[p.arg]), params)
    types = tuple(f.type for f in coerced)
    instance = lift_closure(body, closure, types, None, node)
    if instance.result is None:
        raise FollowupError
    captures = tuple(captured(body, v, node) for v in instance.captures)
    return Call(instance.name, (*coerced, *captures), instance.result, span=body.span(node))


def _closure_argument(
    body: FunctionBody,
    closure: Closure,
    param: ast.arg,
    value: Value,
    node: ast.expr,
) -> Expr:
    if param.annotation is None:
        return with_default_type(body, value, node)
    type = body.compilation.annotation(closure.owner, param.annotation)
    return coerce_or_raise(body, value, type, node, f"argument '{param.arg}' of '{closure.name}'")


def lift_closure(
    body: FunctionBody,
    closure: Closure,
    types: tuple[Type, ...],
    result: Type | None,
    node: Node,
) -> Instance:
    """Lower a lambda or nested function for these argument types, once.

    Args:
        body: The function that uses it.
        closure: The lambda or nested function.
        types: The argument types.
        result: The required result type of a lambda; None if there is none.
        node: The node, for errors.

    Raises:
        SceneError: The function calls itself.
    """
    known: Instance | None = closure.instances.get((*types, result))
    if known is not None:
        body.compilation.check_recursion(known, body.span(node))
        return known
    owner = closure.owner
    name = f"{owner.name}_{closure.name}" if closure.name == "lambda" else closure.name
    instance = Instance(body.compilation.unique_name(name), closure.name, types)
    closure.instances[(*types, result)] = instance
    body.compilation.in_progress.append(instance)
    labels = owner.labels
    if isinstance(node, ast.Call):
        params = zip(plain_parameters(closure.node.args), types, strict=True)
        untyped = {p.arg: t for p, t in params if p.annotation is None}
        labels = body.labels_of_call(node, untyped) or labels
    try:
        _lower_closure(closure, instance, result, labels)
    finally:
        body.compilation.in_progress.pop()
    return instance


def _lower_closure(
    closure: Closure, instance: Instance, result: Type | None, labels: tuple[Label, ...]
) -> None:
    node, owner = closure.node, closure.owner
    compilation = owner.compilation
    args = plain_parameters(closure.node.args)
    body_nodes: list[ast.stmt]
    if isinstance(node, ast.Lambda):
        returned = ast.Return(node.body)
        body_nodes = [ast.copy_location(returned, node.body)]
    else:
        body_nodes = node.body
    scopes = analyse_scopes(body_nodes, {a.arg for a in args})
    body = FunctionBody(compilation, closure.name, owner.source, owner.names, scopes, owner)
    body.bindings, body.labels = owner.bindings, labels
    params = []
    for arg, type in zip(args, instance.params, strict=True):
        _check_annotation(owner, arg, type)
        params.append(Param(body.add_parameter(arg.arg, type, owner.span(arg)).ir_name, type))
    if isinstance(node, ast.FunctionDef) and node.returns is not None:
        body.result = compilation.annotation(owner, node.returns)
    elif isinstance(node, ast.Lambda):
        # A lambda gets the required result type, so that its literals take that type.
        body.result = result
    instance.result = body.result
    statements = scene_calls.lower_body(body, body_nodes)
    if body.reachable and not body.failed and isinstance(node, ast.FunctionDef):
        message = f"'{closure.name}' may end without returning a value"
        span = owner.source.name_span(node)
        body.report(
            Diagnostic(ErrorCode.RESULT, message, span, "end every way through it with return")
        )
    owner.failed = owner.failed or body.failed
    if body.failed:
        return
    found, statements = scene_calls.infer_result(body, statements)
    if found is None:
        owner.failed = True
        return
    instance.result = found
    instance.captures = tuple(body.captures)
    all_params = (*params, *body.capture_params())
    span = owner.source.span(node) if isinstance(node, ast.Lambda) else owner.source.name_span(node)
    compilation.add(Function(instance.name, all_params, found, statements, closure.name, span=span))


def _check_annotation(owner: FunctionBody, arg: ast.arg, type: Type) -> None:
    if arg.annotation is None:
        return
    annotated = owner.compilation.annotation(owner, arg.annotation)
    if annotated is not type:
        raise owner.problem(ErrorCode.TYPE, must_be(f"parameter '{arg.arg}'", type, annotated), arg)
