"""Lower assignments: to names, to parts of values, and to several targets at once."""

from __future__ import annotations

import ast

from distal.diagnostics import Label
from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody, Variable
from distal.frontend.lowering.expressions import element, member
from distal.frontend.lowering.lowered_nodes import UNPACKED, parts_of
from distal.frontend.problems import LOWERING_ERRORS, FollowupError, SceneError, must_be
from distal.frontend.source import Node
from distal.frontend.types.coercion import (
    coerce,
    conversion_hint,
    shown_type,
    with_default_type,
    wrong_type,
)
from distal.frontend.types.operators import binary
from distal.frontend.values import Closure, SequenceValue, Static, Value, Whole
from distal.ir.nodes import Assign, Const, Expr, Field, Read, Swizzle, Uniform
from distal.ir.types import FLOAT, INT, is_static
from distal.ir.walk import nodes_in


def assign(body: FunctionBody, target: ast.expr, value: Value, stmt: ast.stmt) -> None:
    """Lower ``target = value``.

    Args:
        body: The function being lowered.
        target: The left side.
        value: The lowered right side.
        stmt: The statement, for spans and errors.

    Raises:
        SceneError: The target cannot be assigned to, or has another type than the value.
    """
    match target:
        case ast.Name():
            _assign_name(body, target, value, stmt)
        case ast.Tuple(elts) | ast.List(elts):
            _unpack(body, target, elts, value, stmt)
        case ast.Attribute() | ast.Subscript():
            place = lvalue(body, target)
            _assign_part(body, place, target, value, stmt)
        case ast.Starred():
            raise body.problem(ErrorCode.LANGUAGE, "'*' is not part of scene code", target)
        case _:
            raise body.problem(ErrorCode.ASSIGNMENT, "this cannot be assigned to", target)


def local(body: FunctionBody, target: ast.Name) -> Variable:
    """Return the local that an assignment to a name changes.

    Raises:
        SceneError: The name is a loop variable, which is read-only.
    """
    variable = body.lookup(target.id)
    assert variable is not None, target.id
    if variable.loop:
        message = f"the loop variable '{target.id}' is read-only"
        raise body.problem(
            ErrorCode.ASSIGNMENT, message, target, "assign to a local with another name"
        )
    return variable


def _assign_name(body: FunctionBody, target: ast.Name, value: Value, stmt: ast.stmt) -> None:
    variable = local(body, target)
    if isinstance(value, Static | Closure) or is_static(getattr(value, "type", INT)):
        _assign_static(body, variable, value, target)
        return
    if variable.static is not None:
        raise body.problem(
            ErrorCode.ASSIGNMENT, f"'{variable.name}' is a function and does not change", target
        )
    if variable.type is None:
        expr = with_default_type(body, value, value_node(stmt))
    else:
        coerced = coerce(body, value, variable.type, value_node(stmt))
        if coerced is None:
            written = isinstance(stmt, ast.Assign) and target in stmt.targets
            raise changed_type(body, variable, value, value_node(stmt) if written else stmt)
        expr = coerced
    starts = not variable.ir_name
    body.store(variable, expr, stmt)
    if starts and isinstance(value, Whole):
        body.whole_starts[variable.ir_name] = value.value


def value_node(stmt: ast.stmt) -> Node:
    """Return the right side of an assignment, where errors about its value point."""
    value = getattr(stmt, "value", None)
    return value if isinstance(value, ast.expr) else stmt


def _assign_static(body: FunctionBody, variable: Variable, value: Value, target: ast.Name) -> None:
    """Bind a local name to a function, type or resource; this exists only at compile time."""
    if variable.changes or variable.type is not None:
        message = f"'{variable.name}' cannot change what function it stands for"
        raise body.problem(
            ErrorCode.ASSIGNMENT, message, target, "give each function a name of its own"
        )
    variable.static = value
    body.assigned.add(variable)


def changed_type(body: FunctionBody, variable: Variable, value: Value, node: Node) -> SceneError:
    """Return the error for a local that is assigned a value of another type.

    Args:
        body: The function being lowered.
        variable: The local.
        value: The value.
        node: The node that the error points at.
    """
    type, given = variable.type, shown_type(value)
    assert type is not None
    hint = conversion_hint(value, type)
    if type is INT and given == str(FLOAT):
        hint = f"start it as a float: {variable.name} = 0.0"
    message = must_be(f"'{variable.name}'", type, given)
    return body.problem(ErrorCode.TYPE, message, node, hint, labels_of_type(variable))


def labels_of_type(variable: Variable) -> tuple[Label, ...]:
    """Return the label of the place where a local gets its type; none if it is not known."""
    if variable.typed_at is None:
        return ()
    return (Label(variable.typed_at, f"'{variable.name}' gets the type {variable.type} here"),)


def _assign_part(
    body: FunctionBody, place: Expr, target: ast.expr, value: Value, stmt: ast.stmt
) -> None:
    coerced = coerce(body, value, place.type, value_node(stmt))
    if coerced is None:
        raise wrong_type(body, value, place.type, stmt, f"'{ast.unparse(target)}'")
    body.emit(Assign(place, coerced, span=body.span(stmt)))


