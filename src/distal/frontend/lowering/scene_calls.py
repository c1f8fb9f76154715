"""Lower calls between scene functions: choose the overload, and lower the callee once."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

from distal.diagnostics import Diagnostic, Label
from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody, Variable
from distal.frontend.lowering.argument_matching import Argument, closeness, match, pair
from distal.frontend.lowering.instances import Instance
from distal.frontend.lowering.recipes import keep, repeated
from distal.frontend.lowering.statements import lower_statements
from distal.frontend.problems import FollowupError, SceneError, must_be_call, must_match
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, FunctionSignature
from distal.frontend.source import Node
from distal.frontend.types.coercion import shown_type
from distal.frontend.values import Value, Whole
from distal.ir.nodes import Call, Const, Expr, Function, Param, Read, Return, Stmt, Var
from distal.ir.types import FLOAT, INT, Kind, Scalar, Type, is_static
from distal.ir.walk import blocks, map_statement
from distal.lang.functions import Func

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation


def call(
    body: FunctionBody,
    function: Func,
    args: Sequence[Value],
    node: ast.Call,
) -> Expr:
    """Lower a call of another scene function.

    Args:
        body: The calling function.
        function: The called function.
        args: The lowered positional arguments.
        node: The call.

    Raises:
        SceneError: No overload takes the arguments.
        FollowupError: The called function has errors, which are reported already.
    """
    positional = [Argument(v, n) for v, n in zip(args, node.args, strict=True)]
    keywords = keyword_arguments(body, node)
    count = len(positional)
    signatures = [body.compilation.signature(o).collecting(count) for o in function.overloads]
    signature, paired = _choose(body, function, signatures, positional, keywords, node)
    if signature.problems:
        raise FollowupError
    matched = match(body, signature, paired)
    instance = instantiate(
        body.compilation, signature, matched.types, matched.bindings, (body, node)
    )
    if instance.result is None:
        raise FollowupError
    return Call(instance.name, matched.args, instance.result, span=body.span(node))


def keyword_arguments(body: FunctionBody, node: ast.Call) -> dict[str, Argument]:
    """Lower the keyword arguments of a call.

    Raises:
        SceneError: The call has a ``**`` argument.
    """

    def named(keyword: ast.keyword) -> tuple[str, Argument]:
        if keyword.arg is None:
            raise body.problem(
                ErrorCode.LANGUAGE, "'**' in a call is not part of scene code", keyword
            )
        return keyword.arg, Argument(body.expression(keyword.value), keyword.value)

    return dict(body.each(named, node.keywords)) if node.keywords else {}


def _choose(
    body: FunctionBody,
    function: Func,
    signatures: list[FunctionSignature],
    args: list[Argument],
    keywords: dict[str, Argument],
    node: ast.Call,
) -> tuple[FunctionSignature, list[Argument]]:
    if len(signatures) == 1:
        (only,) = signatures
        return only, pair(body, only, args, keywords, node)
    best: tuple[int, FunctionSignature, list[Argument]] | None = None
    for signature in signatures:
        try:
            paired = pair(body, signature, args, keywords, node)
        except SceneError:
            continue
        score = closeness(signature, paired, body)
        if score is not None and (best is None or score > best[0]):
            best = (score, signature, paired)
    if best is None:
        types = [shown_type(a.value) for a in (*args, *keywords.values())]
        message = must_be_call(function.name, (s.text() for s in signatures), types)
        raise body.problem(ErrorCode.TYPE, message, node)
    return best[1], best[2]


def instantiate(
    compilation: Compilation,
    signature: FunctionSignature,
    types: tuple[Type, ...],
    bindings: dict[TypeVar, Type],
    caller: tuple[FunctionBody, Node] | None,
) -> Instance:
    """Return the instance of a function for these types; lower it at the first request.

    Args:
        compilation: The compilation that gets the function.
        signature: The overload.
        types: The types of its parameters.
        bindings: The types bound to its type variables.
        caller: The calling function and node, for errors; None outside scene code.

    Raises:
        SceneError: The call is recursive.
    """
    key = (signature.overload, types)
    instance = compilation.instances.get(key)
    if instance is not None:
        if caller is not None:
            compilation.check_recursion(instance, caller[0].span(caller[1]))
    else:
        instance = repeated(compilation, *key) or _lowered(
            compilation, signature, types, bindings, caller
        )
        compilation.instances[key] = instance
    compilation.record("instance", (*key, bindings), instance.name)
    return instance


def _lowered(
    compilation: Compilation,
    signature: FunctionSignature,
    types: tuple[Type, ...],
    bindings: dict[TypeVar, Type],
    caller: tuple[FunctionBody, Node] | None,
) -> Instance:
    labels: tuple[Label, ...] = ()
    if caller is not None:
        labels = caller[0].labels_of_call(caller[1], {v.__name__: t for v, t in bindings.items()})
    with compilation.recording() as recording:
        name = compilation.unique_name(signature.name, _suffix(types))
        instance = Instance(name, signature.name, types)
        # Known from now on, so that recursion is found.
        compilation.instances[signature.overload, types] = instance
        compilation.in_progress.append(instance)
        try:
            lower_function(compilation, signature, instance, bindings, labels)
        finally:
            compilation.in_progress.pop()
    keep(signature.overload, types, recording, instance)
    return instance


def _suffix(types: tuple[Type, ...]) -> str:
    for type in types:
        if not is_static(type):
            return "".join(c if c.isalnum() else "_" for c in str(type)).strip("_")
    return ""


def lower_function(
    compilation: Compilation,
    signature: FunctionSignature,
    instance: Instance,
    bindings: dict[TypeVar, Type],
    labels: tuple[Label, ...],
) -> None:
    """Lower one function's body; its errors are recorded in the compilation.

    Args:
        compilation: The compilation that gets the function.
        signature: The overload.
        instance: The instance, whose result type is set.
        bindings: The types bound to its type variables.
        labels: The calls that chose these types.
    """
    scopes = signature.definition.scopes
    body = FunctionBody(compilation, signature.name, signature.source, signature.names, scopes)
    body.bindings, body.labels = bindings, labels
    if signature.overload.takes_self and signature.parameters:
        body.self_name = signature.parameters[0].name
    params = []
    for parameter, type in zip(signature.parameters, instance.params, strict=True):
        failed = parameter.annotation is MISSING
        variable = body.add_parameter(parameter.name, None if failed else type, parameter.span)
        params.append(Param(variable.ir_name, type))
    result_ok = _declare_result(signature, body, bindings)
    instance.result = body.result
    statements = lower_body(body, signature.node.body)
    if body.reachable and not body.failed:
        message = f"'{signature.name}' may end without returning a value"
        body.report(
            Diagnostic(
                ErrorCode.RESULT, message, signature.span, "end every way through it with return"
            )
        )
    if not result_ok or body.failed:
        return
    result, statements = infer_result(body, statements)
    if result is None:
        return
    instance.result = result
    compilation.add(
        Function(
            instance.name,
            tuple(params),
            result,
            statements,
            signature.name,
            apart=signature.overload.apart,
            span=signature.span,
        )
    )


def _declare_result(
    signature: FunctionSignature,
    body: FunctionBody,
    bindings: dict[TypeVar, Type],
) -> bool:
    if signature.result is MISSING:
        return not signature.problems
    returns = signature.node.returns
    assert returns is not None
    span = signature.source.span(returns)
    try:
        body.result = body.compilation.adopt(to_type(signature.result, bindings))
    except AnnotationError as error:
        body.report(Diagnostic(ErrorCode.ANNOTATION, error.message, span, error.hint))
        return False
    except UnboundVariableError as error:
        message = f"the type '{error.variable.__name__}' is not known here"
        body.report(Diagnostic(ErrorCode.ANNOTATION, message, span))
        return False
    if is_static(body.result):
        message = f"a function returns a value, not {body.result}"
        body.report(Diagnostic(ErrorCode.ANNOTATION, message, span))
        return False
    return True


def lower_body(body: FunctionBody, statements: list[ast.stmt]) -> tuple[Stmt, ...]:
    """Lower a function's statements; parameters that it assigns to are copied to locals first."""
    with body.block(statements) as block:
        for name in sorted(body.scopes.changed_parameters):
            parameter = body.parameters[name]
            if parameter.type is None or is_static(parameter.type):
                continue
            local = Variable(
                name, body, True, block, body.fresh(name), parameter.type, parameter.typed_at
            )
            initial = Read(parameter.ir_name, parameter.type)
            block.statements.append(Var(local.ir_name, initial))
            body.parameters[name] = local
            body.assigned.add(local)
        lower_statements(body, statements)
    return tuple(block.statements)


