"""Lower expressions: one function for each kind of syntax node, in one table.

A node without an entry is not part of the language and is reported as an error.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from enum import EnumMeta
from types import ModuleType
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody, Variable
from distal.frontend.lowering.calls import arguments, lower_call
from distal.frontend.lowering.lowered_nodes import (
    LoweredNode,
    lowered_value,
    methods_of,
    without_stars,
)
from distal.frontend.lowering.refusals import refusal
from distal.frontend.other_languages import hint_for
from distal.frontend.problems import LOWERING_ERRORS, did_you_mean, must_be
from distal.frontend.types.coercion import coerce, constant_int, with_default_type
from distal.frontend.types.constructors import repeated
from distal.frontend.types.operators import binary, compare, condition, unary
from distal.frontend.types.python_objects import RefusedError, value_of
from distal.frontend.types.unification import unify_values
from distal.frontend.values import (
    FALSE,
    LARGEST_FLOAT,
    TRUE,
    Closure,
    SequenceValue,
    Static,
    Value,
    Whole,
)
from distal.ir.build import element_type, integer
from distal.ir.nodes import (
    Const,
    Expr,
    Field,
    Index,
    Logical,
    LogicalOp,
    Select,
    Swizzle,
    Unary,
    UnaryOp,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    Array,
    Buffer,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Vector,
    kind_of,
    vector_of,
)

_LETTER_SETS: Final = ("xyzw", "rgba")


def lower_expression(body: FunctionBody, node: ast.expr) -> Value:
    """Lower an expression.

    Raises:
        SceneError: The expression is not valid scene code.
    """
    rule = _RULES.get(type(node))
    if rule is None:
        raise refusal(body, node)
    return rule(body, node)


def _constant(body: FunctionBody, node: ast.Constant) -> Value:
    match node.value:
        case bool():
            return TRUE if node.value else FALSE
        case int():
            return Whole(node.value)
        case float():
            if abs(node.value) <= LARGEST_FLOAT:
                return Const(node.value, FLOAT)
            hint = "the largest is 3.4e38"
            raise body.problem(
                ErrorCode.NUMBER, "this number is larger than a 32-bit float can be", node, hint
            )
        case _:
            raise refusal(body, node)


def _name(body: FunctionBody, node: ast.Name) -> Value:
    found = body.find(node.id, node)
    if isinstance(found, Variable):
        return body.read(found, node)
    exists, obj = found
    if not exists:
        hint = hint_for(node.id, body.names.known() | body.scopes.names)
        raise body.problem(ErrorCode.NAME, f"'{node.id}' is not defined", node, hint)
    return object_value(body, obj, node.id, node)


def object_value(body: FunctionBody, obj: Any, text: str, node: ast.expr) -> Value:
    """Return the value of a Python object that scene code names.

    Args:
        body: The function being lowered.
        obj: The object.
        text: The name in the source, for messages.
        node: The node, for errors.

    Raises:
        SceneError: Scene code cannot use the object.
    """
    try:
        return value_of(obj, text, body.compilation)
    except RefusedError as refused:
        raise body.problem(ErrorCode.VALUE, refused.message, node, refused.hint) from None


def _attribute(body: FunctionBody, node: ast.Attribute) -> Value:
    base = body.expression(node.value)
    if isinstance(base, Static):
        return _static_attribute(body, base, node)
    if node.attr == "value" and _is_enum_member(body, node.value):
        return base
    if isinstance(base, SequenceValue) and len(base.items) in (2, 3, 4):
        base = _as_vector(body, base, node.value)
    value = with_default_type(body, base, node.value)
    return member(body, value, node.attr, node)


def _is_enum_member(body: FunctionBody, node: ast.expr) -> bool:
    """Return whether the node is ``Mode.A``, which is lowered to its value directly."""
    if not isinstance(node, ast.Attribute):
        return False
    owner = body.expression(node.value)
    return isinstance(owner, Static) and isinstance(owner.object, EnumMeta)


def _as_vector(body: FunctionBody, sequence: SequenceValue, node: ast.expr) -> Value:
    """Return a captured tuple as a vector of floats, because the code accesses its components."""
    coerced = coerce(body, sequence, vector_of(Kind.FLOAT, len(sequence.items)), node)
    return sequence if coerced is None else coerced


def member(body: FunctionBody, value: Expr, name: str, node: ast.expr) -> Expr:
    """Lower ``value.name``: a swizzle or a field.

    Args:
        body: The function being lowered.
        value: The value.
        name: The name of the field, or the letters of the swizzle.
        node: The node, for errors.

    Raises:
        SceneError: The value has no such component or field.
    """
    match value.type:
        case Vector(kind):
            lanes = swizzle_lanes(body, name, value.type, node)
            return Swizzle(value, lanes, vector_of(kind, len(lanes)), span=body.span(node))
        case Struct(_, fields, False):
            found = value.type.field(name)
            if found is not None:
                return Field(value, name, found, span=body.span(node))
            names = [n for n, _ in fields]
            close = did_you_mean(name, names)
            listed = f"fields: {', '.join(names)}"
            hint = f"{close} {listed}" if close else listed
            if name in methods_of(value.type):
                hint = f"it is a method: call it, {name}(...)"
            elif callable(getattr(value.type.owner, name, None)):
                hint = f"write @func above the def of '{name}'"
            raise body.problem(ErrorCode.NAME, f"{value.type} has no field '{name}'", node, hint)
        case _:
            hint = ""
            if isinstance(value.type, Scalar) and set(name) <= set("xyzwrgba"):
                hint = f"a {value.type} has one component: use it as it is"
            raise body.problem(ErrorCode.NAME, f"{value.type} has no '{name}'", node, hint or None)


def swizzle_lanes(body: FunctionBody, name: str, type: Vector, node: ast.expr) -> str:
    """Return the letters of a swizzle as ``xyzw``.

    Args:
        body: The function being lowered.
        name: The letters in the source, from ``xyzw`` or ``rgba``.
        type: The type of the vector.
        node: The node, for errors.

    Raises:
        SceneError: The vector has no such components, or there are more than 4 letters.
    """
    for letters in _LETTER_SETS:
        if set(name) <= set(letters):
            lanes = "".join("xyzw"[letters.index(c)] for c in name)
            if set(lanes) <= set("xyzw"[: type.size]):
                if len(lanes) <= 4:
                    return lanes
                raise body.problem(ErrorCode.NAME, "a swizzle has 1 to 4 letters", node)
            hint = f"its components are {', '.join(letters[: type.size])}"
            raise body.problem(ErrorCode.NAME, f"{type} has no component '{name}'", node, hint)
    if name == "length":
        raise body.problem(ErrorCode.NAME, f"{type} has no 'length'", node, "write length(v)")
    hint = f"its components are {', '.join('xyzw'[: type.size])}"
    if set(name) <= set("xyzwrgba"):
        hint = "xyzw and rgba do not mix in one swizzle"
    raise body.problem(ErrorCode.NAME, f"{type} has no component '{name}'", node, hint)


def _static_attribute(body: FunctionBody, base: Static, node: ast.Attribute) -> Value:
    text = f"{base.text}.{node.attr}"
    try:
        obj = getattr(base.object, node.attr)
    except AttributeError:
        known = dir(base.object)
        what = "the module" if isinstance(base.object, ModuleType) else ""
        subject = f"{what} '{base.text}'".strip()
        hint = did_you_mean(node.attr, known)
        if hint is None and isinstance(base.object, EnumMeta):
            hint = f"its members: {', '.join(base.object.__members__)}"
        raise body.problem(ErrorCode.NAME, f"{subject} has no '{node.attr}'", node, hint) from None
    except Exception as error:
        message = f"'{text}' fails: {type(error).__name__}"
        raise body.problem(ErrorCode.LANGUAGE, message, node) from None
    return object_value(body, obj, text, node)


def _bin_op(body: FunctionBody, node: ast.BinOp) -> Value:
    # A long sum is nested in its left operands: walk them in a loop instead of recursing.
    spine = [node]
    while isinstance(spine[-1].left, ast.BinOp):
        spine.append(spine[-1].left)
    operands = iter([spine[-1].left, *(step.right for step in reversed(spine))])
    try:
        value = body.expression(next(operands))
        for step in reversed(spine):
            value = _one_bin_op(body, step, value, body.expression(next(operands)))
            if not isinstance(value, Whole | SequenceValue | Static | Closure):
                value = body.shallow(value)
    except LOWERING_ERRORS as error:
        raise body.followup(error, operands, body.expression) from None
    return value


def _one_bin_op(body: FunctionBody, node: ast.BinOp, left: Value, right: Value) -> Value:
    if isinstance(node.op, ast.Mult):
        for one, other in ((left, right), (right, left)):
            if isinstance(one, SequenceValue) and one.is_list and not one.captured:
                return repeated(body, one, other, node)
    return binary(body, node.op, left, right, node)


def _unary_op(body: FunctionBody, node: ast.UnaryOp) -> Value:
    operand = body.expression(node.operand)
    if not isinstance(node.op, ast.Not):
        return unary(body, node.op, operand, node)
    if not isinstance(operand, Whole | SequenceValue | Static | Closure):
        type = operand.type
        if isinstance(type, Vector) and type.kind is Kind.BOOL:
            hint = "write ~v for each component, or not any(v)"
            raise body.problem(
                ErrorCode.TYPE, must_be("the operand of 'not'", BOOL, type), node, hint
            )
    value = condition(body, operand, node.operand, "the operand of 'not'")
    return Unary(UnaryOp.NOT, value, BOOL, span=body.span(node))


def _bool_op(body: FunctionBody, node: ast.BoolOp) -> Value:
    op = LogicalOp.AND if isinstance(node.op, ast.And) else LogicalOp.OR
    what = f"an operand of '{op.value}'"
    parts = body.each(lambda v: condition(body, body.expression(v), v, what), node.values)
    total = parts[0]
    for part in parts[1:]:
        total = body.shallow(Logical(op, total, part, BOOL, span=body.span(node)))
    return total


def _compare(body: FunctionBody, node: ast.Compare) -> Value:
    parts: list[Expr] = []
    operands = iter([node.left, *node.comparators])
    try:
        left = body.expression(next(operands))
        for op in node.ops:
            right = body.expression(next(operands))
            parts.append(compare(body, op, left, right, node))
            left = right
    except LOWERING_ERRORS as error:
        raise body.followup(error, operands, body.expression) from None
    if len(parts) == 1:
        return parts[0]
    total: Expr | None = None
    for part in parts:
        if part.type is not BOOL:
            hint = "write all(a < b) and all(b < c)"
            raise body.problem(
                ErrorCode.TYPE, "a chain compares single numbers, not vectors", node, hint
            )
        total = part if total is None else Logical(LogicalOp.AND, total, part, BOOL)
        total = body.shallow(total)
    assert total is not None
    return total


def _if_exp(body: FunctionBody, node: ast.IfExp) -> Value:
    operands = iter((node.test, node.body, node.orelse))
    try:
        test = condition(body, body.expression(next(operands)), node.test, "a condition")
    except LOWERING_ERRORS as error:
        raise body.followup(error, operands, body.expression) from None
    values = body.each(body.expression, operands)
    yes, no = unify_values(body, values, node, "the branches of a conditional expression")
    return Select(test, yes, no, yes.type, span=body.span(node))


def _subscript(body: FunctionBody, node: ast.Subscript) -> Value:
    try:
        base = body.expression(node.value)
    except LOWERING_ERRORS as error:
        is_text = isinstance(node.slice, ast.Slice | ast.Tuple | ast.Constant)
        raise body.followup(error, () if is_text else (node.slice,), body.expression) from None
    if isinstance(base, Static):
        message = f"'{base.text}' is not an array"
        raise body.problem(ErrorCode.VALUE, message, node)
    if isinstance(base, SequenceValue):
        position = constant_int(body.expression(node.slice))
        if position is not None:
            check_index(body, position, len(base.items), node)
            return base.items[position]
        return element(
            body, body.bind(array_name(node.value), with_default_type(body, base, node)), node
        )
    return element(body, with_default_type(body, base, node.value), node)


def array_name(node: ast.expr) -> str:
    """Return a name for a local that holds an array: the author's name if there is one."""
    match node:
        case ast.Name(name) | ast.Attribute(_, name):
            return name
        case _:
            return "values"


