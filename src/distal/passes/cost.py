"""Estimate the cost of computing a node, in scalar operations.

Input: expressions and functions. Output: integers that passes compare with each other; they only
have to be right within a factor of two. Taking components from a value and building a value from
components is free on every target.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, assert_never

from distal.ir.contents import calls_in, contents, size_of
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Apply,
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    For,
    Function,
    FunctionRef,
    Gradient,
    Index,
    Logical,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Size,
    Splat,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    While,
)
from distal.ir.types import Kind, Matrix, Scalar, Type, Vector, component_count, kind_of
from distal.ir.walk import blocks, expressions, nodes_in, statements_in

UNKNOWN_ROUNDS: Final = 16  # the assumed number of iterations of a loop with non-constant bounds
MOST_ROUNDS: Final = 128
MOST_COST: Final = 1 << 40


def _components(type: Type) -> int:
    return component_count(type) if isinstance(type, Scalar | Vector | Matrix) else 4


def node_cost(e: Expr, calls: Mapping[str, int]) -> int:
    """Return the cost of one node without its operands; ``calls`` maps functions to their costs."""
    match e:
        case Const() | Read() | Uniform() | PerFrame() | Resource():
            return 0
        case Splat() | Compose() | Swizzle() | Field() | Construct() | FunctionRef():
            return 0
        case Unary() | Compare() | Cast() | Select():
            return _components(e.type)
        case Logical() | Size():
            return 1
        case Binary(op, _, _, type):
            return _components(type) * _operator_cost(op, kind_of(type))
        case MatMul(lhs, _, type):
            products = _components(type)
            side = lhs.type.size if isinstance(lhs.type, Vector | Matrix) else 1
            return 2 * products * side
        case Index(_, index):
            return 0 if isinstance(index, Const) else 3
        case Builtin(name, args):
            return INTRINSICS[name].cost * _components(args[0].type)
        case Call(function):
            return _call_cost(function, calls)
        case Sample() | Texel():
            return 20
        case Apply() | Gradient():
            return 100
        case _:
            assert_never(e)


def _operator_cost(op: BinaryOp, kind: Kind | None) -> int:
    match op:
        case BinaryOp.DIV:
            return 4
        case BinaryOp.FLOOR_DIV | BinaryOp.MOD:
            return 8
        case _:
            return 1


class Costs:
    """Costs of whole expressions; each distinct node is counted once.

    What long parts of an expression share (see ``Contents``) is counted for each of them, up to
    ``MOST_COST``: then no work is done twice for an expression that is a part of many.
    """

    def __init__(self, calls: Mapping[str, int]) -> None:
        self.calls = calls
        self._found: dict[Expr, int] = {}

    def of(self, e: Expr) -> int:
        """Return the cost of an expression."""
        waiting = [] if e in self._found else [e]
        while waiting:
            parts = [part for part in contents(waiting[-1]).parts if part not in self._found]
            if parts:
                waiting += parts
            else:
                last = waiting.pop()
                self._found[last] = self._cost(last)
        return self._found[e]

    def _cost(self, e: Expr) -> int:
        record = contents(e)
        if not record.parts:
            return expression_cost(e, self.calls)
        own = sum([node_cost(n, self.calls) for n in record.own])
        return min(own + sum([self._found[part] for part in record.parts]), MOST_COST)


def expression_cost(root: Expr, calls: Mapping[str, int]) -> int:
    """Return the cost of an expression; ``calls`` maps functions to their costs."""
    known = contents(root)
    if known.cost is None:
        known.cost = sum([node_cost(n, {}) for n in nodes_in(root) if not isinstance(n, Call)])
    return known.cost + sum([_call_cost(name, calls) for name in calls_in(root)])


def own_cost(root: Expr) -> int:
    """Return the cost of an expression without the bodies of the functions that it calls."""
    return expression_cost(root, dict.fromkeys(contents(root).callees, 0))


def _call_cost(function: str, calls: Mapping[str, int]) -> int:
    return 2 + calls.get(function, 100)


def function_costs(functions: Iterable[Function]) -> dict[str, int]:
    """Return the cost of each function's body; requires that callees precede callers."""
    costs: dict[str, int] = {}
    for function in functions:
        costs[function.name] = block_cost(function.body, costs)
    return costs


def block_cost(body: tuple[Stmt, ...], calls: Mapping[str, int]) -> int:
    """Return the cost of running a block; both branches of an If are counted."""
    total = 0
    for stmt in body:
        roots = expressions(stmt)
        if len(roots) == 1:
            own = expression_cost(roots[0], calls)
        else:
            own = sum(node_cost(n, calls) for n in nodes_in(*roots))
        inner = sum(block_cost(b, calls) for b in blocks(stmt))
        total += own + inner * rounds(stmt)
        if isinstance(stmt, While):
            total += own * (UNKNOWN_ROUNDS - 1)
    return total


def rounds(stmt: Stmt) -> int:
    """Return the assumed number of times that a statement's blocks run."""
    match stmt:
        case For(_, Const(start), Const(stop), step):
            return min(len(range(int(start), int(stop), step)), MOST_ROUNDS)
        case For() | While():
            return UNKNOWN_ROUNDS
        case _:
            return 1


def size(body: tuple[Stmt, ...]) -> int:
    """Return the size of a block: its statements plus its nodes except constants and reads."""
    return sum(1 + _size(expressions(s)) for s in statements_in(body))


def _size(roots: tuple[Expr, ...]) -> int:
    if len(roots) == 1:
        return size_of(roots[0])
    return sum(1 for n in nodes_in(*roots) if not isinstance(n, Const | Read))
