"""Lower statements: one function for each kind of syntax node, in one table.

An error in a statement is recorded, and lowering continues with the next statement. So the author
sees all errors of a function at once.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody, OpenLoop, Variable
from distal.frontend.lowering.assignment import (
    assign,
    augment,
    labels_of_type,
    unpacked_items,
    value_node,
)
from distal.frontend.lowering.expressions import make_closure
from distal.frontend.lowering.iterations import Iteration, iteration
from distal.frontend.lowering.refusals import refusal
from distal.frontend.problems import LOWERING_ERRORS, SceneError, must_be
from distal.frontend.types.coercion import coerce_or_raise, default_type, with_default_type
from distal.frontend.types.operators import condition
from distal.frontend.values import TRUE, Closure, SequenceValue, Static, Value, Whole
from distal.ir.build import negation
from distal.ir.nodes import Break, Continue, Expr, For, If, Let, Read, Return, Stmt, While
from distal.ir.types import INT, Type, is_static

# From this number of nested calls on, a RecursionError is attributed to the calls.
DEEP_CALLS: Final = 20


def lower_statements(body: FunctionBody, statements: list[ast.stmt]) -> None:
    """Lower statements into the current block, and continue after each error."""
    for stmt in statements:
        body.begin_statement(stmt)
        try:
            rule = _RULES.get(type(stmt))
            if rule is None:
                raise refusal(body, stmt)
            rule(body, stmt)
        except LOWERING_ERRORS as error:
            body.record(error)
            _give_up(body, stmt)
        except RecursionError:
            _report_depth(body, stmt)
            _give_up(body, stmt)


def _report_depth(body: FunctionBody, stmt: ast.stmt) -> None:
    """Report that Python's recursion limit is reached: by this statement, or by nested calls."""
    body.failed = True
    compilation = body.compilation
    if len(compilation.in_progress) < DEEP_CALLS:
        hint = "split it into several lines"
        body.report(
            body.problem(ErrorCode.RECURSION, "this is too deeply nested", stmt, hint).diagnostic
        )
    elif not compilation.is_too_deep:
        compilation.is_too_deep = True  # every caller fails in the same way
        first = compilation.in_progress[0].source_name
        message = f"functions call one another too many levels deep, beginning with '{first}'"
        hint = "join some of them, or call them one after the other"
        body.report(body.problem(ErrorCode.RECURSION, message, stmt, hint).diagnostic)


def _give_up(body: FunctionBody, stmt: ast.stmt) -> None:
    """Mark the names that a failed statement defines, so that uses of them are not reported."""
    names = [n.id for n in ast.walk(stmt) if isinstance(n, ast.Name) and _stores(n)]
    if isinstance(stmt, ast.FunctionDef | ast.ClassDef):
        names.append(stmt.name)
    for name in names:
        variable = body.lookup(name)
        if variable is not None:
            body.assigned.add(variable)
            variable.failed = True


def _stores(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)


def _guarded(body: FunctionBody, lower: Callable[[], Expr]) -> Expr | None:
    """Return the condition, or None after recording its error; the blocks are lowered anyway."""
    try:
        return lower()
    except LOWERING_ERRORS as error:
        body.record(error)
    return None


def _assign(body: FunctionBody, stmt: ast.Assign) -> None:
    try:
        value = body.expression(stmt.value)
    except LOWERING_ERRORS as error:
        places = (t for t in stmt.targets if isinstance(t, ast.Attribute | ast.Subscript))
        raise body.followup(error, places, body.expression) from None
    if len(stmt.targets) > 1 and not isinstance(value, Whole | SequenceValue | Static | Closure):
        value = body.bind("value", value)
    for target in stmt.targets:
        assign(body, target, value, stmt)


def _ann_assign(body: FunctionBody, stmt: ast.AnnAssign) -> None:
    if not isinstance(stmt.target, ast.Name):
        raise body.problem(ErrorCode.ASSIGNMENT, "only a name takes a type", stmt.target)
    try:
        type = _annotated(body, stmt.target.id, stmt)
    except LOWERING_ERRORS as error:
        raise body.followup(error, filter(None, (stmt.value,)), body.expression) from None
    if stmt.value is not None:
        value = body.expression(stmt.value)
        expr = coerce_or_raise(body, value, type, value_node(stmt), f"'{stmt.target.id}'")
        assign(body, stmt.target, expr, stmt)