def element(body: FunctionBody, base: Expr, node: ast.Subscript) -> Expr:
    """Lower ``base[index]``, also as an assignment target.

    Args:
        body: The function being lowered.
        base: The array, vector, matrix, tuple or buffer.
        node: The subscript.

    Raises:
        SceneError: The base takes no index, or the index is invalid.
    """
    if isinstance(node.slice, ast.Slice):
        hint = "pick components by letters, such as .xy" if isinstance(base.type, Vector) else None
        raise body.problem(ErrorCode.LANGUAGE, "slices are not part of scene code", node, hint)
    if isinstance(node.slice, ast.Tuple):
        hint = "write m[column][row]" if isinstance(base.type, Matrix) else None
        raise body.problem(ErrorCode.INDEX, "an index is one number", node, hint)
    index = body.expression(node.slice)
    length = _length(body, base, node)
    position = constant_int(index)
    if position is not None:
        check_index(body, position, length, node)
        return _constant_element(body, base, position, node)
    value = with_default_type(body, index, node.slice)
    if isinstance(base.type, Struct):
        raise body.problem(ErrorCode.INDEX, "a tuple's index is a number known now", node.slice)
    if value.type is not INT:
        hint = (
            "write int(...) around it" if kind_of(value.type) in (Kind.FLOAT, Kind.UINT) else None
        )
        raise body.problem(ErrorCode.TYPE, must_be("an index", INT, value.type), node.slice, hint)
    return Index(base, value, element_type(base.type), span=body.span(node))