def infer_result(
    body: FunctionBody, statements: tuple[Stmt, ...]
) -> tuple[Type | None, tuple[Stmt, ...]]:
    """Return the result type, and the statements with literals coerced to it.

    Without an annotation, the type of the returned values is used. It is None if they differ.
    """
    if body.result is not None:
        return body.result, statements
    found: dict[Type, ast.Return] = {}
    literal = True
    for stmt in _returns(statements):
        found.setdefault(stmt.value.type, None)  # type: ignore[arg-type]
    wholes = [isinstance(value, Whole) for value, _ in body.returned]
    if set(found) == {INT, FLOAT}:
        literal = all(
            whole
            for whole, (value, _) in zip(wholes, body.returned, strict=True)
            if whole or getattr(value, "type", None) is INT
        )
        if literal:
            return FLOAT, tuple(_as_float(s) for s in statements)
    if len(found) != 1:
        if found and body.returned:
            _, last = body.returned[-1]
            hint = f"annotate the result: def {body.name}(...) -> {next(iter(found))}"
            message = must_match(f"the values that '{body.name}' returns", found)
            body.report(Diagnostic(ErrorCode.TYPE, message, body.span(last), hint))
        return None, statements
    return next(iter(found)), statements


def _returns(statements: tuple[Stmt, ...]) -> list[Return]:
    found: list[Return] = []
    for stmt in statements:
        if isinstance(stmt, Return):
            found.append(stmt)
        for inner in blocks(stmt):
            found.extend(_returns(inner))
    return found


def _as_float(stmt: Stmt) -> Stmt:
    if isinstance(stmt, Return):
        value = stmt.value
        if isinstance(value, Const) and value.type is Scalar(Kind.INT):
            return Return(Const(float(value.value), FLOAT), span=stmt.span)
        return stmt
    return map_statement(stmt, lambda e: e, lambda inner: tuple(_as_float(s) for s in inner))