def lvalue(body: FunctionBody, target: ast.expr) -> Expr:
    """Return the assignable expression of ``v.xy``, ``a[i]`` or ``hit.color``; its root is a local.

    Raises:
        SceneError: The target cannot be assigned to.
    """
    match target:
        case ast.Name():
            return _root(body, target)
        case ast.Attribute(base, name):
            place = member(body, lvalue(body, base), name, target)
            if isinstance(place, Swizzle) and len(set(place.lanes)) < len(place.lanes):
                message = f"'.{name}' names a component twice and cannot be assigned to"
                raise body.problem(ErrorCode.ASSIGNMENT, message, target)
            return place
        case ast.Subscript(base):
            place = element(body, lvalue(body, base), target)
            if isinstance(place, Field):
                raise body.problem(
                    ErrorCode.ASSIGNMENT, "a tuple does not change", target, "use a struct"
                )
            return place
        case _:
            raise body.problem(
                ErrorCode.ASSIGNMENT,
                "this cannot be assigned to",
                target,
                "assign it to a local first",
            )


def _root(body: FunctionBody, target: ast.Name) -> Expr:
    variable = body.lookup(target.id)
    if variable is None:
        message = f"'{target.id}' belongs to the module or to an outer function and cannot change"
        raise body.problem(
            ErrorCode.ASSIGNMENT, message, target, f"copy it first: local = {target.id}"
        )
    local(body, target)
    if target.id == body.self_name:
        message = f"'{target.id}' is a copy of the struct, which a method cannot change"
        hint = f"copy it first, result = {target.id}, and return the copy"
        raise body.problem(ErrorCode.ASSIGNMENT, message, target, hint)
    if variable.failed:
        raise FollowupError
    if variable.static is not None:
        raise body.problem(ErrorCode.ASSIGNMENT, f"'{target.id}' cannot change", target)
    value = body.read(variable, target)
    assert isinstance(value, Read)
    return value


def _unpack(
    body: FunctionBody, target: ast.expr, elements: list[ast.expr], value: Value, stmt: ast.stmt
) -> None:
    items = unpacked_items(body, value, len(elements), target, value_node(stmt))
    if len(items) > 1 and _depend(body, items, elements):
        # Copy all values before the first target changes: a, b = b, a.
        items = [_held(body, i) for i in items]
    for element_target, item in zip(elements, items, strict=True):
        assign(body, element_target, item, stmt)


def _held(body: FunctionBody, value: Value) -> Value:
    match value:
        case Whole() | Static() | Closure() | Const() | Uniform():
            return value
        case SequenceValue(items, is_list, captured):
            return SequenceValue(tuple(_held(body, i) for i in items), is_list, captured)
        case _:
            return body.hold("value", value)


def _depend(body: FunctionBody, items: list[Value], targets: list[ast.expr]) -> bool:
    """Return whether a value reads a local that an earlier assignment may have changed."""
    names = {n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)}
    variables = (body.lookup(name) for name in names)
    changing = {v.ir_name for v in variables if v is not None and v.changes}
    return bool(changing) and any(_reads(i, changing) for i in items)


def _reads(value: Value, names: set[str]) -> bool:
    match value:
        case Whole() | Static() | Closure():
            return False
        case SequenceValue(items):
            return any(_reads(i, names) for i in items)
        case _:
            return any(isinstance(e, Read) and e.name in names for e in nodes_in(value))


def unpacked_items(
    body: FunctionBody, value: Value, count: int, target: ast.expr, node: Node
) -> list[Value]:
    """Return the values for several targets.

    Args:
        body: The function being lowered.
        value: The value to unpack.
        count: The number of targets.
        target: The targets, for errors.
        node: The node of the value, for errors.

    Raises:
        SceneError: The value has another number of parts, or none.
    """
    if isinstance(value, SequenceValue):
        items = list(value.items)
    else:
        expr = with_default_type(body, value, node)
        parts = parts_of(body, expr)
        if parts is None:
            raise body.problem(
                ErrorCode.TYPE, must_be("what is unpacked", UNPACKED, expr.type), node
            )
        items = parts
    if len(items) != count:
        raise body.problem(
            ErrorCode.ASSIGNMENT, f"{count} names cannot take {len(items)} values", target
        )
    return items


def augment(body: FunctionBody, stmt: ast.AugAssign) -> None:
    """Lower ``target op= value``."""
    name = stmt.target if isinstance(stmt.target, ast.Name) else None
    try:
        old = lvalue(body, stmt.target) if name is None else body.read(local(body, name), name)
    except LOWERING_ERRORS as error:
        raise body.followup(error, (stmt.value,), body.expression) from None
    value = binary(body, stmt.op, old, body.expression(stmt.value), stmt)
    if isinstance(old, Whole | SequenceValue | Static | Closure):
        message = f"'{ast.unparse(stmt.target)}' does not change"
        raise body.problem(ErrorCode.ASSIGNMENT, message, stmt)
    if name is not None:
        _assign_name(body, name, value, stmt)
    else:
        _assign_part(body, old, stmt.target, value, stmt)