def _length(body: FunctionBody, base: Expr, node: ast.expr) -> int | None:
    match base.type:
        case Array(_, length):
            return length
        case Vector(_, size) | Matrix(size):
            return size
        case Struct(_, fields, True):
            return len(fields)
        case Buffer():
            return None
        case _:
            wanted = "an array, a vector, a matrix, a tuple or a buffer"
            raise body.problem(
                ErrorCode.TYPE, must_be("what takes an index", wanted, base.type), node
            )


def _constant_element(body: FunctionBody, base: Expr, position: int, node: ast.expr) -> Expr:
    span = body.span(node)
    match base.type:
        case Vector(kind):
            return Swizzle(base, "xyzw"[position], Scalar(kind), span=span)
        case Struct(_, fields):
            name, type = fields[position]
            return Field(base, name, type, span=span)
        case _:
            return Index(base, integer(position), element_type(base.type), span=span)


LONGEST_QUOTE: Final = 40  # characters of the author's code inside a hint


def check_index(body: FunctionBody, position: int, length: int | None, node: ast.Subscript) -> None:
    """Check that a constant index is in 0 .. length - 1.

    Negative indices are rejected, although Python counts them from the end: indices computed at run
    time are clamped, and the same index must not select two different elements.

    Args:
        body: The function being lowered.
        position: The index.
        length: The number of elements; None for a buffer, whose length is not known.
        node: The subscript.

    Raises:
        SceneError: The index is out of range.
    """
    if position < 0 and (length is None or position >= -length):
        text = ast.unparse(node.value)
        name = text if len(text) <= LONGEST_QUOTE else "..."
        inside = f"len({name}) - {-position}" if length is None else str(length + position)
        message = f"index {position} is negative: indices count from 0, on every target"
        raise body.problem(ErrorCode.INDEX, message, node, f"write {name}[{inside}]")
    if length is not None and not 0 <= position < length:
        raise body.problem(
            ErrorCode.INDEX, f"index {position} is out of range: there are {length} elements", node
        )


