"""Functions as values: built-ins, scene functions, lambdas and nested functions passed on.

A lambda or nested ``def`` is lifted to a function of the module. The enclosing locals it uses
become its last parameters, and the reference to it carries their values of the moment.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TYPE_CHECKING

from distal.diagnostics import Diagnostic
from distal.frontend.lowering import scene_calls as calling
from distal.frontend.lowering.body import Body, Variable
from distal.frontend.lowering.builtin_calls import exact_instances
from distal.frontend.objects import RefusedError, value_of
from distal.frontend.problems import FollowupError, SceneError
from distal.frontend.signatures.instances import Instance
from distal.frontend.signatures.matching import slot_type
from distal.frontend.signatures.scopes import scan
from distal.frontend.signatures.signatures import MISSING, Header
from distal.frontend.types.coercion import fit_or_refuse, settle
from distal.frontend.values import Closure, Static, Value
from distal.ir.intrinsics import Intrinsic
from distal.ir.nodes import Builtin, Call, Expr, Function, FunctionRef, Param, Read, Return
from distal.ir.types import FunctionType, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.names import LangFunction

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Program

Node = ast.expr | ast.stmt


def function_value(
    program: Program, body: Body, value: Value, type: FunctionType, node: Node
) -> Expr | None:
    """A function as a value of exactly ``type``; None where it cannot be one."""
    match value:
        case Closure():
            return _closure_value(program, body, value, type, node)
        case Static(Func() as function):
            return _func_value(program, body, function, type, node)
        case Static(LangFunction(row)):
            return _row_value(program, row, type)
        case Static(Composed() as obj):
            found = program.composed(obj).reference()
            return found if found.type is type else None
        case _:
            return None


def _func_value(
    program: Program, body: Body, function: Func, type: FunctionType, node: Node
) -> Expr | None:
    problem: SceneError | None = None
    for overload in function.overloads:
        header = program.header(overload)
        if header.problems:
            raise FollowupError
        try:
            found = _header_value(program, body, header, type, node)
        except SceneError as error:
            problem = error
            continue
        if found is not None:
            return found
    if problem is not None:
        raise problem
    return None


def _header_value(
    program: Program, body: Body, header: Header, type: FunctionType, node: Node
) -> Expr | None:
    slots = [s for s in header.slots if s.positional]
    count = len(type.params)
    extra = header.slots[count:]
    if len(slots) < count or any(s.default is MISSING for s in extra):
        message = f"'{header.name}' takes {len(slots)} arguments where {type} is wanted"
        raise body.problem(message, node)
    bindings = {
        s.annotation: t
        for s, t in zip(slots, type.params, strict=False)
        if getattr(s.annotation, "__constraints__", None) is not None
    }
    types = tuple(slot_type(body, header, s, bindings) for s in header.slots)
    if types[:count] != type.params:
        return None
    captures = tuple(
        _default(program, body, header.name, s.name, s.default, t, node)
        for s, t in zip(extra, types[count:], strict=True)
    )
    instance = calling.instantiate(program, header, types, bindings, (body, node))
    if instance.result is None:
        raise FollowupError
    if instance.result is not type.result:
        message = f"'{header.name}' gives {instance.result} where {type.result} is wanted"
        raise body.problem(message, node)
    return FunctionRef(instance.name, captures, type)


def _default(
    program: Program, body: Body, function: str, name: str, default: object, type: Type, node: Node
) -> Expr:
    try:
        value = value_of(default, name, program)
    except RefusedError as refused:
        raise body.problem(refused.message, node, refused.hint) from None
    return fit_or_refuse(body, value, type, node, f"the default of '{name}' of '{function}'")


def _row_value(program: Program, row: Intrinsic, type: FunctionType) -> Expr | None:
    """A built-in passed as a function: a small function that calls it."""
    result = exact_instances(row.name).get(type.params)
    if result is not type.result:
        return None
    instance = lower_row(program, row, type.params)
    return FunctionRef(instance.name, (), type)


def lower_row(program: Program, row: Intrinsic, types: tuple[Type, ...]) -> Instance:
    """A function of the module that only calls a built-in."""
    key = (row.name, types)
    known = program.instances.get(key)
    if known is not None:
        return known
    result = exact_instances(row.name)[types]
    name = program.unique_name(f"{row.name}_function", str(types[0]))
    params = tuple(Param(n, t) for n, t in zip(row.args, types, strict=True))
    value = Builtin(row.name, tuple(Read(p.name, p.type) for p in params), result)
    program.functions.append(Function(name, params, result, (Return(value),), row.name))
    instance = Instance(name, row.name, types, result)
    program.instances[key] = instance
    return instance


def _closure_value(
    program: Program, body: Body, closure: Closure, type: FunctionType, node: Node
) -> Expr | None:
    args = _parameters(closure)
    extra = args[len(type.params) :]
    if len(args) < len(type.params) or any(a.arg not in closure.defaults for a in extra):
        wanted = len(type.params)
        count = f"{wanted} argument{'' if wanted == 1 else 's'}"
        what = "the lambda" if closure.name == "lambda" else f"'{closure.name}'"
        raise body.problem(f"{what} takes {len(args)} where {count} come", node)
    defaults = [settle(body, closure.defaults[a.arg], node) for a in extra]
    types = (*type.params, *(d.type for d in defaults))
    instance = lift(program, body, closure, types, type.result, node)
    if instance.result is None:
        raise FollowupError
    if instance.result is not type.result:
        what = "the lambda" if closure.name == "lambda" else f"'{closure.name}'"
        raise body.problem(f"{what} gives {instance.result} where {type.result} is wanted", node)
    captures = tuple(captured(body, v, node) for v in instance.captures)
    return FunctionRef(instance.name, (*defaults, *captures), type)


def captured(body: Body, variable: Variable, node: Node) -> Expr:
    """The value that a captured variable has where the function is used."""
    if variable not in variable.owner.assigned and variable.owner.reachable:
        message = f"'{variable.name}' may be read before it has a value"
        raise body.problem(message, node, "give it a value first")
    return body.capture(variable)


def _parameters(closure: Closure) -> list[ast.arg]:
    a = closure.node.args
    return [*a.posonlyargs, *a.args, *a.kwonlyargs]


def call_closure(
    program: Program, body: Body, closure: Closure, args: Sequence[Value], node: ast.Call
) -> Expr:
    """A direct call of a lambda or nested function."""
    params = _parameters(closure)
    given: dict[str, tuple[Value, ast.expr]] = {}
    if len(args) > len(params):
        message = f"'{closure.name}' takes {len(params)} arguments, got {len(args)}"
        raise body.problem(message, node)
    for param, value, at in zip(params, args, node.args, strict=False):
        given[param.arg] = (value, at)
    for name, argument in calling.keyword_arguments(body, node).items():
        if name not in {p.arg for p in params}:
            raise body.problem(f"'{closure.name}' has no parameter '{name}'", argument.node)
        if name in given:
            raise body.problem(f"'{closure.name}' gets parameter '{name}' twice", argument.node)
        given[name] = (argument.value, argument.node)
    for param in params:
        if param.arg in closure.defaults:
            given.setdefault(param.arg, (closure.defaults[param.arg], node))
        if param.arg not in given:
            raise body.problem(f"'{closure.name}' needs its parameter '{param.arg}'", node)
    fitted = [_closure_argument(program, body, closure, p, *given[p.arg]) for p in params]
    types = tuple(f.type for f in fitted)
    instance = lift(program, body, closure, types, None, node)
    if instance.result is None:
        raise FollowupError
    captures = tuple(captured(body, v, node) for v in instance.captures)
    return Call(instance.name, (*fitted, *captures), instance.result, span=body.span(node))


def _closure_argument(
    program: Program, body: Body, closure: Closure, param: ast.arg, value: Value, node: ast.expr
) -> Expr:
    if param.annotation is None:
        return settle(body, value, node)
    type = program.annotation(closure.owner, param.annotation)
    return fit_or_refuse(body, value, type, node, f"argument '{param.arg}' of '{closure.name}'")


def lift(
    program: Program,
    body: Body,
    closure: Closure,
    types: tuple[Type, ...],
    result: Type | None,
    node: Node,
) -> Instance:
    """Lower a lambda or nested function for these types, once."""
    known: Instance | None = closure.instances.get((*types, result))
    if known is not None:
        program.check_recursion(known, body.span(node))
        return known
    owner = closure.owner
    name = f"{owner.name}_{closure.name}" if closure.name == "lambda" else closure.name
    instance = Instance(program.unique_name(name), closure.name, types)
    closure.instances[(*types, result)] = instance
    program.in_progress.append(instance)
    try:
        _lower_closure(program, closure, instance, result)
    finally:
        program.in_progress.pop()
    return instance


def _lower_closure(
    program: Program, closure: Closure, instance: Instance, result: Type | None
) -> None:
    node, owner = closure.node, closure.owner
    args = _parameters(closure)
    body_nodes: list[ast.stmt]
    if isinstance(node, ast.Lambda):
        returned = ast.Return(node.body)
        body_nodes = [ast.copy_location(returned, node.body)]
    else:
        body_nodes = node.body
    plan = scan(body_nodes, {a.arg for a in args})
    body = Body(program, closure.name, owner.source, owner.names, plan, owner)
    body.bindings = owner.bindings
    params = []
    for arg, type in zip(args, instance.params, strict=True):
        _check_annotation(program, owner, arg, type)
        params.append(Param(body.add_parameter(arg.arg, type).ir_name, type))
    if isinstance(node, ast.FunctionDef) and node.returns is not None:
        body.result = program.annotation(owner, node.returns)
    elif isinstance(node, ast.Lambda):
        # A lambda's result is what is wanted of it, so that its literals take that type.
        body.result = result
    instance.result = body.result
    statements = calling.lower_body(body, body_nodes)
    if body.reachable and not body.failed and isinstance(node, ast.FunctionDef):
        message = f"'{closure.name}' may end without returning a value"
        span = owner.source.header(node)
        body.report(Diagnostic(message, span, "end every way through it with return"))
    owner.failed = owner.failed or body.failed
    if body.failed:
        return
    found, statements = calling.settle_result(body, statements)
    if found is None:
        owner.failed = True
        return
    instance.result = found
    instance.captures = tuple(body.captures)
    all_params = (*params, *body.capture_params())
    span = owner.source.span(node) if isinstance(node, ast.Lambda) else owner.source.header(node)
    program.functions.append(
        Function(instance.name, all_params, found, statements, closure.name, span=span)
    )


def _check_annotation(program: Program, owner: Body, arg: ast.arg, type: Type) -> None:
    if arg.annotation is None:
        return
    annotated = program.annotation(owner, arg.annotation)
    if annotated is not type:
        raise owner.problem(f"parameter '{arg.arg}' is {annotated}, and gets {type}", arg)
