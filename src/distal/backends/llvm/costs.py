"""Estimate the cost of expressions and blocks, roughly in vector instructions.

Input: expressions and blocks. Output: numbers that decide whether a branch around code saves time.
"""

from __future__ import annotations

from distal.ir.contents import calls_in, contents
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Compare,
    Const,
    Expr,
    For,
    Function,
    Index,
    Logical,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    While,
)
from distal.ir.types import component_count, is_static, kind_of
from distal.ir.walk import blocks, children, expressions, nodes_in

_DIVISION = 8  # also for square roots: vector dividers take as long as about 8 multiplications
_HEAVY = frozenset(("sqrt", "inversesqrt"))


class LaneCosts:
    """Costs in one module; a call costs as much as its function, and a loop adds ``LOOP``."""

    LOOP = 1000
    MANY_ROUNDS = 2**31

    def __init__(self, functions: tuple[Function, ...]) -> None:
        self._functions: dict[str, int] = {}
        self._rounds: dict[str, int] = {}
        for function in functions:
            self._functions[function.name] = self.block(function.body)
            self._rounds[function.name] = self.rounds(function.body)

    def function(self, name: str) -> int:
        """Return the cost of a function's body."""
        return self._functions[name]

    def rounds_of(self, name: str) -> int:
        """Return the maximum iterations of a function's innermost loop; 1: it has no loop."""
        return self._rounds[name]

    def rounds(self, block: tuple[Stmt, ...]) -> int:
        """Return the maximum iterations of a block's innermost loop, including called functions."""
        most = 1
        for stmt in block:
            for e in expressions(stmt):
                most = max([most, *(self._rounds[name] for name in contents(e).callees)])
            inside = max((self.rounds(b) for b in blocks(stmt)), default=1)
            match stmt:
                case For():
                    own = constant_rounds(stmt)
                    inside *= self.MANY_ROUNDS if own is None else own
                case While():
                    inside = self.MANY_ROUNDS
            most = max(most, inside)
        return min(most, self.MANY_ROUNDS)

    def expression(self, *roots: Expr) -> int:
        """Return the cost of expressions; shared parts are counted once."""
        if len(roots) == 1:
            return self._expression(roots[0])
        return sum(self.node(e) for e in nodes_in(*roots))

    def _expression(self, root: Expr) -> int:
        known = contents(root)
        if known.lane_cost is None:
            nodes = (e for e in nodes_in(root) if not isinstance(e, Call))
            known.lane_cost = sum(map(self.node, nodes))
        return known.lane_cost + sum([self._functions[name] for name in calls_in(root)])

    def block(self, block: tuple[Stmt, ...]) -> int:
        """Return the cost of running every statement of a block once."""
        total = 0
        for stmt in block:
            total += self.expression(*expressions(stmt))
            total += sum(map(self.block, blocks(stmt)))
            if isinstance(stmt, For | While):
                total += self.LOOP
        return total

    def node(self, e: Expr) -> int:
        """Return the cost of a node without its operands."""
        match e:
            case Const() | Read() | Uniform() | PerFrame() | Resource() | Swizzle():
                return 0
            case Call(function):
                return self._functions[function]
            case Texel() | Sample():
                return 30
            case Binary(op) if op in (BinaryOp.DIV, BinaryOp.FLOOR_DIV, BinaryOp.MOD):
                return _DIVISION * width(e)
            case Builtin(name):
                wide = max(map(width, children(e)))
                if name == "length":
                    return _DIVISION + wide
                return wide * (_DIVISION if name in _HEAVY else 1)
            case MatMul():
                return 16
            case Index(base):
                return 1 if is_static(base.type) else 4
            case Binary() | Unary() | Compare() | Logical() | Select():
                return width(e)
            case _:
                return 0


def constant_rounds(stmt: For) -> int | None:
    """Return the number of iterations of a loop, or None if it is not constant."""
    match stmt.start, stmt.stop:
        case Const(start), Const(stop):
            return len(range(int(start), int(stop), stmt.step))
        case _:
            return None


def width(e: Expr) -> int:
    """Return the number of components of a value."""
    return component_count(e.type) if kind_of(e.type) else 4
