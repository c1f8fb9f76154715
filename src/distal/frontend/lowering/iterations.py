"""What a ``for`` loop goes over: ``range``, an array, ``enumerate`` and ``zip``.

Input: the expression after ``in``. Output: the bounds of the IR's loop, and the value of one round
made from the loop's counter. Lengths are known at compile time, except those of a plain ``range``.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.lowering.expressions import arguments_of_range, array_name
from distal.frontend.lowering.lowered_nodes import unstarred
from distal.frontend.problems import must_be
from distal.frontend.types.coercion import coerce_or_raise, constant_int, with_default_type
from distal.frontend.values import FALSE, TRUE, SequenceValue, Static, Value, Whole
from distal.ir.build import add, element_type, integer, multiply
from distal.ir.nodes import Expr, Index
from distal.ir.types import INT, Array, Matrix, Vector

Bounds: TypeAlias = tuple[Expr, Expr, int]


@dataclass(frozen=True, slots=True)
class Iteration:
    """What a loop goes over.

    Attributes:
        bounds: The start, stop and step of the counter.
        element: The value of one round, from the counter.
        is_counter: Whether this value is the counter itself.
        first_is_counter: Whether it is a pair whose first value is the counter itself.
    """

    bounds: Bounds
    element: Callable[[Expr], Value]
    is_counter: bool = False
    first_is_counter: bool = False


@dataclass(frozen=True, slots=True)
class _Fixed:
    """Values whose number is known: ``element`` gives the one at a position."""

    length: int
    element: Callable[[Expr], Value]


def iteration(body: FunctionBody, node: ast.expr) -> Iteration:
    """Lower what stands after ``in`` of a loop.

    Raises:
        SceneError: A loop cannot go over it.
    """
    called = _called(body, node)
    if called is builtins.range and isinstance(node, ast.Call):
        return Iteration(_range(body, node), lambda counter: counter, is_counter=True)
    fixed = _fixed(body, node)
    bounds = (integer(0), integer(fixed.length), 1)
    from_zero = called is builtins.enumerate and not _has_start(node)
    return Iteration(bounds, fixed.element, first_is_counter=from_zero)


def _called(body: FunctionBody, node: ast.expr) -> Any:
    """Return the Python object that a call calls; None if the node is no call of one."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name | ast.Attribute):
        return None
    called = body.expression(node.func) if isinstance(node.func, ast.Name) else None
    return called.object if isinstance(called, Static) else None


def _has_start(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and len(node.args) + len(node.keywords) > 1


def _fixed(body: FunctionBody, node: ast.expr) -> _Fixed:
    rule = _ITERATORS.get(_called(body, node))
    if rule is not None:
        assert isinstance(node, ast.Call)
        return rule(body, node)
    return _values(body, node)


def _values(body: FunctionBody, node: ast.expr) -> _Fixed:
    value = body.expression(node)
    if isinstance(value, SequenceValue):
        # A tuple of equal types is gone through like a list.
        value = SequenceValue(value.items, is_list=True, captured=value.captured)
    expr = with_default_type(body, value, node)
    match expr.type:
        case Array(_, length):
            pass
        case Vector(_, length) | Matrix(length):
            pass
        case _:
            hint = "write for i in range(n)" if expr.type is INT else None
            wanted = "range(...), an array, a vector or a matrix"
            message = must_be("what a loop goes over", wanted, expr.type)
            raise body.problem(ErrorCode.TYPE, message, node, hint)
    held = body.hold(array_name(node), expr)
    return _Fixed(length, lambda counter: Index(held, counter, element_type(held.type)))


def _fixed_range(body: FunctionBody, node: ast.Call) -> _Fixed:
    start, stop, step = _range(body, node)
    first, last = constant_int(start), constant_int(stop)
    if first is None or last is None:
        hint = "its bounds are whole numbers"
        raise body.problem(ErrorCode.LOOP, "the length of this range is not known now", node, hint)
    length = len(range(first, last, step))
    return _Fixed(length, lambda counter: _shifted(start, counter, step))


def _shifted(start: Expr, counter: Expr, step: int) -> Expr:
    moved = counter if step == 1 else multiply(counter, integer(step))
    return moved if constant_int(start) == 0 else add(start, moved)


def _enumerate(body: FunctionBody, node: ast.Call) -> _Fixed:
    hint = "enumerate(values), or enumerate(values, start=1)"
    node = unstarred(body, node)
    plain = [*node.args, *(k.value for k in node.keywords if k.arg == "start")]
    unknown = any(k.arg != "start" for k in node.keywords)
    if unknown or not node.args or len(plain) > 2:
        raise body.problem(ErrorCode.CALL, "'enumerate' takes values and a start", node, hint)
    fixed = _fixed(body, plain[0])
    what = "the start of 'enumerate'"
    start: Expr = integer(0)
    if len(plain) == 2:
        value = coerce_or_raise(body, body.expression(plain[1]), INT, plain[1], what)
        start = body.hold("start", value)

    def element(counter: Expr) -> Value:
        pair = (_shifted(start, counter, 1), fixed.element(counter))
        return SequenceValue(pair, is_list=False)

    return _Fixed(fixed.length, element)


def _zip(body: FunctionBody, node: ast.Call) -> _Fixed:
    strict = False
    for keyword in node.keywords:
        value = body.expression(keyword.value) if keyword.arg == "strict" else None
        if value is not TRUE and value is not FALSE:
            raise body.problem(
                ErrorCode.CALL, "'zip' takes arrays, and strict=True or strict=False", keyword
            )
        strict = value is TRUE
    nodes = unstarred(body, node).args
    if not nodes:
        raise body.problem(
            ErrorCode.CALL, "'zip' takes one array or more", node, "zip(starts, ends)"
        )
    parts = [_fixed(body, n) for n in nodes]
    lengths = [p.length for p in parts]
    if strict and len(set(lengths)) > 1:
        listed = " and ".join(map(str, lengths))
        raise body.problem(ErrorCode.LOOP, f"'zip' with strict=True gets lengths {listed}", node)

    def element(counter: Expr) -> Value:
        return SequenceValue(tuple(p.element(counter) for p in parts), is_list=False)

    return _Fixed(min(lengths), element)


def _range(body: FunctionBody, node: ast.Call) -> Bounds:
    node = unstarred(body, node)
    args = arguments_of_range(body, node)
    step = constant_int(args[2]) if len(args) == 3 else 1
    if step is None:
        raise body.problem(
            ErrorCode.LOOP, "the step of a range is a whole number known now", node.args[2]
        )
    if step == 0:
        raise body.problem(ErrorCode.LOOP, "the step of a range is not 0", node.args[2])
    bounds = args[:2] if len(args) > 1 else [Whole(0), *args]
    nodes = node.args[:2] if len(args) > 1 else [node.args[0], node.args[0]]
    whole = [_bound(body, b, at) for b, at in zip(bounds, nodes, strict=True)]
    if step not in range(-(2**31), 2**31):
        raise body.problem(ErrorCode.NUMBER, f"{step} is out of the range of int", node.args[2])
    return whole[0], whole[1], step


def _bound(body: FunctionBody, value: Value, node: ast.expr) -> Expr:
    return coerce_or_raise(body, value, INT, node, "a bound of a range")


_ITERATORS: Final[dict[Any, Callable[[FunctionBody, ast.Call], _Fixed]]] = {
    builtins.range: _fixed_range,
    builtins.enumerate: _enumerate,
    builtins.zip: _zip,
}
