"""Activity analysis: find the values that change when a function's arguments change.

Input: functions, with callees known by name, and for each parameter of one of them the set of
directions along which it changes. Output: these sets for every local and for the result. A set of
directions is an int with one bit for each direction. Values that are not floats count as constant,
and so do texels; control flow is assumed to be fixed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import assert_never

from distal.ir.contents import nodes_outside
from distal.ir.intrinsics import INTRINSICS, derivatives
from distal.ir.nodes import (
    Apply,
    Assign,
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
    Function,
    FunctionRef,
    Gradient,
    Index,
    Let,
    Logical,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Return,
    Sample,
    Select,
    Size,
    Splat,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    Var,
)
from distal.ir.tangents import has_floats
from distal.ir.walk import root_of, statements_in


@dataclass(frozen=True, slots=True)
class FunctionActivity:
    """The directions along which each local and the result change, as bit sets."""

    locals: Mapping[str, int]
    result: int


class Activity:
    """Computes and caches activities for the functions of one module."""

    def __init__(self, functions: Mapping[str, Function]) -> None:
        self._functions = functions
        self._known: dict[tuple[str, tuple[int, ...]], FunctionActivity] = {}

    def of(self, name: str, params: tuple[int, ...]) -> FunctionActivity:
        """Return the activity of a function whose parameters change along these directions."""
        key = (name, params)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = self._settled(self._functions[name], params)
        return found

    def _settled(self, function: Function, params: tuple[int, ...]) -> FunctionActivity:
        """Visit the statements until nothing is added; each round adds a bit or is the last."""
        active = {p.name: mask for p, mask in zip(function.params, params, strict=True)}
        statements = list(statements_in(function.body))
        while True:
            before = dict(active)
            memo: dict[Expr, int] = {}
            result = 0
            for stmt in statements:
                result |= self._step(stmt, active, memo)
            if active == before:
                return FunctionActivity(active, result)

    def _step(self, stmt: Stmt, active: dict[str, int], memo: dict[Expr, int]) -> int:
        match stmt:
            case Let(name, value) | Var(name, value):
                added = self.expression(value, active, memo)
            case Assign(target, value):
                name = root_of(target).name
                added = self.expression(value, active, memo)
            case Return(value):
                return self.expression(value, active, memo)
            case _:
                return 0
        if added & ~active.get(name, 0):
            active[name] = active.get(name, 0) | added
            memo.clear()
        return 0

    def expression(self, root: Expr, active: Mapping[str, int], memo: dict[Expr, int]) -> int:
        """Return the directions along which an expression changes.

        Args:
            root: The expression.
            active: The local -> the directions along which it changes.
            memo: The results for nodes so far; extended.

        Raises:
            AssertionError: The expression contains a node that earlier passes remove.
        """
        for e in nodes_outside(root, memo):
            memo[e] = self._node(e, active, memo) if has_floats(e.type) else 0
        return memo[root]

    def _node(self, e: Expr, active: Mapping[str, int], memo: Mapping[Expr, int]) -> int:
        match e:
            case Read(name):
                return active.get(name, 0)
            case Const() | Uniform() | PerFrame() | Resource() | Texel() | Size():
                return 0
            case Compare() | Logical() | Cast():
                return 0
            case Unary(_, operand) | Splat(operand) | Swizzle(operand) | Field(operand):
                return memo[operand]
            case Index(base):
                return memo[base]
            case Binary(BinaryOp.FLOOR_DIV):
                return 0
            case Binary(_, lhs, rhs) | MatMul(lhs, rhs):
                return memo[lhs] | memo[rhs]
            case Select(_, yes, no):
                return memo[yes] | memo[no]
            case Compose(parts) | Construct(parts):
                return _union(parts, memo)
            case Builtin(name, args):
                rule = INTRINSICS[name].derivative
                return 0 if rule is derivatives.constant else _union(args, memo)
            case Call(name, args):
                return self.of(name, tuple(memo[a] for a in args)).result
            case Sample(_, coord):
                return memo[coord]
            case Apply() | FunctionRef() | Gradient():
                raise AssertionError(f"{e} is gone before gradients are taken")
            case _:
                assert_never(e)


def _union(parts: tuple[Expr, ...], memo: Mapping[Expr, int]) -> int:
    total = 0
    for part in parts:
        total |= memo[part]
    return total