def _annotated(body: FunctionBody, name: str, stmt: ast.AnnAssign) -> Type:
    """Return the type that a local is annotated with, which becomes its type."""
    type = body.compilation.annotation(body, stmt.annotation)
    variable = body.lookup(name)
    if is_static(type):
        raise body.problem(ErrorCode.ANNOTATION, f"a local cannot be {type}", stmt.annotation)
    if variable is not None and variable.type is None and not variable.loop:
        variable.type, variable.typed_at = type, body.span(stmt)
    elif variable is not None and variable.type is not type and not variable.loop:
        message = must_be(f"'{name}'", variable.type, type)
        raise body.problem(ErrorCode.TYPE, message, stmt.annotation, None, labels_of_type(variable))
    return type


def _if(body: FunctionBody, stmt: ast.If) -> None:
    def head() -> Expr:
        return condition(body, body.expression(stmt.test), stmt.test, "a condition")

    test = _guarded(body, head)
    before, reachable = set(body.assigned), body.reachable
    with body.block(stmt.body) as then:
        lower_statements(body, stmt.body)
    then_assigned, then_reachable = body.assigned, body.reachable
    body.assigned, body.reachable = before, reachable
    with body.block(stmt.orelse) as otherwise:
        lower_statements(body, stmt.orelse)
    if then_reachable:
        both = then_assigned & body.assigned
        body.assigned = both if body.reachable else then_assigned
    body.reachable = then_reachable or body.reachable
    if test is not None:
        made = If(test, tuple(then.statements), tuple(otherwise.statements), span=body.span(stmt))
        _emit_after(body, made, reachable=reachable)


def _emit_after(body: FunctionBody, stmt: Stmt, *, reachable: bool) -> None:
    """Add a statement; ``reachable`` is for its start, and its end may be unreachable."""
    after, body.reachable = body.reachable, reachable
    body.emit(stmt)
    body.reachable = after


def _while(body: FunctionBody, stmt: ast.While) -> None:
    if stmt.orelse:
        raise body.problem(
            ErrorCode.LANGUAGE, "'else' of a loop is not part of scene code", stmt.orelse[0]
        )
    reachable = body.reachable
    with body.block([]) as head:

        def lower_head() -> Expr:
            return condition(body, body.expression(stmt.test), stmt.test, "a condition")

        test = _guarded(body, lower_head)
    before = set(body.assigned)
    loop = OpenLoop()
    body.loops.append(loop)
    with body.block(stmt.body) as inner:
        lower_statements(body, stmt.body)
    body.loops.pop()
    forever = test is TRUE
    body.assigned = before if not forever or loop.at_break is None else loop.at_break
    body.reachable = reachable and not (forever and loop.at_break is None)
    if test is None:
        return
    span = body.span(stmt)
    statements = tuple(inner.statements)
    if head.statements:
        # The condition has statements, which must run again in each iteration.
        leave = If(negation(test), (Break(span=span),), (), span=span)
        test, statements = TRUE, (*head.statements, leave, *statements)
    _emit_after(body, While(test, statements, span=span), reachable=reachable)


def _for(body: FunctionBody, stmt: ast.For) -> None:
    if stmt.orelse:
        raise body.problem(
            ErrorCode.LANGUAGE, "'else' of a loop is not part of scene code", stmt.orelse[0]
        )
    names = _loop_names(body, stmt.target)
    shadowed = [v for n in names if (v := body.lookup(n.id)) is not None]
    for name in names:
        known = body.lookup(name.id)
        if known is not None and not (name.id == "_" and known.loop):
            message = f"'{name.id}' is a local already"
            raise body.problem(
                ErrorCode.ASSIGNMENT, message, name, "give the loop variable a name of its own"
            )
    found = None
    try:
        found = iteration(body, stmt.iter)
    except LOWERING_ERRORS as error:
        body.record(error)
    _loop_body(body, stmt, names, found)
    # Nested loops over _: in Python the inner loop's value remains.
    body.assigned.difference_update(shadowed)


def _loop_names(body: FunctionBody, target: ast.expr) -> list[ast.Name]:
    """Return the loop variables: one name, or as many as the values have parts."""
    match target:
        case ast.Name():
            return [target]
        case ast.Tuple(elements) | ast.List(elements) if elements:
            return [name for e in elements for name in _loop_names(body, e)]
        case _:
            raise body.problem(
                ErrorCode.ASSIGNMENT, "a loop variable is a name", target, "unpack it in the body"
            )


def _loop_body(
    body: FunctionBody, stmt: ast.For, names: list[ast.Name], found: Iteration | None
) -> None:
    before, reachable, span = set(body.assigned), body.reachable, body.span(stmt)
    first = names[0].id.strip("_") or "i"
    counter = body.fresh(first if _counts(stmt.target, found) else f"{first}_index")
    body.loops.append(OpenLoop())
    with body.block(stmt.body) as block:
        for name in names:
            failed = found is None
            variable = Variable(name.id, body, False, loop=True, failed=failed)
            block.variables[name.id] = variable
            body.assigned.add(variable)
        if found is not None:
            _set_loop_variables(body, stmt.target, found.element(Read(counter, INT)))
        lower_statements(body, stmt.body)
    body.loops.pop()
    body.assigned, body.reachable = before, reachable
    if found is not None:
        start, stop, step = found.bounds
        body.emit(For(counter, start, stop, step, tuple(block.statements), span=span))