def _tuple(body: FunctionBody, node: ast.Tuple) -> Value:
    if not node.elts:
        raise body.problem(ErrorCode.SIZE, "an empty tuple holds nothing", node)
    return SequenceValue(_items(body, node.elts), is_list=False)


def _list(body: FunctionBody, node: ast.List) -> Value:
    if not node.elts:
        raise body.problem(
            ErrorCode.SIZE, "an array has at least one element", node, "write [0.0] * 8"
        )
    return SequenceValue(_items(body, node.elts), is_list=True)


def _items(body: FunctionBody, nodes: list[ast.expr]) -> tuple[Value, ...]:
    return tuple(body.each(body.expression, without_stars(body, nodes)))


def _lambda(body: FunctionBody, node: ast.Lambda) -> Value:
    return make_closure(body, node, "lambda")


def make_closure(body: FunctionBody, node: ast.Lambda | ast.FunctionDef, name: str) -> Closure:
    """Return a lambda or nested function, with its default values lowered here.

    Args:
        body: The function that contains it.
        node: Its syntax.
        name: Its name; ``lambda`` for a lambda.

    Raises:
        SceneError: It has starred parameters.
    """
    a = node.args
    if a.vararg or a.kwarg:
        raise body.problem(
            ErrorCode.LANGUAGE,
            "'*' parameters are not part of scene code",
            a.vararg or a.kwarg or a.args[0],
        )
    positional = [*a.posonlyargs, *a.args]
    pairs = list(zip(positional[len(positional) - len(a.defaults) :], a.defaults, strict=True))
    pairs += [(p, d) for p, d in zip(a.kwonlyargs, a.kw_defaults, strict=True) if d is not None]
    defaults: dict[str, Value] = {p.arg: body.expression(d) for p, d in pairs}
    return Closure(node, body, name, defaults)


def arguments_of_range(body: FunctionBody, node: ast.Call) -> list[Value]:
    """Lower the 1 to 3 arguments of ``range``.

    Raises:
        SceneError: There are more or fewer arguments, or keywords.
    """
    if node.keywords or not 1 <= len(node.args) <= 3:
        raise body.problem(
            ErrorCode.CALL, "'range' takes 1 to 3 arguments", node, "range(start, stop, step)"
        )
    return arguments(body, node)


_RULES: Final[dict[type[ast.expr], Callable[[FunctionBody, Any], Value]]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.BinOp: _bin_op,
    ast.UnaryOp: _unary_op,
    ast.BoolOp: _bool_op,
    ast.Compare: _compare,
    ast.IfExp: _if_exp,
    ast.Call: lower_call,
    ast.Subscript: _subscript,
    ast.Tuple: _tuple,
    ast.List: _list,
    ast.Lambda: _lambda,
    LoweredNode: lowered_value,
}
