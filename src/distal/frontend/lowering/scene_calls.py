"""Scene functions calling scene functions: choosing the overload, lowering the callee once."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

from distal.diagnostics import Diagnostic
from distal.frontend.lowering.body import Body, Variable
from distal.frontend.lowering.statements import lower_statements
from distal.frontend.problems import FollowupError, SceneError
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.instances import Instance
from distal.frontend.signatures.matching import Argument, closeness, match, pair, signature_of
from distal.frontend.signatures.scopes import scan
from distal.frontend.signatures.signatures import MISSING, Header
from distal.frontend.types.coercion import shown_type
from distal.frontend.values import Value, Whole
from distal.ir.nodes import Call, Const, Expr, Function, Param, Read, Return, Stmt, Var
from distal.ir.types import FLOAT, INT, Kind, Scalar, Type, is_static
from distal.ir.walk import blocks, map_statement
from distal.lang.functions import Func

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Program


def call(
    program: Program, body: Body, function: Func, args: Sequence[Value], node: ast.Call
) -> Expr:
    """A call of another scene function."""
    positional = [Argument(v, n) for v, n in zip(args, node.args, strict=True)]
    keywords = keyword_arguments(body, node)
    headers = [program.header(o) for o in function.overloads]
    header, paired = _choose(body, function, headers, positional, keywords, node)
    if header.problems:
        raise FollowupError
    matched = match(body, header, paired)
    instance = instantiate(program, header, matched.types, matched.bindings, (body, node))
    if instance.result is None:
        raise FollowupError
    return Call(instance.name, matched.args, instance.result, span=body.span(node))


def keyword_arguments(body: Body, node: ast.Call) -> dict[str, Argument]:
    """The keyword arguments of a call, lowered."""
    keywords: dict[str, Argument] = {}
    for keyword in node.keywords:
        if keyword.arg is None:
            raise body.problem("'**' in a call is not part of scene code", keyword)
        keywords[keyword.arg] = Argument(body.expression(keyword.value), keyword.value)
    return keywords


def _choose(
    body: Body,
    function: Func,
    headers: list[Header],
    args: list[Argument],
    keywords: dict[str, Argument],
    node: ast.Call,
) -> tuple[Header, list[Argument]]:
    if len(headers) == 1:
        (only,) = headers
        return only, pair(body, only, args, keywords, node)
    best: tuple[int, Header, list[Argument]] | None = None
    for header in headers:
        try:
            paired = pair(body, header, args, keywords, node)
        except SceneError:
            continue
        score = closeness(header, paired, body)
        if score is not None and (best is None or score > best[0]):
            best = (score, header, paired)
    if best is None:
        shown = ", ".join(shown_type(a.value) for a in (*args, *keywords.values()))
        hint = " or ".join(signature_of(h) for h in headers)
        raise body.problem(
            f"no overload of '{function.name}' takes {shown or 'nothing'}", node, hint
        )
    return best[1], best[2]


def instantiate(
    program: Program,
    header: Header,
    types: tuple[Type, ...],
    bindings: dict[TypeVar, Type],
    caller: tuple[Body, ast.expr | ast.stmt] | None,
) -> Instance:
    """The function for these types, lowered now if it was not yet."""
    key = (header.overload, types)
    known = program.instances.get(key)
    if known is not None:
        if caller is not None:
            program.check_recursion(known, caller[0].span(caller[1]))
        return known
    instance = Instance(program.unique_name(header.name, _suffix(types)), header.name, types)
    program.instances[key] = instance
    program.in_progress.append(instance)
    try:
        lower_function(program, header, instance, bindings)
    finally:
        program.in_progress.pop()
    return instance


def _suffix(types: tuple[Type, ...]) -> str:
    for type in types:
        if not is_static(type):
            return "".join(c if c.isalnum() else "_" for c in str(type)).strip("_")
    return ""


def lower_function(
    program: Program, header: Header, instance: Instance, bindings: dict[TypeVar, Type]
) -> None:
    """Lower one function's body; its mistakes are noted in the program."""
    plan = scan(header.node.body, {s.name for s in header.slots})
    body = Body(program, header.name, header.source, header.names, plan)
    body.bindings = bindings
    params = []
    for slot, type in zip(header.slots, instance.params, strict=True):
        failed = slot.annotation is MISSING
        variable = body.add_parameter(slot.name, None if failed else type)
        params.append(Param(variable.ir_name, type))
    result_ok = _declare_result(program, header, body, bindings)
    instance.result = body.result
    statements = lower_body(body, header.node.body)
    if body.reachable and not body.failed:
        message = f"'{header.name}' may end without returning a value"
        body.report(Diagnostic(message, header.span, "end every way through it with return"))
    if not result_ok or body.failed:
        return
    result, statements = settle_result(body, statements)
    if result is None:
        return
    instance.result = result
    program.functions.append(
        Function(instance.name, tuple(params), result, statements, header.name, span=header.span)
    )


def _declare_result(
    program: Program, header: Header, body: Body, bindings: dict[TypeVar, Type]
) -> bool:
    if header.result is MISSING:
        return not header.problems
    returns = header.node.returns
    assert returns is not None
    span = header.source.span(returns)
    try:
        body.result = program.adopt(to_type(header.result, bindings))
    except AnnotationError as error:
        body.report(Diagnostic(error.message, span, error.hint))
        return False
    except UnboundVariableError as error:
        message = f"nothing tells what '{error.variable.__name__}' is"
        body.report(Diagnostic(message, span))
        return False
    if is_static(body.result):
        message = f"a function returns a value, not {body.result}"
        body.report(Diagnostic(message, span))
        return False
    return True


def lower_body(body: Body, statements: list[ast.stmt]) -> tuple[Stmt, ...]:
    """Lower a function's statements; parameters that change become locals first."""
    with body.block(statements) as block:
        for name in sorted(body.plan.changed_parameters):
            parameter = body.parameters[name]
            if parameter.type is None or is_static(parameter.type):
                continue
            local = Variable(name, body, True, block, body.fresh(name), parameter.type)
            initial = Read(parameter.ir_name, parameter.type)
            block.statements.append(Var(local.ir_name, initial))
            body.parameters[name] = local
            body.assigned.add(local)
        lower_statements(body, statements)
    return tuple(block.statements)


def settle_result(body: Body, statements: tuple[Stmt, ...]) -> tuple[Type | None, tuple[Stmt, ...]]:
    """The result's type; without an annotation the returned values tell."""
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
            kinds = " and ".join(map(str, found))
            _, last = body.returned[-1]
            hint = f"annotate the result: def {body.name}(...) -> {next(iter(found))}"
            message = f"'{body.name}' returns {kinds}"
            body.report(Diagnostic(message, body.span(last), hint))
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