def _counts(target: ast.expr, found: Iteration | None) -> bool:
    """Return whether the first loop variable is the counter itself."""
    if isinstance(target, ast.Name):
        return found is None or found.is_counter
    assert isinstance(target, ast.Tuple | ast.List)
    return found is not None and found.first_is_counter and isinstance(target.elts[0], ast.Name)


def _set_loop_variables(body: FunctionBody, target: ast.expr, value: Value) -> None:
    if isinstance(target, ast.Name):
        variable = body.lookup(target.id)
        assert variable is not None
        expr = with_default_type(body, value, target)
        if isinstance(expr, Read) and expr.type is INT:
            variable.ir_name, variable.type = expr.name, INT
        else:
            variable.ir_name, variable.type = body.fresh(target.id), expr.type
            body.emit(Let(variable.ir_name, expr, span=body.span(target)))
        return
    assert isinstance(target, ast.Tuple | ast.List)
    items = unpacked_items(body, value, len(target.elts), target, target)
    for element, item in zip(target.elts, items, strict=True):
        _set_loop_variables(body, element, item)


def _break(body: FunctionBody, stmt: ast.Break) -> None:
    body.emit(Break(span=body.span(stmt)))
    loop = body.loops[-1]
    if body.reachable:
        known = loop.at_break
        loop.at_break = set(body.assigned) if known is None else known & body.assigned
    body.reachable = False


def _continue(body: FunctionBody, stmt: ast.Continue) -> None:
    body.emit(Continue(span=body.span(stmt)))
    body.reachable = False


def _return(body: FunctionBody, stmt: ast.Return) -> None:
    try:
        if stmt.value is None:
            raise body.problem(
                ErrorCode.RESULT, f"'{body.name}' returns no value here", stmt, "write return value"
            )
        value = body.expression(stmt.value)
        expr = _returned(body, value, stmt.value)
        body.returned.append((value, stmt))
        body.emit(Return(expr, span=body.span(stmt)))
    finally:
        body.reachable = False


def _returned(body: FunctionBody, value: Value, node: ast.expr) -> Expr:
    if body.result is not None:
        whose = "the lambda" if body.name == "lambda" else f"'{body.name}'"
        return coerce_or_raise(body, value, body.result, node, f"the value of {whose}")
    expr = with_default_type(body, value, node)
    if is_static(expr.type):
        raise body.problem(
            ErrorCode.ANNOTATION, f"a function returns a value, not {expr.type}", node
        )
    return expr


def _expr(body: FunctionBody, stmt: ast.Expr) -> None:
    match stmt.value:
        case ast.Constant(value) if value is Ellipsis:
            return
        case ast.Constant(str()):
            return  # a docstring, or a comment written as one
        case _:
            default: Type | None = default_type(body.expression(stmt.value))
            what = "this value" if default is None else f"this {default}"
            hint = "functions have no effect but their value: assign it, or return it"
            raise body.problem(ErrorCode.RESULT, f"{what} is not used", stmt, hint)


def _pass(body: FunctionBody, stmt: ast.Pass) -> None:
    """Do nothing."""


def _function_def(body: FunctionBody, stmt: ast.FunctionDef) -> None:
    variable = body.lookup(stmt.name)
    assert variable is not None
    if stmt.decorator_list:
        message = f"the nested function '{stmt.name}' has a decorator"
        raise body.problem(
            ErrorCode.DEFINITION, message, stmt.decorator_list[0], "a nested def needs none"
        )
    if variable.changes or variable.static is not None:
        message = f"'{stmt.name}' cannot change what function it stands for"
        raise SceneError(
            ErrorCode.ASSIGNMENT,
            message,
            body.source.name_span(stmt),
            "give each function a name of its own",
        )
    variable.static = make_closure(body, stmt, stmt.name)
    body.assigned.add(variable)


_RULES: Final[dict[type[ast.stmt], Callable[[FunctionBody, Any], None]]] = {
    ast.Assign: _assign,
    ast.AugAssign: augment,
    ast.AnnAssign: _ann_assign,
    ast.If: _if,
    ast.While: _while,
    ast.For: _for,
    ast.Break: _break,
    ast.Continue: _continue,
    ast.Return: _return,
    ast.Expr: _expr,
    ast.Pass: _pass,
    ast.FunctionDef: _function_def,
}
